"""Which noise model the readings speak for, once every cause of the catalogue has had its say.

Scatter that looks like more noise, like noise that grows, or like zero readings that were shared,
may be a cause that does not go in proportion to the load. Where the readings raise that doubt, the
search runs under every noise model in question, and the one that explains most is believed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.optimize import minimize_scalar

from sk120stiff.effects import Situation
from sk120stiff.explain.settling import Attempt
from sk120stiff.identify import Fit, choose_noise
from sk120stiff.measurements import Measurements, NoiseModel, candidates

SURE = 2.5  # standard errors of the scatter that let another σ into the race
SETTLED = 0.2  # change of the growth, in natural logarithms, that needs no further attempt
COMPUTED = 1e-8  # m; a smaller scatter is that of computed readings, which know no noise to race

Try = Callable[[NoiseModel], Attempt]
Found = tuple[Attempt, Sequence[str]]


def race(measurements: Measurements, situation: Situation, under: Try) -> Found:
    """The best attempt, and why its noise model was taken.

    Parameters
    ----------
    measurements, situation
        The readings.
    under
        Makes an attempt under one noise model.
    """
    plain, reasons, told, zero = _plain(measurements, situation, under)
    clean = plain.base.problem  # without its outliers
    found: list[Found] = [(plain, reasons)]
    tried = [clean.noise]
    for grows in (True, False):
        other, said = choose_noise(
            clean.measurements, clean.situation, grows=grows, sure=SURE, zero=zero
        )
        same = not (clean.noise.stated or len(plain.aside)) and other.growth == clean.noise.growth
        if same or other in tried or other.sigma < COMPUTED:
            continue
        tried.append(other)
        if other.growth == clean.noise.growth:
            other = replace(other, stated=False)  # the scatter tells a σ, but no better than a fit
        found.append(_regrown(under(other), said, under))
    best, why = min(found, key=lambda each: each[0].total)
    return best, [*told, *why]


def _plain(
    measurements: Measurements, situation: Situation, under: Try
) -> tuple[Attempt, list[str], list[str], Literal["shared", "separate"]]:
    """The best attempt under the noise that the data describe; a zero nobody described is raced.

    With it the reasons for its noise, what is to be said of the zero, and the zero.
    """
    kinds = list(dict.fromkeys(noise.zero for noise in candidates(measurements)))
    found = []
    for kind in kinds:
        noise, reasons = choose_noise(measurements, situation, doubt=False, zero=kind)
        found.append((under(noise), reasons, kind))
    best, reasons, kind = min(found, key=lambda each: each[0].total)
    said = f"Nobody said how zero readings were shared; {kind} ones explain the readings best."
    return best, reasons, [said] if len(kinds) > 1 else [], kind


def _regrown(found: Attempt, reasons: Sequence[str], under: Try) -> Found:
    """The attempt with its growth estimated anew from what its model leaves."""
    noise = found.base.problem.noise
    if not noise.growth:
        return found, reasons
    growth = likeliest_growth(found.final)
    if abs(np.log(growth / noise.growth)) < SETTLED:
        return found, reasons
    again = under(replace(noise, growth=growth))
    if again.total >= found.total:
        return found, reasons
    said = f"With the model that was found the noise grows by {growth * 100:.2g} %."
    return again, [*reasons, said]


def likeliest_growth(fit: Fit) -> float:
    """Growth of the noise at which what a fitted model leaves is likeliest, near its own growth."""
    problem = fit.problem
    gap = fit.gap

    def unlikely(logarithm: float) -> float:
        noise = replace(problem.noise, growth=float(np.exp(logarithm)))
        whitener = noise.whitener(problem.measurements, problem.sizes)
        return float(np.sum(whitener.apply(gap) ** 2) + whitener.logdet)

    middle = float(np.log(problem.noise.growth))
    bounds = (middle - 2.5, middle + 1.0)
    return float(np.exp(minimize_scalar(unlikely, bounds=bounds, method="bounded").x))
