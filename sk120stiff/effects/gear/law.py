"""What all laws of a gear have in common: one turning joint, and its torque."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Elastic, scale_of
from sk120stiff.effects.elongation import Elongation
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.places import USUAL_PLACES
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot


@dataclass(frozen=True)
class GearEffect(Elastic):
    """A law of the total torque of one turning actuated joint, its weight's share included."""

    of_gear: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The gear of one joint."""
        return cls(where, scale_of(robot))

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every actuated joint that turns."""
        return USUAL_PLACES["a joint that turns"](robot)

    def weight_torque(self, load_cases: LoadCases) -> Array:
        """(N, 1) torque of the arm's weight on the joint, before the load came [N·m]."""
        index = load_cases.robot.actuated.index(self.where)
        torque = load_cases.gravity_torque[:, index : index + 1]
        # About a vertical axis only rounding is left, and its sign must not count.
        return np.where(np.abs(torque) > 1e-9 * load_cases.robot.total_mass, torque, 0.0)

    def load_torque(self, load_cases: LoadCases) -> Array:
        """(N, 1) torque of the load on the joint at the unloaded pose [N·m]."""
        index = load_cases.robot.actuated.index(self.where)
        load = load_cases.nominal.at(load_cases.force_point).torques(load_cases.wrench)
        return np.asarray(load[:, index : index + 1])

    def largest_torque(self, load_cases: LoadCases) -> float:
        """Largest total torque on the joint among the readings [N·m]."""
        total = self.load_torque(load_cases) + self.weight_torque(load_cases)
        return float(np.abs(total).max(initial=0.0))


def constant_in_torque(shapes: Array, values: Array) -> Elongation:
    """Σ values[p] · shapes (N, p) of one coordinate, whatever the torque of the loaded pose is."""
    return Elongation(
        value=(shapes @ values)[:, None],
        by_torque=np.zeros((len(shapes), 1, 1)),
        by_parameter=shapes[:, None, :],
    )


def torques_told(names: Iterable[str], head: str, what: str) -> tuple[float, ...]:
    """Torques [N·m] in which those of some names end that begin with `head`; `what` they are.

    Raises:
        InputError: A name begins so but ends in no positive number.
    """
    found = []
    for name in names:
        if not name.startswith(head):
            continue
        try:
            torque = float(name.removeprefix(head))
        except ValueError:
            torque = np.nan
        if not (np.isfinite(torque) and torque > 0.0 and f"{head}{torque:g}" == name):
            raise InputError(
                f"the parameter {name!r} names no {what}",
                remedy=f"Write {head}150 for 150 N·m.",
            )
        found.append(torque)
    return tuple(found)
