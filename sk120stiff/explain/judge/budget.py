"""The error budget of a fitted model: what each effect moves the point by, at given loads."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.identify import Fit
from sk120stiff.model import Share, moved_by, shares


def brought(fit: Fit, *effects: str) -> Array:
    """(N, 3) what the effects with these ids bring at the readings of a fit, base axes [m]."""
    _, derivative = fit.model.predict_with_sensitivities(fit.problem.load_cases)
    return moved_by(fit.model, derivative, effects)


def error_budget(fit: Fit, load_cases: LoadCases | None = None) -> tuple[Share, ...]:
    """Shares of all effects of a fitted model, the largest first.

    Args:
        fit: The fitted model.
        load_cases: Poses and loads of a task; None: those that were measured.
    """
    at = fit.problem.load_cases if load_cases is None else load_cases
    _, derivative = fit.model.predict_with_sensitivities(at)
    return shares(fit.model, derivative, internal_covariance(fit))


def internal_covariance(fit: Fit) -> Array:
    """(P, P) covariance of the internal values of a fitted model; zero where they were given."""
    covariance = np.zeros((len(fit.model.values),) * 2)
    free = np.ix_(fit.problem.free, fit.problem.free)
    covariance[free] = fit.covariance * np.outer(fit.problem.scale, fit.problem.scale)
    return covariance
