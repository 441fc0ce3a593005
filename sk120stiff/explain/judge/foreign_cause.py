"""How far a cause without a name may have moved what was estimated.

Where something structured remains, the parameters have taken on what they could of it, and the
scatter of the readings knows nothing of that: a tracker that stands on the robot's floor makes a
spring too soft by many standard errors. Of all that `localise` suspects each may be the cause, at
sizes that leave as much as remains. Beside each the parameters come out elsewhere; by how much, and
how likely each is, is linear algebra of normal distributions, and the second moment over all of
them (law of total variance: Hoeting et al. 1999, Bayesian model averaging) joins the errors. Where
readings tell little, what is known beforehand of draws and instruments holds the parameters.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.localise.places import line_up, look_at
from sk120stiff.identify import Fit, yardstick
from sk120stiff.identify.checks.left_over import orthonormal


def moved_by_a_foreign_cause(fit: Fit, remains: float) -> Array:
    """(P_free, P_free) second moment of what a cause without a name may have done to the estimates.

    It moves them together, as the readings have them.

    Args:
        fit: The fitted model beside model-form error.
        remains: Size of its remainder, rms per axis [m].
    """
    moving = ~fit.at_bound
    out = np.zeros((len(fit.x),) * 2)
    look = look_at(fit, yardstick(fit))
    lineup = line_up(look)
    unit = np.sqrt(look.noise.scale)
    J = fit.jacobian[:, moving] / unit
    inside = orthonormal(J)
    inverse = np.linalg.pinv(np.vstack([J, fit.beforehand.rows()[:, moving] / unit]))[:, : len(J)]
    gap = -fit.residual / unit
    gap = gap - inside @ (inside.T @ gap)
    evidence, squares = [0.0], [np.zeros((J.shape[1],) * 2)]  # first: that there is no such cause
    for suspect, part, columns in zip(lineup.suspects, lineup.parts, lineup.reading, strict=True):
        length = np.sqrt((columns[fit.problem.read] ** 2).mean(axis=0))
        seen = length > 0.0
        if not seen.any():
            continue
        drawn = lineup.white[:, part][:, seen] / unit
        drawn = drawn * remains / (length[seen] * np.sqrt(seen.sum()))
        left, size, right = np.linalg.svd(drawn - inside @ (inside.T @ drawn), full_matrices=False)
        along = left.T @ gap
        told = size**2 / (1.0 + size**2)
        choice = suspect.price_of_choice  # those alike are one cause together
        evidence.append(float(told @ along**2 - np.log1p(size**2).sum()) - choice)
        taken = inverse @ drawn @ right.T  # what the parameters take on of each
        likeliest = taken @ (size / (1.0 + size**2) * along)
        rest = taken / np.sqrt(1.0 + size**2)
        squares.append(np.outer(likeliest, likeliest) + rest @ rest.T)
    weights = np.exp(0.5 * (np.array(evidence) - max(evidence)))
    out[np.ix_(moving, moving)] = np.tensordot(weights / weights.sum(), np.array(squares), axes=1)
    return out
