"""What can be said of a claim."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum


class Verdict(StrEnum):
    """Three answers."""

    REPRODUCED = "reproduced"
    NOT_REPRODUCIBLE = "not reproducible"
    WRONG = "wrong"


@dataclass(frozen=True)
class Claim:
    """A claim of the paper and what became of it.

    Attributes
    ----------
    where
        Section, table, figure or equation.
    claim
        What the paper says, in short.
    verdict
        Ours.
    evidence
        Why, in one or two sentences with the numbers computed.
    numbers
        The same numbers by name, unit in the name, SI but for µm.
    """

    where: str
    claim: str
    verdict: Verdict
    evidence: str
    numbers: Mapping[str, float] = field(default_factory=dict)


def small(value: float) -> str:
    """A tiny number by its size alone."""
    return "0" if value == 0.0 else f"{value:.0e}"


def reproduced_if(holds: bool, otherwise: Verdict = Verdict.WRONG) -> Verdict:
    """Reproduced where the numbers say so, `otherwise` else."""
    return Verdict.REPRODUCED if holds else otherwise
