"""Instruments that misread, and rigid geometry that is not as the drawing says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from .arm import Arm
from .equilibrium import Rest
from .rotations import Array, exponential
from .world import Cause, Scene


def _vector(cause: Cause) -> Array:
    return np.array([cause.size("x"), cause.size("y"), cause.size("z")])


@dataclass(frozen=True)
class ForceSensor(Cause):
    """True = matrix reported + bias, in sensor (tool) axes. Gains concern forces alone; a turned
    sensor turns moments too."""

    turns_moments: ClassVar[bool] = False

    def matrix(self) -> Array:
        return np.eye(3)

    def bias(self) -> Array:
        return np.zeros(3)

    def wrench(
        self, force: Array, moment: Array, tool_rotation: Array, scene: Scene
    ) -> tuple[Array, Array]:
        inside = tool_rotation @ self.matrix() @ np.swapaxes(tool_rotation, 1, 2)
        true_force = np.einsum("nij,nj->ni", inside, force) + tool_rotation @ self.bias()
        if self.turns_moments:
            moment = np.einsum("nij,nj->ni", inside, moment)
        return true_force, moment


@dataclass(frozen=True)
class ForceScale(ForceSensor):
    """Sizes: share of each sensor axis x, y, z."""

    name: ClassVar[str] = "force_scale"
    exact: ClassVar[bool] = True

    def matrix(self) -> Array:
        return np.eye(3) + np.diag(_vector(self))


@dataclass(frozen=True)
class ForceBias(ForceSensor):
    """Sizes: x, y, z [N]. The sensor is zeroed nowhere; unloaded readings carry no force."""

    name: ClassVar[str] = "force_bias"
    exact: ClassVar[bool] = True

    def bias(self) -> Array:
        return _vector(self)


@dataclass(frozen=True)
class ForceRotation(ForceSensor):
    """Sizes: rotation vector x, y, z [rad]."""

    name: ClassVar[str] = "force_rotation"
    turns_moments: ClassVar[bool] = True
    exact: ClassVar[bool] = True

    def matrix(self) -> Array:
        return exponential(_vector(self))


@dataclass(frozen=True)
class ForceCrosstalk(ForceSensor):
    """Sizes: 'xy' is what reported y adds to true x, and so on."""

    name: ClassVar[str] = "force_crosstalk"

    def matrix(self) -> Array:
        out = np.eye(3)
        for key, value in self.sizes.items():
            out["xyz".index(key[0]), "xyz".index(key[1])] += value
        return out


@dataclass(frozen=True)
class ReadingRotation(Cause):
    """The tracker's frame is turned against the base. Sizes: rotation vector x, y, z [rad]."""

    name: ClassVar[str] = "reading_rotation"
    exact: ClassVar[bool] = True

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        return displacement @ exponential(_vector(self)).T


@dataclass(frozen=True)
class ReadingScale(Cause):
    """Sizes: share."""

    name: ClassVar[str] = "reading_scale"
    exact: ClassVar[bool] = True

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        return (1.0 + self.size("share")) * displacement


@dataclass(frozen=True)
class ReadingDrift(Cause):
    """The tracker wanders. Sizes: x, y, z [m per reading]."""

    name: ClassVar[str] = "reading_drift"
    exact: ClassVar[bool] = True

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        since = scene.rows.order - scene.rows.zero_order
        return displacement + since[:, None] * _vector(self)


@dataclass(frozen=True)
class ZeroOffset(Cause):
    """Every pose has a wrong zero of its own. Sizes: rms [m]; option seed."""

    name: ClassVar[str] = "zero_offset"

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        seed = int(self.options["seed"])
        own = {
            pose: np.random.default_rng((seed, int(pose))).normal(size=3)
            for pose in np.unique(scene.rows.pose)
        }
        return displacement + self.size("rms") * np.array([own[p] for p in scene.rows.pose])


@dataclass(frozen=True)
class JointOffset(Cause):
    """The joint stands elsewhere than reported. Sizes: offset [rad or m]."""

    name: ClassVar[str] = "joint_offset"
    exact: ClassVar[bool] = True

    def coordinates(self, values: Mapping[str, Array]) -> Mapping[str, Array]:
        return {**values, self.where: values[self.where] + self.size("offset")}


@dataclass(frozen=True)
class ToolOffset(Cause):
    """The measured and loaded point stands elsewhere on the tool. Sizes: x, y, z [m]."""

    name: ClassVar[str] = "tool_offset"
    exact: ClassVar[bool] = True

    def point(self, local: Array) -> Array:
        return local + _vector(self)


@dataclass(frozen=True)
class LinkLength(Cause):
    """A link is longer than drawn. Sizes: length [m]. A rod beside it is longer too, so that a
    parallelogram stays one."""

    name: ClassVar[str] = "link_length"
    exact: ClassVar[bool] = True

    def geometry(self, arm: Arm) -> Arm:
        index, span = arm.spans()[self.where]
        before = arm.joints[index + 1].before.copy()
        before[:3, 3] += self.size("length") * span / np.linalg.norm(span)
        arm = arm.with_joint(index + 1, before=before)
        if arm.loop is not None and index == arm.loop.pivot:
            loop = replace(arm.loop, rod=arm.loop.rod + self.size("length"))
            arm = replace(arm, loop=loop)
        return arm
