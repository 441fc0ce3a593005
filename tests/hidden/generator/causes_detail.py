"""Structures and trackers as they are: right in kind for a catalogue's name, wrong in detail."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .arm import Arm
from .causes_elastic import BaseRocking
from .equilibrium import Rest
from .mechanism import Insert
from .rotations import Array, normals
from .world import Cause, Scene


@dataclass(frozen=True)
class RealBeam(Cause):
    """A beam that tapers and has steps, clamped at its joint. Sizes: flexibility, mean of 1/EI.

    Options: taper 0..0.8 (the height falls by it); steps ((station, factor), ...): from that
    station on 1/EI is that many times its tapered value; ratio of the two lateral flexibilities;
    tube: it lies around the axis of the roll joint that it carries, as far as there is one.
    """

    name: ClassVar[str] = "link_bending"

    def local(self, stations: Array) -> Array:
        """1/EI over its mean (pieces,)."""
        out = (1.0 - float(self.options.get("taper", 0.0)) * stations) ** -3.0
        for station, factor in self.options.get("steps", ()):
            out = np.where(stations >= station, factor * out, out)
        return out / out.mean()

    def inserts(self, arm: Arm) -> list[Insert]:
        if self.options.get("tube", False):
            index, start, span = arm.shafts()[self.where]
        else:
            index, span = arm.spans()[self.where]
            start = np.zeros(3)
        pieces = int(self.options.get("pieces", 24))
        length = float(np.linalg.norm(span))
        stations = (np.arange(pieces) + 0.5) / pieces
        mean = self.size("flexibility") * length / pieces
        ratio = float(self.options.get("ratio", 1.0))
        return [
            Insert(f"bend:{self.where}:{side}:{i}", index, start + s * span, axis, False,
                   float(mean * factor * c), float(s))
            for side, (axis, factor) in enumerate(
                zip(normals(span / length), (1.0, ratio), strict=True)
            )
            for i, (s, c) in enumerate(zip(stations, self.local(stations), strict=True))
        ]  # fmt: skip


@dataclass(frozen=True)
class TurnedRocking(Cause):
    """The foundation rocks softly about one horizontal axis and stiffly about the other, and they
    are not the base's. Sizes: soft, stiff [rad/(N m)]; option turn [rad] from the base's x."""

    name: ClassVar[str] = BaseRocking.name

    def inserts(self, arm: Arm) -> list[Insert]:
        turn = float(self.options["turn"])
        along = np.array([np.cos(turn), np.sin(turn), 0.0])
        across = np.array([-np.sin(turn), np.cos(turn), 0.0])
        return [
            Insert(f"rock:{key}", -1, np.zeros(3), axis, False, self.size(key))
            for key, axis in (("soft", along), ("stiff", across))
        ]


@dataclass(frozen=True)
class WarmUp(Cause):
    """The tracker drifts while it warms up: fast at first, then no more. Sizes: x, y, z
    [m per reading], the rate at first; option time, in readings."""

    name: ClassVar[str] = "reading_drift"

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        time = float(self.options["time"])
        rows = scene.rows
        gone = time * (np.exp(-rows.zero_order / time) - np.exp(-rows.order / time))
        rate = np.array([self.size("x"), self.size("y"), self.size("z")])
        return displacement + gone[:, None] * rate
