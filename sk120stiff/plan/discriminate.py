"""Poses that tell two effects apart: T-optimal design (Atkinson & Fedorov 1975).

If effect e is true with the size that was fitted, its rival f and the base model imitate part of
its signature u = S_e α. What they cannot imitate, λ = ‖M_[B, S_f] u‖², is the evidence. Poses are
chosen so that λ is as large as can be: greedily, then by exchange.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Effect
from sk120stiff.errors import InputError
from sk120stiff.model import Model
from sk120stiff.plan.design import DISPLACEMENT, best_choice
from sk120stiff.plan.pool import Pool


@dataclass(frozen=True, eq=False)
class Choice:
    """Readings chosen from a pool.

    Attributes:
        rows: (K,) chosen candidates.
        before, after: √λ without and with them, in units of the noise.
    """

    rows: tuple[int, ...]
    before: float
    after: float


@dataclass(frozen=True, eq=False)
class Rivalry:
    """Two effects and what each reading of a pool would say between them.

    Attributes:
        gains: (2, M, k, k) information of every candidate, for either effect as the true one: base
            and rival over their plausible ranges, last the signature.
        known: (2, k, k) information before.
    """

    gains: Array
    known: Array

    @classmethod
    def of(cls, gains: Sequence[Array], known: Sequence[Array]) -> Self:
        """From (M, k, k) and (k, k) of either effect; plausible ranges are known beforehand."""
        size = max(block.shape[-1] for block in gains)
        return cls(
            np.array([_padded(block, size) for block in gains]),
            np.array([_padded(block, size) for block in known]) + prior(size),
        )

    def of_candidates(self, rows: Index) -> Rivalry:
        """The same of some candidates."""
        return Rivalry(self.gains[:, rows], self.known)

    def evidence_of(self, rows: Sequence[int]) -> float:
        """√λ of a choice, the smaller of both directions, in units of the noise."""
        total = self.known + self.gains[:, list(rows)].sum(axis=1)
        return float(np.sqrt(_evidence(total).min()))

    def best(self, count: int, pose: Index | None = None, loads: int = 1) -> Choice:
        """The readings that tell most, for the effect that is the harder to tell.

        With the `pose` of each candidate, `count` poses with `loads` each.
        """
        if not 1 <= count <= self.gains.shape[1]:
            raise InputError(
                f"{count} readings cannot be chosen from {self.gains.shape[1]} candidates"
            )
        size = self.gains.shape[-1]

        def worth(total: Array) -> Array:
            both = total.reshape(len(total), 2, size, size)
            return np.asarray(_evidence(both).min(axis=-1))

        flat = np.moveaxis(self.gains, 0, 1).reshape(len(self.gains[0]), 2 * size, size)
        rows = best_choice(worth, flat, self.known.reshape(2 * size, size), count, pose, loads)
        return Choice(tuple(rows), self.evidence_of([]), self.evidence_of(rows))


def readings_for_all(columns: Sequence[Array], *, count: int) -> tuple[tuple[int, ...], Array]:
    """Readings that tell several pairs of effects apart at once, and how far each.

    They share the readings: Σ ln(1 + λ) over the pairs is largest, so that none is left behind for
    the sake of another that is told already.

    Args:
        columns: For each of P pairs (M, 3, k), see `signature_columns`, in units of the noise.
        count: How many to choose.

    Returns:
        tuple: Rows of the pool, and (P,) √λ of each pair with them.
    """
    size = max(block.shape[-1] for block in columns)
    blocks = [
        _padded(np.einsum("mik,mil->mkl", block, block, optimize=True), size) for block in columns
    ]
    gains, start = np.concatenate(blocks, axis=1), np.tile(prior(size), (len(blocks), 1))

    def apart(total: Array) -> Array:
        return _evidence(total.reshape(len(total), len(blocks), size, size))

    def worth(total: Array) -> Array:
        return np.asarray(np.log1p(apart(total)).sum(axis=-1))

    rows = best_choice(worth, gains, start, min(count, len(gains)))
    return tuple(rows), np.sqrt(apart((start + gains[rows].sum(axis=0))[None])[0])


def rivalry(
    model: Model,
    effect: Effect,
    rival: Effect,
    pool: Pool,
    *,
    sigma: float,
    known: Pool | None = None,
) -> Rivalry:
    """What a pool of readings would say between two effects, whichever of them is true.

    Args:
        model: Base model; an effect that it holds keeps its values, another has its typical size.
        effect, rival: What is to be told apart.
        pool: Candidate readings.
        sigma: Standard uncertainty of one reading per axis [m]; a displacement has √2 of it.
        known: Readings that were taken already.
    """

    gains, before = [], []
    for true, other in ((effect, rival), (rival, effect)):
        columns = signature_columns(model, true, other, pool) / (sigma * DISPLACEMENT)
        gains.append(np.einsum("mik,mil->mkl", columns, columns))
        before.append(np.zeros(gains[-1].shape[1:]))
        if known is not None:
            old = signature_columns(model, true, other, known) / (sigma * DISPLACEMENT)
            before[-1] = np.einsum("mik,mil->kl", old, old)
    return Rivalry.of(gains, before)


def signature_columns(model: Model, effect: Effect, rival: Effect, pool: Pool) -> Array:
    """(M, 3, k) columns of a pool, see `over_ranges` [m]."""
    full = with_both(model, effect, rival)
    return over_ranges(full, full.predict_with_sensitivities(pool.load_cases)[1], effect)


def with_both(model: Model, effect: Effect, rival: Effect) -> Model:
    """The model with those of two effects that it lacks."""
    for added in (effect, rival):
        if added.id not in {present.id for present in model.effects}:
            model = model + added
    return model


def over_ranges(model: Model, derivative: Array, effect: Effect) -> Array:
    """(..., k) columns of base and rival over their plausible ranges, last the effect's signature.

    The base are the free parameters of the model. An effect whose values are all zero has its
    typical size.

    Args:
        model: Base with both effects, P parameters.
        derivative: (..., P) of what is read, by each parameter.
        effect: The one that is held to be true.
    """
    own = np.array([parameter.effect.id == effect.id for parameter in model.parameters])
    others = np.array([parameter.free for parameter in model.parameters]) & ~own
    plausible = np.array([parameter.spec.plausible for parameter in model.parameters])
    sizes = model.values[own]
    if not sizes.any():
        sizes = np.array([parameter.spec.typical for parameter in model.parameters])[own]
    signature = derivative[..., own] @ sizes
    return np.concatenate(
        [derivative[..., others] * plausible[others], signature[..., None]], axis=-1
    )


def prior(size: int) -> Array:
    """(k, k) information of the plausible ranges; none on the signature."""
    ridge = np.eye(size)
    ridge[-1, -1] = 0.0
    return ridge


def _padded(block: Array, size: int) -> Array:
    """A block with zero rows and columns in front, so that the signature stays last."""
    missing = size - block.shape[-1]
    return np.pad(block, [(0, 0)] * (block.ndim - 2) + [(missing, 0), (missing, 0)])


def _evidence(information: Array) -> Array:
    """(...,) Schur complement of the last column."""
    inner, border = information[..., :-1, :-1], information[..., :-1, -1]
    solved = np.linalg.solve(inner, border[..., None])[..., 0]
    left = information[..., -1, -1] - (border * solved).sum(-1)
    return np.asarray(np.maximum(left, 0.0))
