"""An arm that weighs otherwise than its URDF states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from sk120stiff.effects.base import Weighing
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot import Robot


@dataclass(frozen=True)
class LinkMasses(Weighing):
    """All links are heavier or lighter by one share; where their masses lie is as stated.

    Own weight bends every spring: without a payload or a load beside it one share of all
    compliances does the same. With it, one share of the payload and of all springs does: what is
    told is the ratio of both weights, and the springs are by the payload as it was stated. Laws of
    gears go by the weight of the URDF.
    """

    name: ClassVar[str] = "link_masses"
    place: ClassVar[str] = "the base frame"
    equation: ClassVar[str] = "weight = (1 + s) * weight by the masses of the URDF"
    says: ClassVar[str] = (
        "The arm's links weigh more or less beside the payload than is stated: the masses of the "
        "URDF are off, or the payload's is, and with it all springs."
    )
    advice: ClassVar[str] = (
        "Weigh the payload: only if it weighs what is stated, the springs are what they say."
    )
    axes: ClassVar[str] = "all links alike"
    needs: ClassVar[str] = "positions of an arm that yields under weight, with a payload or load"
    only_absolute: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Relative error of the masses."""
        return (
            ParameterSpec(
                "scale", "1", "1", plausible=0.5, typical=0.03, lower=-1.0,
                meaning="(true - stated) / stated mass of the links; positive: the arm is heavier",
            ),
        )  # fmt: skip

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """The whole arm, where its URDF states masses and gravity pulls them."""
        weighs = robot.total_mass > 0.0 and robot.gravity.any()
        return (robot.base_frame,) if weighs else ()

    def applies_to(self, load_cases: LoadCases) -> bool:
        """The arm's own weight has to be told from another, of a payload or a load."""
        return super().applies_to(load_cases) and bool(load_cases.wrench.any())
