"""A tracker that was pushed, or a marker that slipped, in the middle of a campaign.

From every row on another place of either is tried beside all that the model has, by sums over the
rows behind it (a change point of a linear model, e.g. Andrews, Econometrica 61, 1993, p. 821). It
counts where the square of what is left halves: no smooth error of a model does that at one row,
since poses before and behind it are alike. What creeps from row to row instead is no push.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg

from sk120stiff.arrays import Array, Index, lengths_of
from sk120stiff.effects import Viewpoint
from sk120stiff.effects.geometry import ToolOffset
from sk120stiff.effects.reading_drift import BRIEF, COURSES
from sk120stiff.errors import InputError, listed, two_digits
from sk120stiff.identify.absolute.pose_problem import PoseProblem
from sk120stiff.identify.absolute.repeated import cells_of_numbers
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.uncertainty.laid_out import seen_directions
from sk120stiff.measurements import Measurements

HALF = 0.5  # of the square of what is left, below which a push must bring it
BEYOND_DOUBT = 10.0  # logarithm of the odds for it, after what so many rows and numbers cost
SIDE = 6  # rows at least before and after it
SPLITS = 400  # rows between which it is looked for first
MOST = 4  # pushes of one campaign
ENOUGH = 4  # times as many numbers to spare as a push would take up: fewer are fitted by anything
WORTH = 0.05  # of the gap: a push that takes off less is not spoken of
STURDY = 5.0  # times the odds against courses of time, since errors of a model go together
CLEARER = 3.0  # times what a border in a joint's values takes off, which an error of a model may
ROUNDING = 1e-10  # added to the squares of columns of length one, which may hold each other


@dataclass(frozen=True)
class _Cause:
    """What was moved, the column that tells when, and what each of its labels has."""

    what: str
    column: str
    own: str


PUSHED = _Cause("the tracker", "station", "a frame of its own")
SLIPPED = _Cause("the marker", "series", "a place of its own on the tool")


def refuse_pushed(
    found: Fit, readings: Measurements, others: Array, prior: Array
) -> tuple[str, ...]:
    """Stop where the tracker was pushed, or its marker slipped, and the file tells nothing of it.

    Where an error of the model might still be mistaken for it, a sentence says what it looks like.

    Args:
        found: A fit whose tracker has a frame.
        readings: Where they come from.
        others: (M, P) whitened columns of all that may be at work.
        prior: (P,) inverse variances of their factors, in units of what is left.

    Raises:
        InputError: It was, between lines that the message tells.
    """
    problem = found.problem
    if not isinstance(problem, PoseProblem) or "distance" in problem.channels.present:
        return ()
    when, a = _when(problem.measurements), problem.measurements.joints
    frames = {
        PUSHED: [k for k, p in enumerate(found.parameters) if isinstance(p.effect, Viewpoint)],
        SLIPPED: [k for k, p in enumerate(found.parameters) if isinstance(p.effect, ToolOffset)],
    }
    pose = cells_of_numbers(problem, problem.measurements.pose_index[:, None])
    told = {PUSHED: problem.said.stations, SLIPPED: problem.said.series}
    tried = {
        cause: _Steps(
            others,
            prior,
            found.residual,
            found.jacobian[:, columns],
            when[problem.rows],
            a[problem.rows],
            pose,
        ).found()
        for cause, columns in frames.items()
        if columns and told[cause] is None
    }
    cause = min(tried, key=lambda each: tried[each][1], default=PUSHED)
    cuts, share, sure = tried.get(cause, ([], 1.0, False))
    if not cuts:
        return ()
    order, line = np.argsort(when), problem.measurements.line
    between = [f"{line[order[k - 1]]} and {line[order[k]]}" for k in cuts]
    looks = (
        f"{cause.what} looks moved between lines {listed(between)}: with another place from there "
        f"on the gap falls to {two_digits(100.0 * share)} % of what all else leaves"
    )
    remedy = (
        f"Add a column {cause.column} with a label for each time between, as a and b: each has "
        f"{cause.own} then, and the arm is one. Or one label for all, if nothing was moved."
    )
    if sure:
        raise InputError(looks, where=readings.place, remedy=remedy)
    return (f"{looks[0].upper()}{looks[1:]}. {remedy}",)


def _when(readings: Measurements) -> Index:
    """(N,) place of each row in the order in which they were read, which is that of the file."""
    clock = readings.order if readings.order is not None else readings.time
    rows = np.arange(readings.n_readings) if clock is None else clock
    return np.asarray(np.argsort(np.argsort(rows, kind="stable"), kind="stable"), dtype=np.intp)


@dataclass(frozen=True, eq=False)
class _Steps:
    """What M numbers leave, and when and where they were read.

    Attributes:
        columns, prior: (M, P) all that may be at work, and inverse variances (P,) of its factors.
        gap: (M,) what is left.
        frame: (M, f) columns of a place.
        when: (M,) times.
        joints: (M, n) joint values, over which errors of a model are smooth.
        pose: (M,) pose and axis, of which numbers err together.
    """

    columns: Array
    prior: Array
    gap: Array
    frame: Array
    when: Index
    joints: Array
    pose: Index

    def found(self) -> tuple[list[int], float, bool]:
        """Times at which a place changed, in order, the share of the rms gap that they leave, and
        whether that is beyond doubt: half is taken off, of what evenly creeping would leave too.

        Less is told where no border in any joint takes off nearly as much, and no course of time.
        """
        cuts = list[int]()
        most = min(MOST, int(self.freedom / (ENOUGH * self.frame.shape[1])))
        while len(cuts) < most and (cut := self._next(cuts)) is not None:
            cuts = sorted([*cuts, cut])
        while cuts:  # the first ones may stand between others
            less = {cut: [c for c in cuts if c != cut] for cut in cuts}
            weakest = min(cuts, key=lambda cut: self._left(less[cut]))
            if self._odds(self._left(less[weakest]), self._left(cuts)) > BEYOND_DOUBT:
                break
            cuts = less[weakest]
        if not cuts:
            return [], 1.0, False
        cuts = [self._nearest(cuts, k) for k in range(len(cuts))]
        before, after = self._left([]), self._left(cuts)
        share = float(np.sqrt(after / before))
        if after <= HALF * min(before, self._left([], creeping=[self.time])):
            return cuts, share, True
        fading = [np.exp(-self.time / course) for course in (BRIEF, *COURSES)]
        courses = self._left([], creeping=[self.time, *fading])
        told = share < 1.0 - WORTH and self._odds(courses, after) > STURDY * BEYOND_DOUBT
        if told and before - after > CLEARER * self._by_places():
            return cuts, share, False
        return [], 1.0, False

    def _by_places(self) -> float:
        """Fall of the square by another place beyond the best border in any joint's values."""
        best = 0.0
        for values in self.joints.T:
            ranks = np.unique(values, return_inverse=True)[1]
            beyond = replace(self, when=ranks.astype(np.intp))
            best = max(best, beyond.largest(beyond._beside([]), [])[0])
        return best

    def _odds(self, before: float, after: float) -> float:
        """Logarithm of the odds for one time more, which leaves a square `after` of `before`."""
        cost = 0.5 * self.frame.shape[1] * np.log(len(self.gap)) + np.log(int(self.when.max()) + 1)
        return float(0.5 * self.freedom * np.log(before / after) - cost)

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

    def _beside(self, cuts: list[int], *, creeping: Sequence[Array] = ()) -> _Fitted:
        """All that may be at work and these changes, fitted."""
        known = [self.frame * (self.when >= cut)[:, None] for cut in cuts]
        known += [self.frame * course[:, None] for course in creeping]
        A = np.concatenate([self.columns, *known], axis=1)
        prior = np.concatenate([self.prior, np.zeros(A.shape[1] - len(self.prior))])
        size = lengths_of(A)
        A, prior = A[:, size > 0.0] / size[size > 0.0], prior[size > 0.0] / size[size > 0.0] ** 2
        H = linalg.cho_factor(A.T @ A + np.diag(prior + ROUNDING))
        left = self.gap - A @ linalg.cho_solve(H, A.T @ self.gap)
        return _Fitted(A, H, left, max(float(self.gap @ left), 1e-300))

    def _left(self, cuts: list[int], *, creeping: Sequence[Array] = ()) -> float:
        return self._beside(cuts, creeping=creeping).square

    def _nearest(self, cuts: list[int], k: int) -> int:
        """The best time near one of them, with the others as they are."""
        others = [cut for cut in cuts if cut != cuts[k]]
        near = range(max(cuts[k] - SIDE, 1), min(cuts[k] + SIDE, int(self.when.max())) + 1)
        return min(near, key=lambda cut: self._left(sorted([*others, cut])))

    def _next(self, cuts: list[int]) -> int | None:
        """The change that takes off most beside those that are known, if it is beyond doubt."""
        known = self._beside(cuts)
        fall, cut = self.largest(known, cuts)
        after = max(known.square - fall, 1e-12 * known.square)
        return cut if self._odds(known.square, after) > BEYOND_DOUBT else None

    def largest(self, known: _Fitted, cuts: list[int]) -> tuple[float, int]:
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

    def _gains(self, known: _Fitted, ways: Index, stop: int) -> Array:
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
class _Fitted:
    """Columns (M, Q), the factor of their products, what is left (M,), and its penalised square."""

    columns: Array
    factor: tuple[Array, bool]
    left: Array
    square: float


def _fall(b: Array, S: Array) -> float:
    """bᵀ S⁻¹ b along what S shows."""
    size, values, vectors = seen_directions(S, 1e-8)
    along = vectors.T @ (b / size)
    return float(along**2 @ (1.0 / values))
