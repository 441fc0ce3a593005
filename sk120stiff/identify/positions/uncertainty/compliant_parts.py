"""What links, bearings and floors that a calibration leaves rigid may make of its springs.

No link is rigid. What one yields as a spring does is counted in that spring; what shows beside it,
and nothing asks for, moves the springs all the same. Each way in which a part yields counts by its
probability: before anything is read it shows as likely as not, with a compliance that is of its
usual size (half-normal), and the readings say more or less of both (Bayesian model averaging).
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from sk120stiff.effects import CATALOGUE, Catalogue, Effect
from sk120stiff.identify.checks.left_over import beside, orthonormal
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.selection import Blocks
from sk120stiff.identify.uncertainty.parts import moved_by_parts, taken, weights, yields

ROUNDING = 1e-9  # of the largest singular value, below which columns tell nothing new


def beside_parts(
    found: Calibration, catalogue: Catalogue = CATALOGUE, without: Collection[str] = ()
) -> Calibration:
    """The calibration, its values uncertain by parts that may yield.

    Causes that it lacks beyond doubt (`lacks`) stand beside them, and are none of them.

    Args:
        found: The calibration.
        catalogue: All that may be at work.
        without: Effects that are known to be rigid, by ``name`` or ``name:where``.
    """
    springs = np.array([p.effect.joint_spring for p in found.parameters], dtype=bool)
    springs &= (found.x > 0.0) & found.identifiable
    if not springs.any() or not np.isfinite(found.unit) or not found.unit:
        return found

    def wanted(cause: Effect) -> bool:
        part = yields(cause) and not {cause.id, cause.name} & set(without)
        return part or cause.id in found.lacks

    blocks, moving = Blocks.of(found, catalogue, wanted), ~found.at_bound
    lacking = [k for k, cause in enumerate(blocks.causes) if cause.id in found.lacks]
    parts = [k for k in range(len(blocks.causes)) if k not in lacking]
    if not parts:
        return found
    beyond = np.hstack([np.zeros((len(found.residual), 0)), *(blocks.whole[k] for k in lacking)])
    kept = np.hstack([-found.jacobian[:, moving], beyond]) / found.unit
    prior = np.concatenate([1.0 / found.problem.prior[moving] ** 2, np.ones(beyond.shape[1])])
    ways = np.hstack([blocks.whole[k] for k in parts]) / found.unit
    takes = np.zeros((ways.shape[1], len(found.x)))
    takes[:, moving] = taken(kept, prior, ways)[:, : moving.sum()]
    shown = beside(orthonormal(np.hstack([blocks.base, beyond]), ROUNDING), ways)
    share = np.abs(takes[:, springs] / found.x[springs]).max(axis=1)
    told = shown.T @ (found.residual / found.unit)
    moves = np.sqrt(weights(shown, share, told))[:, None] * takes
    effects = [blocks.causes[k] for k in parts for _ in blocks.causes[k].parameters]
    return moved_by_parts(found, moves, effects)
