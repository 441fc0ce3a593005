"""A fit whose model holds the estimates, their standard errors, and what stands behind each."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.covariance import covariance_of
from sk120stiff.model import CALIBRATED, ON_BOUND, TOGETHER, UNSEEN

MOSTLY = 4.0  # times the variance that is left by calibrations, from where on they tell most

AnyFit = TypeVar("AnyFit", bound=Fit)


def with_values(found: AnyFit) -> AnyFit:
    """The fit with the estimates and standard errors written into its model."""
    problem = found.problem
    std: list[float | None] = [p.internal_std for p in problem.model.parameters]
    errors = np.sqrt(np.diag(found.covariance)) * problem.scale
    for index, error, held in zip(problem.free, errors, found.at_bound, strict=True):
        std[index] = None if held else float(error)
    x = np.where(found.at_bound & (np.abs(found.x) < 1e-6), 0.0, found.x)
    model = problem.model.with_values(problem.values(x), std, origin="identified")
    parameters = list(model.parameters)
    together = {k for group in found.overlays for k in group.members}
    alone, known = (
        np.diag(covariance_of(np.vstack([found.small[0], each]), found.held, problem.span))
        for each in (found.beforehand.draws.rows(), found.beforehand.rows())
    )
    for k, index in enumerate(problem.free):
        origin = parameters[index].origin
        if not found.identifiable[k]:
            origin = UNSEEN
        elif k in together:
            origin = TOGETHER
        elif found.at_bound[k]:
            origin = ON_BOUND
        elif alone[k] > MOSTLY * known[k]:
            origin = CALIBRATED
        parameters[index] = replace(parameters[index], origin=origin)
    return replace(found, model=replace(model, parameters=tuple(parameters)))


def leaving_out(found: AnyFit, moved: Array, told: Mask) -> AnyFit:
    """The fit with what is left out counted beside what was counted before.

    Args:
        found: The fit.
        moved: (Q, Q) covariance of those estimates that are on no bound.
        told: (P,) estimates into whose standard errors it goes.
    """
    before, moving = found.moves, ~found.at_bound
    omitted = before.omitted.copy()
    omitted[np.ix_(moving, moving)] += moved
    own = np.zeros(len(found.x))
    own[moving] = np.diag(moved)
    left_out = np.sqrt(before.left_out**2 + np.where(told, own, 0.0))
    return with_values(replace(found, left_out=left_out, omitted=omitted))
