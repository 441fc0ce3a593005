"""What moves estimates beside the noise: other models, what is left out, foreign causes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array


@dataclass(frozen=True, eq=False)
class Moves:
    """By how much the P estimates of a fit may be off beside the noise, each in its own way.

    Attributes:
        models: (P,) by other models that are possible as well.
        left_out: (P,) standard errors by what the model is known to leave out.
        omitted: (P, P) covariance by the same, also of values whose standard errors it is not in;
            it moves them together, and such readings are foretold alike.
        foreign: (P, P) covariance by a cause that has no name, which moves them together.
        parts: (P, P) the same by parts that yield instead, which foretell such readings alike.
        by_form: (P, P) the same by what numbers of a law's form are known to.
    """

    models: Array
    left_out: Array
    omitted: Array
    foreign: Array
    parts: Array
    by_form: Array

    @classmethod
    def of(
        cls,
        count: int,
        models: Array | None,
        left_out: Array | None,
        omitted: Array | None,
        foreign: Array | None,
        parts: Array | None,
        by_form: Array | None,
    ) -> Moves:
        """Of so many estimates; None: by nothing."""
        none, apart = np.zeros(count), np.zeros((count, count))
        each = none if left_out is None else left_out
        return cls(
            none if models is None else models,
            each,
            np.diag(each**2) if omitted is None else omitted,
            apart if foreign is None else foreign,
            apart if parts is None else parts,
            apart if by_form is None else by_form,
        )

    @property
    def covariance(self) -> Array:
        """(P, P) of all together, each model's move for itself."""
        apart = np.diag(self.models**2 + self.left_out**2)
        return np.asarray(apart + self.foreign + self.parts + self.by_form)

    @property
    def random(self) -> Array:
        """(P,) standard errors that are as likely one way or the other."""
        return np.sqrt(self.left_out**2 + np.diag(self.parts + self.by_form))

    def widened(self, ends: Array, x: Array, reach: float, bounds: tuple[Array, Array]) -> Array:
        """(P, 2) ends of intervals about estimates (P,) with these moves beside the noise.

        Args:
            ends: (P, 2) those by the noise alone.
            x: The estimates.
            reach: Standard errors that an interval reaches.
            bounds: (P,) each, that no value goes beyond.
        """
        low, high = (bound[:, None] for bound in bounds)
        random, elsewhere = self.random[:, None], np.outer(self.elsewhere, [-1.0, 1.0])
        if random.any():  # errors like the noise's: squares add
            away, error = np.abs(ends - x[:, None]), reach * random
            wider = error**2 / np.maximum(away + np.hypot(away, error), 1e-300)
            ends = np.clip(ends + wider * [-1.0, 1.0], low, high)
        return np.clip(ends + elsewhere, low, high) if elsewhere.any() else ends

    @property
    def elsewhere(self) -> Array:
        """(P,) how far from the estimates the values may lie instead, the noise for itself."""
        return np.hypot(self.models, np.sqrt(np.diag(self.foreign)))
