"""The whole paper, recomputed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

from sk120stiff.paper.appendix import Appendix, appendix
from sk120stiff.paper.claims import Claim, claims
from sk120stiff.paper.forces import Critical, DiagonalParts, critical, diagonal_parts
from sk120stiff.paper.formulation import Formulation, formulation
from sk120stiff.paper.identified import FITS, Identified, identify_springs
from sk120stiff.paper.posture import Posture, Pull, posture, pulls
from sk120stiff.paper.setting import Setting, setting
from sk120stiff.paper.table2 import Table2, table2
from sk120stiff.paper.table3 import Table3, table3
from sk120stiff.paper.table4 import Table4, table4

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
