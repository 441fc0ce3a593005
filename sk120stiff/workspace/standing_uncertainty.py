"""How surely a loaded tool stands where a model says: what the model's own uncertainty makes of it.

A correction cancels what the model believes. What remains in truth is what the model does not know:
its parameters within their uncertainty, and what it leaves unexplained.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, rms
from sk120stiff.effects import load_case
from sk120stiff.errors import Refusal
from sk120stiff.model import (
    Model,
    Share,
    held_loads,
    joint_shares,
    seen_from,
    shares,
    without_marker,
)
from sk120stiff.model.predicted import blamed
from sk120stiff.model.sensitivities import standing_sensitivities
from sk120stiff.model.uncertainty import spread

BLOCK = 1024  # points solved together


@dataclass(frozen=True, eq=False)
class StandingUncertainty:
    """Standard distance of N loaded points from where a model says that they stand.

    Attributes:
        std_parameters: (N,) root of the variances along x, y and z, from the parameters [m];
            infinite where a value counts that the readings of the fit do not show, NaN where no
            equilibrium exists.
        std_remainder: (N,) the same from what the model leaves unexplained [m]; None: not known.
        blame: Parameters that make it infinite.
    """

    std_parameters: Array
    std_remainder: Array | None
    blame: tuple[str, ...]

    @property
    def rms(self) -> tuple[float, float | None]:
        """Of `std_parameters` and of `std_remainder`, over the points that have an equilibrium."""
        left = self.std_remainder
        return _rms(self.std_parameters), None if left is None else _rms(left)

    @property
    def std(self) -> Array | None:
        """(N,) both together [m]; None where it is not known."""
        if not np.isfinite(self.rms[0]):
            return None
        left = 0.0 if self.std_remainder is None else self.std_remainder
        return np.asarray(np.hypot(self.std_parameters, left))


def _rms(std: Array) -> float:
    """Infinite if one of them is unknown."""
    there = std[~np.isnan(std)]
    return rms(there)


def standing_uncertainty(
    model: Model,
    commanded: ArrayLike,
    wrench: ArrayLike,
    *,
    frame: str | None = None,
) -> StandingUncertainty | None:
    """± of where a tool stands for commands (N, n) under loads (N, 6), as `standing` tells it.

    Weight and wrong geometry count too. None if the model stores no uncertainty.
    """
    known = model.uncertainty
    if known is None:
        return None
    physical, a, load, at = _seen(model, commanded, wrench, frame)
    L, B = known.factors(physical.names)
    std = np.full(len(a), np.nan)
    blame: list[str] = []
    for rows, derivative in _derivatives(physical, a, load, at):
        axes = spread(derivative @ L, derivative @ B, known.floor)
        std[rows] = np.linalg.norm(axes, axis=1)
        if np.isinf(axes).any():
            blame += blamed(known, physical.names, derivative[np.isinf(axes).any(axis=1)])
    left = None
    if known.remainder is not None:
        left = np.linalg.norm(known.remainder.std(load), axis=1)
    return StandingUncertainty(std, left, tuple(dict.fromkeys(blame)))


def standing_budgets(
    model: Model,
    commanded: ArrayLike,
    wrench: ArrayLike,
    *,
    frame: str | None = None,
) -> tuple[tuple[Share, ...], tuple[Share, ...]]:
    """What each effect moves a loaded tool by, for commands (N, n) under loads (N, 6).

    Weight and wrong geometry count too. Standard errors where the model stores its uncertainty, and
    the readings of its fit show the effect.

    Returns:
        tuple: The effects, and the sums of all that yields at each joint: spring, gear and bearing.
    """
    physical, a, load, at = _seen(model, commanded, wrench, frame)
    found = [derivative for _, derivative in _derivatives(physical, a, load, at)]
    derivative = np.concatenate([np.zeros((0, 3, len(physical.values))), *found])
    if not len(derivative):
        return (), ()
    covariance = None
    if model.uncertainty is not None:
        L, B = model.uncertainty.factors(physical.names)
        covariance = L @ L.T + B @ B.T
        unknown = np.isinf(spread(L, B, 0.0))
        covariance[unknown, unknown] = np.inf
    parts = physical, derivative, covariance
    return shares(*parts), joint_shares(*parts)


def _seen(
    model: Model, commanded: ArrayLike, wrench: ArrayLike, frame: str | None
) -> tuple[Model, Array, Array, Array]:
    """The arm up to a frame, commands (N, n), loads (N, 6), and the point in its tool frame."""
    physical, at = seen_from(without_marker(model), frame)
    a = np.atleast_2d(physical.robot.coordinates(commanded))
    return physical, a, np.broadcast_to(np.asarray(wrench, dtype=float), (len(a), 6)), at


def _derivatives(
    physical: Model, a: Array, load: Array, at: Array
) -> Iterator[tuple[Index, Array]]:
    """Rows that have an equilibrium, and (k, 3, P) of where they stand by the internal values."""
    for begin in range(0, len(a), BLOCK):
        rows = np.arange(begin, min(begin + BLOCK, len(a)))
        load_cases = load_case(physical.robot, a[rows], load[rows], point=at, absolute=True)
        try:
            solution = physical.solve(load_cases)
        except Refusal:
            held = held_loads(physical, load_cases)
            if not held.any():
                continue
            rows, load_cases = rows[held], load_cases.rows(held)
            solution = physical.solve(load_cases)
        yield rows, standing_sensitivities(physical.assembly, solution, physical.values)
