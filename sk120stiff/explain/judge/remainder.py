"""What is left once everything that can be named is in the model: how large, how surely, where.

The left-over of a fitted model is laid out as model-form error beside the noise
(`measurements/model_form.py`): its size is that of the random effects that these readings met.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats
from scipy.optimize import brentq
from scipy.special import expit
from scipy.special import logit as _logit

from sk120stiff.explain.priors import SOMETHING_ELSE
from sk120stiff.identify import Fit
from sk120stiff.identify.uncertainty.variance_components import (
    Components,
    Deviance,
    variance_components,
)
from sk120stiff.measurements.model_form import ModelForm, form_columns, rows_of_poses

LEVEL = 1e-3  # below this probability of noise alone something is left
INTERVAL = float(stats.chi2.isf(0.05, 1))  # rise of -2 ln L at the ends of a 95 % interval
NORMAL = float(stats.norm.isf(0.025))  # standard deviations of a 95 % interval
SMALLEST = 1e-6  # of a pose's compliance: where an upper limit is looked for from
WIDEST = 16.0  # ln of the factors by which the size is looked for


@dataclass(frozen=True)
class Remainder:
    """What a model leaves beyond the noise.

    Attributes:
        rms: Its size at the measured loads, rms per axis [m].
        interval: 95 % interval of `rms`.
        probability: Probability that noise alone leaves as much.
        form: How it goes with the load.
        where: Where it lives, in sentences.
        something_else: Probability that a cause is at work which no effect in the model is.
    """

    rms: float
    interval: tuple[float, float]
    probability: float
    form: ModelForm
    where: tuple[str, ...] = ()
    something_else: float = 0.0

    @property
    def significant(self) -> bool:
        """Noise alone does not explain it."""
        return self.probability < LEVEL

    def beside(self, chance: float) -> Remainder:
        """The same where another test of what is left has this probability of noise alone.

        Such a test speaks for something else by 1 / (-e p ln p) at most (Sellke, Bayarri & Berger
        2001).
        """
        if not self.rms or chance >= self.probability:
            return self
        p = float(np.clip(chance, 1e-300, np.exp(-1.0)))
        logit = _logit(SOMETHING_ELSE) - 1.0 - float(np.log(-p * np.log(p)))
        return replace(
            self,
            probability=chance,
            something_else=max(self.something_else, float(expit(logit))),
        )

    def sentence(self) -> str:
        """How large it is, in plain words."""
        low, high = (1e6 * end for end in self.interval)
        if not self.significant:
            if not np.isfinite(high):
                return "The readings do not tell how large an error of the model's form is."
            return (
                f"Beyond the noise the model's form is off by {high:.3g} µm rms per axis at most."
            )
        parts = []
        if self.form.proportional:
            parts.append(f"{100.0 * self.form.proportional:.2g} % of a pose's compliance")
        if self.form.constant:
            parts.append(f"{1e6 * self.form.constant:.3g} µm of its own at every pose")
        return (
            f"Left over beyond the noise are {1e6 * self.rms:.3g} µm rms per axis (95 %: {low:.3g} "
            f"to {high:.3g}), as if every pose had {' and '.join(parts)} that no effect explains."
        )


def remainder_of(fit: Fit) -> Remainder:
    """The remainder of a fitted model; its model-form error is estimated anew."""
    found = variance_components(fit)
    readings = fit.problem.measurements
    deviance = Deviance.of(fit)
    relative = found.form.scaled(1.0 / found.noise_factor)
    least = deviance(relative)
    form = relative or ModelForm(proportional=SMALLEST)

    def rise(logarithm: float) -> float:
        return deviance(form.scaled(float(np.exp(logarithm)))) - least - INTERVAL

    def factor(way: float) -> float:
        """Of the sizes, at one end of their interval."""
        return float(np.exp(brentq(rise, *sorted((0.0, way * WIDEST)))))

    size = form.scaled(found.noise_factor)
    low, high = 0.0, np.inf
    if relative and rise(-WIDEST) > 0.0:
        low = _left(fit, size.scaled(factor(-1.0)), found.noise_factor)[0]
    if rise(WIDEST) > 0.0:
        high = _left(fit, size.scaled(factor(1.0)), found.noise_factor)[2]
    return Remainder(
        _left(fit, found.form, found.noise_factor)[1],
        (low, high),
        found.probability,
        found.form,
        something_else=_something_else(found, len(readings.poses)),
    )


def _left(fit: Fit, form: ModelForm, noise_factor: float) -> tuple[float, float, float]:
    """What random effects of one size left in these readings: 2.5 %, mean, 97.5 %, rms [m].

    Their distribution given the gap is normal (Searle, Casella & McCulloch, chapter 7); what the
    model's parameters took on is not left, and no remainder is larger than the gap.
    """
    problem = fit.problem
    readings = problem.measurements
    gap = problem.measured - fit.model.predict(problem.situation)
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


def _something_else(found: Components, poses: int) -> float:
    """By the gain of random effects, each of whose sizes costs ln of the number of poses (BIC)."""
    sizes = max(int(found.form.proportional > 0.0) + int(found.form.constant > 0.0), 1)
    logit = _logit(SOMETHING_ELSE) + 0.5 * (max(found.gain, 0.0) - sizes * np.log(max(poses, 2)))
    return float(expit(logit))
