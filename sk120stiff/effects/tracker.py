"""The tracker misreads displacements. Everything is stated in axes of the base frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import ReadingError, scale_of
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import crossed


@dataclass(frozen=True)
class ReadingRotation(ReadingError):
    """The tracker's frame was aligned to the base with a small error: d_read = d + ω × d."""

    name: ClassVar[str] = "reading_rotation"
    place: ClassVar[str] = "tracker"
    calibrated: ClassVar[bool] = True
    equation: ClassVar[str] = "d_read = d + a x d"
    says: ClassVar[str] = "The tracker's frame is turned against the robot's base frame."
    axes: ClassVar[str] = "axes of the base frame"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Misalignment about the base axes."""
        return of_axes(
            "angle_{}", "rad", plausible=0.06, typical=0.003,
            meaning="angle about {} of the base by which displacements are read turned, "
            "right-handed",
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """ω ×."""
        return crossed(np.eye(3))


@dataclass(frozen=True)
class ReadingScale(ReadingError):
    """Every displacement is read too large or too small by the same share."""

    name: ClassVar[str] = "reading_scale"
    place: ClassVar[str] = "tracker"
    calibrated: ClassVar[bool] = True
    equation: ClassVar[str] = "d_read = (1 + s) d"
    says: ClassVar[str] = "The tracker's scale is wrong."
    axes: ClassVar[str] = "all axes alike"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Relative scale error."""
        return (
            ParameterSpec(
                "scale", "1", "1", plausible=0.01, typical=1e-5,
                meaning="(read - true) / true displacement; positive: the tracker reads too much",
            ),
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """The identity."""
        return np.eye(3)[None]


@dataclass(frozen=True)
class ZeroOffset(ReadingError):
    """The unloaded reading of a pose was off: a constant on all readings of that pose."""

    poses: tuple[str, ...] = ()
    name: ClassVar[str] = "zero_offset"
    place: ClassVar[str] = "tracker"
    equation: ClassVar[str] = "d_read = d + c of the pose"
    says: ClassVar[str] = "The unloaded readings of the poses are off by more than the noise."
    axes: ClassVar[str] = "axes of the base frame"
    random_effects: ClassVar[bool] = True
    needs: ClassVar[str] = "several readings of a pose"

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """Offsets of the poses of an experiment."""
        return cls(where, scale_of(robot), poses=options.poses)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The poses that the names of the parameters tell, `POSE.x`."""
        return Options(poses=tuple(dict.fromkeys(name.rpartition(".")[0] for name in parameters)))

    @classmethod
    def sample(cls) -> Self:
        """The offset of one pose."""
        return cls(cls.place, poses=("POSE",))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Offset of each pose along the base axes."""
        return tuple(
            ParameterSpec(
                f"{pose}.{axis}", "m", "m", plausible=5e-4, typical=1e-5,
                meaning=f"read minus true along {axis} of the base, for all displacements of pose "
                f"{pose}",
            )
            for pose in self.poses
            for axis in "xyz"
        )  # fmt: skip

    def applies_to(self, load_cases: LoadCases) -> bool:
        """Poses need several readings each, else the offset takes everything."""
        return bool(self.poses) and load_cases.count > len(self.poses)

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the displacement."""
        return np.zeros((3 * len(self.poses), 3, 3))

    def offsets(self, load_cases: LoadCases) -> Array:
        """One on the readings of the pose that the parameter belongs to."""
        known = {pose: k for k, pose in enumerate(self.poses)}
        out = np.zeros((load_cases.count, 3, len(self.poses), 3))
        for row, index in enumerate(load_cases.pose):
            k = known.get(load_cases.poses[index])
            if k is not None:
                out[row, :, k, :] = np.eye(3)
        return out.reshape(load_cases.count, 3, -1)
