"""Whitening in which the draws of random_effects effects count as noise.

Zero offsets, one for every pose, can imitate whatever is constant at single poses. As free
parameters they leave nothing of it to look at; as draws of one size they must be as irregular as
draws, and a cause that hides behind them stands out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Mask, rms
from sk120stiff.identify import Fit
from sk120stiff.measurements.noise.whitening import Shortening
from sk120stiff.measurements.poses import rows_by_label


@dataclass(frozen=True, eq=False)
class RandomEffects:
    """The random_effects parameters of a fitted model as part of its noise.

    Attributes:
        fit: The fitted model.
        derivative: (N, 3, P) its sensitivities, reading axes.
    """

    fit: Fit
    derivative: Array

    @cached_property
    def columns(self) -> Mask:
        """(P,) which parameters are draws; offsets that are known and held are none."""
        return np.array([p.effect.random_effects and p.free for p in self.fit.model.parameters])

    def covered(self) -> Array:
        """(N, 3) what the draws explain of the readings [m]."""
        values = self.fit.model.values[self.columns]
        return np.asarray(self.derivative[:, :, self.columns] @ values)

    def whiten(self, x: Array) -> Array:
        """As `Whitener.apply`, with the scatter of the draws besides."""
        return self._scatter.apply(self.fit.problem.whitener.apply(x))

    @cached_property
    def _scatter(self) -> Shortening:
        if not self.columns.any():
            return Shortening([], [])
        size = rms(self.fit.model.values[self.columns])
        spread = self.fit.problem.whitener.apply(size * self.derivative[:, :, self.columns])
        poses = rows_by_label(self.fit.problem.pose)
        parts = [spread[rows] for rows in poses]
        return Shortening(poses, [part[:, (part != 0.0).any(axis=0)] for part in parts])
