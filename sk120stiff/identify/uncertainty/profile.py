"""Profile-likelihood intervals of a fit, at exact equilibrium: no linearity is assumed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.covariance import covariance_of, public_interval
from sk120stiff.identify.solve.profile_likelihood import Valley
from sk120stiff.model import CALIBRATED


def profile_intervals(
    fit: Fit, *, progress: Callable[[int, int], None] | None = None
) -> tuple[tuple[float, float], ...]:
    """95 % confidence intervals of the public values, one (low, high) per estimated parameter.

    Args:
        fit: A converged fit.
        progress: Called as ``progress(done, total)``.

    Notes:
        An end that no misfit sets lies at the physical bound, which may be infinite. A parameter
        that the readings do not show has both ends there. One that a calibration tells has the ends
        of `Fit.intervals`: along what the readings leave open they have no misfit to follow.
    """
    problem = fit.problem
    lower, upper = problem.bounds
    goal = fit.reach() * fit.unit
    variance = np.diag(covariance_of(fit.jacobian, fit.at_bound, problem.span))
    valley = Valley(
        evaluate=problem.evaluate,
        x=fit.x,
        misfit=fit.chi_square,
        bounds=problem.bounds,
        span=problem.span,
        plausible=problem.plausible,
        std=np.sqrt(variance),
        slopes=np.linalg.norm(fit.jacobian, axis=0),
    )
    found, linear = [], fit.intervals()
    for k, parameter in enumerate(fit.parameters):
        ends = (float(lower[k]), float(upper[k]))
        if parameter.origin == CALIBRATED or not np.isfinite(variance[k]):
            found.append(linear[k])
            continue
        if np.isfinite(goal):
            ends = (valley.end(k, -1.0, goal), valley.end(k, 1.0, goal))
        scale = float(problem.scale[k])
        found.append(public_interval(parameter.spec, ends[0] * scale, ends[1] * scale))
        if progress is not None:
            progress(k + 1, len(fit.parameters))
    return tuple(found)
