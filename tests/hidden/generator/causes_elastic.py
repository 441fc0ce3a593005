"""Missing compliance: bearings, links, foundation, tool, wrist, and the closed linkage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .arm import Arm
from .mechanism import Insert
from .rotations import Array, normals
from .world import Cause, Scene

AXES = {"x": np.array([1.0, 0, 0]), "y": np.array([0, 1.0, 0]), "z": np.array([0, 0, 1.0])}


@dataclass(frozen=True)
class WristSpring(Cause):
    """A joint that the base model holds rigid yields. Sizes: compliance."""

    name: ClassVar[str] = "joint_springs"
    exact: ClassVar[bool] = True

    def compliances(self, scene: Scene) -> Mapping[str, float]:
        return {self.where: self.size("compliance")}


def tilt_axes(arm: Arm, index: int) -> tuple[Array, Array]:
    """Axes of a bearing's tilt: along the link that it carries, and across."""
    joint = arm.joints[index]
    after = arm.joints[index + 1].before if index + 1 < len(arm.joints) else arm.tool
    along = after[:3, 3] - joint.axis * (joint.axis @ after[:3, 3])
    if np.linalg.norm(along) < 1e-6:
        return normals(joint.axis)
    along = along / np.linalg.norm(along)
    return along, np.cross(joint.axis, along)


@dataclass(frozen=True)
class JointTilt(Cause):
    """The bearing tilts about two axes normal to its joint axis, which turn with the joint.

    Sizes: `first` about the direction of the link (as far as it is normal to the joint axis),
    `second` across it.
    """

    name: ClassVar[str] = "joint_tilt"
    exact: ClassVar[bool] = True

    def inserts(self, arm: Arm) -> list[Insert]:
        index = arm.joint_index(self.where)
        axes = tilt_axes(arm, index)
        return [
            Insert(f"tilt:{self.where}:{key}", index, np.zeros(3), axis, False, self.size(key))
            for key, axis in zip(("first", "second"), axes, strict=True)
            if self.size(key) != 0.0
        ]


@dataclass(frozen=True)
class BaseRocking(Cause):
    """The foundation turns about horizontal axes through the base frame's origin."""

    name: ClassVar[str] = "base_rocking"
    exact: ClassVar[bool] = True

    def inserts(self, arm: Arm) -> list[Insert]:
        return [
            Insert(f"rock:{key}", -1, np.zeros(3), AXES[key], False, value)
            for key, value in self.sizes.items()
        ]


@dataclass(frozen=True)
class BaseSliding(Cause):
    """The foundation gives way along x, y, z."""

    name: ClassVar[str] = "base_sliding"
    exact: ClassVar[bool] = True

    def inserts(self, arm: Arm) -> list[Insert]:
        return [
            Insert(f"slide:{key}", -1, np.zeros(3), AXES[key], True, value)
            for key, value in self.sizes.items()
        ]


@dataclass(frozen=True)
class ToolCompliance(Cause):
    """The fixture turns (rx, ry, rz) and slides (tx, ty, tz) at the flange, in tool axes."""

    name: ClassVar[str] = "tool_compliance"
    exact: ClassVar[bool] = True

    def inserts(self, arm: Arm) -> list[Insert]:
        last = len(arm.joints) - 1
        at, turn = arm.tool[:3, 3], arm.tool[:3, :3]
        return [
            Insert(f"tool:{key}", last, at, turn @ AXES[key[1]], key[0] == "t", value, 1.5)
            for key, value in self.sizes.items()
        ]


def profile(taper: float, stations: Array, power: float = 3.0) -> Array:
    """Local flexibility of a link that gets thinner towards its end; its mean is 1."""
    local = (1.0 - taper * stations) ** -power
    return local / local.mean()


@dataclass(frozen=True)
class LinkBending(Cause):
    """A tapered beam, clamped at its joint, cut into many short pieces.

    Sizes: flexibility = mean of 1/EI. Options: taper 0..0.7, ratio of the two lateral
    flexibilities, pieces, only (0 or 1: one lateral axis alone).
    """

    name: ClassVar[str] = "link_bending"

    def inserts(self, arm: Arm) -> list[Insert]:
        index, span = arm.spans()[self.where]
        pieces = int(self.options.get("pieces", 20))
        length = float(np.linalg.norm(span))
        stations = (np.arange(pieces) + 0.5) / pieces
        local = profile(float(self.options.get("taper", 0.0)), stations)
        ratio = float(self.options.get("ratio", 1.0))
        only = self.options.get("only")
        out = []
        for number, (axis, factor) in enumerate(
            zip(normals(span / length), (1.0, ratio), strict=True)
        ):
            if only is not None and only != number:
                continue
            compliance = self.size("flexibility") * factor * length / pieces * local
            out += [
                Insert(f"bend:{self.where}:{number}:{i}", index, s * span, axis, False, float(c), s)
                for i, (s, c) in enumerate(zip(stations, compliance, strict=True))
            ]
        return out


@dataclass(frozen=True)
class LinkTorsion(Cause):
    """A tapered shaft along the link's tube. Sizes: flexibility = mean of 1/GJ."""

    name: ClassVar[str] = "link_torsion"

    def inserts(self, arm: Arm) -> list[Insert]:
        index, start, tube = arm.shafts()[self.where]
        pieces = int(self.options.get("pieces", 8))
        length = float(np.linalg.norm(tube))
        stations = (np.arange(pieces) + 0.5) / pieces
        local = profile(float(self.options.get("taper", 0.0)), stations)
        compliance = self.size("flexibility") * length / pieces * local
        return [
            Insert(
                f"twist:{self.where}:{i}",
                index,
                start + s * tube,
                tube / length,
                False,
                float(c),
                s,
            )
            for i, (s, c) in enumerate(zip(stations, compliance, strict=True))
        ]


@dataclass(frozen=True)
class ClosureCoupling(Cause):
    """Torque on one motor moves the other. `where` is 'a,b'. Sizes: compliance."""

    name: ClassVar[str] = "closure_coupling"
    exact: ClassVar[bool] = True

    def couplings(self) -> list[tuple[str, str, float]]:
        first, second = self.where.split(",")
        return [(first, second, self.size("compliance"))]


@dataclass(frozen=True)
class ClosureRod(Cause):
    """The rod of the linkage stretches. Sizes: compliance [m/N] along the rod."""

    name: ClassVar[str] = "closure_rod"

    def compliances(self, scene: Scene) -> Mapping[str, float]:
        return {"rod": self.size("compliance")}
