"""What `explain` leaves in its folder, and what it prints: `demo` uses the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sk120stiff.cli.frame import note
from sk120stiff.cli.opening import provenance
from sk120stiff.cli.outputs import refuse_foreign, will_write_into, write_pages
from sk120stiff.cli.positions import yielding
from sk120stiff.cli.shares import budget_tables
from sk120stiff.cli.tables import table
from sk120stiff.cli.values import value_lines
from sk120stiff.explain import Explained, Explanation
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.answer.probabilities import probabilities
from sk120stiff.explain.answer.saving import RESULTS
from sk120stiff.explain.answer.sizes import whole_size
from sk120stiff.explain.answer.verdict import BEST_GUESS, NEXT_POSES, VERDICT
from sk120stiff.explain.answer.words import (
    held_out_words,
    noise_words,
    plain_words,
    set_aside_sentences,
)
from sk120stiff.explain.findings import Contender, Finding, likely, sentence_in
from sk120stiff.identify import unseen_reasons, unseen_sentences
from sk120stiff.identify.report import noise_sentence
from sk120stiff.measurements import Measurements
from sk120stiff.show.wording import um

STRONG = 6  # difference of scores
MANY = 12  # parameters of one effect beyond which only the largest is printed
TOLD = 3  # sentences on where the gap lives that are printed; the report has all


@dataclass(frozen=True)
class Task:
    """What was explained.

    Attributes:
        readings: The measurements.
        data: Their file.
        inputs: All input files, for the report.
        holdout: File of held-out readings, or None.
        seed: Of folds and resampling.
    """

    readings: Measurements
    data: Path
    inputs: Sequence[Path]
    holdout: Path | None = None
    seed: int = 0


def check_folder(out: Path) -> None:
    """Complain before the work, not after it; every result of ours holds a verdict."""
    will_write_into(out, ())
    refuse_foreign(out, RESULTS, ours=(out / VERDICT).exists())
    will_write_into(out, RESULTS)


def write_answer(
    answer: Explanation | Explained,
    task: Task,
    out: Path,
    *,
    report: bool,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, object]:
    """Write verdict, model and gaps as soon as they are known, the pages after them.

    A page that cannot be made is a warning: what was found stands on the disk by then.

    Returns:
        dict: The content of `verdict.json`, and where the files are that were written.
    """
    tell = progress or (lambda _done, _total: None)
    document = answer.save(out, provenance=provenance(task.data, task.readings))
    tell(88, 100)
    try:
        pages = _write_pages(answer, task, out) if report else {}
    except KeyboardInterrupt:
        note(f"What was found stands in {out}; its pages, as report.html, were not made.")
        raise
    tell(100, 100)
    return {**document, "out": out, "model": out / "model.yaml", **pages}


def _write_pages(answer: Explanation | Explained, task: Task, out: Path) -> dict[str, Path]:
    """Scene and report, each where it can be made."""
    from sk120stiff.show import reproducibility, scene_of_model
    from sk120stiff.show.stories import explain_scene

    command = provenance(task.data, task.readings)["command"]
    facts = reproducibility(command, task.inputs, seed=task.seed)
    if isinstance(answer, Explained):
        model, told = answer.final.model, answer.report
        before = {"before": answer.base.model, "after": model} if answer.findings else {}
        return write_pages(
            out,
            lambda: scene_of_model(
                yielding(model),
                task.readings,
                models=before or {"model": model},
                title=model.robot.name,
                subtitle=task.data.name,
                model_file="model.yaml",
                named=[finding.effect for finding in answer.findings],
            ),
            lambda scene: told(
                data=task.data.name,
                scene=scene,
                scene_link="scene.html" if scene else "",
                reproducibility=facts,
            ),
        )
    return write_pages(
        out,
        lambda: explain_scene(answer, subtitle=task.data.name, model_file="model.yaml"),
        lambda scene: answer.report(
            data=task.data.name,
            scene=scene,
            scene_link="scene.html" if scene else "",
            next_poses="" if answer.next_poses is None else NEXT_POSES,
            reproducibility=facts,
            **({} if task.holdout is None else {"heldout": _heldout(task.holdout)}),
        ),
    )


def _heldout(file: Path) -> str:
    return f"on the readings of `{file.name}`, which are of other poses"


def parts(answer: Explanation, out: Path, *, report: object = None) -> list[object]:
    """The answer for people; `report` is where the report was written, if it was."""
    shown: list[object] = [said(answer), *answer.limits, *findings(answer)]
    shown += answer.known_together
    rows = [(s.label, s.fit_rms * 1e6, s.heldout_rms * 1e6) for s in answer.steps]
    shown.append(table("Gap [µm rms per axis]", ["model", "fitted", "held out"], rows))
    shown += [*plain_words(answer), *held_out_words(answer)]
    shown += budget_tables(answer)
    shown += answer.where[:TOLD]
    if answer.suspects:
        lead = "Best, but not confirmed" if answer.unnamed else "Nearest, but not it"
        shown.append(f"{lead}: {', '.join(map(_gain, answer.suspects))}.")
    shown += (*answer.notes, *answer.unnamed)
    shown += unseen_sentences(answer.final)
    if answer.findings and answer.adequacy.lacking:
        shown.append("That is not all: more is left than the noise makes.")
    told = [sentence for sentence in answer.remainder.where if sentence not in shown]
    shown += [answer.remainder.sentence(), *told, *_odds(answer)]
    if answer.guess is not None:
        shown.append(f"The best guess stands in {out / BEST_GUESS}; it is not confirmed.")
    shown.append(noise_sentence(answer.final))
    if answer.adequacy.whole is not None:
        shown.append(answer.adequacy.whole.sentence())
    shown += noise_words(answer)
    shown += set_aside_sentences(answer)
    shown.append(f"What to do now: {next_step(answer)}")
    if answer.next_poses is not None:
        shown.append(f"Measure next what stands in {out / 'next_poses.csv'}.")
    shown += answer.details.get("next_remarks", ())
    if report is not None:
        shown.append(f"Report: {report}")
    shown.append(f"Results are in {out}.")
    return shown


def said(answer: Explanation) -> str:
    """The verdict in the words of the report; what is named follows."""
    if answer.verdict == "named":
        if answer.remainder.significant:
            return (
                "Something was missing. Part of it has a name; "
                f"{um(answer.remainder.rms)} µm rms per axis have none."
            )
        return "Something was missing, and it has a name."
    from sk120stiff.show.stories.verdicts import lead_of  # slow to import

    return lead_of(answer)


def findings(answer: Explanation) -> list[str]:
    """Every named effect, its alternatives and its size."""
    lines = []
    unseen = unseen_reasons(answer.final) if answer.findings else {}
    for finding in answer.findings:
        said = sentence_in(answer.final.model, finding.effect)
        lines.append(f"{said} [{finding.effect.id}] ({_sure(finding)})")
        for other in finding.alternatives:
            share = finding.evidence.odds.get(other)
            kind = "always the same" if other in finding.exact else "not told apart here"
            lines.append(f"  or {other} ({kind}{'' if share is None else f'; {likely(share)}'})")
        own = [p for p in answer.final.model.parameters if p.effect == finding.effect]
        if len(own) > MANY:
            largest = max(own, key=lambda p: abs(p.value))
            lines.append(f"  {len(own)} values, the largest:")
            own = [largest]
        lines += value_lines(own, unseen)
        whole = whole_size(answer, finding)
        if whole is not None:
            lines.append(f"  {whole.sentence}")
        evidence = finding.evidence
        if evidence.runner_up is not None:
            worse = f"worse by {evidence.runner_up_gap:.0f} (BIC; {STRONG} is strong)"
            lines.append(f"  next best: {evidence.runner_up}, {worse}")
    return lines


def _gain(suspect: Contender) -> str:
    """A suspect with what poses that were left out say of it."""
    if not np.isfinite(suspect.heldout_gain):
        return f"{suspect.id} (poses left out do not hold it)"
    way = "falls" if suspect.heldout_gain >= 0.0 else "grows"
    return f"{suspect.id} (the held-out gap {way} by {um(abs(suspect.heldout_gain))} µm)"


def _sure(finding: Finding) -> str:
    """How probable a name is, and where others stand beside it, they and it together."""
    together, odds = likely(finding.probability), finding.evidence.odds
    if not any(name in odds for name in finding.alternatives):
        return together
    own = likely(odds.get(finding.effect.id, 0.0))
    return f"{own}; it or one of those below: {together}"


def _odds(answer: Explanation) -> list[str]:
    """Of nothing and of something else."""
    left = {each.kind: each.probability for each in probabilities(answer)}
    none, other = (
        likely(left[kind], "").strip().removeprefix("= ") for kind in ("none", "something_else")
    )
    return [
        f"Probability that nothing is missing: {none}; that something without a name is at work: "
        f"{other}."
    ]


def warn_of_known_poses(readings: Measurements, others: Measurements) -> None:
    """Say which held-out readings are of poses that are fitted: they prove less."""
    known = np.unique(np.round(readings.joints, 9), axis=0)
    same = (np.round(others.joints, 9)[:, None] == known).all(axis=2).any(axis=1)
    if same.any():
        labels = dict.fromkeys(np.array(others.pose)[same])
        note(f"Held-out readings of poses that are fitted too: {', '.join(labels)}.")
