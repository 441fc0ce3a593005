"""The selection that explains most, and what it is held against.

What was stated of the noise, or found from repeats, stays the yardstick of every fit, whatever
else a search took into account (`beside_form.py`). Where nothing was, noise that grows with the
displacement is held against causes of the gap: what a selection leaves over says how much.

A gap that is rounding, because the readings were computed, has no cause: the search is made again
with the finest noise that instruments have, and finds none.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.explain.select.stepwise import Selection
from sk120stiff.identify import Fit, Problem, likelier, solve_near, yardstick
from sk120stiff.identify.solving import widened_as
from sk120stiff.measurements import Measurements, NoiseModel, candidates, growing
from sk120stiff.measurements.noise import FINEST

TURNS, SAME = 4, 0.2  # of causes and noise at most, and change of ln(growth/σ) that is none


class Try(Protocol):
    """Makes a selection under one noise model, with or without one more effect in the model."""

    def __call__(self, noise: NoiseModel, beside: Effect | None = None, /) -> Selection:
        """The selection."""
        ...


def best_selection(measurements: Measurements, under: Try) -> tuple[Selection, NoiseModel]:
    """The best selection, and the noise that its fits are to be held against.

    Args:
        measurements: Readings in use.
        under: Makes a selection under one noise model.
    """
    tried = [under(noise) for noise in candidates(measurements)]
    found = tried[likelier([-each.total for each in tried])]
    grown = _as_it_grows(found, under)
    if grown is not None:
        one_number_more = float(np.log(measurements.read.sum()))
        found = (found, grown)[likelier([-found.total, -grown.total - one_number_more])]
    noise = found.base.problem.noise
    if yardstick(found.base).source == "computed":
        found = under(replace(noise, sigma=FINEST, freedom=np.inf))
    return found, noise


def _as_it_grows(found: Selection, under: Try) -> Selection | None:
    """The best selection under noise that grows as what one leaves says, one after the other.

    None where nothing hints at it: causes and noise are at their likeliest in turns.
    """
    best: Selection | None = None
    before, known = 0.0, found
    for _ in range(TURNS):
        noise = known.base.problem.noise
        grown = growing(noise, known.final.problem.measurements, known.final.gap)
        if grown is None or abs(np.log(grown.growth / grown.sigma) - before) < SAME:
            break
        before, known = float(np.log(grown.growth / grown.sigma)), under(grown)
        if best is not None and known.total >= best.total:
            break
        best = known
    return best


def held_against(noise: NoiseModel, fit: Fit) -> Fit:
    """The same estimates, their misfit and their errors judged by this noise."""
    problem = fit.problem
    if problem.noise == noise:
        return fit
    again = solve_near(Problem(problem.model, problem.measurements, noise), fit.x)
    return widened_as(again, fit)


def of_readings(measurements: Measurements, fit: Fit) -> Fit:
    """The same model under the same noise, for the readings that a later search kept."""
    problem = Problem(fit.problem.model, measurements, fit.problem.noise)
    if np.array_equal(problem.measured, fit.problem.measured):
        return fit
    return solve_near(problem, fit.x)
