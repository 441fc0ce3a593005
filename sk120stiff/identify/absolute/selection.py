"""Which transmission errors show beyond doubt: what they leave out would be taken for springs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Catalogue, Effect
from sk120stiff.effects.base import Options
from sk120stiff.identify.absolute.pose_problem import PoseProblem
from sk120stiff.identify.fit import Fit

CLEAR = 6.0  # by which the BIC must fall


def waves_that_show(found: Fit, catalogue: Catalogue) -> tuple[Effect, ...]:
    """Transmission errors that the BIC asks for, one after the other, beside a fitted model."""
    model, kind = found.model, catalogue["transmission_error"]
    present = {effect.id for effect in model.effects}
    every = (kind.at(model.robot, where, Options()) for where in kind.places(model.robot))
    effects = [effect for effect in every if effect.id not in present]
    if not effects:
        return ()
    blocks = columns_of(found, effects)
    picked = _forward(blocks, found.residual, len(found.x))
    return tuple(effects[k] for k in picked)


def columns_of(found: Fit, effects: Sequence[Effect]) -> list[Array]:
    """(M, p) whitened derivatives by further effects, beside what the fit estimates already."""
    problem = found.problem
    if not isinstance(problem, PoseProblem):
        raise TypeError("a fit of poses")
    wider = found.model
    for effect in effects:
        wider = wider + effect
    slope = replace(problem, model=wider).channel_gap(wider.values, derivative=True)[1]
    white = slope[:, len(found.model.parameters) :] / problem.of_channels.sigma[:, None]
    Q = np.asarray(np.linalg.qr(found.jacobian)[0])
    white = white - Q @ (Q.T @ white)
    ends = np.cumsum([len(effect.parameters) for effect in effects])
    return np.split(white, ends[:-1], axis=1)


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
        size = np.linalg.norm(A, axis=0)
        A = A / np.where(size > 0.0, size, 1.0)
        weights, _, found, _ = np.linalg.lstsq(A, residual, rcond=1e-6)
        left, rank = residual - A @ weights, int(found)
    square = max(float(left @ left), 1e-300)
    return float(count * np.log(square / count) + rank * np.log(count))
