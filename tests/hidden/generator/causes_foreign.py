"""Causes that no catalogue of the product lists: what `outside` is for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .arm import Arm
from .causes_elastic import AXES
from .equilibrium import Law, Rest
from .mechanism import Insert, Standing
from .rotations import Array, normals
from .world import Cause, Scene


@dataclass(frozen=True)
class QuadraticMount(Cause):
    """The floor anchors yield with the square of the tilting moment. Sizes: x, y [rad/(N m)] at
    the moment `full` (option); option gap: they yield to one side only."""

    name: ClassVar[str] = "foreign_quadratic_mount"

    def inserts(self, arm: Arm) -> list[Insert]:
        return [
            Insert(f"mount:{key}", -1, np.zeros(3), AXES[key], False, 0.0) for key in self.sizes
        ]

    def laws(self, scene: Scene) -> list[Law]:
        full = float(self.options["full"])
        gap = bool(self.options.get("gap", False))

        def one(key: str) -> Law:
            column = scene.mechanism.column[f"mount:{key}"]

            def law(f: Array, x: Array) -> tuple[int, Array]:
                m = f[column]
                shape = np.maximum(m, 0.0) if gap else m * np.abs(m) / full
                return column, self.size(key) * shape

            return law

        return [one(key) for key in self.sizes]


@dataclass(frozen=True)
class RubberMount(Cause):
    """A rubber buffer under the tool stiffens as it is pressed. Sizes: compliance [m/N];
    option full [N]."""

    name: ClassVar[str] = "foreign_rubber_mount"

    def inserts(self, arm: Arm) -> list[Insert]:
        last = len(arm.joints) - 1
        at, turn = arm.tool[:3, 3], arm.tool[:3, :3]
        return [
            Insert(f"rubber:{key}", last, at, turn @ AXES[key], True, 0.0, 1.4) for key in "xyz"
        ]

    def laws(self, scene: Scene) -> list[Law]:
        full = float(self.options["full"])

        def one(key: str) -> Law:
            column = scene.mechanism.column[f"rubber:{key}"]

            def law(f: Array, x: Array) -> tuple[int, Array]:
                load = f[column]
                return column, self.size("compliance") * load / (1.0 + np.abs(load) / full)

            return law

        return [one(key) for key in "xyz"]


@dataclass(frozen=True)
class RadialBearing(Cause):
    """A bearing gives way sideways, without tilting. Sizes: compliance [m/N]."""

    name: ClassVar[str] = "foreign_radial_bearing"

    def inserts(self, arm: Arm) -> list[Insert]:
        index = arm.joint_index(self.where)
        axes = normals(arm.joints[index].axis)
        return [
            Insert(f"radial:{i}", index, np.zeros(3), axis, True, self.size("compliance"), 0.01)
            for i, axis in enumerate(axes)
        ]


@dataclass(frozen=True)
class AxialLink(Cause):
    """A link stretches. Sizes: compliance [m/N]."""

    name: ClassVar[str] = "foreign_axial_link"

    def inserts(self, arm: Arm) -> list[Insert]:
        index, span = arm.spans()[self.where]
        axis = span / np.linalg.norm(span)
        return [Insert("axial", index, span, axis, True, self.size("compliance"), 1.2)]


@dataclass(frozen=True)
class Hose(Cause):
    """A hose pack drags: a spring and a constant part against the motion. Sizes: stiffness
    [N/m], drag [N]; it pulls at the tool."""

    name: ClassVar[str] = "foreign_hose"

    def pull(self, standing: Standing, moved: Array, scene: Scene) -> Array:
        length = np.linalg.norm(moved, axis=1, keepdims=True)
        # the drag sets in over a tenth of a millimetre
        return -self.size("stiffness") * moved - self.size("drag") * moved / (length + 1e-4)


@dataclass(frozen=True)
class ThermalLink(Cause):
    """A link grows and shrinks as the hall warms and cools. Sizes: length [m]; options period
    (readings) and phase."""

    name: ClassVar[str] = "foreign_thermal_link"

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        index, _ = scene.arm.spans()[self.where]
        ends = scene.mechanism.joint_element[index : index + 2]
        span = after.standing.origins[ends[1]] - after.standing.origins[ends[0]]
        span = span / np.linalg.norm(span, axis=1, keepdims=True)
        speed = 2.0 * np.pi / float(self.options["period"])
        phase = float(self.options["phase"])
        rows = scene.rows
        warmer = np.sin(speed * rows.order + phase) - np.sin(speed * rows.zero_order + phase)
        return displacement + self.size("length") * warmer[:, None] * span


@dataclass(frozen=True)
class TrackerStand(Cause):
    """The tracker stands on the same floor and turns with it. Sizes: compliance [rad/(N m)] of
    the floor under the robot's tilting moment; option at: the tracker's place (3,) [m]."""

    name: ClassVar[str] = "foreign_tracker_stand"

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        rows = scene.rows
        assert scene.before_point is not None
        moment = np.cross(scene.before_point, rows.force) + rows.moment
        moment = moment * np.array([1.0, 1.0, 0.0])
        turned = self.size("compliance") * moment
        lever = scene.before_point - np.asarray(self.options["at"], float)
        return displacement - np.cross(turned, lever)
