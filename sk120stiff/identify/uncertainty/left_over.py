"""What a fit leaves beyond the noise, as one number with an interval: its remainder.

Every file and page has it from here: predictions, verdict and report. The gap of the fitted model
is laid out as model-form error beside the noise (`measurements/noise/model_form.py`), with its
sizes by restricted likelihood: what is left is the size of the random effects that these readings
met.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats
from scipy.optimize import brentq, minimize_scalar

from sk120stiff.arrays import Array
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solving import against_noise_alone
from sk120stiff.identify.uncertainty.laid_out import LaidOut, Products, orthonormal_parameters
from sk120stiff.identify.uncertainty.variance_components import (
    Components,
    Deviance,
    likeliest_components,
)
from sk120stiff.measurements.noise.model_form import ModelForm

INTERVAL = float(stats.chi2.isf(0.05, 1))  # rise of -2 ln L at the ends of a 95 % interval
ONE = 1.0  # rise of -2 ln L one standard error away
# relative standard uncertainty of a stated σ: that of a scatter of 15 readings (GUM, table E.1)
STATED = 0.19
NORMAL = float(stats.norm.isf(0.025))  # standard deviations of a 95 % interval
SMALLEST = 1e-6  # of a pose's compliance: where an upper limit is looked for from
NOISE = 1.5  # ln of the factors by which noise is looked for
STARTS = (-1.0, -0.5, 0.0, 0.5)  # ln of factors from which the likeliest size is looked for
WIDEST = 16.0  # ln of the factors by which the size is looked for
ENDS = (0.025, 0.975)  # of an interval that holds 95 %
SHORT = 1e-6  # of the longest: what a direction has of its own


@dataclass(frozen=True)
class LeftOver:
    """What a model leaves beyond the noise.

    Attributes:
        rms: What is left of the readings of the fit, rms per axis [m].
        interval: 95 % interval of `rms`.
        upper: Size of such random effects at poses like these, rms per axis, with one standard
            error more: what they may be at other poses [m]. Where nothing but the gap tells the
            noise, that too: it may be the model's.
        grows: More of it goes in proportion to the load than is constant.
        found: How it goes with the load at single poses.
        probability: Of as much where there is noise alone.
    """

    rms: float
    interval: tuple[float, float]
    upper: float
    grows: bool
    found: Components
    probability: float


def left_over(fit: Fit) -> LeftOver:
    """The remainder of a fitted model; a model-form error that its noise holds is found anew.

    Size, significance and interval are a profile likelihood over the noise, since what is stated of
    it is an estimate too.
    """
    laid = LaidOut.of(against_noise_alone(fit))
    readings = laid.problem.measurements
    deviance, left = Deviance.of(laid, _slack(laid)), LeftByPoses.of(laid)
    found = likeliest_components(deviance)
    form = found.form or ModelForm(proportional=SMALLEST)

    def profile(logarithm: float) -> tuple[float, ModelForm, float]:
        """-2 ln L at the likeliest noise, sizes, and that noise over the one assumed."""
        sizes = form.scaled(float(np.exp(logarithm)))
        tried = minimize_scalar(
            lambda each: deviance.with_noise(sizes, found.noise_factor * float(np.exp(each))),
            bounds=(-NOISE, NOISE), method="bounded", options={"xatol": 0.01},
        )  # fmt: skip
        return float(tried.fun), sizes, found.noise_factor * float(np.exp(tried.x))

    start = min((*STARTS, -WIDEST), key=lambda each: profile(each)[0])
    least = profile(start)[0]

    def end(rise: float, far: float) -> tuple[ModelForm, float] | None:
        """Sizes and noise at which -2 ln L has risen so much; None: nowhere before `far`."""

        def beyond(logarithm: float) -> float:
            return profile(logarithm)[0] - least - rise

        if beyond(far) <= 0.0:
            return None
        return profile(float(brentq(beyond, *sorted((start, far)), xtol=0.01)))[1:]

    rms = left.of_sizes(found.form, found.noise_factor)[1]
    smallest = end(INTERVAL, -WIDEST) if found.form else None
    largest, larger = end(INTERVAL, WIDEST), end(ONE, WIDEST)
    low = 0.0 if smallest is None else min(left.of_sizes(*smallest)[0], rms)
    high = np.inf if largest is None else max(left.of_sizes(*largest)[2], rms)
    upper = np.inf if larger is None else max(larger[0].rms(readings), rms)
    unknown = np.isinf(deviance.slack)
    if found.form or unknown:  # no structure is known to the last reading
        high = _with_single_readings(rms, high, _in_single_readings(laid, deviance, found))
    if unknown:  # what is taken for the noise may be the model's just as well
        upper = float(np.sqrt(upper**2 + _beside_structure(laid, deviance, found)))
    grows = found.form.rms(readings) ** 2 >= 2.0 * found.form.constant**2
    return LeftOver(rms, (low, high), upper, grows, found, found.probability)


def going_with(left: LeftOver, fit: Fit, columns: Array, *, grows: bool) -> LeftOver:
    """The remainder where the gap goes with one thing at all poses.

    What all poses share shows where no single pose shows anything. The larger of both sizes
    counts; the interval holds both.

    Args:
        left: The remainder by what single poses have of their own.
        fit: The fitted model.
        columns: (N, 3, k) what it goes with, reading axes [m].
        grows: That goes with the load.
    """
    laid = LaidOut.of(against_noise_alone(fit))
    low, rms, most = left_by_all(laid, columns, left.found.noise_factor)
    if rms == 0.0:
        return left
    hidden = _in_single_readings(laid, Deviance.of(laid, _slack(laid)), left.found)
    high = _with_single_readings(rms, most, hidden)
    return replace(
        left,
        rms=max(rms, left.rms),
        interval=(min(low, left.interval[0] or low), max(high, left.interval[1])),
        upper=max(rms + (most - rms) / NORMAL, left.upper),
        grows=grows if rms > left.rms else left.grows,
    )


def _with_single_readings(rms: float, high: float, hidden: float) -> float:
    """The upper end of a size with what single readings may have of their own [m²] beside it."""
    return float(np.sqrt(rms**2 + np.hypot(high**2 - rms**2, hidden)))


def _slack(laid: LaidOut) -> float:
    """Relative standard uncertainty of σ: as stated, or as repeats tell it."""
    freedom = laid.problem.noise.freedom
    return STATED if np.isinf(freedom) else 1.0 / np.sqrt(2.0 * max(freedom, 1.0))


def _in_single_readings(laid: LaidOut, deviance: Deviance, found: Components) -> float:
    """Upper end of the variance that readings have of their own beyond the noise [m²].

    Model-form error without any pattern looks like noise: what is left beside the random effects is
    the sum of both, and σ is known to so much of itself only. 97.5 % limit of the difference of two
    variances (MOVER: Zou & Donner 2008); where nothing but the gap tells the noise, all of it.
    """
    both, size = _beside_structure(laid, deviance, found), _variance(laid)
    most = both * deviance.freedom / float(stats.chi2.isf(0.975, deviance.freedom))
    if np.isinf(deviance.slack):
        return most
    least = size * float(np.exp(-2.0 * NORMAL * deviance.slack))
    return max(both - size + float(np.hypot(most - both, size - least)), 0.0)


def _beside_structure(laid: LaidOut, deviance: Deviance, found: Components) -> float:
    """Variance of one reading's axis beside the random effects of poses [m²]."""
    square = deviance.unexplained(found.form.scaled(1.0 / found.noise_factor))
    return _variance(laid) * square / deviance.freedom


def _variance(laid: LaidOut) -> float:
    """Of the noise assumed, of one reading's axis on average [m²]."""
    problem = laid.problem
    parts = problem.noise.variances(problem.measurements)
    return float(sum(part[problem.read].mean() for part in parts))


@dataclass(frozen=True, eq=False)
class LeftByPoses:
    """What random effects of poses leave.

    With Z the random effects of poses, X the derivative, both whitened by the noise in û and C
    alone,

        left = (Z − X (XᵀX)⁻¹ XᵀZ) u = A u,   u ~ N(û, C) given the gap

    (Searle, Casella & McCulloch, chapter 7). Its square is a quadratic form of normal variables,
    taken for a multiple of χ² (Satterthwaite 1946).

    C is a matrix per pose and one of the rank of X; so is K = AᵀA. Nothing larger is built.
    """

    white: Products
    raw: Products
    proportional: int
    rows: int

    @classmethod
    def of(cls, laid: LaidOut) -> LeftByPoses:
        """From the gap of a fitted model."""
        return cls(laid.white(), laid.raw(), laid.proportional, laid.rows)

    def of_sizes(self, form: ModelForm, noise_factor: float) -> tuple[float, float, float]:
        """2.5 %, mean and 97.5 % of what is left, rms per axis [m]."""
        q = self.white.zz.shape[1]
        size = np.where(np.arange(q) < self.proportional, form.proportional, form.constant)
        white, raw = self._scaled(self.white, size), self._scaled(self.raw, size)
        variance = noise_factor**2
        T = orthonormal_parameters(white.xx[:-1, :-1] / variance)
        W, H = white.zx[:, :, :-1] @ T / variance, raw.zx[:, :, :-1] @ T
        D, B = raw.zz, np.linalg.inv(np.eye(q) + white.zz / variance)
        V = B @ W
        S = np.linalg.inv(np.eye(T.shape[1]) - _dot(W, V))
        U = np.concatenate([W, H], axis=2)
        one, R = np.eye(T.shape[1]), T.T @ raw.xx[:-1, :-1] @ T
        middle = np.block([[R, -one], [-one, np.zeros_like(one)]])

        def C(x: Array) -> Array:
            return B @ x + V @ (S @ _dot(V, x))

        def K(x: Array) -> Array:
            return D @ x + U @ (middle @ _dot(U, x))

        gap = white.zx[:, :, -1:] / variance - W @ (T.T @ white.xx[:-1, -1:] / variance)
        likeliest = C(gap)
        E, F = np.concatenate([D @ V @ S, U @ middle], axis=2), np.concatenate([V, C(U)], axis=2)
        DB = D @ B
        mean = _dot(likeliest, K(likeliest)).item() + np.trace(DB, axis1=1, axis2=2).sum()
        mean += np.trace(_dot(F, E))
        spread = np.trace(DB @ DB, axis1=1, axis2=2).sum() + 2.0 * np.trace(_dot(F, DB @ E))
        spread += np.trace(_dot(F, E) @ _dot(F, E))
        pull = K(likeliest)
        return _ends(mean, 2.0 * spread + 4.0 * _dot(pull, C(pull)).item(), self.rows)

    @staticmethod
    def _scaled(sums: Products, size: Array) -> Products:
        return Products(sums.zz * np.outer(size, size), sums.zx * size[:, None], sums.xx)


def _dot(x: Array, y: Array) -> Array:
    """xᵀy of (G, q, m) and (G, q, n): (m, n)."""
    return np.asarray(np.einsum("gqm,gqn->mn", x, y))


def left_by_all(laid: LaidOut, columns: Array, noise_factor: float) -> tuple[float, float, float]:
    """What columns that all poses share leave, as `LeftByPoses.of_sizes`.

    Args:
        laid: The gap of a fitted model.
        columns: (N, 3, k) change of the readings per unit of each of k factors, reading axes [m].
        noise_factor: The noise over the one assumed.
    """
    rows, noise = laid.rows, laid.problem.whitener
    white, taken = noise.apply(columns), noise.apply(laid.derivative)
    T = orthonormal_parameters(taken[:, :-1].T @ taken[:, :-1])
    inside, gap = taken[:, :-1] @ T, taken[:, -1]
    imitated = inside.T @ white
    U, size, right = np.linalg.svd(white - inside @ imitated, full_matrices=False)
    seen = size > SHORT * max(float(np.linalg.norm(white, axis=0).max(initial=0.0)), 1e-300)
    along = U[:, seen].T @ (gap - inside @ (inside.T @ gap))
    square = float(along @ along)
    if not len(along):
        return 0.0, 0.0, 0.0
    read = laid.problem.read
    moved = columns[read] - laid.derivative[:, :, :-1][read] @ T @ imitated
    moved = moved @ right[seen].T / size[seen]
    variance = noise_factor**2
    kept = max(1.0 - variance * len(along) / square, 0.0) if square else 0.0
    K, likeliest, C = moved.T @ moved, kept * along, kept * variance
    mean = float(likeliest @ K @ likeliest + C * np.trace(K))
    deviation = float(2.0 * C**2 * np.trace(K @ K) + 4.0 * C * likeliest @ K @ K @ likeliest)
    return _ends(mean, deviation, rows)


def _ends(mean: float, variance: float, rows: int) -> tuple[float, float, float]:
    """2.5 %, mean and 97.5 % of a sum of squares over so many rows, as rms."""
    if mean <= 0.0 or variance <= 0.0:
        return 0.0, 0.0, 0.0
    freedom = 2.0 * mean**2 / variance
    low, high = stats.chi2.ppf(ENDS, freedom) / freedom
    low, middle, high = np.sqrt(mean / rows * np.array([low, 1.0, high]))
    return float(low), float(middle), float(max(high, middle))
