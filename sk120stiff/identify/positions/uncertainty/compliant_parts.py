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
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.selection import Blocks
from sk120stiff.identify.uncertainty.parts import moved_by_parts, springs_told, yields


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
    if not springs_told(found).any():
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
    return moved_by_parts(
        found,
        kept,
        prior,
        np.hstack([blocks.whole[k] for k in parts]) / found.unit,
        [blocks.causes[k] for k in parts for _ in blocks.causes[k].parameters],
        base=np.hstack([blocks.base, beyond]),
        left=found.residual / found.unit,
    )
