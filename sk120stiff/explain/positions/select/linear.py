"""Positions to first order in everything that may be missing, and models chosen among it.

Small errors enter nearly linearly, so one derivative by every candidate at a registered, rigid arm
serves all models. With Gaussian priors of the usual sizes the evidence of each is exact. All of it
works on sums over the readings of a part, so cross-validation costs no more than a fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Protocol

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import Effect, Elastic, LoadError, Sequential, Weighing
from sk120stiff.effects.foundation import BaseRocking
from sk120stiff.identify.positions.solve.pose_errors import PoseWhitening

WIDENED = 6  # rounds in which a prior and the size under it come to agree
AGREED = 0.01  # share of the size by which they may differ still


class BesideErrors(Protocol):
    """Sets of names, judged beside what errors of the model may be (`smooth_error.py`)."""

    def score(self, chosen: tuple[int, ...], /) -> float:
        """Logarithm of the evidence, up to a constant of all models."""

    def joined(self, chosen: tuple[int, ...], /) -> tuple[Array, Mask]:
        """(K,) the same with one more candidate each, and which are exact; see `Linear.joined`."""

    def likeliest(self, sets: Sequence[tuple[int, ...]], /) -> BesideErrors:
        """Beside those errors alone that are likeliest for these sets."""


@dataclass(frozen=True, eq=False)
class Linear:
    """M whitened numbers, columns of the base and of every candidate.

    Attributes:
        residual: (M,) gap of the base model in units of its noise.
        base: (M, P) orthonormal columns that span the base model.
        columns: (M, K) further columns per usual size of their parameter, what the base does taken
            out.
        positive: (K,) parameters that cannot be negative.
        sizes: (K,) usual size of each parameter, internal units.
        candidates: The effects that the columns belong to.
        slices: The part of the columns of each candidate.
        seen: Candidates that the model has about which it is linearised.
        row: (M,) reading that each number belongs to.
        fold: (M,) part that it is left out with.
        stated: The size of the noise was stated.
        independent: How many independent numbers what is left amounts to; None: all of them.
        errors: Evidence beside errors of the model that nobody knows; None: what is left is noise.
    """

    residual: Array
    base: Array
    columns: Array
    positive: Mask
    sizes: Array
    candidates: tuple[Effect, ...]
    slices: tuple[slice, ...]
    row: Index
    fold: Index
    stated: bool
    seen: tuple[int, ...] = ()
    independent: float | None = None
    errors: BesideErrors | None = None

    @cached_property
    def sums(self) -> Array:
        """(F, P + K + 1, P + K + 1) products of all columns and the gap, part by part."""
        A = np.column_stack([self.base, self.columns, self.residual])
        return np.array([A[self.fold == f].T @ A[self.fold == f] for f in range(self.folds)])

    @cached_property
    def whole(self) -> Array:
        """(P + K + 1, P + K + 1) the same of all parts together."""
        return np.asarray(self.sums.sum(axis=0))

    @property
    def folds(self) -> int:
        """Number of parts."""
        return int(self.fold.max()) + 1

    @property
    def count(self) -> float:
        """Independent numbers beside the base."""
        return self.independent or float(len(self.residual) - self.base.shape[1])

    @cached_property
    def bent(self) -> dict[int, int]:
        """Candidate that bends the spring of a joint → the candidate that is this spring."""
        springs = {each.where: e for e, each in enumerate(self.candidates) if each.joint_spring}
        return {
            e: springs[each.where]
            for e, each in enumerate(self.candidates)
            if each.bends_a_spring and each.where in springs
        }

    @cached_property
    def needs(self) -> dict[int, frozenset[int]]:
        """Candidate → those without which it is not what its columns say.

        What bends a spring needs that spring. A load, or a weight, moves what yields: its columns
        are those of all that yields in the model about which it is linearised.
        """
        yields = frozenset(e for e in self.seen if self.candidates[e].joint_spring)
        yields = yields or frozenset(
            e for e in self.seen if isinstance(self.candidates[e], Elastic)
        )
        loads = {
            e: yields for e, x in enumerate(self.candidates) if isinstance(x, LoadError | Weighing)
        }
        return {**loads, **{e: frozenset({spring}) for e, spring in self.bent.items()}}

    def may_join(self, chosen: tuple[int, ...]) -> list[int]:
        """Candidates that are not chosen, where what they need is."""
        others = (e for e in range(len(self.candidates)) if e not in chosen)
        return [e for e in others if self.needs.get(e, frozenset()) <= set(chosen)]

    def less(self, chosen: tuple[int, ...], e: int) -> tuple[int, ...]:
        """The chosen without one, and without what needs it."""
        return tuple(c for c in chosen if c != e and e not in self.needs.get(c, ()))

    def picked(self, chosen: tuple[int, ...]) -> Index:
        """Columns of the chosen candidates, numbered behind those of the base."""
        P = self.base.shape[1]
        parts = [np.arange(self.slices[e].start, self.slices[e].stop) + P for e in chosen]
        return np.concatenate([np.arange(P), *parts]).astype(np.intp)

    def only(self, chosen: tuple[int, ...]) -> Linear:
        """With these candidates alone, in this order."""
        parts = [self.slices[e] for e in chosen]
        keep = np.concatenate([np.zeros(0), *(np.arange(p.start, p.stop) for p in parts)])
        keep = keep.astype(np.intp)
        ends = np.cumsum([0, *(p.stop - p.start for p in parts)])
        return replace(
            self,
            columns=self.columns[:, keep],
            positive=self.positive[keep],
            sizes=self.sizes[keep],
            candidates=tuple(self.candidates[e] for e in chosen),
            slices=tuple(slice(int(a), int(b)) for a, b in pairwise(ends)),
            seen=tuple(k for k, e in enumerate(chosen) if e in self.seen),
        )

    def by_law(self, e: int, law: Effect, sizes: Array, block: Array) -> Linear:
        """With a candidate by another law: usual sizes (p,) of its parameters, columns (M, p)."""
        own = self.slices[e]
        more = len(sizes) - (own.stop - own.start)
        positive = [spec.lower == 0.0 for spec in law.parameters]

        def put(whole: Array | Mask, part: Array | Mask) -> Array:
            return np.concatenate([whole[..., : own.start], part, whole[..., own.stop :]], axis=-1)

        return replace(
            self,
            columns=put(self.columns, block),
            positive=put(self.positive, np.array(positive)).astype(bool),
            sizes=put(self.sizes, sizes),
            candidates=(*self.candidates[:e], law, *self.candidates[e + 1 :]),
            slices=tuple(
                slice(p.start + more * (k > e), p.stop + more * (k >= e))
                for k, p in enumerate(self.slices)
            ),
        )

    def whitened(self, before: PoseWhitening, after: PoseWhitening) -> Linear:
        """The same numbers with other uncertainties."""
        if before is after:
            return self
        residual, base, columns = (
            after.apply(before.undo(each)) for each in (self.residual, self.base, self.columns)
        )
        return replace(self, residual=residual, base=base, columns=columns)

    def values(self, chosen: tuple[int, ...], noise: float) -> dict[str, float]:
        """Internal value of every parameter of the chosen by its full name; what is rigid is 0."""
        found = self.solved(chosen, noise)
        x = np.zeros(self.base.shape[1] + self.columns.shape[1])
        x[found.pick] = found.x
        x = x[self.base.shape[1] :] * self.sizes
        return {
            f"{self.candidates[e].id}.{spec.name}": float(value)
            for e in chosen
            for spec, value in zip(self.candidates[e].parameters, x[self.slices[e]], strict=True)
        }

    def solved(self, chosen: tuple[int, ...], noise: float, without: int | None = None) -> Solved:
        """The chosen model fitted to all parts, or to all but one.

        `noise` is the variance of the whitened numbers, against which the priors count.
        """
        every = self.picked(chosen)
        G = self.whole if without is None else self.whole - self.sums[without]
        P = self.base.shape[1]
        times = np.ones(P + self.columns.shape[1])  # of the usual size, how wide a prior is
        for _ in range(WIDENED):
            pick = every
            while True:
                inner = G[np.ix_(pick, pick)].copy()
                prior = np.where(pick < P, 0.0, noise / times[pick] ** 2)
                inner[np.diag_indices(len(pick))] += prior + 1e-12
                x = np.linalg.solve(inner, G[pick, -1])
                wrong = (pick >= P) & (x < 0.0)
                wrong[wrong] = self.positive[pick[wrong] - P]
                if not wrong.any():
                    break
                pick = pick[~wrong]  # a part that would have to be softer than rigid is rigid
            wider = np.where(self._may_be_any[pick], np.maximum(np.abs(x), 1.0), 1.0)
            width = times[pick]
            if (np.abs(wider - width) <= AGREED * wider).all():
                break
            times[pick] = wider
        square = float(G[-1, -1] - G[pick, -1] @ x)
        sign, size = np.linalg.slogdet(inner[P:, P:] / noise)
        del sign
        beyond = 4.0 * float(np.log(width).sum())  # by the width, and for being so rare
        return Solved(pick, x, max(square, 1e-12), float(size) + beyond)

    @cached_property
    def _may_be_any(self) -> Mask:
        """(P + K,) columns whose size may lie far beyond what is usual, each decade rarer.

        Those of a foundation: a tool so soft looks like a mass that hangs elsewhere than stated.
        """
        P = self.base.shape[1]
        out = np.zeros(P + self.columns.shape[1], dtype=bool)
        for each, own in zip(self.candidates, self.slices, strict=True):
            if each.place == BaseRocking.place:
                any_size = [spec.customary is not None for spec in each.parameters]
                out[P + own.start : P + own.stop] = any_size
        return out

    def score(self, chosen: tuple[int, ...], noise: float) -> float:
        """Logarithm of the evidence, up to a constant of all models.

        Where noise is larger than stated, or not stated, it is at its likeliest size: models may be
        compared each at its own noise.
        """
        found = self.solved(chosen, noise)
        return float(self._evidence(found.square, found.volume, noise))

    def _evidence(
        self, square: float | Array, volume: float | Array, noise: float
    ) -> float | Array:
        """Logarithm of the evidence of models by what they leave and the volume of their priors."""
        if self.stated and noise <= 1.0:
            return -0.5 * (square + volume)
        return -0.5 * (self.count * (1.0 + np.log(square / self.count)) + volume)

    def joined(self, chosen: tuple[int, ...], noise: float) -> tuple[Array, Mask]:
        """(K,) scores with one more candidate each, all at once, and which of them are exact.

        Values may be negative here and no prior is widened. Where these rules would change nothing
        a score is exact; the others say where it is worth while to look. Of the chosen it is -inf.
        """
        P, pick = self.base.shape[1], self.solved(chosen, noise).pick  # without what is rigid
        G = self.whole
        inner = G[np.ix_(pick, pick)].copy()
        inner[np.diag_indices(len(pick))] += np.where(pick < P, 0.0, noise) + 1e-12
        X = np.linalg.solve(inner, G[pick, P:])
        rest = G[P:, P:] - G[P:, pick] @ X
        K = len(self.candidates)
        square, volume = np.full((2, K), np.inf)
        exact = np.zeros(K, dtype=bool)
        own = float(np.linalg.slogdet(inner[P:, P:] / noise)[1])
        low = np.full(P + self.columns.shape[1], -np.inf)
        low[P:][self.positive] = 0.0
        high = np.where(self._may_be_any, 1.0, np.inf)
        low = np.maximum(low, -high)
        widths = np.array([part.stop - part.start for part in self.slices])
        for p in set(widths.tolist()):
            which = np.flatnonzero(widths == p)
            at = np.array([self.slices[e].start for e in which])[:, None] + np.arange(p)
            block = rest[at[:, :, None], at[:, None, :]] + noise * np.eye(p)
            gap = rest[at, -1]
            new = np.linalg.solve(block, gap[:, :, None])[:, :, 0]
            square[which] = np.maximum(rest[-1, -1] - (gap * new).sum(axis=1), 1e-12)
            volume[which] = own + np.linalg.slogdet(block / noise)[1]
            old = X[:, -1] - np.einsum("nmp,mp->mn", X[:, at], new)
            exact[which] = ((old >= low[pick]) & (old <= high[pick])).all(axis=1)
            exact[which] &= ((new >= low[P + at]) & (new <= high[P + at])).all(axis=1)
        score = np.asarray(self._evidence(square, volume, noise))
        score[list(chosen)] = -np.inf
        return score, exact & (len(pick) == len(self.picked(chosen)))

    @cached_property
    def bound(self) -> Mask:
        """(K,) candidates whose scores `joined` may tell far too low: their size may be any."""
        P = self.base.shape[1]
        return np.array([bool(self._may_be_any[P:][own].any()) for own in self.slices], dtype=bool)

    def noise(self, chosen: tuple[int, ...]) -> float:
        """Variance of what a model leaves, at least the stated one.

        Numbers that err together count as fewer ones, each known as badly as all of them.
        """
        left, all_of_them = 1.0, len(self.residual) - self.base.shape[1]
        together = all_of_them / self.count
        for _ in range(3):
            spent = len(self.picked(chosen))
            left = self.solved(chosen, left).square / max(len(self.residual) - spent, 1) * together
        return max(left, together) if self.stated else left

    def gap(self, chosen: tuple[int, ...], noise: float, *, held_out: bool) -> Array:
        """(M,) whitened gap of a model, fitted, or at the parts left out one by one."""
        A = np.column_stack([self.base, self.columns])
        if not held_out:
            found = self.solved(chosen, noise)
            return np.asarray(self.residual - A[:, found.pick] @ found.x)
        gap = np.empty_like(self.residual)
        for f in range(self.folds):
            found = self.solved(chosen, noise, f)
            rows = self.fold == f
            gap[rows] = self.residual[rows] - A[np.ix_(rows, found.pick)] @ found.x
        return gap

    def left_out(self, chosen: tuple[int, ...], noise: float) -> float:
        """Sum of squares of the gap at parts left out one by one."""
        gap = self.gap(chosen, noise, held_out=True)
        return float(gap @ gap)


def everything(linear: Linear) -> tuple[Array, Array]:
    """Columns (M, P + K) of base and candidates, and inverse variances (P + K,) of their factors.

    In units of what all of them leave together. What goes from reading to reading is left out:
    beside it nothing stands that moved from a reading on, which is held against courses of time.
    """
    every = enumerate(linear.candidates)
    lasting = [e for e, each in every if not (isinstance(each, Sequential) and each.over_time)]
    noise = linear.noise(tuple(lasting))
    columns = [linear.columns[:, linear.slices[e]] for e in lasting]
    prior = [np.zeros(linear.base.shape[1]), *(np.full(each.shape[1], noise) for each in columns)]
    return np.column_stack([linear.base, *columns]), np.concatenate(prior)


@dataclass(frozen=True, eq=False)
class Solved:
    """A linear model fitted: columns that took part, their factors, what is left, prior volume."""

    pick: Index
    x: Array
    square: float
    volume: float
