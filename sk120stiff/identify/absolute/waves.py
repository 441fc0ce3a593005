"""Waves of gears: which show beyond doubt, and how far those that are left out move the rest.

Every gear has some. Where they would show, the selection lets them in, or the readings exclude
them; of few readings neither. So the standard errors are averaged over both models, without waves
and with such of the usual size in every joint, by their evidence (Hoeting et al. 1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import logsumexp

from sk120stiff.arrays import Array, lengths_of
from sk120stiff.effects import Catalogue, Effect
from sk120stiff.effects.options import Options
from sk120stiff.identify.absolute.left_out import COUNTED, widened_by
from sk120stiff.identify.absolute.noise_sizes import of_poses
from sk120stiff.identify.absolute.pose_problem import PoseProblem
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.written import with_values

CLEAR = 6.0  # by which the BIC must fall
NOISES = np.geomspace(0.1, 2.0, 30)  # times the gap that was left: what the noise may be
LEAST = 1e-3  # probability of waves below which they are not looked at


def waves_that_show(found: Fit, catalogue: Catalogue) -> tuple[Effect, ...]:
    """Transmission errors that the BIC asks for, one after the other, beside a fitted model."""
    effects = _further(found, catalogue)
    if not effects:
        return ()
    white = _slopes(found, effects)
    Q = np.asarray(np.linalg.qr(found.jacobian)[0])
    white = white - Q @ (Q.T @ white)  # beside what the fit estimates already
    ends = np.cumsum([len(effect.parameters) for effect in effects])
    blocks = np.split(white, ends[:-1], axis=1)
    picked = _forward(blocks, found.residual, len(found.x))
    return tuple(effects[k] for k in picked)


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


def _forward(blocks: list[Array], residual: Array, spent: int) -> list[int]:
    """Blocks that lower the BIC clearly, the best one first."""
    count, chosen = len(residual), list[int]()
    score = _bic([], residual)
    while len(chosen) < len(blocks):
        rest = [k for k in range(len(blocks)) if k not in chosen]
        tried = {k: _bic([blocks[j] for j in (*chosen, k)], residual) for k in rest}
        best = min(rest, key=lambda k: tried[k])
        spent += blocks[best].shape[1]
        if tried[best] > score - CLEAR or 2 * spent > count:
            break
        chosen.append(best)
        score = tried[best]
    return chosen


def _bic(blocks: list[Array], residual: Array) -> float:
    count, left, rank = len(residual), residual, 0
    if blocks:
        A = np.concatenate(blocks, axis=1)
        size = lengths_of(A)
        A = A / np.where(size > 0.0, size, 1.0)
        weights, _, found, _ = np.linalg.lstsq(A, residual, rcond=1e-6)
        left, rank = residual - A @ weights, int(found)
    square = max(float(left @ left), 1e-300)
    return float(count * np.log(square / count) + rank * np.log(count))


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
    widened = widened_by(per * more, per * kept, drawn, per * left)
    variance = np.zeros(len(found.x))
    variance[moving] = likely * widened
    known = np.zeros(len(found.x)) if found.left_out is None else found.left_out
    left_out = np.sqrt(known**2 + np.where(counted, 0.0, variance))
    return with_values(replace(found, left_out=left_out))


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
