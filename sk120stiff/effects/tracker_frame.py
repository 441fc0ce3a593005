"""Where the tracker stands: the axes in which positions are read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Viewpoint
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.robot.rotations import left_jacobian, rotation_of


@dataclass(frozen=True)
class TrackerFrame(Viewpoint):
    """Turn and shift of the base frame as the tracker sees it."""

    name: ClassVar[str] = "tracker_frame"
    place: ClassVar[str] = "tracker"
    equation: ClassVar[str] = "x_read = R(r) x_base + t"
    says: ClassVar[str] = "The tracker stands elsewhere, and turned, against the base frame."
    axes: ClassVar[str] = "axes of the tracker"
    needs: ClassVar[str] = "positions"
    only_absolute: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Origin of the base frame and rotation vector of its axes, as the tracker sees them."""
        origin = "origin of the base frame along {} of the tracker"
        turn = "turn of the base frame: component {} of the rotation vector"
        return (
            *of_axes("{}", "m", plausible=200.0, typical=1e-3, meaning=origin),
            *of_axes("r{}", "rad", plausible=6.3, typical=1e-3, meaning=turn),
        )

    def frame(self, values: Array) -> tuple[Array, Array]:
        """See `Viewpoint.frame`."""
        return rotation_of(values[3:]), values[:3]

    def columns(self, turned: Array, values: Array) -> Array:
        """A change of the rotation vector turns about J_l(r) dr (Chirikjian 2012, ch. 10)."""
        out = np.zeros((len(turned), 6, 6))
        out[:, :3, :3] = np.eye(3)
        J = left_jacobian(values[3:])
        out[:, :3, 3:] = np.cross(J.T[None], turned[:, None, :]).swapaxes(1, 2)
        out[:, 3:, 3:] = J
        return out
