"""One joint's angle moves another: wrists and belts without full compensation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Geometric
from sk120stiff.effects.closure import PAIR
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.effects.places import USUAL_PLACES
from sk120stiff.robot import Robot

REACH = 2  # joints further on that a drive passes on its way


@dataclass(frozen=True)
class JointCoupling(Geometric):
    """A joint stands further by a share of another joint's coordinate."""

    name: ClassVar[str] = "joint_coupling"
    place: ClassVar[str] = "one joint,the joint that it moves"
    equation: ClassVar[str] = "q_2 true = q_2 + r q_1"
    axes: ClassVar[str] = "axes of the two joints"
    needs: ClassVar[str] = "positions"
    only_absolute: ClassVar[bool] = True
    of_transmission: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """The ratio of the two."""
        return (
            ParameterSpec(
                "ratio", "1", "1", plausible=0.05, typical=1e-4,
                meaning="movement of the second joint for one unit of the first",
            ),
        )  # fmt: skip

    def sentence(self) -> str:
        """What happens."""
        first, second = self.where.split(PAIR)
        return f"{second} moves along with {first}."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every pair of turning joints of which the second follows within two on the way out."""
        turning = USUAL_PLACES["a joint that turns"](robot)
        return tuple(
            PAIR.join((first, second))
            for k, first in enumerate(turning)
            for second in turning[k + 1 : k + 1 + REACH]
        )

    def coordinates(self, robot: Robot) -> tuple[str, ...]:
        """The joint that is moved."""
        return (self.where.split(PAIR)[1],)

    def shifts(self, load_cases: LoadCases) -> Array:
        """The other joint's coordinate."""
        first = load_cases.robot.actuated.index(self.where.split(PAIR)[0])
        return np.asarray(load_cases.a[:, first, None, None])
