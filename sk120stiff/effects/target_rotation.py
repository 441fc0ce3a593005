"""The target whose rotations are read is mounted turned on the tool."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects.base import Mounting, scale_of
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import left_jacobian, rotation_of


@dataclass(frozen=True)
class TargetRotation(Mounting):
    """Rotation of the target's axes against the tool's; later series or markers have their own."""

    rotations: bool = True
    series: tuple[str, ...] = ()
    name: ClassVar[str] = "target_rotation"
    place: ClassVar[str] = "the tool frame"
    equation: ClassVar[str] = "R_read = R_tool R(r)"
    says: ClassVar[str] = "The target whose rotations are read is turned against the tool frame."
    axes: ClassVar[str] = "axes of the tool frame"
    needs: ClassVar[str] = "rotations of the tool"
    only_absolute: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """One rotation of the first series, and one of each after it."""
        return cls(where, scale_of(robot), options.rotations, options.series[1:])

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The series that the names of the parameters tell, `rx` and then `SERIES.rx`."""
        later = dict.fromkeys(name.rpartition(".")[0] for name in parameters if "." in name)
        return Options(series=("", *later), rotations=True)

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Rotation vector of each series."""
        return tuple(
            spec
            for label in ("", *self.series)
            for spec in of_axes(
                f"{label}.r{{}}" if label else "r{}", "rad", plausible=6.3, typical=1e-3,
                meaning="axes of the target" + (f" in series {label}" if label else "")
                + ": component {} of the rotation vector",
            )
        )  # fmt: skip

    def applies_to(self, load_cases: LoadCases) -> bool:
        """There must be rotations."""
        return load_cases.absolute and self.rotations

    def turned(self, load_cases: LoadCases, values: Array) -> tuple[Array, Array]:
        """A change of the rotation vector turns about J_l(r) dr (Chirikjian 2012, ch. 10)."""
        vectors = values.reshape(-1, 3)
        own = self._of_series(load_cases)
        columns = np.zeros((load_cases.count, 3, *vectors.shape))
        for k, vector in enumerate(vectors):
            columns[own == k, :, k] = left_jacobian(vector)
        return rotation_of(vectors)[own], columns.reshape(load_cases.count, 3, -1)

    def _of_series(self, load_cases: LoadCases) -> Index:
        """(N,) which of the rotations each reading has."""
        own = np.zeros(load_cases.count, dtype=np.intp)
        if load_cases.series is not None:
            for k, label in enumerate(self.series, start=1):
                if label in load_cases.series_names:
                    own[load_cases.series == load_cases.series_names.index(label)] = k
        return own
