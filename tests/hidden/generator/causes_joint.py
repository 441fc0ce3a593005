"""What gears and bearings do beyond a linear spring: hardening, lost motion, friction, balance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .equilibrium import Law
from .rotations import Array
from .world import Cause, Scene


@dataclass(frozen=True)
class GearHardening(Cause):
    """Softer at small torque. Sizes: either knees (first, second) or cubic.

    Piecewise: extra compliance c*first inside |torque| < T1 and c*second inside T2 (options T1,
    T2 in N m). Cubic: the compliance falls by the share `cubic` at the torque T (option).
    """

    name: ClassVar[str] = "gear_hardening"

    def laws(self, scene: Scene) -> list[Law]:
        column = scene.mechanism.column[self.where]
        c = scene.springs[self.where]
        knees = [
            (self.size("first"), float(self.options.get("T1", 1.0))),
            (self.size("second"), float(self.options.get("T2", 1.0))),
        ]
        cubic, full = self.size("cubic"), float(self.options.get("T", 1.0))

        def law(f: Array, x: Array) -> tuple[int, Array]:
            torque = f[column]
            extra = sum(r * np.clip(torque, -knee, knee) for r, knee in knees)
            return column, c * (extra - cubic / 3.0 * torque * (torque / full) ** 2)

        return [law]


@dataclass(frozen=True)
class LostMotion(Cause):
    """A jump with the sign of the whole joint torque. Sizes: half_width [rad or m]."""

    name: ClassVar[str] = "lost_motion"
    exact: ClassVar[bool] = True

    def laws(self, scene: Scene) -> list[Law]:
        column = scene.mechanism.column[self.where]
        half = self.size("half_width")

        def law(f: Array, x: Array) -> tuple[int, Array]:
            torque = np.where(np.abs(f[column]) < 1e-9, 0.0, f[column])
            return column, half * np.sign(torque)

        return [law]


@dataclass(frozen=True)
class FrictionHysteresis(Cause):
    """The joint lags: less on the way up, more on the way down. Sizes: half_width."""

    name: ClassVar[str] = "friction_hysteresis"
    exact: ClassVar[bool] = True

    def laws(self, scene: Scene) -> list[Law]:
        if scene.before is None:
            return []
        column = scene.mechanism.column[self.where]
        idle = scene.before.f[column]
        half = self.size("half_width") * scene.rows.branch

        def law(f: Array, x: Array) -> tuple[int, Array]:
            change = f[column] - idle
            return column, -half * np.sign(np.where(np.abs(change) < 1e-9, 0.0, change))

        return [law]


@dataclass(frozen=True)
class GravityCompensator(Cause):
    """A balancing spring pulls the arm upright; the controller balances its torque at the
    commanded angle. Sizes: share of the joint's stiffness."""

    name: ClassVar[str] = "gravity_compensator"

    def laws(self, scene: Scene) -> list[Law]:
        column = scene.mechanism.column[self.where]
        angle = scene.rows.coordinates[self.where]
        share = self.size("share")

        def law(f: Array, x: Array) -> tuple[int, Array]:
            return column, -share * (np.sin(angle + x[column]) - np.sin(angle))

        return [law]


@dataclass(frozen=True)
class PeriodicGear(Cause):
    """Foreign: the gear is stiffer at some of its teeth. Sizes: share; options count, phase."""

    name: ClassVar[str] = "foreign_periodic_gear"

    def compliances(self, scene: Scene) -> dict[str, Array]:
        angle = scene.rows.coordinates[self.where]
        wave = np.sin(float(self.options["count"]) * angle + float(self.options["phase"]))
        return {self.where: self.size("share") * scene.springs[self.where] * wave}


@dataclass(frozen=True)
class Memory(Cause):
    """Foreign: a gear that remembers (play operator over the whole series).

    Sizes: share of the joint's compliance; option play [N m]. Before each pose the torque
    returns to its idle value, the memory does not.
    """

    name: ClassVar[str] = "foreign_memory"

    def laws(self, scene: Scene) -> list[Law]:
        if scene.before is None:
            return []
        rows = scene.rows
        column = scene.mechanism.column[self.where]
        idle = scene.before.f[column]
        play = float(self.options["play"])
        share = self.size("share") * scene.springs[self.where]
        sequence = np.argsort(rows.order, kind="stable")

        def law(f: Array, x: Array) -> tuple[int, Array]:
            out = np.zeros(rows.count)
            state, zero, last = 0.0, 0.0, None
            for row in sequence:
                torque = f[column][row] - idle[row]
                if rows.zero_order[row] != last:
                    state = max(-play, min(play, state))  # the torque went back to idle
                    zero, last = state, rows.zero_order[row]
                state = max(torque - play, min(torque + play, state))
                out[row] = share * (state - zero)
            return column, out

        return [law]


@dataclass(frozen=True)
class Creep(Cause):
    """Foreign: the joint goes on yielding while the load stands. Sizes: share; option time."""

    name: ClassVar[str] = "foreign_creep"

    def compliances(self, scene: Scene) -> dict[str, Array]:
        rows = scene.rows
        standing = (rows.order - rows.zero_order) / float(self.options["time"])
        late = 1.0 - np.exp(-standing)
        return {self.where: self.size("share") * scene.springs[self.where] * late}
