"""The force sensor misreads. Everything is stated in the sensor's axes, those of the tool frame.

An error of the sensor is what it adds to the truth: reported minus true.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import PURE_FORCES, SPRINGS, Alias, LoadError
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import sample_poses
from sk120stiff.robot.rotations import crossed

AXES = "xyz"


class _SensorError(LoadError):
    place: ClassVar[str] = "sensor"
    axes: ClassVar[str] = "axes of the tool frame at each pose, in which the sensor is mounted"


@dataclass(frozen=True)
class ForceScale(_SensorError):
    """Each force axis reads too much or too little by a share of its own."""

    name: ClassVar[str] = "force_scale"
    former: ClassVar[Mapping[str, str]] = {f"gain_{axis}": f"scale_{axis}" for axis in AXES}
    equation: ClassVar[str] = "F_reported - F_true = s * F_reported, axis by axis"
    says: ClassVar[str] = "The force sensor's axes read too much or too little in proportion."

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Relative errors of the three force axes."""
        return of_axes(
            "scale_{}", "1", plausible=0.12, typical=0.01,
            meaning="(reported - true) / reported force along {} of the tool frame; positive: the "
            "sensor reads too much",
        )  # fmt: skip

    def aliases(self, robot: Robot) -> tuple[Alias, ...]:
        """All gains together are what all compliances together are.

        A single one is, too, where its axis always lies along a slide and no other joint yields
        that way: the lift of a SCARA.
        """
        every = "+".join(spec.name for spec in self.parameters)
        found = [Alias(f"{self.id}[{every}]", SPRINGS, PURE_FORCES)]
        screws = robot.screws(sample_poses(robot, 12))
        columns = screws.linear_jacobian  # (12, 3, n)
        for k, spec in enumerate(self.parameters):
            along = np.abs(np.einsum("nij,ni->nj", columns, screws.rotation[:, :, k]))
            for j in np.flatnonzero(robot.prismatic):
                if (along[:, j] > 1.0 - 1e-9).all() and np.delete(along, j, axis=1).max() < 1e-9:
                    spring = f"{SPRINGS}:{robot.actuated[j]}.stiffness"
                    found.append(Alias(f"{self.id}.{spec.name}", spring))
        return tuple(found)

    @cached_property
    def generators(self) -> Array:
        """One diagonal element of the force each: what the sensor adds is taken away."""
        out = np.zeros((3, 6, 6))
        out[range(3), range(3), range(3)] = -1.0
        return out


@dataclass(frozen=True)
class ForceBias(_SensorError):
    """The sensor adds a constant force that the unloaded reading did not have."""

    name: ClassVar[str] = "force_bias"
    former: ClassVar[Mapping[str, str]] = {f"force_{axis}": f"offset_{axis}" for axis in AXES}
    equation: ClassVar[str] = "F_reported - F_true = b, under load alone"
    says: ClassVar[str] = "The force sensor has a constant offset under load."

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """What the sensor adds to the true force."""
        size = self.scale**2
        return of_axes(
            "offset_{}", "N", plausible=50.0 * size, typical=5.0 * size,
            meaning="reported minus true force along {} of the tool frame; positive: the sensor "
            "reads too much",
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the load."""
        return np.zeros((3, 6, 6))

    def offsets(self, load_cases: LoadCases) -> Array:
        """A unit force along each sensor axis, taken away."""
        return np.broadcast_to(-np.eye(6)[:, :3], (load_cases.count, 6, 3))


@dataclass(frozen=True)
class ForceRotation(_SensorError):
    """The sensor is mounted turned by a small angle: W_true = W + φ × W."""

    name: ClassVar[str] = "force_rotation"
    equation: ClassVar[str] = "F_true = F_reported + a x F_reported, and moments alike"
    says: ClassVar[str] = (
        "The force sensor is mounted turned, so it sees the load in a wrong direction."
    )

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Mounting angles about the sensor axes."""
        return of_axes(
            "angle_{}", "rad", plausible=0.15, typical=0.0175,
            meaning="angle about {} of the tool frame by which the sensor is mounted turned, "
            "right-handed",
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """φ × acts on force and moment."""
        out = np.zeros((3, 6, 6))
        for k in range(3):
            out[k, :3, :3] = out[k, 3:, 3:] = crossed(np.eye(3)[k])
        return out


@dataclass(frozen=True)
class ForceCrosstalk(_SensorError):
    """A force along one sensor axis shows on another."""

    name: ClassVar[str] = "force_crosstalk"
    former: ClassVar[Mapping[str, str]] = {
        f"{source}_to_{target}": f"{source}_on_{target}" for source, target in permutations(AXES, 2)
    }
    equation: ClassVar[str] = "F_reported - F_true on one axis = c * F_reported along another"
    says: ClassVar[str] = "The force sensor's axes talk to each other."

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Share of each axis's force that the sensor adds to another's."""
        return tuple(
            ParameterSpec(
                f"{source}_on_{target}", "1", "1", plausible=0.12, typical=0.01,
                meaning=f"share of the reported force along {source} that the sensor adds along "
                f"{target} (tool frame)",
            )
            for source, target in permutations(AXES, 2)
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """One element off the diagonal each: what the sensor adds is taken away."""
        out = np.zeros((6, 6, 6))
        for k, (source, target) in enumerate(permutations(range(3), 2)):
            out[k, target, source] = -1.0
        return out
