"""Which further causes what a calibration leaves asks for, judged beside one another.

Whatever a model lacks, something in it or near it fits a part: waves of a gear take the bending of
a link for theirs, and springs both. So a cause counts for what it brings beside all others that
what is left asks for, and not for what it brings alone: forward by the BIC over the whole
catalogue, and backward. What it brings must show at poses left out, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index, Mask, lengths_of
from sk120stiff.effects import Catalogue, Effect, LoadError, Sequential, referred
from sk120stiff.identify.checks.left_over import beside, orthonormal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.noise.sizes import of_poses
from sk120stiff.identify.positions.omitted.nuisances import COUNTED
from sk120stiff.identify.positions.omitted.other_causes import causes_at, slopes
from sk120stiff.measurements.poses import rows_by_label

CLEAR = 6.0  # by which the BIC must fall
MOST = 12  # causes that are looked at beside one another
ROUNDING = 1e-9  # of the largest singular value, below which what is estimated does not show
SMALL = 1e-6  # of the largest singular value, below which a direction is none
SURE = 2.5  # standard errors of the gain at poses left out


@dataclass(frozen=True, eq=False)
class Blocks:
    """Whitened columns of further causes, what the fit estimates already taken out.

    Attributes:
        causes: The causes.
        columns: (M, p) of each, per usual size of its parameters.
        whole: (M, p) the same with what the fit estimates in it.
        positive: (p,) of each: parameters that cannot be negative.
        base: (M, P) orthonormal columns of what the fit estimates.
        residual: (M,) what is left.
        pose: (M,) pose of each number.
    """

    causes: tuple[Effect, ...]
    columns: tuple[Array, ...]
    whole: tuple[Array, ...]
    positive: tuple[Mask, ...]
    base: Array
    residual: Array
    pose: Index

    @classmethod
    def of(
        cls,
        found: Fit,
        catalogue: Catalogue,
        wanted: Callable[[Effect], bool] = lambda _cause: True,
    ) -> Blocks:
        """Of all causes that may be at work and show, but for errors of what is counted anyhow."""
        problem, model = of_poses(found), found.model
        present = [effect.id for effect in model.effects]
        every = causes_at(model.robot, problem.load_cases, problem.measurements, present, catalogue)
        references = problem.load_cases.references
        every = tuple(
            referred(x, references) for x in every if wanted(x) and not isinstance(x, COUNTED)
        )
        slope = slopes(problem, model, every)
        Q = orthonormal(found.jacobian, ROUNDING)
        white = problem.of_channels.apply
        whole = {each: white(slope[each] * [s.usual for s in each.parameters]) for each in every}
        parts = {each: beside(Q, whole[each]) for each in every}
        shown = tuple(each for each in every if parts[each].any())
        return cls(
            shown,
            tuple(parts[each] for each in shown),
            tuple(whole[each] for each in shown),
            tuple(np.array([s.lower == 0.0 for s in each.parameters]) for each in shown),
            Q,
            found.residual,
            problem.pose_of_channels,
        )

    def beside_loads(self, unit: float) -> tuple[Array, Array]:
        """Columns (M, P + K) of estimates and of errors of loads, and their inverse variances.

        Payloads are hung one after the other: what is wrong of one begins at a row.

        Args:
            unit: What is left, which the variances are in units of.
        """
        return self._with(unit, [isinstance(cause, LoadError) for cause in self.causes])

    def beside_all(self, unit: float) -> tuple[Array, Array]:
        """The same of estimates and of all causes that may be at work, but for what goes from
        reading to reading: beside it nothing stands that moved from a reading on.
        """
        lasting = [not (isinstance(each, Sequential) and each.over_time) for each in self.causes]
        return self._with(unit, lasting)

    def _with(self, unit: float, wanted: Sequence[bool]) -> tuple[Array, Array]:
        whole = [each for each, own in zip(self.whole, wanted, strict=True) if own]
        prior = [np.zeros(self.base.shape[1])]
        prior += [np.full(each.shape[1], unit**2) for each in whole]
        return np.hstack([self.base, *whole]), np.concatenate(prior)

    def asked_for(self) -> list[int]:
        """Causes that lower the BIC clearly, one after the other, each beside all others."""
        count, spent, chosen = len(self.residual), self.base.shape[1], list[int]()
        score = self.bic(())
        while len(chosen) < min(MOST, len(self.causes)):
            rest = [k for k in range(len(self.causes)) if k not in chosen]
            tried = {k: self.bic((*chosen, k)) for k in rest}
            best = min(rest, key=lambda k: tried[k])
            spent += self.columns[best].shape[1]
            if tried[best] > score - CLEAR or 2 * spent > count:
                break
            chosen.append(best)
            score = tried[best]
        return self.at_least(CLEAR, chosen)

    def at_least(self, gain: float, chosen: Sequence[int]) -> list[int]:
        """Those without which the BIC rises by so much, the weakest gone one after the other."""
        kept = list(chosen)
        while kept:
            loss = self.losses(kept)
            weakest = min(kept, key=lambda k: loss[k])
            if loss[weakest] >= gain:
                break
            kept.remove(weakest)
        return kept

    def losses(self, chosen: Sequence[int]) -> dict[int, float]:
        """By how much the BIC rises without each of the chosen."""
        whole = self.bic(chosen)
        return {k: self.bic([c for c in chosen if c != k]) - whole for k in chosen}

    def sure_of(self, k: int, chosen: Sequence[int]) -> bool:
        """Are poses left out foretold better with one of the chosen, by more than chance?

        Squares fall by 2 a d + d², where a is left and d was taken off; the error is that of the
        first term over poses.
        """
        after = self._at_poses_left_out(chosen)
        taken = self._at_poses_left_out([c for c in chosen if c != k]) - after
        saved = float(((2.0 * after + taken) * taken).sum())
        error = 2.0 * float(np.linalg.norm(np.bincount(self.pose, after * taken)))
        return saved > SURE * error

    def bic(self, chosen: Sequence[int]) -> float:
        """Of these causes together."""
        A, free = self._columns(chosen), len(self.residual) - self.base.shape[1]
        left = self.residual - A @ (A.T @ self.residual)
        square = max(float(left @ left), 1e-300)
        return float(free * np.log(square) + A.shape[1] * np.log(len(self.residual)))

    def _columns(self, chosen: Sequence[int]) -> Array:
        """(M, r) orthonormal columns of causes; what would be softer than rigid is rigid."""
        A = np.concatenate(
            [np.zeros((len(self.residual), 0)), *(self.columns[k] for k in chosen)], axis=1
        )
        positive = np.concatenate([np.zeros(0, bool), *(self.positive[k] for k in chosen)])
        while True:
            size = lengths_of(A)
            A, positive = A[:, size > 0.0] / size[size > 0.0], positive[size > 0.0]
            U, told, V = np.linalg.svd(A, full_matrices=False)
            kept = told > SMALL * told.max(initial=0.0)
            weights = V[kept].T @ ((U[:, kept].T @ self.residual) / told[kept])
            wrong = positive & (weights < 0.0)
            if not wrong.any():
                return np.asarray(U[:, kept])
            A, positive = A[:, ~wrong], positive[~wrong]

    def _at_poses_left_out(self, chosen: Sequence[int]) -> Array:
        """(M,) the gap at every pose of a fit to all others."""
        U = np.column_stack([self.base, self._columns(chosen)])
        gap = self.residual - U @ (U.T @ self.residual)
        out = np.empty_like(gap)
        for rows in rows_by_label(self.pose):
            own = np.eye(len(rows)) - U[rows] @ U[rows].T
            out[rows] = np.linalg.lstsq(own, gap[rows], rcond=SMALL)[0]
        return out
