"""From which row on numbers are moved, beside all that may be at work.

Sums over the rows behind each serve every one (a change point of a linear model, e.g. Andrews,
Econometrica 61, 1993, p. 821). What creeps from row to row is held against it, and so is a border
in the values of any joint, which an error of the model may have.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy import linalg

from sk120stiff.arrays import Array, Index, Mask, lengths_of
from sk120stiff.effects.reading_drift import BRIEF, COURSES
from sk120stiff.identify.uncertainty.laid_out import seen_directions

HALF = 0.5  # of the square of what is left, below which a push must bring it
BEYOND_DOUBT = 10.0  # logarithm of the odds for it, after what so many rows and numbers cost
SIDE = 6  # rows at least before and after it
SPLITS = 400  # rows between which it is looked for first
ELSEWHERE = 40  # rows at which it is looked for what a change at any row takes off
MOST = 4  # pushes of one campaign
ENOUGH = 4  # times as many numbers to spare as a push would take up: fewer are fitted by anything
WORTH = 0.05  # of the gap: a push that takes off less is not spoken of
FAR = 6.0  # times what readings usually leave, beyond which a single one is wild
TAKEN = 0.85  # of the gap, below which a change at a known time is spoken of
STURDY = 5.0  # times the odds against courses of time, since errors of a model go together
CLEARER = 3.0  # times what a border in a joint's values takes off, which an error of a model may
ROUNDING = 1e-10  # added to the squares of columns of length one, which may hold each other


class Change(NamedTuple):
    """Where numbers changed.

    Attributes:
        cuts: Times from which on they are moved otherwise, in order; none: they are not.
        share: Of the rms gap that they leave.
        sure: That is beyond doubt.
        odds: Logarithm of the odds for them.
        fall: Of the square of what is left.
    """

    cuts: tuple[int, ...] = ()
    share: float = 1.0
    sure: bool = False
    odds: float = 0.0
    fall: float = 0.0


@dataclass(frozen=True, eq=False)
class Steps:
    """What M numbers leave, and when and where they were read.

    Attributes:
        columns, prior: (M, P) all that may be at work, and inverse variances (P,) of its factors.
        gap: (M,) what is left.
        frame: (M, f) columns of a place, or of whatever may have moved.
        when: (M,) times.
        joints: (M, n) joint values, over which errors of a model are smooth.
        pose: (M,) pose and axis, of which numbers err together.
        creeps: (M, c) columns of all that may creep instead.
    """

    columns: Array
    prior: Array
    gap: Array
    frame: Array
    when: Index
    joints: Array
    pose: Index
    creeps: Array

    @cached_property
    def found(self) -> Change:
        """Where a place changed, wild readings left out: see `among`."""
        return self.kept.among()

    @cached_property
    def kept(self) -> Steps:
        """The same without wild readings."""
        wild = self._wild
        if not wild.any():
            return self
        kept = ~wild
        return replace(
            self, columns=self.columns[kept], gap=self.gap[kept], frame=self.frame[kept],
            when=self.when[kept], joints=self.joints[kept],
            pose=np.unique(self.pose[kept], return_inverse=True)[1], creeps=self.creeps[kept],
        )  # fmt: skip

    @property
    def _wild(self) -> Mask:
        """(M,) numbers of single readings far off what all others leave: no place does that."""
        left, count = self._beside([]).left, np.bincount(self.when)
        size = np.sqrt(np.bincount(self.when, left**2) / np.maximum(count, 1))
        far = size > FAR * float(np.median(size[count > 0]))
        beside = np.convolve(far, [1, 1, 1], mode="same")
        alone = far & (beside < SIDE // 2)
        return np.asarray(alone[self.when] if 0 < alone.sum() < SIDE else np.zeros(len(left), bool))

    def among(self) -> Change:
        """Where a place changed; beyond doubt where half is taken off, of what evenly creeping
        would leave too, and of what a course of time would that ends, if several are its stairs.

        Less is told where no border in any joint takes off nearly as much, and no course of time.
        """
        cuts = list[int]()
        most = min(MOST, int(self.freedom / (ENOUGH * self.frame.shape[1])))
        while len(cuts) < most and (cut := self._next(cuts)) is not None:
            cuts = sorted([*cuts, cut])
        while cuts:  # the first ones may stand between others
            less = {cut: [c for c in cuts if c != cut] for cut in cuts}
            weakest = min(cuts, key=lambda cut: self.left(less[cut]))
            if self._odds(self.left(less[weakest]), self.left(cuts)) > BEYOND_DOUBT:
                break
            cuts = less[weakest]
        return self.judged([self._nearest(cuts, k) for k in range(len(cuts))])

    def fewer(self, change: Change) -> list[Change]:
        """The same changes, and those that count with the weakest of them left out."""
        out, cuts = [change], list(change.cuts)
        while len(cuts) > 1:
            less = [[c for c in cuts if c != cut] for cut in cuts]
            cuts = min(less, key=self.left)
            out.append(self.judged([self._nearest(cuts, k) for k in range(len(cuts))]))
        return [each for each in out if each.cuts]

    def once(self) -> Change:
        """The one change that takes off most, and what it brings."""
        cut = self.largest(self._beside([]), [])[1]
        return self.judged([cut]) if cut > 0 else Change()

    def judged(self, cuts: list[int]) -> Change:
        """What these changes bring; none where that is too little, see `among`."""
        if not cuts or min(np.diff(cuts), default=SIDE) < SIDE:
            return Change()  # nothing, or a wild row or a few: not a place
        before, after = self.left([]), self.left(cuts)
        share = float(np.sqrt(after / before))
        odds = self._odds(before, after, len(cuts))
        fading = [np.exp(-self.time / course) for course in (BRIEF, *COURSES)]
        courses = self.left([], creeping=[self.time, *fading])
        steady = courses if len(cuts) > 1 else self.left([], creeping=[self.time])
        if after <= HALF * min(before, steady):
            return Change(tuple(cuts), share, True, odds, before - after)
        told = share < 1.0 - WORTH and self._odds(courses, after) > STURDY * BEYOND_DOUBT
        if told and before - after > CLEARER * self.by_places:
            return Change(tuple(cuts), share, False, odds, before - after)
        return Change()

    def at(self, times: Sequence[int]) -> Change:
        """Which changes at times that are known take off what is beyond doubt."""
        cuts = list(times)
        most = int(self.freedom / (ENOUGH * self.frame.shape[1]))
        if len(cuts) > min(MOST, most):
            return Change()
        while cuts and not self._each_counts(cuts):
            less = {cut: [c for c in cuts if c != cut] for cut in cuts}
            cuts = min(less.values(), key=self.left)
        if not cuts:
            return Change()
        before, after = self.left([]), self.left(cuts)
        share = float(np.sqrt(after / before))
        if share > TAKEN:
            return Change()
        odds = self._odds(before, after, len(cuts))
        return Change(tuple(cuts), share, after <= HALF * before, odds, before - after)

    def _each_counts(self, cuts: list[int]) -> bool:
        """Does each of these changes bring more than is in doubt beside the others?"""
        whole = self.left(cuts)
        rest = (self.left([c for c in cuts if c != cut]) for cut in cuts)
        return all(self._odds(left, whole) > BEYOND_DOUBT for left in rest)

    @cached_property
    def by_places(self) -> float:
        """Fall of the square by another place beyond the best border in any joint's values."""
        best = 0.0
        for values in self.joints.T:
            ranks = np.unique(values, return_inverse=True)[1]
            beyond = replace(self, when=ranks.astype(np.intp))
            best = max(best, beyond.largest(beyond._beside([]), [])[0])
        return best

    def sizes(self, cuts: Sequence[int]) -> Array:
        """(C, f) by how much what may have moved did at each of these times."""
        fitted = self._beside(list(cuts))
        last = fitted.solution()[-len(cuts) * self.frame.shape[1] :]
        return np.asarray(last.reshape(len(cuts), -1))

    def error_of_number(self, cuts: Sequence[int]) -> float:
        """Square that one number more takes off beside these changes, where nothing happened.

        What noise leaves of each, or what an error of the model does at other rows, if that is
        more: numbers of a change fit it as well as those of any other row.
        """
        known, end = self._beside(list(cuts)), int(self.when.max()) + 1
        freedom = float(self.freedom) - len(cuts) * self.frame.shape[1]
        noise = float(known.square / max(freedom, 1.0))
        if end <= 2 * SIDE:
            return noise
        ways = np.unique(np.linspace(SIDE, end - SIDE, ELSEWHERE).astype(np.intp))
        usual = float(np.median(self._gains(known, ways, end)))
        return float(max(noise, usual / self.frame.shape[1]))

    def of_most(self, frames: Sequence[Array]) -> int:
        """Which of several (M, f) columns takes off most by one change."""
        known = self._beside([])
        return int(np.argmax([replace(self, frame=own).largest(known, [])[0] for own in frames]))

    def _odds(self, before: float, after: float, count: int = 1) -> float:
        """Logarithm of the odds for so many times more that leave `after` of a square `before`."""
        cost = 0.5 * self.frame.shape[1] * np.log(len(self.gap)) + np.log(int(self.when.max()) + 1)
        return float(0.5 * self.freedom * np.log(before / after) - count * cost)

    @property
    def time(self) -> Array:
        """(M,) from 0 at the first reading to 1 at the last."""
        return np.asarray(self.when / max(self.when.max(), 1))

    @cached_property
    def freedom(self) -> float:
        """Independent numbers beyond what all that may be at work takes up.

        Those of one pose that err together count less, by the design effect of their intraclass
        correlation (Kish 1965).
        """
        alone = self._beside([])
        inverse = linalg.cho_solve(alone.factor, np.eye(alone.columns.shape[1]))
        taken = float(np.trace(inverse @ (alone.columns.T @ alone.columns)))
        count = np.bincount(self.pose).astype(float)
        pairs = float((count * (count - 1.0)).sum())
        together = np.bincount(self.pose, alone.left)
        square = float(alone.left @ alone.left)
        alike = (together @ together - square) / max(square / len(self.gap) * pairs, 1e-300)
        design = 1.0 + float(np.clip(alike, 0.0, 1.0)) * pairs / len(self.gap)
        return (len(self.gap) - taken) / design

    def _beside(self, cuts: list[int], *, creeping: Sequence[Array] = ()) -> Fitted:
        """All that may be at work and these changes, fitted."""
        known = [self.frame * (self.when >= cut)[:, None] for cut in cuts]
        known += [self.creeps * course[:, None] for course in creeping]
        A = np.concatenate([self.columns, *known], axis=1)
        prior = np.concatenate([self.prior, np.zeros(A.shape[1] - len(self.prior))])
        size = lengths_of(A)
        A, prior = A[:, size > 0.0] / size[size > 0.0], prior[size > 0.0] / size[size > 0.0] ** 2
        H = linalg.cho_factor(A.T @ A + np.diag(prior + ROUNDING))
        x = linalg.cho_solve(H, A.T @ self.gap)
        left = self.gap - A @ x
        return Fitted(A, H, left, max(float(self.gap @ left), 1e-300), x, size)

    def left(self, cuts: list[int], *, creeping: Sequence[Array] = ()) -> float:
        """Square that is left beside these changes and courses of time."""
        return self._beside(cuts, creeping=creeping).square

    def _nearest(self, cuts: list[int], k: int) -> int:
        """The best time near one of them, with the others as they are."""
        others = [cut for cut in cuts if cut != cuts[k]]
        near = range(max(cuts[k] - SIDE, 1), min(cuts[k] + SIDE, int(self.when.max())) + 1)
        return min(near, key=lambda cut: self.left(sorted([*others, cut])))

    def _next(self, cuts: list[int]) -> int | None:
        """The change that takes off most beside those that are known, if it is beyond doubt."""
        known = self._beside(cuts)
        fall, cut = self.largest(known, cuts)
        after = max(known.square - fall, 1e-12 * known.square)
        return cut if self._odds(known.square, after) > BEYOND_DOUBT else None

    def largest(self, known: Fitted, cuts: list[int]) -> tuple[float, int]:
        """The largest fall of the square by one change more, and its time."""
        end = int(self.when.max()) + 1
        best: tuple[float, int] = 0.0, -1
        for begin, stop in zip([0, *cuts], [*cuts, end], strict=True):
            if stop - begin < 2 * SIDE:
                continue
            ways = np.unique(np.linspace(begin + SIDE, stop - SIDE, SPLITS).astype(int))
            near = ways[int(np.argmax(self._gains(known, ways, stop)))]
            wide = int(np.diff(ways).max(initial=1))
            ways = np.arange(max(near - wide, begin + SIDE), min(near + wide, stop - SIDE) + 1)
            gains = self._gains(known, ways, stop)
            best = max(best, (float(gains.max()), int(ways[int(np.argmax(gains))])))
        return best

    def _gains(self, known: Fitted, ways: Index, stop: int) -> Array:
        """(K,) fall of the square by another place from each of these times on, until `stop`."""
        A, F, f = known.columns, self.frame, self.frame.shape[1]
        edges, out = [*ways.tolist(), stop], np.zeros(len(ways))
        b, G, C = np.zeros(f), np.zeros((f, f)), np.zeros((A.shape[1], f))
        for k in range(len(ways) - 1, -1, -1):
            own = (self.when >= edges[k]) & (self.when < edges[k + 1])
            b, G = b + F[own].T @ known.left[own], G + F[own].T @ F[own]
            C = C + A[own].T @ F[own]
            out[k] = _fall(b, G - C.T @ linalg.cho_solve(known.factor, C))
        return out


@dataclass(frozen=True, eq=False)
class Fitted:
    """Columns (M, Q), the factor of their products, what is left (M,), and its penalised square.

    Attributes:
        scaled: (Q,) values of the columns, which are of length one.
        size: (P,) length of every column before, those of nothing included.
    """

    columns: Array
    factor: tuple[Array, bool]
    left: Array
    square: float
    scaled: Array
    size: Array

    def solution(self) -> Array:
        """(P,) values of the columns as they were given."""
        out = np.zeros(len(self.size))
        out[self.size > 0.0] = self.scaled / self.size[self.size > 0.0]
        return out


def _fall(b: Array, S: Array) -> float:
    """bᵀ S⁻¹ b along what S shows."""
    size, values, vectors = seen_directions(S, 1e-8)
    along = vectors.T @ (b / size)
    return float(along**2 @ (1.0 / values))
