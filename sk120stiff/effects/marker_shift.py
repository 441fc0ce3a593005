"""The marker was mounted anew between two series."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Geometric, scale_of
from sk120stiff.effects.geometry import length_error, tool_slides
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot import Robot, VirtualJoint


@dataclass(frozen=True)
class MarkerShift(Geometric):
    """In every series but the first the marker sits elsewhere on the tool."""

    series: tuple[str, ...] = ()
    name: ClassVar[str] = "marker_shift"
    place: ClassVar[str] = "the tool frame"
    equation: ClassVar[str] = "p_true = p_stated + o of the series"
    says: ClassVar[str] = "The marker sits elsewhere on the tool in another series."
    axes: ClassVar[str] = "axes of the tool frame"
    needs: ClassVar[str] = "positions in several series"
    only_absolute: ClassVar[bool] = True
    of_marker: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """Shifts of the series after the first."""
        return cls(where, scale_of(robot), options.series[1:])

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The series that the names of the parameters tell, `SERIES.x`."""
        later = dict.fromkeys(name.rpartition(".")[0] for name in parameters)
        return Options(series=("", *later))

    @classmethod
    def sample(cls) -> Self:
        """The shift of one series."""
        return cls(cls.place, series=("SERIES",))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Shift of each series against the first."""
        return tuple(
            length_error(
                f"{label}.{axis}", typical=5e-4, scale=self.scale,
                meaning=f"marker of series {label} minus that of the first, along {axis} of the "
                "tool frame",
            )
            for label in self.series
            for axis in "xyz"
        )  # fmt: skip

    def applies_to(self, load_cases: LoadCases) -> bool:
        """There must be several series."""
        return load_cases.absolute and bool(self.series) and load_cases.series is not None

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Three rigid slides at the tool frame."""
        return tool_slides(robot, self.id)

    def shifts(self, load_cases: LoadCases) -> Array:
        """One in the series that the parameter belongs to."""
        out = np.zeros((load_cases.count, 3, len(self.series), 3))
        if load_cases.series is not None:
            for k, label in enumerate(self.series):
                if label in load_cases.series_names:
                    rows = load_cases.series == load_cases.series_names.index(label)
                    out[rows, :, k, :] = np.eye(3)
        return out.reshape(load_cases.count, 3, -1)
