"""Noise that goes with the load, as single poses show it without a reading repeated.

A force that was read by hand errs by a share of itself, each reading by its own, and so does the
displacement that it is written beside. No two such readings are repeats. But whatever an arm lacks
is smooth in the load at one pose, and these errors are not: what single poses leave about lines
through their loads, constants, curves and branches tells their size, by restricted likelihood
(Patterson & Thompson 1971), as repeats do (`measurements/noise/repeats.py`).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg
from scipy.optimize import minimize_scalar

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import LoadCases
from sk120stiff.errors import Refusal, two_digits
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.noise.saturated import load_basis, load_directions, pose_columns
from sk120stiff.identify.robust import far_off
from sk120stiff.identify.solve.forces import with_by_force
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.measurements.noise.law import WITHIN
from sk120stiff.measurements.noise.repeats import ENOUGH
from sk120stiff.measurements.poses import rows_by_label

STRONG = 15.0  # fall of -2 ln L that it takes: one in ten thousand, of two laws that are asked
MOST = 0.1  # of the force or displacement that noise may be; a gauge held six degrees askew
REACH = 7.0  # natural logarithm of how much less of it is looked for
NEVER = 0.99  # of the force, so that any size is a number of a noise model
CLOSE = 0.02  # natural logarithm of sizes that are as good
FEWEST = 4  # readings of a pose beyond the directions of its loads
INDEPENDENT = 1e-6  # of the longest column of a pose: what a column has beside the others


def growing(fit: Fit, least: float = STRONG) -> NoiseModel | None:
    """The noise of a fit's readings with what goes with the load, where single poses ask for it.

    Errors of forces, or a share of the displacement, whichever is likelier. None where neither is
    by so much likelier than noise of one size, where poses have too few readings, and where the
    noise was described already, or was asked of repeats.

    Args:
        fit: A fitted model; its noise has no model-form error.
        least: By which -2 ln L has to fall.
    """
    noise, readings = fit.problem.noise, fit.problem.measurements
    if noise.growth and readings.noise.growth is None:  # repeats told it, by the one law they know
        noise = replace(noise, growth=0.0)
    described = noise.growth or noise.force or noise.form
    if described or (noise.known and not noise.stated):
        return None
    if readings.by_force is None:
        with suppress(Refusal):  # an arm that hardly holds its loads tells no more than growth
            readings = with_by_force(fit.model, readings)
    told = _with_loads_enough(fit.problem.load_cases)
    if not told.any():
        return None
    weights = fit.problem.weights
    some = None if weights is None else weights[told]
    left = _Left(Problem(fit.model, readings.select(told), noise, some), fit.gap[told])
    if left.freedom < ENOUGH:
        return None
    best, lowest = None, left.deviance(noise, free=True) - least
    for unit in _laws(noise, readings):
        sought = _Stated(left, unit) if noise.stated else _Free(left, unit)
        found = minimize_scalar(
            sought.deviance, bounds=sought.bounds, method="bounded", options={"xatol": CLOSE}
        )
        likeliest = sought.noise(float(found.x))
        small = likeliest.growth + likeliest.force < (1.0 - 2.0 * CLOSE) * MOST
        if found.fun < lowest and small:
            best, lowest = likeliest, float(found.fun)
    return best


@dataclass(frozen=True, eq=False)
class _Stated:
    """Sizes of a law beside a σ that was stated, by their logarithm.

    Attributes:
        left: What the readings leave.
        unit: The law with some size.
    """

    left: _Left
    unit: NoiseModel

    @property
    def bounds(self) -> tuple[float, float]:
        """Where the logarithm may lie."""
        most = float(np.log(MOST / (self.unit.growth + self.unit.force)))
        return most - REACH, most

    def deviance(self, logarithm: float) -> float:
        """-2 ln L."""
        return self.left.deviance(self.noise(logarithm), free=False)

    def noise(self, logarithm: float) -> NoiseModel:
        """The noise of that size."""
        size = float(np.exp(logarithm))
        return replace(self.unit, growth=self.unit.growth * size, force=self.unit.force * size)


@dataclass(frozen=True, eq=False)
class _Free(_Stated):
    """The same where the readings have to tell σ too: by the logarithm of the law over σ."""

    @property
    def bounds(self) -> tuple[float, float]:
        """Where the logarithm may lie."""
        return -REACH, REACH

    def deviance(self, logarithm: float) -> float:
        """-2 ln L at the likeliest of both sizes together."""
        return self.left.deviance(self._beside(logarithm), free=True)

    def noise(self, logarithm: float) -> NoiseModel:
        """The noise with the likeliest of both sizes together."""
        beside = self._beside(logarithm)
        factor = self.left.factor(beside)
        most = max(factor * (beside.growth + beside.force) / NEVER, 1.0)
        return beside.scaled(factor / most)

    def _beside(self, logarithm: float) -> NoiseModel:
        return replace(self.unit, sigma=self.unit.sigma * float(np.exp(-logarithm)))


def _laws(noise: NoiseModel, readings: Measurements) -> Iterator[NoiseModel]:
    """Each law beside the noise, of a size that is σ at the usual reading."""
    said = readings.noise
    if said.growth is None and readings.sigma is None:
        usual = float(np.median(np.linalg.norm(readings.moved, axis=1)))
        if usual > 0.0:
            yield replace(noise, growth=min(noise.sigma / usual, MOST))
    if said.force is None and readings.by_force is not None:
        usual = float(np.median(np.linalg.norm(readings.by_force, axis=(1, 2)))) / np.sqrt(3.0)
        if usual > 0.0:
            yield replace(noise, force=min(noise.sigma / usual, MOST))


class _Left:
    """What all that is smooth in the loads of single poses leaves of a gap.

    Args:
        problem: N readings, with what their forces move.
        gap: (N, 3) measured minus predicted [m].
    """

    def __init__(self, problem: Problem, gap: Array) -> None:
        self._problem, self._gap = problem, gap
        basis = load_basis(problem.load_cases, jump=True, cubic=True, branches=True)
        self._columns = pose_columns(basis)
        white = problem.whitener.apply(self._columns)
        self._own: list[tuple[Index, Index]] = []
        for rows in rows_by_label(problem.pose):
            _, R, order = linalg.qr(white[rows], mode="economic", pivoting=True)
            size = np.abs(np.diag(R))
            rank = int((size > INDEPENDENT * size.max(initial=0.0)).sum())
            self._own.append((rows, np.sort(order[:rank]).astype(np.intp)))
        self.freedom = sum(len(rows) - len(own) for rows, own in self._own)
        """Degrees of freedom."""

    def deviance(self, noise: NoiseModel, *, free: bool) -> float:
        """-2 ln L of a noise, or where its size is `free` of the likeliest size of it."""
        square, price = self._terms(noise)
        if not free:
            return square + price
        return self.freedom * (1.0 + float(np.log(square / self.freedom))) + price

    def factor(self, noise: NoiseModel) -> float:
        """The likeliest size over the one assumed."""
        return float(np.sqrt(self._terms(noise)[0] / self.freedom))

    def _terms(self, noise: NoiseModel) -> tuple[float, float]:
        """Square of what is left, and ln det V + ln det XᵀV⁻¹X."""
        whitener = replace(self._problem, noise=noise).whitener
        white, columns = whitener.apply(self._gap), whitener.apply(self._columns)
        square, price = 0.0, float(whitener.logdet)
        for rows, own in self._own:
            Q, R = np.linalg.qr(columns[np.ix_(rows, own)])
            left = white[rows] - Q @ (Q.T @ white[rows])
            square += float(left @ left)
            price += 2.0 * float(np.log(np.abs(np.diag(R))).sum())
        return max(square, 1e-300), price


def _with_loads_enough(load_cases: LoadCases) -> Mask:
    """(N,) readings at poses whose loads tell a constant and a curve beside lines.

    Elsewhere lost motion and gears that harden would look like noise.
    """
    out = np.zeros(load_cases.count, dtype=bool)
    for rows in rows_by_label(load_cases.pose):
        out[rows] = len(rows) >= len(load_directions(load_cases, rows)) + FEWEST
    return out


def may_be_noise(fit: Fit) -> str | None:
    """What is to be said where single poses scatter as noise does that goes with the load.

    The model that was fitted may lack a cause that does the same, so that nothing is taken for it.
    """
    found = None if len(far_off(fit)) else growing(fit)
    if found is None:
        return None
    share, key = (found.force, "force") if found.force else (found.growth, "growth")
    told = f"every component of a force is off by {two_digits(100.0 * share)} % of the force"
    if not found.force:
        told = f"noise grows by {two_digits(100.0 * share)} % of the displacement"
    return (
        f"{WITHIN} scatter as where {told}: a gauge held by hand makes it, or a cause that is not "
        "smooth in the load (lost motion, friction, teeth). 'sk120stiff explain' asks for both; "
        f"'noise: {{{key}: {share:.2g}}}' in the YAML file states it."
    )
