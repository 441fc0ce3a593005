"""Axes that are turned: of base and readings about the base's z, and zeros of joints.

Another base frame than the one that loads and displacements are stated in is the usual slip, as on
arms whose base link is turned by half a turn against the world.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import combinations, product
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.arrays import Array
from sk120stiff.data_checks.correction import Correction
from sk120stiff.data_checks.sheet import Sheet
from sk120stiff.measurements.data import Frame
from sk120stiff.measurements.sensor_axes import Rpy, axes_line

QUARTERS = (1, 2, 3)  # of a turn, as frames and conventions of controllers differ
ROUNDING = 1e-12  # of a cosine
What = Literal["both", "d", "f"]  # displacements and loads, or one of them
COARSE, FINE = np.radians(15.0), np.radians(0.5)  # steps in which a turn is looked for


def quarter_turns(sheet: Sheet) -> Iterator[Correction]:
    """Axes and zeros that are off by quarters of a turn."""
    for quarter in QUARTERS:
        for what in _turned_by(sheet):
            yield turned(quarter * np.pi / 2, what, sheet.force_frame, sheet.sensor_rpy)
    for axis in range(2):
        if sheet.directions is None:
            yield _half_about(axis, "displacement", sheet)
        yield _half_about(axis, "force", sheet)
    for zeros in _zeros(sheet):
        yield from zeros


def two_zeros(sheet: Sheet) -> Iterator[tuple[Correction, Correction]]:
    """Zeros of two joints that are off by quarters of a turn each."""
    for one, other in combinations(_zeros(sheet), 2):
        yield from product(one, other)


def _zeros(sheet: Sheet) -> list[list[Correction]]:
    """Of every joint that turns, its zero off by quarters of a turn."""
    return [
        [_zero(sheet, k, (quarter + 1) % 4 - 1) for quarter in QUARTERS]
        for k, slides in enumerate(sheet.robot.prismatic)
        if not slides
    ]


def _half_about(axis: int, what: Literal["displacement", "force"], sheet: Sheet) -> Correction:
    """Displacements, or loads, in axes turned by half a turn about x or y: their z points down."""
    signs = np.where(np.arange(3) == axis, 1.0, -1.0)
    names = [f"{what[0]}{name}" for k, name in enumerate("xyz") if k != axis]
    said = (
        f"the {what} looks stated in axes turned by 180 deg about {'xy'[axis]}, with z pointing "
        "down"
    )

    def mend(sheet: Sheet) -> Sheet:
        if what == "displacement":
            return replace(sheet, displacement=sheet.displacement * signs)
        return replace(sheet, wrench=sheet.wrench * np.tile(signs, 2))

    remedy = f"Negate the columns {names[0]} and {names[1]}."
    if what == "force" and sheet.sensor_rpy is not None:
        half = Rotation.from_rotvec(np.pi * np.eye(3)[axis])
        remedy = f"Write '{axes_line(sheet.force_frame, half, sheet.sensor_rpy)}'."
    return Correction(said, remedy, mend)


def by_any_angle(sheet: Sheet, left: Callable[[Correction], float]) -> list[Correction]:
    """The best turn of both, and of displacements and of loads alone, from coarse to fine.

    Args:
        sheet: The readings as they stand.
        left: What is left with a correction.
    """
    frame, rpy = sheet.force_frame, sheet.sensor_rpy
    read = not np.isnan(sheet.measured[:, :2]).any()
    out = []
    for what in _turned_by(sheet) if read else ():
        angle, step = 0.0, COARSE
        tried = np.arange(-np.pi, np.pi, step)
        while step >= FINE:
            angle = float(min(tried, key=lambda each: left(turned(each, what, frame, rpy))))
            step *= 0.5
            tried = np.array([angle - step, angle, angle + step])
        out.append(turned(angle, what, frame, rpy))
    return out


def turned(angle: float, what: What, frame: Frame, rpy: Rpy | None = None) -> Correction:
    """Displacements, loads, or both are stated in axes turned by an angle about the base's z.

    Loads in axes of the tool (`frame`) about the tool's: a sensor may be screwed on turned.
    """
    degrees = 180.0 - round((180.0 - float(np.degrees(angle))) % 360.0, 1)
    looks = {"both": "force and displacement look", "d": "the displacement looks"}
    said = (
        f"{looks.get(what, 'the force looks')} stated in axes that are turned by {degrees:g} deg "
        f"about z of the {'base' if what != 'f' else frame} frame"
    )
    line = axes_line(frame, Rotation.from_euler("z", degrees, degrees=True), rpy)
    remedy = {
        "both": "Choose the base frame that they are stated in (base_frame, --base), or turn them "
        "by as much.",
        "d": "Turn the displacement by as much, into axes of the base frame.",
        "f": f"Write '{line}' into the YAML file, beside what else stands there of the force; of a "
        "file with positions in the same axes, import it with --forces instrument.",
    }

    def mend(sheet: Sheet) -> Sheet:
        mended = sheet
        if what != "f":
            mended = replace(mended, displacement=_about_z(sheet.displacement, angle))
        if what != "d":
            wrench = [_about_z(sheet.wrench[:, part], angle) for part in (slice(3), slice(3, 6))]
            mended = replace(mended, wrench=np.concatenate(wrench, axis=1))
        return mended

    return Correction(said, remedy[what], mend)


def _turned_by(sheet: Sheet) -> tuple[What, ...]:
    """What may be turned about z of the base: what is stated in its axes."""
    if sheet.displacement_frame != "base" or sheet.directions is not None:
        return ("f",)  # along directions of their own numbers cannot be turned
    return ("both", "d", "f") if sheet.force_frame == "base" else ("d", "f")


def _about_z(vectors: Array, angle: float) -> Array:
    """(N, 3) turned; an axis that was not read stays so by quarters of a turn."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turn[np.abs(turn) < ROUNDING] = 0.0
    out = np.zeros_like(vectors)
    for i, j in zip(*np.nonzero(turn), strict=True):
        out[:, i] += turn[i, j] * vectors[:, j]
    return out


def _zero(sheet: Sheet, k: int, quarters: int) -> Correction:
    """Joint k counts from elsewhere."""
    name, degrees = sheet.robot.actuated[k], 90 * quarters
    off = np.radians(degrees) * np.eye(sheet.robot.n)[k]
    return Correction(
        f"the zero of {name} seems to be {degrees} deg off",
        f"Add {degrees} deg to the column {name}.",
        lambda s: replace(s, joints=s.joints + off),
    )
