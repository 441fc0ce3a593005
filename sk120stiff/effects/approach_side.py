"""Play taken up from either side: where a joint stops depends on where it came from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Geometric, scale_of
from sk120stiff.effects.counting import Sequential
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot import Robot


@dataclass(frozen=True)
class ApproachSide(Sequential, Geometric):
    """A joint that comes from below stops short, one that comes from above stops far."""

    slides: bool = False
    name: ClassVar[str] = "approach_side"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "q_true = q + b * side, side the sign of the last movement"
    says: ClassVar[str] = "{where} stops elsewhere when it comes from the other side."
    axes: ClassVar[str] = "the axis of the joint itself"
    needs: ClassVar[str] = "positions in a known order"
    only_absolute: ClassVar[bool] = True
    of_transmission: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> ApproachSide:
        """In rad or m as the joint asks for."""
        return cls(where, scale_of(robot), robot.prismatic[robot.actuated.index(where)])

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half of what lies between the two sides."""
        unit = "m" if self.slides else "rad"
        return (
            ParameterSpec(
                "half_width", unit, unit, plausible=2e-3, typical=3e-5,
                meaning="true minus reported coordinate after a movement the positive way",
            ),
        )  # fmt: skip

    def applies_to(self, load_cases: LoadCases) -> bool:
        """The order must be known, and both sides must occur."""
        if not load_cases.absolute or load_cases.side is None:
            return False
        sides = load_cases.side[:, load_cases.robot.actuated.index(self.where)]
        return bool((sides > 0).any() and (sides < 0).any())

    def shifts(self, load_cases: LoadCases) -> Array:
        """The side of each reading."""
        if load_cases.side is None:
            return np.zeros((load_cases.count, 1, 1))
        own = load_cases.side[:, load_cases.robot.actuated.index(self.where)]
        return np.asarray(own[:, None, None])
