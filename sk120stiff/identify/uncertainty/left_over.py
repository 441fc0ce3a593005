"""What a fit leaves beyond the noise, as one number with an interval: its remainder.

Every file and page has it from here: predictions, verdict and report. The gap of the fitted model
is laid out as model-form error beside the noise (`measurements/model_form.py`), with its sizes by
restricted likelihood: what is left is the size of the random effects that these readings met.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.optimize import brentq, minimize_scalar

from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solving import against_noise_alone
from sk120stiff.identify.uncertainty.variance_components import (
    Components,
    Deviance,
    variance_components,
)
from sk120stiff.measurements.model_form import ModelForm, form_columns, rows_of_poses

INTERVAL = float(stats.chi2.isf(0.05, 1))  # rise of -2 ln L at the ends of a 95 % interval
ONE = 1.0  # rise of -2 ln L one standard error away
NORMAL = float(stats.norm.isf(0.025))  # standard deviations of a 95 % interval
SMALLEST = 1e-6  # of a pose's compliance: where an upper limit is looked for from
NOISE = 1.5  # ln of the factors by which noise is looked for
STARTS = (-1.0, -0.5, 0.0, 0.5)  # ln of factors from which the likeliest size is looked for
WIDEST = 16.0  # ln of the factors by which the size is looked for


@dataclass(frozen=True)
class LeftOver:
    """What a model leaves beyond the noise.

    Attributes:
        rms: What is left of the readings of the fit, rms per axis [m].
        interval: 95 % interval of `rms`.
        upper: Size of such random effects at poses like these, rms per axis, with one standard
            error more: what they may be at other poses [m].
        grows: More of it goes in proportion to the load than is constant.
        found: How it goes with the load, and how sure it is.
    """

    rms: float
    interval: tuple[float, float]
    upper: float
    grows: bool
    found: Components


def left_over(fit: Fit) -> LeftOver:
    """The remainder of a fitted model; a model-form error that its noise holds is found anew.

    Its size is told beside the noise as it was stated. Its interval is a profile likelihood over
    the noise, since what is stated of it is an estimate too.
    """
    fit = against_noise_alone(fit)
    found = variance_components(fit)
    readings = fit.problem.measurements
    deviance = Deviance.of(fit)
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

    rms = _left(fit, found.form, found.noise_factor)[1]
    smallest = end(INTERVAL, -WIDEST) if found.form else None
    largest, larger = end(INTERVAL, WIDEST), end(ONE, WIDEST)
    low = 0.0 if smallest is None else min(_left(fit, *smallest)[0], rms)
    high = np.inf if largest is None else max(_left(fit, *largest)[2], rms)
    upper = np.inf if larger is None else max(larger[0].rms(readings), rms)
    grows = found.form.rms(readings) ** 2 >= 2.0 * found.form.constant**2
    return LeftOver(rms, (low, high), upper, grows, found)


def _left(fit: Fit, form: ModelForm, noise_factor: float) -> tuple[float, float, float]:
    """What random effects of one size left in these readings: 2.5 %, mean, 97.5 %, rms [m].

    Their distribution given the gap is normal (Searle, Casella & McCulloch, chapter 7); what the
    model's parameters took on is not left, and no remainder is larger than the gap.
    """
    problem = fit.problem
    readings = problem.measurements
    gap = problem.measured - fit.model.predict(problem.load_cases)
    proportional, constant = form_columns(readings)
    Z = np.concatenate([form.proportional * proportional, form.constant * constant], axis=2)
    white = problem.whitener.apply(np.concatenate([Z, gap[:, :, None]], axis=2)) / noise_factor
    Z = Z.reshape(len(white), -1)
    mean = variance = 0.0
    for rows in rows_of_poses(readings):
        drawn, rest = white[rows, :-1], white[rows, -1]
        spread = np.linalg.inv(np.eye(drawn.shape[1]) + drawn.T @ drawn)
        likeliest = Z[rows] @ (spread @ (drawn.T @ rest))
        covariance = Z[rows] @ spread @ Z[rows].T
        mean += float(likeliest @ likeliest + np.trace(covariance))
        variance += float(2.0 * (covariance**2).sum() + 4.0 * likeliest @ covariance @ likeliest)
    ends = mean + NORMAL * np.sqrt(variance) * np.array([-1.0, 0.0, 1.0])
    low, middle, high = np.sqrt(np.maximum(ends, 0.0) / max(len(white), 1))
    return float(low), float(middle), float(high)
