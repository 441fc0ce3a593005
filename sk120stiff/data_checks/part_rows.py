"""Loads or readings in another unit, or of the other sign, in a part of the rows.

The second of two files was written in kgf, or one of two operators counts a pull as a push. The
part may be rows that follow one another, or rows here and there. Where loads are `times` as large
as stated, so are the columns of unit compliances: whatever the part, what remains to be fitted are
sums over its rows and over the others. How often a part was tried is counted against it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.special import gammaln

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.data_checks.passive import Passive, compliances, of_sums
from sk120stiff.data_checks.sheet import Sheet

KGF = 9.80665  # N, by definition
LBF = 4.4482216152605  # N, by definition
INCH = 25.4  # mm
THOUSAND = 1e3  # N of a kN, um of a mm, mm of a m
TIMES = tuple(by for one in (KGF, LBF, INCH, THOUSAND) for by in (one, 1.0 / one))
EDGES = 12  # stretches of a file between whose ends parts are tried before they are moved by rows
LEAST = 3  # rows of a part: fewer are looked at one by one, once a model is fitted
WORTH = 9.0  # of the square left per number, by which a row here and there must fit better
ROUNDS = 12  # of sorting rows here and there
SETTLED = 5  # reweightings, after which rows far off hardly count
FAINT = 0.1  # of the median that a row is off, below which all rows count alike
FREE = 0.12  # logarithm by which a factor that is free may differ from the known one
AS_GOOD = 1.1  # times what it leaves that the known one may leave
OF_ITSELF = 0.75  # share that must be explained of the part and of the other rows, each by itself


@dataclass(frozen=True)
class Way:
    """What may differ in a part of the rows.

    Attributes:
        times: Loads are so many times what is stated, -1: of the other sign; 1: see `negated`.
        negated: The column of one axis that has the other sign, or empty.
    """

    times: float = 1.0
    negated: str = ""


@dataclass(frozen=True, eq=False)
class Part:
    """Rows whose loads or readings are written otherwise than those of the others.

    Attributes:
        way: What differs.
        rows: Rows of the sheet, in use.
        found: What a passive arm explains once it is mended.
        price: Of having tried so many parts, as twice a log-likelihood.
    """

    way: Way
    rows: Index
    found: Passive
    price: float

    def mend(self, sheet: Sheet) -> Sheet:
        """The sheet with the part as the others; where readings are off, the loads are mended."""
        return _otherwise(sheet, self.way, self.rows)


def part_of_the_rows(sheet: Sheet, drives: int | None) -> Part | None:
    """The part and the way that leave least for their price; None where none is sound.

    Args:
        sheet: The readings, none left out.
        drives: Of the unit compliances only so many are asked for; None: all.
    """
    rows = np.flatnonzero(sheet.kept)
    if len(rows) < 2 * LEAST:
        return None
    plain = _Numbers.of(sheet, drives)
    best: _Tried | None = None
    for way in _ways():
        other = _changed(sheet, way, plain, drives)
        for each in (_between(plain, other), _here_and_there(plain, other)):
            if each is not None and (best is None or each.cost < best.cost):
                best = replace(each, way=way, other=other)
    if best is None or not _sound(plain, best):
        return None
    return Part(best.way, rows[best.inside], best.found, best.price)


def _ways() -> Iterator[Way]:
    yield from (Way(times) for times in (-1.0, *TIMES))
    yield from (Way(negated=name) for name in ("fx", "fy", "fz", "dx", "dy", "dz"))


def _otherwise(sheet: Sheet, way: Way, rows: Index) -> Sheet:
    wrench, displacement = sheet.wrench.copy(), sheet.displacement.copy()
    wrench[rows] *= way.times
    if way.negated:
        axis = "xyz".index(way.negated[1])
        (wrench if way.negated[0] == "f" else displacement)[rows, axis] *= -1.0
    return replace(sheet, wrench=wrench, displacement=displacement)


@dataclass(frozen=True, eq=False)
class _Numbers:
    """M rows in use: columns (M, 3, k) and readings (M, 3), zero where none was read.

    `sums` holds (k + 1, k + 1) products of columns and readings: of each row, of pairs of rows, of
    pairs of these, and so on. What is small is summed up, never left over from what is large.
    """

    columns: Array
    read: Array
    count: Array  # (M,) numbers read
    sums: tuple[Array, ...]
    by: float = 1.0  # times the columns of `sums`

    @staticmethod
    def of(sheet: Sheet, drives: int | None) -> _Numbers:
        A, d = sheet.columns()[:, :, :drives], sheet.measured
        known = np.isfinite(d)
        A, d = np.where(known[:, :, None], A, 0.0), np.where(known, d, 0.0)
        both = np.concatenate([A, d[:, :, None]], axis=2)
        sums = [np.swapaxes(both, 1, 2) @ both]
        while len(sums[-1]) > 1:
            last = sums[-1]
            pairs = len(last) // 2
            sums.append(last[0 : 2 * pairs : 2] + last[1 : 2 * pairs : 2])
        return _Numbers(A, d, known.sum(axis=1).astype(float), tuple(sums))

    def times(self, by: float) -> _Numbers:
        """The same under loads that are `by` times as large."""
        return replace(self, columns=by * self.columns, by=by * self.by)

    def between(self, first: int, last: int) -> Array:
        """(k + 1, k + 1) sum over rows first to last - 1."""
        out = np.zeros(self.sums[0].shape[1:])
        for level in self.sums:
            if first >= last:
                break
            if first % 2:
                out, first = out + level[first], first + 1
            if last % 2:
                out, last = out + level[last - 1], last - 1
            first, last = first // 2, last // 2
        by = np.full(len(out), self.by)
        by[-1] = 1.0
        return np.asarray(out * by * by[:, None])

    def off(self, c: Array) -> Array:
        """(M,) squares of what compliances leave at every row."""
        return np.asarray(((self.read - self.columns @ c) ** 2).sum(axis=1))


@dataclass(frozen=True, eq=False)
class _Tried:
    """A part, as a mask of the M rows in use, and what it leaves."""

    inside: Mask
    found: Passive
    price: float
    numbers: float
    way: Way = Way()
    other: _Numbers | None = None

    @property
    def cost(self) -> float:
        """Twice a negative log-likelihood, but for a constant."""
        return self.numbers * float(np.log(max(self.found.left, 1e-300))) + self.price


def _changed(sheet: Sheet, way: Way, plain: _Numbers, drives: int | None) -> _Numbers:
    if not way.negated:
        return plain.times(way.times)
    return _Numbers.of(_otherwise(sheet, way, np.flatnonzero(sheet.kept)), drives)


def _with(plain: _Numbers, other: _Numbers, first: int, last: int) -> Passive:
    """Fitted to the other numbers in rows first to last - 1 and to the plain ones elsewhere."""
    rows = len(plain.read)
    S = plain.between(0, first) + other.between(first, last) + plain.between(last, rows)
    return of_sums(S[:-1, :-1], S[:-1, -1], float(S[-1, -1]), int(plain.count.sum()))


def _between(plain: _Numbers, other: _Numbers) -> _Tried | None:
    """The best stretch of rows that follow one another."""
    M = len(plain.read)
    known: dict[tuple[int, int], Passive] = {}

    def left(ends: tuple[int, int]) -> float:
        first, last = ends
        if not (first >= 0 and LEAST <= last - first <= M - LEAST and last <= M):
            return np.inf
        if ends not in known:
            known[ends] = _with(plain, other, first, last)
        return known[ends].left

    edges = np.unique(np.linspace(0, M, min(EDGES, M) + 1).astype(int)).tolist()
    best = min(combinations(edges, 2), key=left)
    step = M // EDGES + 1
    while step := (step + 1) // 2 if step > 1 else 0:
        moved = True
        while moved:
            near = [
                (best[0] + by, best[1] + to)
                for by, to in ((0, 0), (step, 0), (-step, 0), (0, step), (0, -step))
            ]
            nearest = min(near, key=left)
            moved, best = nearest != best, nearest
    if not np.isfinite(left(best)):
        return None
    rows = np.arange(M)
    price = 4.0 * float(np.log(M))
    inside = (rows >= best[0]) & (rows < best[1])
    return _Tried(inside, known[best], price, float(plain.count.sum()))


def _here_and_there(plain: _Numbers, other: _Numbers) -> _Tried | None:
    """Rows sorted by whether they fit better otherwise, until no row changes."""
    best: _Tried | None = None
    for c in _starts(plain):
        inside = np.zeros(len(plain.read), dtype=bool)
        for _ in range(ROUNDS):
            own, off = plain.off(c), other.off(c)
            each = float(np.median(np.minimum(own, off) / np.maximum(plain.count, 1.0)))
            now = own - off > WORTH * each
            if (now == inside).all():
                break
            inside = now
            found, fitted = _fitted(plain, other, inside)
            if fitted is None:
                break
            c = fitted
        few = min(int(inside.sum()), int((~inside).sum()))
        if few < LEAST:
            continue
        M = len(inside)
        chosen = gammaln(M + 1) - gammaln(few + 1) - gammaln(M - few + 1)
        tried = _Tried(inside, found, 2.0 * float(chosen), float(plain.count.sum()))
        if best is None or tried.cost < best.cost:
            best = tried
    return best


def _starts(plain: _Numbers) -> Iterator[Array]:
    """Compliances by least squares, and those that rows far off hardly move."""
    weight = np.ones(len(plain.read))
    for k in range(SETTLED + 1):
        rooted = np.sqrt(weight)[:, None]
        A = (rooted[:, :, None] * plain.columns).reshape(plain.read.size, -1)
        c = compliances(A.T @ A, A.T @ (rooted * plain.read).ravel())
        if c is None:
            return
        if k in (0, SETTLED):
            yield c
        off = np.sqrt(plain.off(c))
        weight = 1.0 / np.maximum(off, max(FAINT * float(np.median(off)), 1e-300))


def _fitted(plain: _Numbers, other: _Numbers, inside: Mask) -> tuple[Passive, Array | None]:
    """What is left with the other numbers at some rows, and the compliances."""
    A = np.where(inside[:, None, None], other.columns, plain.columns).reshape(plain.read.size, -1)
    d = np.where(inside[:, None], other.read, plain.read).ravel()
    gram, along = A.T @ A, A.T @ d
    return (
        of_sums(gram, along, float(d @ d), int(plain.count.sum())),
        compliances(gram, along),
    )


def _sound(plain: _Numbers, best: _Tried) -> bool:
    """Are part and others explained each by itself, and is the known factor as good as any?"""
    other = best.other
    if other is None:
        return False
    found, c = _fitted(plain, other, best.inside)
    if c is None:
        return False
    for rows, numbers in ((best.inside, other), (~best.inside, plain)):
        size = float((numbers.read[rows] ** 2).sum())
        if float(numbers.off(c)[rows].sum()) > (1.0 - OF_ITSELF) * size:
            return False
    if best.way.negated:
        return True
    free = np.linspace(-4.0 * FREE, 4.0 * FREE, 33)
    lefts = [_fitted(plain, other.times(float(np.exp(by))), best.inside)[0].left for by in free]
    least = int(np.argmin(lefts))
    return abs(float(free[least])) < FREE or found.left < AS_GOOD * lefts[least]
