"""The whole paper, recomputed."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TypeVar

from sk120stiff.paper.appendix import appendix
from sk120stiff.paper.claims import Claim, claims
from sk120stiff.paper.findings import Findings
from sk120stiff.paper.forces import critical, diagonal_parts
from sk120stiff.paper.formulation import formulation
from sk120stiff.paper.identified import FITS, identify_springs
from sk120stiff.paper.posture import posture, pulls
from sk120stiff.paper.setting import setting
from sk120stiff.paper.table2 import table2
from sk120stiff.paper.table3 import table3
from sk120stiff.paper.table4 import table4

T = TypeVar("T")


class Reproduction(Findings):
    """Every table, figure and claim of the paper beside ours; made by `reproduce`."""

    @cached_property
    def claims(self) -> tuple[Claim, ...]:
        """Every claim of the paper with its verdict."""
        return claims(self)


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
        setting=arm,
        table2=second,
        identified=found,
        table3=third,
        table4=after(table4(arm)),
        critical=after(critical(arm)),
        appendix=after(appendix(arm)),
        formulation=after(formulation(arm)),
        posture=after(posture(arm, (second.printed, third.printed))),
        parts=after(diagonal_parts(arm)),
        pulls=after(pulls(arm, springs)),
    )
