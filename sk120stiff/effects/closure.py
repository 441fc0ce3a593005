"""Compliance of a closed linkage between two motors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import LinearElastic
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.robot import Robot
from sk120stiff.robot.robot import Linkage

PAIR = ","  # joint_2_l,joint_3_u: a pair of joints as one place


@dataclass(frozen=True)
class ClosureCoupling(LinearElastic):
    """Torque on one motor moves the other: a cross term c₂₃ between two joint compliances."""

    name: ClassVar[str] = "closure_coupling"
    place: ClassVar[str] = "one motor,another"
    equation: ClassVar[str] = "q_1 += c * torque_2, q_2 += c * torque_1"
    axes: ClassVar[str] = "axes of the two joints"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """The cross compliance, given as its reciprocal; it may have either sign."""
        return (
            compliance(
                "cross_stiffness",
                softest=2e5,
                typical=1e7,
                scale=self.scale,
                signed=True,
                meaning="1 / c; positive where a torque on one moves the other the positive way",
            ),
        )

    def sentence(self) -> str:
        """What happens."""
        first, second = self.where.split(PAIR)
        return f"Torque on {first} moves {second} through the closed linkage, and back."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every pair of actuated joints that a linkage of `robot.yaml` ties together."""
        return tuple(PAIR.join(linkage.drivers) for linkage in robot.linkages)

    def coordinates(self, robot: Robot) -> tuple[str, ...]:
        """The two joints."""
        return tuple(self.where.split(PAIR))

    def patterns(self, load_cases: LoadCases) -> Array:
        """c₂₃ (e₂ e₃ᵀ + e₃ e₂ᵀ)."""
        return np.array([[[0.0, 1.0], [1.0, 0.0]]])


@dataclass(frozen=True)
class ClosureRod(LinearElastic):
    """The linkage rod stretches: c / (r sin γ)² on the joint whose crank it holds.

    r is the crank's length and γ the angle between crank and rod. A rod longer by δ stands where a
    crank further by δ / (r sin γ) would put it, in any four-bar linkage.
    """

    name: ClassVar[str] = "closure_rod"
    place: ClassVar[str] = "rod"
    equation: ClassVar[str] = (
        "crank angle = torque / (K * (r sin g)^2), r the crank, g its angle to the rod"
    )
    says: ClassVar[str] = "The linkage's {where} stretches, the more so the more the linkage folds."
    axes: ClassVar[str] = "along the rod"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Axial stiffness of the rod, EA/L for a plain one, with its pins."""
        return (
            compliance(
                "stiffness",
                softest=3e6,
                typical=7e7,
                scale=self.scale,
                unit="N/m",
                meaning="force per length by which the rod stretches, its pins included",
            ),
        )

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every rod that `robot.yaml` describes."""
        return tuple(linkage.rod for linkage in robot.linkages)

    def linkage(self, robot: Robot) -> Linkage:
        """The description of this rod."""
        return next(linkage for linkage in robot.linkages if linkage.rod == self.where)

    def coordinates(self, robot: Robot) -> tuple[str, ...]:
        """The joint whose crank the rod holds."""
        return (self.linkage(robot).drivers[1],)

    def patterns(self, load_cases: LoadCases) -> Array:
        """1 / (r sin γ)² at the unloaded pose [1/m²]."""
        corners = self.linkage(load_cases.robot).corners
        pivot, elbow, end = (
            load_cases.robot.screws(load_cases.a, frame).position for frame in corners
        )
        crank, rod = elbow - pivot, end - elbow
        lever = (np.cross(crank, rod) ** 2).sum(-1) / (rod**2).sum(-1)  # (r sin γ)² [m²]
        folded = 1e-6 * (crank**2).sum(-1)  # where crank and rod fall in line, no rod holds
        return np.asarray(1.0 / np.maximum(lever, folded))[None, :, None, None]
