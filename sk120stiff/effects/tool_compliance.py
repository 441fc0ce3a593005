"""The fixture or sensor at the flange yields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.effects.base import LinearElastic, ParameterSpec, compliance
from sk120stiff.effects.situation import Situation
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.coupling import Array


@dataclass(frozen=True)
class ToolCompliance(LinearElastic):
    """What is bolted to the flange, round about the tool axis z: it bends, twists and shifts."""

    name: ClassVar[str] = "tool_compliance"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Stiffness against bending (about x and y), twisting (about z) and shifting."""
        return (
            compliance("stiffness_bending", softest=3e3, typical=2e5),
            compliance("stiffness_torsion", softest=3e3, typical=2e5),
            compliance("stiffness_shift", softest=2e6, typical=5e7, unit="N/m"),
        )

    def sentence(self) -> str:
        """What happens."""
        return f"The fixture at {self.where} yields between flange and measured point."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """The tool frame."""
        return (robot.tool_frame,)

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

    def patterns(self, situation: Situation) -> Array:
        """Bending acts about x and y alike, shifting along all axes alike."""
        diagonals = ([1, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1])
        return np.array([np.diag(np.array(d, dtype=float)) for d in diagonals])
