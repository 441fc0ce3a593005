"""The curves of gears as they were found: people recognise a gear by its curve."""

from __future__ import annotations

from sk120stiff.errors import listed
from sk120stiff.explain import Explanation
from sk120stiff.explain.judge.gear_curve import GearCurve, gear_curves
from sk120stiff.show.figures.gear_curve import gear_curve
from sk120stiff.show.report import Block, Picture, Section


def gear_section(answer: Explanation) -> Section | None:
    """A picture of every gear at which something was named; None where none was."""
    curves = gear_curves(answer.final, [finding.effect.id for finding in answer.findings])
    if not curves:
        return None
    blocks: list[Block] = [
        "Spring and gear together, as if the joint stood on a bench: the torque grows from zero, "
        "falls to the other side and grows back. A loop is friction, a step is play, a bend is a "
        "gear that gets stiffer. The dashed line is the plain law of the name that comes nearest."
    ]
    return Section("The curve of the gear", [*blocks, *(_picture(curve) for curve in curves)])


def _picture(curve: GearCurve) -> Picture:
    largest = 1e6 * abs(curve.twist).max()
    names = listed([f"`{name}`" for name in curve.names])
    return Picture(
        lambda: gear_curve(curve),
        alt=f"Twist of {curve.where} up to {largest:.3g} µrad over its torque up to "
        f"{abs(curve.torque).max():.3g} N·m, found curve and plain law.",
        caption=f"{curve.where}: {names}. Points: readings whose point the joint moves well.",
    )
