"""Poses that tell two effects apart: T-optimal design (Atkinson & Fedorov 1975).

If effect e is true with the size that was fitted, its rival f and the base model imitate part of
its signature u = S_e α. What they cannot imitate, λ = ‖M_[B, S_f] u‖², is the evidence. Poses are
chosen one after the other so that λ grows fastest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.model import Model
from sk120stiff.plan.pool import Pool
from sk120stiff.robot.coupling import Array


@dataclass(frozen=True, eq=False)
class Choice:
    """Readings chosen from a pool.

    Attributes
    ----------
    rows
        (K,) chosen candidates, in the order of their choice.
    before, after
        √λ without and with them, in units of the noise.
    """

    rows: tuple[int, ...]
    before: float
    after: float


def discriminating_readings(
    model: Model,
    effect: Effect,
    rival: Effect,
    pool: Pool,
    *,
    count: int,
    sigma: float,
    known: Array | None = None,
) -> Choice:
    """Choose readings that tell `effect` from `rival`.

    Parameters
    ----------
    model
        Fitted model that holds `effect` with its size.
    effect, rival
        What is to be told apart.
    pool
        Candidate readings.
    count
        How many to choose.
    sigma
        Standard uncertainty of one displacement per axis [m].
    known
        (k, k) information that is already there, from `information`; none by default.
    """
    columns = signature_columns(model, effect, rival, pool) / sigma  # (M, 3, k)
    gains = np.einsum("mik,mil->mkl", columns, columns)
    total = np.zeros(gains.shape[1:]) if known is None else known.copy()
    ridge = 1e-9 * np.trace(gains.mean(axis=0)) * np.eye(len(total))
    ridge[-1, -1] = 0.0
    before = _evidence((total + ridge)[None])[0]
    rows: list[int] = []
    free = np.ones(len(gains), dtype=bool)
    for _ in range(min(count, len(gains))):
        found = _evidence(total + ridge + gains)
        pick = int(np.argmax(np.where(free, found, -np.inf)))
        free[pick] = False
        rows.append(pick)
        total = total + gains[pick]
    after = _evidence((total + ridge)[None])[0]
    return Choice(tuple(rows), float(np.sqrt(before)), float(np.sqrt(after)))


def signature_columns(model: Model, effect: Effect, rival: Effect, pool: Pool) -> Array:
    """(M, 3, k) columns of base and rival, and last the signature of the effect [m]."""
    full = model if rival.id in {e.id for e in model.effects} else model + rival
    _, derivative = full.predict_with_sensitivities(pool.situation)
    owner = np.array([parameter.effect.id for parameter in full.parameters])
    typical = np.array([parameter.spec.typical for parameter in full.parameters])
    own = owner == effect.id
    others = derivative[:, :, ~own] * typical[~own]
    signature = derivative[:, :, own] @ full.values[own]
    return np.concatenate([others, signature[:, :, None]], axis=2)


def _evidence(information: Array) -> Array:
    """(M,) Schur complement of the last column."""
    inner, border = information[:, :-1, :-1], information[:, :-1, -1]
    solved = np.linalg.solve(inner, border[..., None])[..., 0]
    return np.maximum(information[:, -1, -1] - (border * solved).sum(-1), 0.0)
