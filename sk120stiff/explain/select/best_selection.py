"""The selection that explains most, and what it is held against.

What was stated of the noise, or found from repeats, stays the yardstick of every fit, whatever
else a search took into account (`beside_form.py`).

Noise that goes with the load is asked of single poses before the search, lest it makes names, and
again beside what the search settled on: what has a name is no noise.

A gap that is rounding, because the readings were computed, has no cause: the search is made again
with the finest noise that instruments have, and finds none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.explain.select.stepwise import Selection
from sk120stiff.identify import Fit, Problem, likelier, solve_near, yardstick
from sk120stiff.identify.noise.growing import growing
from sk120stiff.identify.solving import widened_as
from sk120stiff.measurements import Measurements, NoiseModel, candidates
from sk120stiff.measurements.noise.law import FINEST

ROUNDS = 3  # of asking single poses and searching
SUSPECTED = 4.0  # fall of -2 ln L from which on a search begins with noise that goes with the load
ALIKE = 0.1  # of its size by which noise may differ beside what was found, without a new search


class Try(Protocol):
    """Makes a selection under one noise model, with or without one more effect in the model."""

    def __call__(self, noise: NoiseModel, beside: Effect | None = None, /) -> Selection:
        """The selection."""
        ...


def best_selection(
    measurements: Measurements, first: Fit, under: Try
) -> tuple[Selection, NoiseModel]:
    """The best selection, and the noise that its fits are to be held against.

    Args:
        measurements: Readings in use.
        first: The base model, fitted to them.
        under: Makes a selection under one noise model.
    """
    plain = candidates(measurements)
    open_ = [growing(held_against(noise, first), least=SUSPECTED) or noise for noise in plain]
    ends = []
    for _ in range(ROUNDS):
        found, noise = _likeliest(open_, under)
        ends.append((found, noise))
        again = [growing(held_against(each, found.final)) or each for each in plain]
        if all(map(_alike, again, open_)):
            break
        open_ = again
    else:  # one leads to another and that one back: the likeliest
        found, noise = min(ends, key=lambda end: end[0].total)
    if yardstick(found.base).source == "computed":
        found = under(replace(noise, sigma=FINEST, freedom=np.inf))
    return found, noise


def _likeliest(open_: Sequence[NoiseModel], under: Try) -> tuple[Selection, NoiseModel]:
    tried = [under(noise) for noise in open_]
    best = likelier([-each.total for each in tried])
    return tried[best], tried[best].base.problem.noise


def _alike(one: NoiseModel, other: NoiseModel) -> bool:
    """Do both hold the same of what goes with the load?"""
    return all(
        abs(a - b) <= ALIKE * b for a, b in ((one.growth, other.growth), (one.force, other.force))
    )


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
