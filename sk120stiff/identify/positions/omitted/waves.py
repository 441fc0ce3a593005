"""Waves of gears: which show beyond doubt, and how far those that are left out move the rest.

Every gear has some. Where they would show, the selection lets them in, or the readings exclude
them; of few readings neither. So the standard errors are averaged over both models, without waves
and with such of the usual size in every joint, by their evidence (Hoeting et al. 1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import stats
from scipy.special import logsumexp

from sk120stiff.arrays import Array
from sk120stiff.effects import Catalogue, Effect
from sk120stiff.effects.options import Options
from sk120stiff.effects.transmission_error import TransmissionError
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.noise.sizes import of_poses
from sk120stiff.identify.positions.omitted.nuisances import COUNTED, moved_by
from sk120stiff.identify.positions.omitted.selection import Blocks
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.identify.written import leaving_out

CHANCE = 1e-3  # probability of values as far off zero by noise alone
ROUNDING = 1e-12  # of the largest variance, below which one is none
NOISES = np.geomspace(0.1, 2.0, 30)  # times the gap that was left: what the noise may be
LEAST = 1e-3  # probability of waves below which they are not looked at


def waves_that_show(found: Fit, catalogue: Catalogue) -> tuple[Effect, ...]:
    """Transmission errors that a fitted model asks for, each beside all else that it asks for.

    Any smooth cause that the model lacks is in part a wave of the first orders, and so is what the
    law of such a cause leaves of it. So those waves alone show that bring more than every other
    cause that is asked for brings beside them, at poses left out as well.
    """
    blocks = Blocks.of(found, catalogue)
    loss = blocks.losses(chosen := blocks.asked_for())
    waves = [k for k in chosen if isinstance(blocks.causes[k], TransmissionError)]
    most = max((loss[k] for k in chosen if k not in waves), default=0.0)
    return tuple(blocks.causes[k] for k in waves if loss[k] > most and blocks.sure_of(k, chosen))


def doubtful(found: Fit, waves: Sequence[Effect]) -> Effect | None:
    """The one of these waves in a fit whose values together are least off zero, where by chance.

    Single values need not be off zero: where a joint moves little, waves are alike there.
    """
    chance = {}
    for effect in waves:
        own = [k for k, p in enumerate(found.parameters) if p.effect.id == effect.id]
        x, covariance = found.x[own], found.covariance[np.ix_(own, own)]
        square = float(x @ np.linalg.pinv(covariance, rcond=ROUNDING, hermitian=True) @ x)
        chance[effect] = float(stats.chi2.sf(square, max(len(own), 1)))
    least = max(waves, key=lambda effect: chance[effect], default=None)
    return least if least is not None and chance[least] > CHANCE else None


def beside_waves(found: Fit, catalogue: Catalogue) -> Fit:
    """The fit with standard errors that know of waves which it leaves out."""
    problem = found.problem
    if not isinstance(problem, PoseProblem) or not np.isfinite(found.unit):
        return found
    effects = _further(found, catalogue)
    counted = np.array([isinstance(p.effect, COUNTED) for p in found.parameters])
    if not effects or counted.all():
        return found
    more = _slopes(found, effects)
    more *= [spec.typical for effect in effects for spec in effect.parameters]
    moving = ~found.at_bound
    kept, left = -found.jacobian[:, moving], found.residual
    likely = _likely(kept, more, left, found.unit, stated=found.sigma_known and not found.exceeds)
    if likely < LEAST:
        return found
    drawn = 1.0 / problem.prior[moving] ** 2
    per = 1.0 / found.unit
    moved = moved_by(per * more, per * kept, drawn, per * left)
    return leaving_out(found, likely * moved, ~counted)


def _likely(kept: Array, more: Array, left: Array, unit: float, *, stated: bool) -> float:
    """Probability of waves of the usual size, beside what was estimated, at even odds before."""
    Q = np.asarray(np.linalg.qr(kept)[0])
    left, more = left - Q @ (Q.T @ left), more - Q @ (Q.T @ more)
    ways, size, _ = np.linalg.svd(more, full_matrices=False)
    along = (ways.T @ left) ** 2
    rest = float(left @ left) - float(along.sum())
    freedom = len(left) - Q.shape[1] - len(size)
    noise = np.ones(1) if stated else (unit * NOISES) ** 2

    def evidence(of_waves: Array) -> float:
        total = noise[:, None] + of_waves
        each = (np.log(total) + along / total).sum(axis=1)
        each += freedom * np.log(noise) + max(rest, 0.0) / noise
        return float(logsumexp(-0.5 * each))

    odds = evidence(size**2) - evidence(0.0 * size)
    return float(1.0 / (1.0 + np.exp(-np.clip(odds, -50.0, 50.0))))


def _further(found: Fit, catalogue: Catalogue) -> list[Effect]:
    """The waves that a model has not."""
    robot, kind = found.model.robot, catalogue["transmission_error"]
    present = {effect.id for effect in found.model.effects}
    every = (kind.at(robot, where, Options()) for where in kind.places(robot))
    return [effect for effect in every if effect.id not in present]


def _slopes(found: Fit, effects: Sequence[Effect]) -> Array:
    """(M, p) whitened derivative by further effects."""
    problem, wider = of_poses(found), found.model
    for effect in effects:
        wider = wider + effect
    slope = replace(problem, model=wider).channel_gap(wider.values, derivative=True)[1]
    return problem.of_channels.apply(slope[:, len(found.model.parameters) :])
