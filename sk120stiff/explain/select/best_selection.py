"""The selection that explains most, and what it is held against.

What was stated of the noise, or found from repeats, stays the yardstick of every fit, whatever
else a search took into account (`beside_form.py`).

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
from sk120stiff.measurements import Measurements, NoiseModel, candidates
from sk120stiff.measurements.noise.law import FINEST


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
    noise = found.base.problem.noise
    if yardstick(found.base).source == "computed":
        found = under(replace(noise, sigma=FINEST, freedom=np.inf))
    return found, noise


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
