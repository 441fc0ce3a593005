"""Where a tracker sees the marker of an arm that nobody pushes: geometry, sag, gears.

Finite rotations throughout; weight, payload and springs at rest together. `Truth` holds what is
wrong, `Visits` where the arm goes and what hangs on it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from .arm import Arm
from .equilibrium import Law, Springs, settle
from .mechanism import GRAVITY, Insert, Mechanism, Standing
from .rotations import Array, exponential, placement
from .world import Cause

TEETH = 0.5  # N m
MOVED = 1e-3  # rad; a smaller movement is jitter of the encoder


def _play(index: int, half: float) -> Law:
    """A gear leans to the side to which weight pushes it; teeth take hold within some N m."""
    return lambda f, _x: (index, half * np.tanh(f[index] / TEETH))


@dataclass(frozen=True)
class Visits:
    """Rows in the order of reading: encoder values, stated payload [kg], degrees, series."""

    pose: Array  # (N,) whole numbers
    values: Mapping[str, Array]  # (N,) each [rad]
    payload: Array  # (N,)
    temperature: Array  # (N,) beyond the first reading [K]
    series: Array  # (N,) whole numbers
    hung: Array  # (3,) where the payload hangs, tool axes [m]

    @property
    def count(self) -> int:
        return len(self.pose)

    def sides(self, name: str) -> Array:
        """Sign of each joint's last movement; nothing is known of the first reading."""
        out = np.zeros(self.count)
        for k, step in enumerate(np.diff(self.values[name]), 1):
            out[k] = np.sign(step) if abs(step) > MOVED else out[k - 1]
        return out


@dataclass(frozen=True)
class Truth:
    """All that is wrong with an arm and unknown of the instrument; SI, nothing by default."""

    arm: Arm
    turn: Array = field(default_factory=lambda: np.zeros(3))  # of the tracker, rotation vector
    shift: Array = field(default_factory=lambda: np.zeros(3))
    marker: Array = field(default_factory=lambda: np.zeros(3))  # tool axes
    frames: Mapping[str, Array] = field(default_factory=dict)  # joint -> shift and turn (6,)
    compliance: Mapping[str, float] = field(default_factory=dict)  # joint -> rad/(N m)
    waves: Mapping[str, Array] = field(default_factory=dict)  # sin q, cos q, sin 2q, cos 2q
    coupling: Mapping[str, float] = field(default_factory=dict)  # "driver,driven" -> ratio
    play: Mapping[str, float] = field(default_factory=dict)  # joint -> half of it [rad]
    side: Mapping[str, float] = field(default_factory=dict)  # joint -> half of the lost way
    growth: Mapping[str, float] = field(default_factory=dict)  # link -> m/K
    remount: Array = field(default_factory=lambda: np.zeros(3))  # of the marker in later series
    load: Array = field(default_factory=lambda: np.zeros(4))  # kg and kg m beside what is stated
    soft: tuple[Cause, ...] = ()  # bearings and beams

    def positions(self, visits: Visits) -> Array:
        """(N, 3) [m], axes of the tracker, free of noise."""
        standing = self._stand(visits)
        local = self.marker + (visits.series > 0)[:, None] * self.remount
        x = standing.tool_position + np.einsum("nij,nj->ni", standing.tool_rotation, local)
        return x @ exponential(self.turn).T + self.shift

    def _stand(self, visits: Visits) -> Standing:
        arm = self.arm
        for name, error in self.frames.items():
            index = arm.joint_index(name)
            before = arm.joints[index].before @ placement(error[:3], exponential(error[3:]))
            arm = arm.with_joint(index, before=before)
        inserts = [part for cause in self.soft for part in cause.inserts(self.arm)]
        grown = {}
        for link, rate in self.growth.items():
            index, span = self.arm.spans()[link]
            label = f"grow:{link}"
            grown[label] = rate * visits.temperature
            along = span / np.linalg.norm(span)
            inserts.append(Insert(label, index, span, along, True, 0.0, 1.0))
        mechanism = Mechanism(arm, inserts)
        commanded = mechanism.commanded(self._stands_at(visits))
        for label, length in grown.items():
            commanded[mechanism.column[label]] = length
        compliance = np.zeros((len(mechanism.labels), visits.count))
        for name, value in self.compliance.items():
            compliance[mechanism.column[name]] = value
        for part in inserts:
            compliance[mechanism.column[part.label]] = part.compliance
        laws = [_play(mechanism.column[name], half) for name, half in self.play.items()]
        weight = (visits.payload + self.load[0])[:, None] * GRAVITY

        def load(at: Standing) -> tuple[Array, Array, Array]:
            moment = np.cross(at.tool_rotation @ self.load[1:], GRAVITY)
            return at.point(visits.hung), weight, moment

        return settle(mechanism, commanded, None, Springs(compliance, (), laws), load).standing

    def _stands_at(self, visits: Visits) -> dict[str, Array]:
        """Joint values without sag, by what encoders say and what gears make of it."""
        q = {name: value.copy() for name, value in visits.values.items()}
        for name, amplitudes in self.waves.items():
            a = visits.values[name]
            q[name] += (
                np.stack([np.sin(a), np.cos(a), np.sin(2 * a), np.cos(2 * a)], 1) @ amplitudes
            )
        for pair, ratio in self.coupling.items():
            driver, driven = pair.split(",")
            q[driven] += ratio * visits.values[driver]
        for name, half in self.side.items():
            q[name] += half * visits.sides(name)
        return q
