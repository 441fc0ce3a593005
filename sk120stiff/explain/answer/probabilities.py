"""How probable every name is, and what each number is a probability of.

Names that could stand in one place exclude one another there: their numbers and that of nothing in
this place add up to one. Numbers of different places do not exclude one another.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sk120stiff.explain.answer.verdict import Kind
from sk120stiff.explain.judge.posterior import LISTED, NONE

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation
    from sk120stiff.explain.findings import Finding

SOMETHING_ELSE = "something_else"
EVEN = 0.5  # probability of nothing below which nobody is told that nothing is missing


@dataclass(frozen=True)
class Odds:
    """One probability.

    Attributes:
        name: ``name:where``, ``none`` or ``something_else``.
        probability: See `kind`.
        kind: ``named``: that the named effect stands in its place, beside all other names;
            ``instead``: that this one stands there in its stead; ``further``: that it is at work
            besides all that is named; ``none``: that no effect is missing, and nothing else is;
            ``something_else``: that a cause is at work which no effect in the model is.
        place: The named effect whose place it is; None where it is nobody's.
    """

    name: str
    probability: float
    kind: Kind
    place: str | None = None


def probabilities(answer: Explanation) -> tuple[Odds, ...]:
    """Every candidate above a hundredth, the likeliest first, with ``none`` and something else.

    A name has one line: where it may stand in several places, that of the largest.
    """
    found: dict[str, Odds] = {}
    for name, share in answer.odds.items():
        if name != NONE:
            found[name] = Odds(name, share, "further")
    for finding in answer.findings:
        own = finding.effect.id
        for name, share in finding.evidence.odds.items():
            if name not in found or share > found[name].probability:
                found[name] = Odds(name, share, "named" if name == own else "instead", own)
    for finding in answer.findings:  # what is named is told as such, wherever else it might stand
        own = finding.effect.id
        found[own] = Odds(own, finding.evidence.odds.get(own, 0.0), "named", own)
    listed = [each for each in found.values() if each.probability > LISTED]
    none = Odds(NONE, nothing(answer), "none")
    other = Odds(SOMETHING_ELSE, answer.remainder.something_else, "something_else")
    return tuple(sorted([*listed, none, other], key=lambda each: -each.probability))


def nothing(answer: Explanation) -> float:
    """Probability that no effect of the catalogue is missing, and nothing else is."""
    share = answer.odds.get(NONE, 1.0) * (1.0 - answer.remainder.something_else)
    for finding in answer.findings:
        share *= nothing_in_its_place(finding)
    return share


def unsettled(answer: Explanation) -> str:
    """What may be missing where nothing is named, in words."""
    others = [each for each in probabilities(answer) if each.kind != "none"]
    said = f"its probability is {nothing(answer):.2f}"
    if not others:
        return said
    unnamed = others[0].kind == SOMETHING_ELSE
    name = "a cause without a name" if unnamed else others[0].name
    return f"{said}, that of {name} {others[0].probability:.2f}"


def nothing_in_its_place(finding: Finding) -> float:
    """Probability that no effect of the catalogue stands in the place of a named one.

    Its rivals are effects too: what they have is not that of none.
    """
    return max(0.0, 1.0 - sum(finding.evidence.odds.values()))
