"""An arm that stands and one that hangs place a marker alike; what is up in the file tells them.

Where the second axis meets the first at right angles, the base may be turned over about the second:
with the first joint of the other sign and the second half a turn on, every link from the second on
is where it was. Positions cannot tell the two, loads and weight can.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.placing.cloud import Cloud
from sk120stiff.measurements.placing.slips import NEARLY, SLACK, Convention

ALIKE = 1.02  # times what is left, up to which two conventions fit alike
PLUMB = np.cos(np.radians(10.0))  # of the angle to z of the file, within which a base is level


@dataclass(frozen=True, eq=False)
class Standing:
    """A convention of the joints, and how the base stands with it.

    Attributes:
        way: The convention.
        up: (3,) what is up for the base, a unit vector in axes of the file; None where nothing
            pulls.
        other: The one with the base turned over, where it fits as well.
    """

    way: Convention
    up: Array | None
    other: Standing | None = None

    @property
    def upright(self) -> bool:
        """Is what is up for the base up along z of the file?"""
        return self.up is not None and bool(self.up[2] > PLUMB)

    @property
    def hangs(self) -> bool:
        """Is it down along z of the file?"""
        return self.up is not None and bool(self.up[2] < -PLUMB)

    def beside(self, told: Callable[[Convention], str]) -> str:
        """What is to be said of the other one, with a blank before it; empty without one.

        Args:
            told: How a convention is written, ``--joints '-A1,A2'``.
        """
        other = self.other
        if other is None or self.up is None or other.up is None:
            return ""
        also = f"With {told(other.way)} {1e3 * other.way.rms:.3g} mm are left, too"
        if self.upright:
            return (
                f" The base then stands upright, with z of these positions up. {also}, and the "
                "base upside down: take that if the arm hangs from a ceiling, or if z points down."
            )
        return (
            f" Up is then along {_listed(self.up)} in these positions' axes. {also}, with up along "
            f"{_listed(other.up)}: take the one that is so."
        )


class OtherConvention(InputError):
    """Joints that are another controller's; `standing` says how they are read."""

    def __init__(self, what: str, *, where: str, remedy: str, standing: Standing) -> None:
        super().__init__(what, where=where, remedy=remedy)
        self.standing = standing


def standing(cloud: Cloud, way: Convention, gravity: Array) -> Standing:
    """The convention, or one that fits as well, or nearly so, and has the base upright.

    Poses that move one joint after the other hardly tell a base that stands from one that hangs.

    Args:
        cloud: Positions and columns.
        way: How joints follow from these columns.
        gravity: (3,) in axes of the base.
    """
    up, rms = _up(cloud, way, gravity)
    found = Standing(replace(way, rms=rms), up)
    if found.hangs:
        for near in way.others:
            up, rms = _up(cloud, near, gravity)
            other = Standing(replace(near, rms=rms), up, found)
            if other.upright:
                return other
    turned = _turned_over(cloud, way)
    if up is None or turned is None:
        return found
    up, rms = _up(cloud, turned, gravity)
    if rms > ALIKE * found.way.rms:
        return found
    other = Standing(replace(turned, rms=rms), up)
    first, second = (other, found) if other.upright and not found.upright else (found, other)
    return replace(first, other=second)


def _turned_over(cloud: Cloud, way: Convention) -> Convention | None:
    """None where these joints do not turn, or the second would go beyond its limits."""
    robot = cloud.robot
    if len(way.zero) < 2 or any(robot.prismatic[:2]):
        return None
    share, low, high = way.share.copy(), robot.lower - SLACK, robot.upper + SLACK
    share[0] *= -1.0
    for half in (np.pi, -np.pi):
        zero = way.zero + half * np.eye(len(way.zero))[1]
        zero[0] *= -1.0
        a = (cloud.a @ share.T + zero)[:, :2]
        if ((a >= low[:2]) & (a <= high[:2])).all():
            return Convention(np.inf, share, zero)
    return None


def _up(cloud: Cloud, way: Convention, gravity: Array) -> tuple[Array | None, float]:
    """(3,) up in axes of the file, and what is left [m]."""
    moved = replace(cloud, a=cloud.a @ way.share.T + way.zero)
    found, _ = moved.placed(fit_marker=True, until=NEARLY)
    size = float(np.linalg.norm(gravity))
    return (None if size == 0.0 else -found.turns[0] @ gravity / size), found.rms


def _listed(way: Array) -> str:
    return f"({', '.join(f'{value + 0.0:.2f}' for value in np.round(way, 2))})"
