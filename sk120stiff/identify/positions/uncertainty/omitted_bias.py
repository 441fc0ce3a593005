"""What the causes that a calibration lacks move its values by.

Springs swallow what a model lacks: the noise tells nothing of by how much. Where what is left asks
for other causes beyond doubt, the values are as uncertain as they differ from those beside these
causes, and they differ together: positions like those that were read are foretold much the same.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import CATALOGUE, Catalogue
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.selection import CLEAR, Blocks
from sk120stiff.identify.solve.covariance import posterior
from sk120stiff.identify.written import with_values


def beside_lacking(found: Calibration, catalogue: Catalogue = CATALOGUE) -> Calibration:
    """The calibration with the causes that it lacks beyond doubt, and standard errors beside them.

    One of many that are looked at is beyond doubt by as much more as there are.
    """
    if not np.isfinite(found.unit) or not found.unit:
        return found
    blocks = Blocks.of(found, catalogue)
    beyond_doubt = CLEAR + 2.0 * float(np.log(max(len(blocks.causes), 1)))
    chosen = blocks.at_least(beyond_doubt, blocks.asked_for())
    if not chosen:
        return found
    foreign = _moved(
        found,
        np.concatenate([blocks.whole[k] for k in chosen], axis=1),
        np.concatenate([blocks.positive[k] for k in chosen]),
    )
    causes = tuple(blocks.causes[k].id for k in chosen)
    return replace(with_values(replace(found, foreign=foreign)), lacks=causes)


def _moved(found: Calibration, more: Array, positive: Mask) -> Array:
    """(P, P) covariance of the estimates by what further columns (M, p) make of them."""
    moving, per = ~found.at_bound, 1.0 / found.unit
    kept, left = -per * found.jacobian[:, moving], per * found.residual
    drawn = 1.0 / found.problem.prior[moving] ** 2
    here, alone = posterior(kept, drawn, left)
    while True:
        both = np.column_stack([kept, per * more])
        there, beside = posterior(both, np.concatenate([drawn, np.ones(more.shape[1])]), left)
        wrong = positive & (there[len(here) :] < 0.0)
        if not wrong.any():
            break
        more, positive = more[:, ~wrong], positive[~wrong]
    count = len(here)
    step = there[:count] - here
    spread, ways = np.linalg.eigh(beside[:count, :count] - alone)
    out = np.zeros((len(found.x), len(found.x)))
    out[np.ix_(moving, moving)] = np.outer(step, step) + (ways * np.maximum(spread, 0.0)) @ ways.T
    return out
