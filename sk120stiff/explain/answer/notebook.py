"""An explanation as a notebook shows it: the names, the gap step by step, where it lives.

The whole story with its figures is `Explanation.report`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation
from sk120stiff.explain.findings import Finding

HEADINGS = {
    "none": "Nothing is missing that these readings could show",
    "named": "Model and readings disagree, and the reason has a name",
    "ambiguous": "Model and readings disagree, and no one name is sure",
    "outside": "Model and readings disagree, and no effect of the catalogue explains it",
}
FULL = 160.0  # width of the longest bar [px]


def summary_html(answer: Explanation) -> str:
    """A fragment of HTML without scripts; every text in it is escaped."""
    heading = HEADINGS[answer.verdict]
    if answer.verdict == "none" and answer.unnamed:
        heading = "No effect can be named"
    parts = [f"<h4>{heading}</h4>"]
    if answer.findings:
        parts.append(
            _table(
                ("effect", "what happens", "size", "or", "poses drawn again say so"),
                (_named(answer, finding) for finding in answer.findings),
            )
        )
    elif answer.suspects:
        names = ", ".join(suspect.id for suspect in answer.suspects)
        parts.append(f"<p>Nearest, but not confirmed: {escape(names)}</p>")
    parts.append(
        _table(
            ("model", "gap fitted [µm rms]", "on other poses [µm rms]", ""),
            (_step(answer, k) for k in range(len(answer.steps))),
        )
    )
    parts.append(_list((*answer.unnamed, *answer.where)))
    if answer.next_poses is not None:
        count = len(answer.next_poses[0])
        parts.append(f"<p><code>next_poses</code> holds {count} readings that would settle it.</p>")
    return "<div>" + "".join(parts) + "</div>"


def _named(answer: Explanation, finding: Finding) -> Sequence[str]:
    sizes = []
    for p in answer.final.model.parameters:
        if p.effect == finding.effect and p.free:
            std = "" if p.std is None else f" ± {p.std:.2g}"
            sizes.append(f"{escape(p.spec.name)} = {p.value:.4g}{std} {escape(p.spec.unit)}")
    return (
        f"<code>{escape(finding.effect.id)}</code>",
        escape(finding.effect.sentence()),
        "<br>".join(sizes),
        "<br>".join(f"<code>{escape(name)}</code>" for name in finding.alternatives) or "–",
        f"{100.0 * finding.evidence.confirmation.frequency:.0f} %",
    )


def _step(answer: Explanation, number: int) -> Sequence[str]:
    step = answer.steps[number]
    largest = max(each.heldout_rms for each in answer.steps)
    width = FULL * step.heldout_rms / largest if largest > 0.0 else 0.0
    bar = f'<div style="background:#4477aa;height:0.8em;width:{width:.0f}px"></div>'
    return (
        f"<code>{escape(step.label)}</code>",
        f"{1e6 * step.fit_rms:.3g}",
        f"{1e6 * step.heldout_rms:.3g}",
        bar,
    )


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Cells are HTML already."""
    top = "".join(f"<th>{escape(word)}</th>" for word in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def _list(sentences: Iterable[str]) -> str:
    return "<ul>" + "".join(f"<li>{escape(text)}</li>" for text in sentences) + "</ul>"
