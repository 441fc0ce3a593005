"""One sealed case: what the program under test gets, and what only the scorer knows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from .arm import Arm
from .noise import Noise
from .public import quantities
from .rotations import Array
from .rows import Rows
from .signature import Rival
from .world import Cause, World


@dataclass(frozen=True)
class Hidden:
    """A cause as the truth file lists it."""

    cause: Cause
    visibility: float  # ||u|| / sigma beyond the base springs
    left: float  # the same beyond the other hidden causes too
    rivals: Sequence[Rival] = ()


@dataclass(frozen=True)
class Case:
    """Data of one case and its truth."""

    level: str
    arm: Arm
    world: World
    train: Rows
    holdout: Rows
    sealed: Rows  # held-out readings that `explain` never gets; predictions are judged on them
    noise: Noise
    positions: bool
    force_frame: str
    seed: tuple[int, ...]
    hidden: Sequence[Hidden] = ()
    accepted: Sequence[str] = ()  # L5: the class of which no member may stand alone
    expected: str = "named"  # verdict that is right
    arguments: Sequence[str] = ()  # further options of the command
    urdf: str | None = None
    note: str = ""
    truth_extra: dict[str, object] = field(default_factory=dict)

    def foreseeable(self, rows: Rows) -> Array:
        """Noise-free displacements (N, 3) [m] without zero offsets."""
        causes = [cause for cause in self.world.causes if cause.name != "zero_offset"]
        return self.world.with_causes(*causes).displacement(rows)

    def check(self) -> None:
        """Every set has to have an equilibrium."""
        for rows in (self.train, self.holdout, self.sealed):
            self.world.observe(rows)

    def sealed_sigma(self) -> float:
        """Root mean variance of a sealed displacement's noise [m], outliers left out."""
        displacement, position, _ = self.world.observe(self.sealed)
        covariance = self.noise.covariance(self.sealed, displacement, position)
        return float(np.sqrt(np.mean(np.diag(covariance))))

    def truth(self) -> dict[str, object]:
        """The sealed JSON document."""
        return {
            "level": self.level,
            "robot": self.arm.name,
            "seed": list(self.seed),
            "expected": self.expected,
            "note": self.note,
            "arguments": list(self.arguments),
            "accepted": list(self.accepted),
            "effects": [self._effect(entry) for entry in self.hidden],
            "springs": {name: 1.0 / c for name, c in self.world.springs.items()},
            "noise": {
                "sigma_um": 1e6 * self.noise.sigma,
                "shared_zero": self.noise.shared_zero,
                "growth": self.noise.growth,
                "angular": self.noise.angular,
                "outliers": self.noise.outliers,
                "outlier_um": 1e6 * self.noise.outlier_size,
                "wander_um": 1e6 * self.noise.wander,
                "along": self.noise.along,
                "warm_up_um": 1e6 * self.noise.warm_up,
                "declared": dict(self.noise.declared),
            },
            # what the best possible model predicts: chance zeros of new poses are in nobody's model
            "oracle": np.round(self.foreseeable(self.sealed), 10).tolist(),
            "sealed_sigma_um": 1e6 * self.sealed_sigma(),
            **self.truth_extra,
        }

    def _effect(self, entry: Hidden) -> dict[str, object]:
        cause = entry.cause
        return {
            "name": cause.name,
            "where": cause.where,
            "sizes": dict(cause.sizes),
            "options": {key: _plain(value) for key, value in cause.options.items()},
            "quantities": quantities(cause, self.world.springs),
            "visibility": round(entry.visibility, 2),
            "left": round(entry.left, 2),
            "rivals": [
                {
                    "name": rival.name,
                    "where": rival.where,
                    "separation": round(rival.separation, 2),
                    "angle_deg": round(rival.angle, 2),
                }
                for rival in list(entry.rivals)[:8]
            ],
        }


def _plain(value: object) -> object:
    return value.item() if isinstance(value, np.generic) else value
