"""The fixture or sensor at the flange yields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.effects.nonlinear import Nonlinear, StraightPart
from sk120stiff.effects.parameter import ParameterSpec, compliances
from sk120stiff.robot import Robot, VirtualJoint


@dataclass(frozen=True)
class ToolCompliance(StraightPart):
    """What is bolted to the flange turns about and shifts along the axes of the tool frame.

    Fixtures are rarely round, so every axis has a stiffness of its own.
    """

    name: ClassVar[str] = "tool_compliance"
    place: ClassVar[str] = "the tool frame"
    equation: ClassVar[str] = "turn = moment / K and shift = force / K, axis by axis"
    says: ClassVar[str] = "The fixture at {where} yields between flange and measured point."
    axes: ClassVar[str] = "axes of the tool frame, at its origin"
    yields_under: ClassVar[str] = "the tool carries"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Stiffness against turning about x, y, z and against shifting along them.

        Softest is rubber, or a compliance device, that gives some millimetres under what the arm
        may carry.
        """
        turning = compliances(
            "xyz", "stiffness_turn_{}", softest=1e2, customary=3e3, typical=2e5, scale=self.scale,
            meaning="against turning about {} of the tool frame",
        )  # fmt: skip
        shifting = compliances(
            "xyz", "stiffness_shift_{}", softest=3e4, customary=2e6, typical=5e7, scale=self.scale,
            unit="N/m", meaning="against shifting along {} of the tool frame",
        )  # fmt: skip
        return (*turning, *shifting)

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff against bending both ways, and against shifting all ways."""
        return ((0, 1), (3, 4, 5))

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Three turns and three slides at the tool frame."""
        chain = robot.mechanism().chain
        placement = chain.placements[-1]
        return tuple(
            VirtualJoint(
                f"{self.id}.{kind}_{label}", chain.m - 1, placement, np.eye(3)[k], revolute=turns
            )
            for kind, turns in (("turn", True), ("shift", False))
            for k, label in enumerate("xyz")
        )


class NonlinearTool(Nonlinear):
    """The fixture stiffens as it is pressed, or gives way one way only."""

    says: ClassVar[str] = (
        "The fixture at {where} yields between flange and measured point, not in proportion."
    )
    straight: ClassVar[type[StraightPart]] = ToolCompliance
