"""The proof: a campaign in which a cause was hidden, explained, and only then the truth."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from sk120stiff.errors import listed
from sk120stiff.explain import Explanation
from sk120stiff.model import Parameter
from sk120stiff.show.report import Note, Section, Table
from sk120stiff.show.stories.gap_section import steps_table, waterfall
from sk120stiff.show.stories.verdicts import title_of
from sk120stiff.show.wording import number, um, with_error


@dataclass(frozen=True, eq=False)
class HiddenCause:
    """What `explain` said of a campaign, beside what was hidden in it.

    Attributes:
        answer: The explanation, which knew the readings and nothing else.
        hidden: Name and place of every cause that was hidden.
        values: Name of a parameter → its true value in public units.
    """

    answer: Explanation
    hidden: tuple[str, ...]
    values: dict[str, float]

    @property
    def found(self) -> tuple[str, ...]:
        """Name and place of every effect that was named."""
        return tuple(finding.effect.id for finding in self.answer.findings)

    @property
    def parameters(self) -> list[Parameter]:
        """Those of the final model whose truth is known."""
        return [p for p in self.answer.final.parameters if p.name in self.values]

    def table(self) -> Table:
        """Every value that was hidden, beside what the readings gave."""
        return Table(
            ["parameter", "found ± standard error", "hidden"],
            [
                (p.name, with_error(p.value, p.std, p.spec.unit), number(self.values[p.name], 4))
                for p in self.parameters
            ],
            "Every value that was hidden, beside what the readings gave.",
        )

    def opened(self) -> str:
        """The truth in a sentence."""
        same = set(self.found) == set(self.hidden)
        verdict = "and that is what was named" if same else "and that is not what was named"
        return f"Only now the truth is opened: {listed(self.hidden)} was hidden, {verdict}."

    def in_short(self) -> str:
        """What came of the campaign, in a sentence."""
        first, last = self.answer.steps[0], self.answer.steps[-1]
        if set(self.found) != set(self.hidden):
            return "In a simulated campaign with a hidden cause, that cause was not found."
        return (
            f"In a simulated campaign with a hidden cause, `{listed(self.found)}`, that cause is "
            f"named and added, and the gap at new poses falls from {um(first.heldout_rms)} to "
            f"{um(last.heldout_rms)} µm."
        )


def opened(answer: Explanation, truth: Path) -> HiddenCause:
    """An answer beside the truth, which is read from its file only here."""
    document = json.loads(truth.read_text(encoding="utf-8"))
    effects = [(f"{e['name']}:{e['where']}", e["quantities"]) for e in document["effects"]]
    values = {
        f"joint_springs:{joint}.stiffness": value for joint, value in document["springs"].items()
    }
    for name, quantities in effects:
        values |= {f"{name}.{quantity}": value for quantity, value in quantities.items()}
    return HiddenCause(answer, tuple(name for name, _ in effects), values)


def hidden_section(cause: HiddenCause, link: str) -> Section:
    """The proof as a part of a report, with the address of the campaign's own."""
    answer = cause.answer
    first, last = answer.steps[0], answer.steps[-1]
    poses = len(answer.base.problem.load_cases.poses)
    return Section(
        "4. The proof: a hidden cause",
        [
            f"Other code than this program's models simulated a campaign of {poses} poses with an "
            "SK120 in which something more than springs is at work. `explain` saw its readings "
            f"and nothing else. Its answer: **{title_of(answer)}** The gap at poses that no fit "
            f"saw falls from {um(first.heldout_rms)} to {um(last.heldout_rms)} µm rms per axis.",
            steps_table(answer),
            waterfall(answer),
            Note(cause.opened(), "note", "The truth"),
            cause.table(),
            *([f"The whole answer stands in `{link}`."] if link else []),
        ],
    )
