"""A link grows as it gets warmer, or as time passes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Imposed, scale_of
from sk120stiff.effects.counting import Counting
from sk120stiff.effects.geometry import link_slide
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.effects.reference import TEMPERATURE, TIME
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import arm_joint


@dataclass(frozen=True)
class ThermalGrowth(Counting, Imposed):
    """A link's length goes with the temperature, or with time where no temperature was read.

    At the reference it is as the model's geometry has it: at the mean temperature, or the first
    moment, of the readings that the model was identified from.

    Attributes:
        thermal: By the temperature, not by the clock.
        length: Of the link [m], with which it grows.
    """

    thermal: bool = False
    length: float = field(default=1.0, compare=False)
    name: ClassVar[str] = "thermal_growth"
    place: ClassVar[str] = "a link"
    equation: ClassVar[str] = "length_true = length + g * (temperature or time since the reference)"
    axes: ClassVar[str] = "the line from the link's joint to the next"
    needs: ClassVar[str] = "positions with a column temperature[degC] or time[s]"
    only_absolute: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """By the temperature where there is one, else by the clock."""
        return cls(where, scale_of(robot), options.thermal, arm_joint(robot, where).length)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """What the units of the parameters tell."""
        return Options(thermal="m/K" in parameters.values())

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Growth per kelvin or per second; steel of 1 m grows by 11 µm per kelvin.

        A link whose motor heats it grows by more for each kelvin of a room.
        """
        unit, of_metre = ("m/K", 1e-5) if self.thermal else ("m/s", 1e-8)
        typical = of_metre * self.length
        return (
            ParameterSpec(
                "growth", unit, unit, plausible=10 * typical, typical=typical,
                meaning="growth of the link "
                + ("per kelvin" if self.thermal else "per second of the clock"),
            ),
        )  # fmt: skip

    def sentence(self) -> str:
        """What happens."""
        cause = "as it gets warmer" if self.thermal else "as time passes"
        return f"The link {self.where} grows {cause}."

    @property
    def goes_with(self) -> str:
        """See `Counting.goes_with`."""
        return TEMPERATURE if self.thermal else TIME

    def _clock(self, load_cases: LoadCases) -> Array | None:
        return load_cases.since(self.goes_with, self.reference)

    def applies_to(self, load_cases: LoadCases) -> bool:
        """The file must hold what it goes with."""
        clock = self._clock(load_cases)
        return load_cases.absolute and clock is not None and bool(np.ptp(clock) > 0.0)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """A rigid slide along the link, at its far end."""
        return (link_slide(robot, self.where, f"{self.id}.length"),)

    def shifts(self, load_cases: LoadCases) -> Array:
        """Temperature or time of each reading since the reference."""
        clock = self._clock(load_cases)
        elapsed = np.zeros(load_cases.count) if clock is None else clock
        return np.asarray(elapsed[:, None, None])
