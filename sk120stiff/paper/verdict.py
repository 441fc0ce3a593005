"""What can be said of a claim."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """Three answers."""

    REPRODUCED = "reproduced"
    NOT_REPRODUCIBLE = "not reproducible"
    WRONG = "wrong"


@dataclass(frozen=True)
class Claim:
    """A claim of the paper, its section, table or equation, and what became of it, and why."""

    where: str
    claim: str
    verdict: Verdict
    evidence: str


def small(value: float) -> str:
    """A tiny number by its size alone."""
    return "0" if value == 0.0 else f"{value:.0e}"


def reproduced_if(holds: bool, otherwise: Verdict = Verdict.WRONG) -> Verdict:
    """Reproduced where the numbers say so, `otherwise` else."""
    return Verdict.REPRODUCED if holds else otherwise
