"""Profile-likelihood intervals: where the misfit, all other parameters refitted, has risen enough.

They need no linearity: for each parameter the root of the signed distance
z(x_k) = ± √(χ²(x_k) − χ²_min), which is a straight line where the readings are linear, is sought by
interpolation (Bates & Watts 1988, chapter 6).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sk120stiff.errors import Refusal
from sk120stiff.identify.covariance import covariance_of, public_interval
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.polish import Minimum, polish
from sk120stiff.robot.coupling import Array

TRIALS = 20
CLOSE = 1e-3  # of the distance that is sought


def profile_intervals(
    fit: Fit, level: float = 0.95, *, progress: Callable[[int, int], None] | None = None
) -> tuple[tuple[float, float], ...]:
    """Confidence intervals of the public values, one (low, high) per estimated parameter.

    Parameters
    ----------
    fit
        A converged fit.
    level
        Confidence.
    progress
        Called as ``progress(done, total)``.

    Notes
    -----
    An end that no misfit sets lies at the physical bound, which may be infinite. A parameter that
    the readings do not show has both ends there.
    """
    lower, upper = fit.problem.bounds
    goal = fit.reach(level) * fit.unit
    found = []
    for k, parameter in enumerate(fit.parameters):
        ends = (float(lower[k]), float(upper[k]))
        if fit.identifiable[k] and np.isfinite(goal):
            ends = (_end(fit, k, -1.0, goal), _end(fit, k, 1.0, goal))
        scale = float(fit.problem.scale[k])
        found.append(public_interval(parameter.spec, ends[0] * scale, ends[1] * scale))
        if progress is not None:
            progress(k + 1, len(fit.parameters))
    return tuple(found)


def _end(fit: Fit, k: int, side: float, goal: float) -> float:
    """Scaled value of parameter k where the distance reaches the goal, or its bound."""
    limit = float(fit.problem.bounds[0 if side < 0.0 else 1][k])
    room = abs(limit - float(fit.x[k]))
    if room == 0.0:
        return limit
    near = fit.x
    low, high = (0.0, 0.0), (np.inf, np.inf)  # (way, distance) below and above the goal
    way = min(_first_way(fit, k, goal), room)
    for _ in range(TRIALS):
        value = float(fit.x[k]) + side * way
        try:
            solved = _refitted(fit, k, limit if way == room else value, near)
        except Refusal:  # no equilibrium out there: the misfit is as good as infinite
            high = (way, np.inf)
            way = 0.5 * (low[0] + way)
            continue
        rise = float(solved.residual @ solved.residual) - fit.chi_square
        distance = float(np.sqrt(max(rise, 0.0)))
        if abs(distance - goal) <= CLOSE * goal:
            return value
        if distance < goal:
            if way == room:
                return limit
            low, near = (way, distance), solved.x
        else:
            high = (way, distance)
        if np.isfinite(high[1]):
            way = low[0] + (goal - low[1]) / (high[1] - low[1]) * (high[0] - low[0])
        elif np.isfinite(high[0]):
            way = 0.5 * (low[0] + high[0])
        else:
            way = min(way * min(goal / max(distance, 0.25 * goal), 4.0), room)
    return float(fit.x[k]) + side * low[0]


def _first_way(fit: Fit, k: int, goal: float) -> float:
    covariance = covariance_of(fit.jacobian, fit.at_bound, fit.problem.span)
    std = float(np.sqrt(covariance[k, k]))
    if std > 0.0:
        return goal * std
    own = float(np.linalg.norm(fit.jacobian[:, k]))
    return goal / own


def _refitted(fit: Fit, k: int, value: float, near: Array) -> Minimum:
    """All parameters but k fitted again, with k at a value."""
    problem = fit.problem
    others = np.delete(np.arange(len(near)), k)
    whole = near.copy()
    whole[k] = value

    def evaluate(part: Array) -> tuple[Array, Array]:
        x = whole.copy()
        x[others] = part
        residual, jacobian = problem.evaluate(x)
        return residual, jacobian[:, others]

    far = np.maximum(problem.span, np.abs(fit.x))  # others may follow as far as is plausible
    lower, upper = (np.clip(bound, -far, far)[others] for bound in problem.bounds)
    found = polish(evaluate, near[others], (lower, upper), problem.span[others], fine=CLOSE**2)
    whole[others] = found.x
    return replace(found, x=whole)
