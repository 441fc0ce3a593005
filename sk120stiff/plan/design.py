"""Choosing readings from a pool: D-optimal design, greedily and then by exchange.

The information of a choice is the sum of its readings' AᵀA, on top of what is known already and of
the plausible range of every parameter (Chaloner & Verdinelli 1995): so it is regular from the first
reading on. D-optimal for some of the parameters is what makes the determinant of their own part of
the covariance least, the others free (D_s, Atkinson, Donev & Tobias 2007). After the greedy choice
poses are exchanged as long as that helps (Fedorov 1972).

Beside it stands what people do without a design: random poses, or poses spread well over the
joints' ranges. The paper's twenty were "well-spaced configurations ... determined heuristically to
cover the range of motion of all the active joints", loaded along orthogonal axes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError
from sk120stiff.model import Model
from sk120stiff.plan.pool import Pool, usable_range
from sk120stiff.plan.rig import unit

#: information (M, k, k) → what it is worth (M,); more is better
Worth = Callable[[Array], Array]

PASSES = 20
BETTER = 1e-9  # gain in worth that counts as one
DISPLACEMENT = np.sqrt(2.0)  # a displacement is two readings


@dataclass(frozen=True, eq=False)
class Design:
    """Readings chosen from a pool for the sake of some parameters.

    Attributes:
        rows: (K,) chosen candidates.
        parameters: Full names of the k parameters that count.
        std: (k,) standard errors to expect of their internal values.
        worth: Mean logarithm of the inverse of the standard errors, over their plausible ranges.
        gains: The candidates' information, for `worth_of` other choices.
        known: (P, P) information before.
    """

    rows: tuple[int, ...]
    parameters: tuple[str, ...]
    std: Array
    worth: float
    gains: Array
    known: Array
    interest: Index

    def of_rows(self, rows: Sequence[int]) -> Design:
        """The same with other rows of the pool."""
        before, total = (self.known + self.gains[list(k)].sum(axis=0) for k in (self.rows, rows))
        grown = np.diag(np.linalg.inv(total)) / np.diag(np.linalg.inv(before))
        std = self.std * np.sqrt(grown[self.interest])
        return replace(self, rows=tuple(rows), std=std, worth=self.worth_of(rows))

    def worth_of(self, rows: Sequence[int]) -> float:
        """Worth of another choice from the same pool."""
        total = self.known + self.gains[list(rows)].sum(axis=0)
        return float(determinant_worth(self.interest)(total[None])[0])

    def gain_over(self, rows: Sequence[int]) -> float:
        """Geometric mean of the standard errors of another choice, over that of this one."""
        return float(np.exp(self.worth - self.worth_of(rows)))


def d_optimal(
    model: Model,
    pool: Pool,
    *,
    count: int,
    sigma: float,
    parameters: Sequence[str] | None = None,
    known: Pool | None = None,
    loads: int | None = None,
) -> Design:
    """Choose readings that make parameters as well known as can be.

    Args:
        model: Model with its values; its free parameters are estimated, the others are known.
        pool: Candidate readings.
        count: How many to choose, each candidate at most once; with `loads` how many poses.
        loads: Loads at each of the poses; None: as may be.
        sigma: Standard uncertainty of one reading per axis [m]; a displacement has √2 of it.
        parameters: Full names of those that count, all free ones by default.
        known: Readings that were taken already.

    Raises:
        InputError: Nothing is free, a name is unknown or not free, or the pool is too small.
    """
    wanted = that_count(model, parameters)
    refuse_count(pool.pose, count, loads)
    span = plausible_sizes(model)
    noise = sigma * DISPLACEMENT
    gains = information(model, pool, span) / noise**2
    before = np.eye(len(span))
    if known is not None:
        before += information(model, known, span).sum(axis=0) / noise**2
    return best_design(
        model, wanted, gains, before, span, count, pool.pose if loads else None, loads or 1
    )


def that_count(model: Model, parameters: Sequence[str] | None) -> tuple[str, ...]:
    """Full names of the parameters that count, all free ones by default.

    Raises:
        InputError: Nothing is free, or a name is unknown or not free.
    """
    names = [model.names[k] for k in model.free]
    if not names:
        raise InputError("no parameter of the model is free", where=model.robot.name)
    wanted = tuple(dict.fromkeys(parameters or names))
    for name in wanted:
        model.parameter(name)
        if name not in names:
            raise InputError(
                f"the parameter {name!r} is fixed in the model",
                remedy="Write 'free: true' at it.",
            )
    return wanted


def best_design(
    model: Model,
    wanted: Sequence[str],
    gains: Array,
    known: Array,
    span: Array,
    count: int,
    pose: Index | None = None,
    loads: int = 1,
) -> Design:
    """The choice that makes parameters as well known as can be, see `d_optimal`.

    Args:
        model: Its P free parameters are estimated.
        wanted: Full names of those that count.
        gains: (M, P, P) information of each candidate on them over their spans.
        known: (P, P) information before, that of what is plausible in it.
        span: (P,) plausible sizes, internal.
        count, pose, loads: See `best_choice`.
    """
    names = [model.names[k] for k in model.free]
    interest = np.array([names.index(name) for name in wanted], dtype=np.intp)
    worth = determinant_worth(interest)
    rows = best_choice(worth, gains, known, count, pose, loads)
    total = known + gains[rows].sum(axis=0)
    std = np.sqrt(np.diag(np.linalg.inv(total)))[interest] * span[interest]
    reached = float(worth(total[None])[0])
    return Design(tuple(rows), tuple(wanted), std, reached, gains, known, interest)


def plausible_sizes(model: Model) -> Array:
    """(P,) beyond which values of the free parameters are implausible, internal."""
    return np.array([model.parameters[k].spec.plausible for k in model.free])


def information(model: Model, pool: Pool, span: Array) -> Array:
    """(M, P, P) AᵀA of each candidate for the free parameters over their spans [m²]."""
    _, derivative = model.predict_with_sensitivities(pool.load_cases)
    A = derivative[:, :, model.free] * span
    return np.asarray(np.einsum("mik,mil->mkl", A, A))


def determinant_worth(interest: Index) -> Worth:
    """Half the logarithm of the determinant of the information on some parameters, per parameter.

    The information on some of them is the Schur complement of the others.
    """

    def worth(total: Array) -> Array:
        others = np.setdiff1d(np.arange(total.shape[-1]), interest)
        whole = np.linalg.slogdet(total)[1]
        rest = np.linalg.slogdet(total[:, others[:, None], others])[1] if len(others) else 0.0
        return np.asarray(0.5 * (whole - rest) / len(interest))

    return worth


def refuse_count(pose: Index, count: int, loads: int | None) -> None:
    """Raise an `InputError` where so many cannot be chosen; `pose` (M,): that of each candidate."""
    if loads is None:
        if not 1 <= count <= len(pose):
            raise InputError(
                f"{count} readings cannot be chosen from {len(pose)} candidates",
                remedy="Ask for fewer, or give the rig more directions or steps.",
            )
        return
    sizes = np.sort(np.bincount(pose))[::-1]
    if count < 1 or loads < 1 or count > len(sizes) or sizes[count - 1] < loads:
        raise InputError(
            f"{count} poses with {loads} load{'s' if loads > 1 else ''} each cannot be chosen from "
            f"candidates at {len(sizes)} poses with up to {sizes[0]} loads",
            remedy="Ask for fewer, or give the rig more directions or steps.",
        )


def best_choice(
    worth: Worth,
    gains: Array,
    known: Array,
    count: int,
    pose: Index | None = None,
    loads: int = 1,
) -> list[int]:
    """Rows of `gains` (M, k, k) whose sum is worth most: greedy, then by exchange of whole poses.

    With the `pose` (M,) of each candidate, `count` poses with `loads` rows each; else single rows.
    """
    owner = np.arange(len(gains)) if pose is None else pose

    def filled(rows: list[int], total: Array, size: int) -> tuple[list[int], Array]:
        while len(rows) < size:
            found = worth(total + gains)
            pick = int(np.argmax(np.where(_open(rows, owner, count, loads), found, -np.inf)))
            rows, total = [*rows, pick], total + gains[pick]
        return rows, total

    rows, total = filled([], known, count * loads)
    reached = float(worth(total[None])[0])
    for _ in range(PASSES):
        before = reached
        for own in owner[rows]:
            kept = [row for row in rows if owner[row] != own]
            gone = [row for row in rows if owner[row] == own]
            if not gone:  # given up for another already
                continue
            tried, after = filled(kept, total - gains[gone].sum(axis=0), len(rows))
            value = float(worth(after[None])[0])
            if value > reached + BETTER:
                rows, total, reached = tried, after, value
        if reached <= before + BETTER:
            break
    return rows


def _open(rows: Sequence[int], owner: Index, count: int, loads: int) -> Mask:
    """(M,) candidates that may still join `rows`: no pose has too many, nor are there too many."""
    taken = np.bincount(owner[list(rows)], minlength=int(owner.max()) + 1)
    full = np.bincount(owner) < loads  # a pose that never can have so many loads
    good = (taken < loads) & ~full
    if np.count_nonzero(taken) >= count:
        good &= taken > 0
    open_rows = good[owner]
    open_rows[list(rows)] = False
    return np.asarray(open_rows)


def random_choice(pool: Pool, count: int, rng: np.random.Generator, loads: int = 1) -> list[int]:
    """Candidates drawn without preference: `count` poses, with so many of their loads each."""
    if loads == 1:
        return [int(k) for k in rng.choice(pool.count, count, replace=False)]
    enough = np.flatnonzero(np.bincount(pool.pose) >= loads)
    poses = rng.choice(enough, count, replace=False)
    return [
        int(row)
        for pose in poses
        for row in rng.choice(np.flatnonzero(pool.pose == pose), loads, replace=False)
    ]


def well_spread(pool: Pool, count: int, rng: np.random.Generator, loads: int = 1) -> list[int]:
    """Candidates whose poses lie far apart in the joints' ranges, loaded along x, y, z in turn.

    The first pose is random, each further one is the farthest from those before (Gonzalez 1985);
    of its loads those nearest to the axes whose turn it is count.
    """
    load_cases = pool.load_cases
    lower, upper = usable_range(load_cases.robot)
    place = (load_cases.a - lower) / np.where(upper > lower, upper - lower, 1.0)
    along = unit(load_cases.wrench[:, :3])
    enough = (np.bincount(pool.pose) >= loads)[pool.pose]
    distance = np.where(enough, np.inf, -1.0)
    pick = int(rng.choice(np.flatnonzero(enough)))
    rows: list[int] = []
    for k in range(count):
        same = np.flatnonzero(pool.pose == pool.pose[pick])
        for turn in range(loads):
            row = int(same[np.argmax(np.abs(along[same, (k + turn) % 3]))])
            rows.append(row)
            same = same[same != row]
        distance = np.minimum(distance, np.linalg.norm(place - place[pick], axis=1))
        pick = int(np.argmax(distance))
    return rows
