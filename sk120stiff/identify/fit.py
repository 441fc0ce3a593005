"""Measurements + model become a `Fit`: estimates, their covariance, and how well they agree."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array, Index, Mask, rms
from sk120stiff.errors import MissingPart, short
from sk120stiff.identify.moves import Moves
from sk120stiff.identify.solve.beforehand import Beforehand
from sk120stiff.identify.solve.covariance import (
    condition_of,
    correlation_of,
    covariance_of,
    internal_intervals,
    public_interval,
)
from sk120stiff.identify.solve.overlaid import Overlay, overlays
from sk120stiff.identify.solve.polish import FAINTEST, seen_directions
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.model import Model, Parameter, parameter_frame

if TYPE_CHECKING:
    import pandas as pd

SHOWN = 4  # parameters in one line
MANY = 20  # rows for one parameter from which on turning them first pays
LEVEL = 0.01  # probability below which model and readings are said to disagree


@dataclass(frozen=True, eq=False)
class Fit:
    """A model whose free parameters were estimated from readings.

    Attributes:
        problem: What was fitted; its noise has the scale that was stated or assumed before the fit.
        model: The model with the estimates and their standard errors.
        x: (P_free,) estimates in units of `problem.scale`.
        residual, jacobian: (R,) whitened gap and (R, P_free) its derivative by `x`.
        at_bound: (P_free,) estimates that a physical bound holds.
        iterations: Evaluations of the model.
        reasons: What was decided about the noise beyond the data's description, in sentences.
        spread: Noise seen over noise assumed, where a robust fit found it without its outliers.
        inflation: Variance of the estimates over that of least squares with the same weights
            (robust fits).
        selection_uncertainty, left_out, omitted, foreign, parts, by_form: What moves the estimates
            beside the noise, see `Moves`; None: nothing of the kind.
        parts_by: (P_free,) the part that adds most to each, ``name:where``; empty: none counts.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(data / "table2_measured.csv")
        >>> found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
        >>> print(f"{1e6 * found.rms:.1f} µm, {found.degrees_of_freedom} degrees of freedom")
        17.2 µm, 42 degrees of freedom
    """

    problem: Problem
    model: Model
    x: Array
    residual: Array
    jacobian: Array
    at_bound: Mask
    iterations: int
    reasons: tuple[str, ...] = ()
    spread: float | None = None
    inflation: float = 1.0
    selection_uncertainty: Array | None = None
    left_out: Array | None = None
    omitted: Array | None = None
    foreign: Array | None = None
    parts: Array | None = None
    by_form: Array | None = None
    parts_by: tuple[str, ...] = ()

    def __repr__(self) -> str:
        values = ", ".join(
            p.name if not seen else f"{p.name} {p.value:.4g} {p.spec.unit}"
            for p, seen in zip(self.parameters[:SHOWN], self.identifiable, strict=False)
        )
        more = ", …" if len(self.parameters) > SHOWN else ""
        return f"<{type(self).__name__}: {self.size}; {values}{more}>"

    def _repr_html_(self) -> str | None:
        """What a notebook shows; without pandas it is the line of `repr`."""
        with suppress(MissingPart):
            table = self.to_frame().to_html(index=False, float_format="{:.4g}".format, na_rep="")
            return f"<div><p>Gap {self.size}{self.per_axis}</p>{table}</div>"
        return None

    def to_frame(self) -> pd.DataFrame:
        """One row per estimated parameter in its public unit: value, std, 95 % interval, note.

        What the readings do not tell has neither value nor error, and a note.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> found.to_frame().columns.tolist()
            ['name', 'value', 'std', 'unit', 'free', 'note', 'low_95', 'high_95']
        """
        rows = parameter_frame(self.parameters)
        low, high = np.array(self.intervals()).reshape(-1, 2).T
        rows["low_95"], rows["high_95"] = low, high
        unseen = ~self.identifiable
        rows.loc[unseen, ["value", "std", "low_95", "high_95"]] = np.nan
        rows.loc[unseen, "note"] = "not identifiable"
        return rows

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The estimated parameters."""
        return tuple(self.model.parameters[k] for k in self.problem.free)

    @cached_property
    def gap(self) -> Array:
        """(N, 3) measured minus predicted [m]; NaN in an axis that was not read."""
        return self.problem.gap(self.x)

    @property
    def sigma_known(self) -> bool:
        """Is the noise's size known from elsewhere? Else it is estimated from the residual."""
        return self.problem.noise.known

    @property
    def rms(self) -> float:
        """Root mean square of the gap over all numbers read [m]; NaN without a length."""
        return rms(self.gap)

    @property
    def size(self) -> str:
        """The gap's root mean square with its unit."""
        return f"{short(1e6 * self.rms)} µm rms"

    @property
    def per_axis(self) -> str:
        """Words that follow `size` where every number read has an axis."""
        return " per axis"

    @cached_property
    def small(self) -> tuple[Array, Array]:
        """Derivative and gap, turned: few rows hold all that is known of the parameters."""
        if len(self.residual) < MANY * (len(self.x) + 1):
            return self.jacobian, self.residual
        Q, R = np.linalg.qr(self.jacobian)
        return np.asarray(R), np.asarray(Q.T @ self.residual)

    @property
    def chi_square(self) -> float:
        """Sum of squares of the whitened gap."""
        return float(self.residual @ self.residual)

    @cached_property
    def estimated(self) -> int:
        """Number of combinations of parameters that the readings determine."""
        moving = ~self.at_bound
        return len(seen_directions(self.small[0][:, moving], self.problem.span[moving])[1])

    @property
    def degrees_of_freedom(self) -> int:
        """Numbers that were read minus combinations of parameters that were estimated."""
        return len(self.residual) - self.estimated

    @cached_property
    def judged(self) -> tuple[float, int]:
        """Sum of squares and degrees of freedom of what is held against the noise.

        That is everything, or the readings of known noise among others whose size is fitted: their
        number less the share of the parameters that they determine (trace of the hat matrix).
        """
        return self._held_against(self.residual)

    def _held_against(self, left: Array) -> tuple[float, int]:
        """Sum of squares and degrees of freedom of what is left (M,) in units of the noise."""
        own = self.problem.judged
        if own is None:
            return float(left @ left), self.degrees_of_freedom
        U = np.linalg.svd(self.jacobian[:, ~self.at_bound], full_matrices=False)[0]
        spent = float((U[own, : self.estimated] ** 2).sum())
        part = left[own]
        return float(part @ part), max(round(len(part) - spent), 0)

    @property
    def noise_factor(self) -> float:
        """What the residual shows over the noise assumed; 1 if all is well."""
        if self.spread is not None:
            return self.spread
        square, freedom = self.judged
        return float(np.sqrt(square / max(freedom, 1)))

    @cached_property
    def misfit(self) -> tuple[float, tuple[int, int | None], float] | None:
        """The whole misfit held against a σ known from elsewhere; None where there is none.

        χ² where σ was stated; where repeats told it, F of what exceeds their pure error over that
        error. With it the degrees of freedom (of the yardstick: None if it is exact), and the
        probability of a larger one if the model were true. Readings that were trusted less than
        their σ says leave no sum of squares to test.
        """
        (square, freedom), noise = self.judged, self.problem.noise
        if not self.sigma_known or self.problem.weights is not None or freedom < 1:
            return None
        if noise.stated:
            return square, (freedom, None), float(stats.chi2.sf(square, freedom))
        repeats = int(noise.freedom)
        if freedom <= repeats:
            return None
        ratio = max(square - repeats, 0.0) / (freedom - repeats)
        chance = float(stats.f.sf(ratio, freedom - repeats, repeats))
        return ratio, (freedom - repeats, repeats), chance

    @property
    def exceeds(self) -> bool:
        """The model leaves more than a σ known from elsewhere allows."""
        return self.misfit is not None and self.misfit[2] < LEVEL and self.noise_factor > 1.0

    @property
    def log_likelihood(self) -> float:
        """Natural logarithm of the likelihood of the readings, σ at its best where not known."""
        count = len(self.residual)
        constant = self.problem.whitener.logdet + count * float(np.log(2.0 * np.pi))
        if self.sigma_known:
            return -0.5 * (self.chi_square + constant)
        variance = float(np.log(max(self.chi_square, 1e-300) / count))
        return -0.5 * (count * variance + count + constant)

    @property
    def aic(self) -> float:
        """Akaike's criterion; smaller is better."""
        return 2.0 * self._counted - 2.0 * self.log_likelihood

    @property
    def bic(self) -> float:
        """Schwarz's criterion; smaller is better."""
        count = float(np.log(len(self.residual)))
        return self._counted * count - 2.0 * self.log_likelihood

    @property
    def _counted(self) -> int:
        return self.estimated + (0 if self.sigma_known else 1)

    @cached_property
    def overlays(self) -> tuple[Overlay, ...]:
        """Parameters that lie on one another, of which the bounds alone say who carries what."""
        reach = self.reach() * self.unit
        bounds, plausible = self.problem.bounds, self.problem.plausible
        return overlays(self.x, *self.small, self.at_bound, bounds, plausible, reach)

    @cached_property
    def held(self) -> Mask:
        """(P_free,) estimates on a bound that the readings put there.

        Not so those that do not show, and those that lie on others.
        """
        length = np.linalg.norm(self.jacobian, axis=0)
        held: Mask = self.at_bound & (length * self.problem.span > FAINTEST)
        held[[k for group in self.overlays for k in group.held]] = False
        return held

    @cached_property
    def covariance(self) -> Array:
        """(P_free, P_free) covariance of `x`; zero for `held` estimates, infinite: unknown.

        Where a bound decides which of several like parameters carries the load, all of them count
        as free: what one has, another may.
        """
        covariance = covariance_of(self.informed, self.held, self.problem.span)
        if np.isfinite(self.unit):
            return np.asarray(covariance * self.unit**2 + self.moves.covariance)
        return np.where(covariance != 0.0, np.inf, 0.0)

    @cached_property
    def informed(self) -> Array:
        """The derivative, small, and what is known beforehand."""
        return np.vstack([self.small[0], self.beforehand.rows()])

    @cached_property
    def beforehand(self) -> Beforehand:
        """What draws' being draws and calibrations of instruments tell that the readings do not."""
        return Beforehand.of(self.problem, self.x, self.small[0], self.held, self.unit)

    @property
    def moves(self) -> Moves:
        """What is not of the readings' noise."""
        models, each = self.selection_uncertainty, self.left_out
        return Moves.of(
            len(self.x), models, each, self.omitted, self.foreign, self.parts, self.by_form
        )

    @property
    def unit(self) -> float:
        """What counts over the noise assumed; infinite where nothing is left to estimate it.

        Where the model leaves more than a known σ allows, the standard errors are inflated by as
        much (Birge 1932): what is missing is no noise, but it moves the estimates too.
        """
        if self.sigma_known:
            return float(np.sqrt(self.inflation)) * (self.noise_factor if self.exceeds else 1.0)
        if self.degrees_of_freedom < 1:
            return float(np.inf)
        return self.noise_factor * float(np.sqrt(self.inflation))

    @property
    def freedom(self) -> float:
        """Degrees of freedom behind `unit`; infinite where a stated σ bears it alone."""
        known = self.sigma_known and not self.exceeds
        own = self.problem.noise.freedom if known else self.degrees_of_freedom
        return min(own, self.problem.freedom_of_form)

    @cached_property
    def correlation(self) -> Array:
        """(P_free, P_free) correlations of the estimates."""
        return correlation_of(self.covariance)

    @cached_property
    def condition(self) -> float:
        """Condition number of the whitened derivative with columns of unit length."""
        return condition_of(self.small[0])

    @cached_property
    def identifiable(self) -> Mask:
        """(P_free,) parameters that the readings determine at all, those on a bound included."""
        return np.asarray(
            np.isfinite(np.diag(covariance_of(self.informed, self.held, self.problem.span)))
        )

    def reach(self, level: float = 0.95) -> float:
        """Half width of an interval in standard errors: normal, or Student where σ is estimated.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> print(f"{found.reach():.3f} {found.reach(0.99):.3f}")  # of Student
            2.018 2.698
        """
        upper = 0.5 * (1.0 + level)
        if np.isinf(self.freedom) or self.freedom < 1:
            return float(stats.norm.ppf(upper))
        return float(stats.t.ppf(upper, self.freedom))

    def intervals(self, level: float = 0.95) -> tuple[tuple[float, float], ...]:
        """Confidence intervals of the public values, one (low, high) per estimated parameter.

        They are made where the readings are nearly linear, in compliances, and then turned over: so
        an interval of a stiffness is not symmetric, and it is open upwards where the readings do
        not exclude a rigid part. A physical bound cuts them.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> low, high = found.intervals()[0]
            >>> print(f"{low:.3g} to {high:.3g} {found.parameters[0].spec.unit}")
            1.33e+06 to 1.39e+06 N*m/rad
        """
        if level not in self._intervals:
            self._intervals[level] = self._ends(level)
        return self._intervals[level]

    @cached_property
    def _intervals(self) -> dict[float, tuple[tuple[float, float], ...]]:
        return {}

    def _ends(self, level: float) -> tuple[tuple[float, float], ...]:
        ends = internal_intervals(
            self.x,
            self.informed,
            np.concatenate([self.small[1], np.zeros(len(self.informed) - len(self.small[1]))]),
            self.at_bound,
            self.problem.bounds,
            self.problem.span,
            self.problem.plausible,
            self.reach(level),
            self.unit,
        )
        ends = self.moves.widened(ends, self.x, self.reach(level), self.problem.bounds)
        scaled = ends * self.problem.scale[:, None]
        return tuple(
            public_interval(parameter.spec, float(low), float(high))
            for parameter, (low, high) in zip(self.parameters, scaled, strict=True)
        )

    @cached_property
    def down_weighted(self) -> Index:
        """Indices of the readings that a robust fit trusted less than the others."""
        weights = self.problem.weights
        return np.flatnonzero(weights < 1.0) if weights is not None else np.zeros(0, dtype=np.intp)
