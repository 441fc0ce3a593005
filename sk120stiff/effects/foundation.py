"""The base on its foundation: it rocks about the axes of its mounting surface, and it slides."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import AxisByAxis, Effect
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.nonlinear import ALSO, Nonlinear, StraightPart
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.rotations import homogeneous

CROSS = "cross_stiffness"


@dataclass(frozen=True)
class BaseRocking(StraightPart):
    """The base turns about the x and y axes of the base frame through the foundation point.

    The base frame's z is the normal of the mounting surface, whether floor, wall or ceiling. Yaw
    about it is left out: where the first joint turns about that line, it is that joint's spring
    under another name. A foundation whose stiff direction lies askew has a cross term too.
    """

    askew: bool = False
    name: ClassVar[str] = "base_rocking"
    place: ClassVar[str] = "the base frame"
    equation: ClassVar[str] = "turn = moment / K, about x and about y"
    says: ClassVar[str] = "The base rocks on its foundation."
    axes: ClassVar[str] = (
        "axes of the base frame through the foundation point; z is the normal of the floor"
    )
    also: ClassVar[str] = f"with {CROSS}, where the stiff direction lies askew of the axes; {ALSO}"
    yields_under: ClassVar[str] = "tips the base"

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Effect:
        """The foundation, askew where names of parameters tell of a cross term."""
        found = super().at(robot, where, options)
        return replace(found, askew=CROSS in options.shape) if isinstance(found, cls) else found

    def other_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """With a cross term or without, and out of proportion."""
        return (replace(self, askew=not self.askew), *super().other_laws(load_cases))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Rocking stiffness about x and about y, and what couples the two."""
        cross = compliance(
            CROSS,
            softest=6e5,
            typical=2e7,
            scale=self.scale,
            meaning="moment about x over the turn about y that it brings, and the other way round",
            signed=True,
        )
        own = (
            compliance(
                f"stiffness_{label}",
                softest=3e5,
                typical=1e7,
                scale=self.scale,
                meaning=f"against rocking about {label} of the base frame",
            )
            for label in "xy"
        )
        return (*own, *([cross] if self.askew else []))

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff about one axis as about the other."""
        return ((0, 1),)

    @property
    def couplings(self) -> tuple[tuple[int, int, int], ...]:
        """What turns about x under a moment about y, and the other way round."""
        return ((0, 1, 2),) if self.askew else ()

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Two joints before all others."""
        at = homogeneous(robot.foundation)
        return tuple(
            VirtualJoint(f"{self.id}.{label}", -1, at, np.eye(3)[k]) for k, label in enumerate("xy")
        )

    def patterns(self, load_cases: LoadCases) -> Array:
        """Each axis has a compliance of its own; the cross term couples them."""
        own = [np.diag(row) for row in np.eye(2)]
        return np.array([*own, 1.0 - np.eye(2)] if self.askew else own)


class NonlinearRocking(Nonlinear):
    """The foundation gives way more and more, one way only, or stiffens as it is loaded."""

    says: ClassVar[str] = "The base rocks on its foundation, not in proportion to the moment."
    straight: ClassVar[type[StraightPart]] = BaseRocking


@dataclass(frozen=True)
class BaseSliding(AxisByAxis):
    """The base shifts along the axes of the base frame."""

    name: ClassVar[str] = "base_sliding"
    place: ClassVar[str] = "the base frame"
    equation: ClassVar[str] = "shift = force / K, along x, y and z"
    says: ClassVar[str] = "The base shifts on its foundation under the load."
    axes: ClassVar[str] = "axes of the base frame"
    yields_under: ClassVar[str] = "pushes the base"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Stiffness against shifting along x, y and z."""
        return tuple(
            compliance(
                f"stiffness_{label}",
                softest=2e6,
                typical=7e7,
                scale=self.scale,
                unit="N/m",
                meaning=f"against shifting along {label} of the base frame",
            )
            for label in "xyz"
        )

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff along one axis as along the others."""
        return ((0, 1, 2),)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Three slides before all other joints."""
        return tuple(
            VirtualJoint(f"{self.id}.{label}", -1, np.eye(4), np.eye(3)[k], revolute=False)
            for k, label in enumerate("xyz")
        )
