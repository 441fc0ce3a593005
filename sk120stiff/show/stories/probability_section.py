"""How probable every name is: in its place, beside it, nothing at all, something without a name."""

from __future__ import annotations

from typing import NamedTuple

from sk120stiff.explain import Explanation
from sk120stiff.explain.answer.probabilities import nothing_in_its_place, probabilities
from sk120stiff.explain.findings import likely
from sk120stiff.show.figures.probabilities import probability_bars
from sk120stiff.show.report import Picture, Section, Table

FURTHER = 5  # names that may be at work besides and are listed; verdict.json has all
SMALL = 1e-3  # rivals below are not drawn


class Row(NamedTuple):
    """One line: whose place it is, what may be there, how probable it is, and whether it is named.

    A line without a place is of the whole answer.
    """

    place: str
    name: str
    probability: float
    named: bool = False


def probability_section(answer: Explanation) -> Section:
    """Bars and a table; lines of one place add up to one."""
    rows = rows_of(answer)
    said = [likely(row.probability, "").strip().removeprefix("= ") for row in rows]
    told = "; ".join(f"{row.name} {text}" for row, text in zip(rows, said, strict=True))
    return Section(
        "How probable it is",
        [
            "Names that could stand in one place exclude one another: with 'none of them' they "
            "add up to one, less what may be in this place and has no name. A name is given alone "
            "from 0.95 on. They are probabilities within the catalogue; 'something without a name' "
            "is what it lacks.",
            Picture(
                lambda: probability_bars(
                    [(row.name, row.probability) for row in rows],
                    said,
                    named=[k for k, row in enumerate(rows) if row.named],
                ),
                alt=f"Bars of {len(rows)} probabilities: {told}.",
                caption="Violet: what was named.",
            ),
            Table(
                ["in the place of", "what", "probability"],
                [(row.place, row.name, text) for row, text in zip(rows, said, strict=True)],
                "All of it as numbers; verdict.json has more digits.",
            ),
        ],
    )


def rows_of(answer: Explanation) -> list[Row]:
    """Place by place, then what may be at work besides, nothing, and something else."""
    rows = []
    for finding in answer.findings:
        own, odds = finding.effect.id, finding.evidence.odds
        listed = sorted((name for name in odds if name != own), key=lambda name: -odds[name])
        rows.append(Row(own, own, odds.get(own, 0.0), named=True))
        rows += [Row(own, name, odds[name]) for name in listed if odds[name] > SMALL]
        rows.append(Row(own, "none of them", nothing_in_its_place(finding)))
    every = probabilities(answer)
    further = [each for each in every if each.kind == "further"][:FURTHER]
    rows += [Row("besides", f"{each.name}, one more", each.probability) for each in further]
    names = {"none": "nothing is missing", "something_else": "something without a name"}
    whole = [each for each in every if each.kind in names]
    rows += [Row("the whole", names[each.kind], each.probability) for each in whole]
    return rows
