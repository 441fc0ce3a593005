"""Slips of the pen in positions: what is left with each one mended."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations, product

import numpy as np
from scipy.optimize import minimize_scalar

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import listed
from sk120stiff.measurements.placing.cloud import Cloud
from sk120stiff.measurements.placing.registration import register
from sk120stiff.measurements.table.angle_units import mixed

MARKERS = 4  # up to which every exchange of markers is tried
BETTERED = 0.9  # of what is left, that one change of a convention must fall below
SIDE = 6  # rows at least before and after the tracker moved
SPLITS = 16  # rows between which that is looked for first
WHOLE = 2  # joints of whose ways all are kept, since the wrist tells little of them
ROUGHLY = 1.5  # times what is left, up to which a convention may be the one: few poses tell them
KEPT = 32  # of the ways of the joints so far that are followed
SLACK = 0.02  # rad or m; a joint may go so far beyond what its URDF states
NEARLY = 1e-3  # of what is left, by which a marker may still move where ways are compared
PARALLEL = 0.999  # cosine between the axes of joints that turn in one plane
ZEROS = np.linspace(-np.pi, np.pi, 72, endpoint=False)  # rad; zeros of a joint tried first
SAGGED = np.radians(0.25)  # rad from a quarter turn that sag makes of one
FINE = 1e-5  # rad, to which one is found
ONE_COLUMN = "The column of"
MIRRORED = "mirrored: one axis has the other sign, or two axes are swapped"
TIMES = (1.0, -1.0, 2.0, -2.0)  # another joint's share in a sum, and in one of the wrong sign


def slips(cloud: Cloud, names: tuple[str, ...]) -> Iterator[tuple[float, float, str, str]]:
    """What is left with one slip mended, what it is, and the remedy."""
    turning = ~np.array(cloud.robot.prismatic)

    def left(a: Array = cloud.a, x: Array = cloud.x) -> float:
        return replace(cloud, a=a, x=x).placed(fit_marker=True, until=NEARLY)[0].rms

    for factor, was, unit in (
        (np.pi / 180.0, "degrees, not radians", "deg"),
        (180.0 / np.pi, "radians, not degrees", "rad"),
    ):
        a = np.where(turning, cloud.a * factor, cloud.a)
        rms = left(a=a)
        said = f"The joint angles look like {was}"
        yield rms, rms, said, f"Write [{unit}] in their headers."
        for k in np.flatnonzero(turning):
            a = cloud.a.copy()
            a[:, k] *= factor
            rms = left(a=a)
            said = f"{ONE_COLUMN} {names[k]} looks like {was}"
            yield rms, rms, said, f"Write [{unit}] in its header."
    for some, factor, meant, written in mixed(cloud.a, turning):
        if len(some) < 2:
            continue  # tried above
        a = cloud.a.copy()
        a[:, some] *= factor
        rms = left(a=a)
        said = f"The columns of {listed([names[k] for k in some])} look like {meant}, not {written}"
        remedy = f"Write [{meant}] in their headers, and [{written}] in those of the others."
        yield rms, rms, said, remedy
    for factor, unit in ((1e-3, "mm"), (1e3, "m"), (0.0254, "in"), (25.4, "in"), (1e-6, "um")):
        rms = left(x=cloud.x * factor)
        size = f"{factor:g} times too small" if factor > 1 else f"{1 / factor:g} times too large"
        yield (
            rms / factor,
            rms,
            f"The positions look {size}, as if in another unit",
            f"Check the unit of x, y, z: {unit}?",
        )
    rms = left(x=cloud.x * np.array([-1.0, 1.0, 1.0]))
    yield (
        rms,
        rms,
        f"The positions look {MIRRORED}",
        "Check signs and order of x, y, z: the tracker's axes are right-handed.",
    )
    for i, j in combinations(range(len(names)), 2):
        a = cloud.a.copy()
        a[:, [i, j]] = a[:, [j, i]]
        rms = left(a=a)
        said = f"The columns of {names[i]} and {names[j]} look exchanged"
        yield rms, rms, said, "Put the right names over the columns."
    yield from markers(cloud)


def moved_at(cloud: Cloud) -> tuple[float, int] | None:
    """What is left if the tracker moved once between two rows [m], and the first row after it.

    None where too few rows are on either side, or stations are told.
    """
    if len(cloud.x) < 2 * SIDE or cloud.station.any():
        return None

    def split(row: int) -> Cloud:
        return replace(cloud, station=(np.arange(len(cloud.x)) >= row).astype(np.intp))

    best = _best_row(len(cloud.x), lambda row: _mean_left(split(row)))
    return split(best).placed(fit_marker=True, until=NEARLY)[0].rms, best


def shifted_at(cloud: Cloud, by: int) -> tuple[float, int] | None:
    """What is left if positions from a row on belong to the joints `by` rows on [m], and that row.

    None where there are too few rows.
    """
    count = len(cloud.x)
    if count < 2 * SIDE or cloud.station.any():
        return None

    def paired(row: int) -> Cloud:
        rows = np.arange(count)
        of = rows + by * (rows >= row)
        kept = (of >= 0) & (of < count) & ((rows < row) | (of >= row) | (by > 0))
        return replace(
            cloud, a=cloud.a[of[kept]], x=cloud.x[kept], point=cloud.point[kept],
            marker=cloud.marker[kept], group=cloud.group[kept], station=cloud.station[kept],
        )  # fmt: skip

    best = _best_row(count, lambda row: _mean_left(paired(row)), first=0)
    return paired(best).placed(fit_marker=True, until=NEARLY)[0].rms, best


def _best_row(count: int, left: Callable[[int], float], *, first: int = SIDE) -> int:
    """The row at which least is left, from coarse to fine."""
    rows: list[int] = np.unique(np.linspace(first, count - SIDE, SPLITS).astype(int)).tolist()
    best, step = min(rows, key=left), -(-count // SPLITS)
    while step > 0:
        near = [r for r in (best - step, best, best + step) if first <= r <= count - SIDE]
        best, step = min(near, key=left), step // 2
    return best


def _mean_left(cloud: Cloud) -> float:
    """Mean distance that is left over all rows, wild ones too [m]."""
    screws = cloud.robot.screws(cloud.a)
    found = register(
        cloud.x, screws.frame_position, screws.rotation, cloud.point,
        group=cloud.group, station=cloud.station, until=NEARLY,
    )  # fmt: skip
    return np.inf if found is None else float(found.distance.mean())


def markers(cloud: Cloud) -> Iterator[tuple[float, float, str, str]]:
    """Names of markers exchanged: all ways of a few, pairs of many."""
    kinds, first = np.unique(cloud.marker, return_index=True)
    place, count = cloud.point[first], len(kinds)
    ways = permutations(range(count)) if count <= MARKERS else _pairs(count)
    for way in ways:
        moved = [k for k in range(count) if way[k] != k]
        if not moved:
            continue
        point = cloud.point.copy()
        for k in moved:
            point[cloud.marker == kinds[k]] = place[way[k]]
        rms = replace(cloud, point=point).placed(fit_marker=True, until=NEARLY)[0].rms
        yield (
            rms,
            rms,
            f"{len(moved)} markers look exchanged: what is written as "
            + ", ".join(f"{kinds[k]} is {kinds[way[k]]}" for k in moved),
            "Check the column marker against points.",
        )


def _pairs(count: int) -> Iterator[tuple[int, ...]]:
    for i, j in combinations(range(count), 2):
        way = list(range(count))
        way[i], way[j] = j, i
        yield tuple(way)


@dataclass(frozen=True, eq=False)
class Convention:
    """How joints follow from columns: a = share q + zero.

    Attributes:
        rms: What is left with it [m].
        share: (n, n) of the columns in each joint.
        zero: (n,) [rad].
        others: Those that leave nearly as little, the least odd first.
    """

    rms: float
    share: Array
    zero: Array
    others: tuple[Convention, ...] = ()

    def of(self, share: Array, zero: Array) -> Convention:
        """The same of what the columns are made of, (n, m) shares of others and (n,) zeros."""
        return replace(
            self,
            share=self.share @ share,
            zero=self.share @ zero + self.zero,
            others=tuple(other.of(share, zero) for other in self.others),
        )

    def expressions(self, columns: Sequence[str], slides: Sequence[bool] = ()) -> list[str]:
        """``-A2 + 90 deg``: every joint by names of the columns; `slides` (n,) those in metres."""
        out = []
        for k, (own, zero) in enumerate(zip(self.share, self.zero, strict=True)):
            if k < len(slides) and slides[k]:
                told = f" {'-' if zero < 0 else '+'} {abs(zero):g} m" if zero else ""
                out.append(_expression(own, columns) + told)
                continue
            degrees = (np.degrees(zero) + 180.0) % 360.0 - 180.0
            shown = f"{round(abs(degrees), 2):g}"
            constant = f" {'-' if degrees < 0 else '+'} {shown} deg" if float(shown) else ""
            out.append(_expression(own, columns) + constant)
        return out

    def changed(self, names: Sequence[str]) -> dict[str, str]:
        """Joints that are not the columns of their names → what they are."""
        told = zip(names, self.expressions(names), strict=True)
        return {name: expression for name, expression in told if name != expression}


def signs_and_turns(cloud: Cloud, *, floor: bool = False) -> Convention:
    """The best signs and zeros (quarter turns), of all joints together, from the base outwards.

    One joint mended alone need not bring anything where others are wrong too, as between a
    controller's joints and those of a URDF. The nearest few ways of the joints so far are kept
    (beam search), the wrist as it stands until its turn comes. Where the first joint and the last
    have their zeros, tracker and marker take on.

    Args:
        cloud: Positions and joint columns.
        floor: A joint that turns in one plane with the one before it may be measured against the
            floor, too.
    """
    n = cloud.a.shape[1]
    turning = ~np.array(cloud.robot.prismatic)
    sums = _in_one_plane(cloud) if floor else np.zeros(n, dtype=bool)
    ways: list[tuple[Array, Array]] = [(np.eye(n), np.zeros(n))]
    for k in range(n):
        turns = (0, 1, -1, 2) if turning[k] and 0 < k < n - 1 else (0,)
        others = (0.0, 1.0, -1.0) if sums[k] else (0.0,)
        wider = []
        for (share, zero), sign, turn, other in product(ways, (1.0, -1.0), turns, others):
            own = share.copy(), zero.copy()
            own[0][k, k], own[1][k] = sign, turn * np.pi / 2
            if other:
                own[0][k, k - 1] = other
            wider.append(own)
        ranked = [
            (float(f"{rms:.3g}"), oddness(cloud, *own), own)
            for rms, own in zip(_left(cloud, wider), wider, strict=True)
        ]
        ranked.sort(key=lambda item: item[:2])
        ways = [own for *_, own in (ranked if k < WHOLE else ranked[:KEPT])]
    left = _left(cloud, ways)
    best, *rest = [Convention(r, *way) for r, way in zip(left, ways, strict=True)]
    close = [way for way in rest if way.rms < ROUGHLY * best.rms]
    close.sort(key=lambda way: (*oddness(cloud, way.share, way.zero), way.rms))
    return replace(best, others=tuple(close))


def nearer(cloud: Cloud, way: Convention) -> Convention:
    """The convention with signs and zeros sought once more about it, where that leaves less."""
    joints = cloud.a @ way.share.T + way.zero
    again = signs_and_turns(replace(cloud, a=joints)).of(way.share, way.zero)
    return again if again.rms < BETTERED * way.rms else way


def to_the_floor(cloud: Cloud) -> Convention:
    """The best signs, zeros and sums with the joint before, see `signs_and_turns`."""
    return signs_and_turns(cloud, floor=True)


def _in_one_plane(cloud: Cloud) -> Mask:
    """(n,) joints that turn about the direction about which the one before them turns."""
    robot, n = cloud.robot, cloud.a.shape[1]
    turned = robot.screws(cloud.a[:1]).axes[0]
    names = list(robot.mechanism().chain.names)
    axes = [turned[names.index(name)] if name in names else None for name in robot.actuated]
    out = np.zeros(n, dtype=bool)
    for k in range(1, n):
        one, two = axes[k - 1], axes[k]
        turns = not (robot.prismatic[k - 1] or robot.prismatic[k])
        out[k] = turns and one is not None and two is not None and abs(one @ two) > PARALLEL
    return out


def one_zero(cloud: Cloud) -> Convention:
    """The best zero of one joint, by whatever angle it is off, where all else is as it stands."""
    n = cloud.a.shape[1]

    def left(k: int, *angles: float) -> list[float]:
        return _left(cloud, [(np.eye(n), angle * np.eye(n)[k]) for angle in angles])

    best, joint, zero = np.inf, 0, 0.0
    for k in np.flatnonzero(~np.array(cloud.robot.prismatic)).tolist():
        tried = left(k, *ZEROS)
        near = int(np.argmin(tried))
        if tried[near] < best:
            best, joint, zero = tried[near], k, float(ZEROS[near])
    step = float(ZEROS[1] - ZEROS[0])
    found = minimize_scalar(
        lambda angle: left(joint, angle)[0], bounds=(zero - step, zero + step), method="bounded",
        options={"xatol": FINE},
    )  # fmt: skip
    rms, zero = float(found.fun), float(found.x)
    quarter = np.pi / 2 * round(zero / (np.pi / 2))
    if abs(zero - quarter) < SAGGED:
        (rms,), zero = left(joint, quarter), quarter
    return Convention(rms, np.eye(n), zero * np.eye(n)[joint])


def _left(cloud: Cloud, ways: Sequence[tuple[Array, Array]]) -> list[float]:
    """What is left with joints that are shares of the columns, and zeros of their own [m], by each
    of several ways.
    """
    joints = np.stack([cloud.a @ share.T + zero for share, zero in ways])
    return [float(rms) for rms in cloud.left_with(joints, until=NEARLY)]


def oddness(cloud: Cloud, share: Array, zero: Array) -> tuple[int, int]:
    """Joints beyond their limits, and changes: half a turn counts as two quarters.

    A joint turned over, and the next with the other sign, place a marker as well as neither.

    Args:
        cloud: Positions and joint columns.
        share, zero: See `Convention`.
    """
    a = cloud.a @ share.T + zero
    low, high = cloud.robot.lower - SLACK, cloud.robot.upper + SLACK
    beyond = int(((a < low) | (a > high)).any(axis=0).sum())
    quarters = np.abs(zero) / (np.pi / 2)
    changes = (np.diag(share) < 0.0).sum() + (share != np.diag(np.diag(share))).sum()
    return beyond, int(changes + round(float(quarters.sum())))


def with_sums(cloud: Cloud) -> Convention:
    """The same joint by joint, each measured against another's too, as joint 3 to the floor."""
    n = cloud.a.shape[1]
    share, zero = np.eye(n), np.zeros(n)
    turning = ~np.array(cloud.robot.prismatic)
    (best,) = _left(cloud, [(share, zero)])
    for _ in range(n):
        tried: list[tuple[Array, Array]] = []
        for k in range(n):
            ways = [(sign * share[k], turn) for sign in (1.0, -1.0) for turn in range(4)]
            if not turning[k]:
                ways = [way for way in ways if way[1] == 0]
            else:
                others = (j for j in range(n) if j != k and turning[j])
                ways += [
                    (sign * (share[k] + times * np.eye(n)[j]), 0)
                    for j in others for times in TIMES for sign in (1.0, -1.0)
                ]  # fmt: skip
            for own, turn in ways:
                both = share.copy(), zero.copy()
                both[0][k], both[1][k] = own, turn * np.pi / 2
                tried.append(both)
        left = _left(cloud, tried)
        nearest = int(np.argmin(left))
        if left[nearest] > BETTERED * best:
            break
        best, (share, zero) = left[nearest], tried[nearest]
    return Convention(best, share, zero)


def _expression(share: Array, names: Sequence[str]) -> str:
    """``-j2 - j3``: joints times their shares."""
    out = ""
    for times, name in zip(share, names, strict=True):
        if times:
            sign = ("-" if times < 0 else "") if not out else (" - " if times < 0 else " + ")
            out += f"{sign}{'' if abs(times) == 1 else f'{abs(times):g}*'}{name}"
    return out
