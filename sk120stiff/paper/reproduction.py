"""The whole paper, recomputed, and every claim of it.

Claims stand in its order, each with a verdict that follows from computed numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import TypeVar

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from sk120stiff.arrays import Array, rms
from sk120stiff.errors import listed
from sk120stiff.paper import printed
from sk120stiff.paper.forces import (
    Critical,
    DiagonalParts,
    Posture,
    Pull,
    critical,
    diagonal_parts,
    posture,
    pulls,
)
from sk120stiff.paper.formulation import Appendix, Formulation, appendix, formulation
from sk120stiff.paper.identified import FITS, Identified, identify_springs
from sk120stiff.paper.recomputed import Table2, Table3, Table4, table2, table3, table4
from sk120stiff.paper.setting import Setting, setting

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Reproduction:
    """Every table, figure and claim of the paper beside ours; made by `reproduce`."""

    setting: Setting
    table2: Table2
    identified: Identified
    table3: Table3
    table4: Table4
    critical: Critical
    appendix: Appendix
    formulation: Formulation
    posture: Posture
    parts: DiagonalParts
    pulls: tuple[Pull, ...]

    @cached_property
    def claims(self) -> tuple[Claim, ...]:
        """Every claim of the paper with its verdict."""
        return claims(vars(self))


def reproduce(report: Callable[[int, int], None] = lambda _done, _total: None) -> Reproduction:
    """Recompute the paper's tables and figures with the bundled SK120.

    `report` is called with steps done and steps in all.
    """
    done, total = 0, FITS + 9

    def step() -> None:
        nonlocal done
        done += 1
        report(done, total)

    def after(result: T) -> T:
        step()
        return result

    arm = setting()
    second = after(table2(arm))
    found = identify_springs(arm, second.measured, step)
    third = after(table3(arm))
    springs = {"springs of the paper": arm.arm_springs, "springs identified here": found.springs}
    return Reproduction(
        arm,
        second,
        found,
        third,
        after(table4(arm)),
        after(critical(arm)),
        after(appendix(arm)),
        after(formulation(arm)),
        after(posture(arm, (second.printed, third.printed))),
        after(diagonal_parts(arm)),
        after(pulls(arm, springs)),
    )


_CLAIM = re.compile(r"\[(.*?)\] (.*?)\n= (?:(\w+), else )?([a-z ]+)\n(.*)", re.DOTALL)


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


def claims(found: Mapping[str, object]) -> tuple[Claim, ...]:
    """All claims of `claims.md.j2`, section by section, from the fields of a `Reproduction`."""
    loader = PackageLoader("sk120stiff.paper", "")
    page = Environment(loader=loader, undefined=StrictUndefined, autoescape=False)
    page.filters |= {"to": _to, "size": _size, "plusminus": _plus_minus, "listed": listed}
    text = page.get_template("claims.md.j2").render(found, np=np, rms=rms, paper=printed)
    return tuple(map(_read, text.strip().split("\n\n")))


def _read(block: str) -> Claim:
    match = _CLAIM.fullmatch(block)
    if match is None:
        raise ValueError(f"this claim cannot be read: {block}")
    where, claim, holds, otherwise, evidence = match.groups()
    verdict = Verdict.REPRODUCED if holds == "True" else Verdict(otherwise)
    return Claim(where, claim.replace("\n", " "), verdict, evidence.replace("\n", " "))


def _to(value: float | Mapping[str, float], form: str, factor: float = 1.0) -> str:
    """A number in the unit that `factor` makes, or those of a mapping side by side."""
    values = value.values() if isinstance(value, Mapping) else [value]
    return " / ".join(format(factor * each, form) for each in values)


def _size(value: float) -> str:
    """The size alone of a tiny number."""
    return "0" if value == 0.0 else f"{value:.0e}"


def _plus_minus(springs: Array, errors: Array, form: str) -> str:
    """Springs and their errors in MN·m/rad."""
    pairs = zip(1e-6 * springs, 1e-6 * errors, strict=True)
    return ", ".join(f"{value:{form}} ± {error:{form}}" for value, error in pairs)
