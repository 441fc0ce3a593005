"""The error budget of a fitted model: what each effect moves the point by, at given loads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.identify import Fit
from sk120stiff.model import Share, joint_shares, moved_by, shares, with_own_errors


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


def joint_budget(fit: Fit) -> tuple[Share, ...]:
    """What all that yields at one joint moves the point by, the largest first."""
    _, derivative = fit.model.predict_with_sensitivities(fit.problem.load_cases)
    within = within_joints(fit)
    return with_own_errors(
        joint_shares(fit.model, derivative, internal_covariance(fit)),
        joint_shares(fit.model, derivative, internal_covariance(within)),
    )


def within_joints(fit: Fit) -> Fit:
    """The fit without what other laws and names would make of a parameter.

    At one joint these trade with one another, and their sum stays. What a cause without a name may
    have moved stays uncertain.
    """
    return replace(fit, selection_uncertainty=None)


def internal_covariance(fit: Fit) -> Array:
    """(P, P) covariance of the internal values of a fitted model; zero where they were given."""
    covariance = np.zeros((len(fit.model.values),) * 2)
    free = np.ix_(fit.problem.free, fit.problem.free)
    covariance[free] = fit.covariance * np.outer(fit.problem.scale, fit.problem.scale)
    return covariance
