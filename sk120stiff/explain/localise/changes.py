"""What a gap may go with where an arm became another one while it was measured.

Screws came loose, a brake was let go, a belt was tightened, or readings of two arms stand in one
file: from some pose on the same load moves the point otherwise than before. The rows of a file are
taken in the order in which they were read, or where nobody tells that, in which they stand.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.explain.localise.suspect import Suspect

FEWEST = 2  # poses on either side of a change
LEAST = 3  # readings there; what fewer say is those poses' own
MOST = 24  # poses at which one is looked for, spread evenly
YIELDS_SINCE = "otherwise from pose "  # before the label of the first pose of the second part


@dataclass(frozen=True)
class Cut:
    """Where a file falls into two parts.

    Attributes:
        pose: Label of the first pose of the second part.
        after: (N,) 1 for readings of the second part, else 0.
        clock: (N,) place of each reading in the order.
    """

    pose: str
    after: Array
    clock: Array


def changes(
    load_cases: LoadCases, places: Sequence[Suspect], drives: Sequence[Suspect]
) -> Iterator[Suspect]:
    """Places that yield otherwise from some pose on: each by itself, and the drives together.

    Args:
        load_cases: The N readings.
        places, drives: What may yield, in proportion to its load.
    """
    found = tuple(cuts(load_cases))
    efforts = "torques and forces" if any(load_cases.robot.prismatic) else "torques"
    for cut in found:
        step = cut.after[:, None, None]
        since = f"{YIELDS_SINCE}{cut.pose} on"
        for place in (*places, *drives):
            yield Suspect(
                "change", f"{place.name}, under which it yields {since}", place.columns * step,
                cut.clock, "reading", alike=len(found),
            )  # fmt: skip
        if len(drives) > 1:
            together = np.concatenate([each.columns for each in drives], axis=2) * step
            name = f"the {efforts} of all joints, under which they yield {since}"
            yield Suspect("change", name, together, cut.clock, "reading", alike=len(found))


def cuts(load_cases: LoadCases, most: int = MOST) -> Iterator[Cut]:
    """At most so many poses that begin a second part, none of whose poses is in the first."""
    clock = _clock(load_cases)
    first = np.array(
        [clock[load_cases.pose == k].min(initial=np.inf) for k in range(len(load_cases.poses))]
    )
    last = np.array(
        [clock[load_cases.pose == k].max(initial=-np.inf) for k in range(len(load_cases.poses))]
    )
    order = np.argsort(first, kind="stable")
    order = order[np.isfinite(first[order])]
    ended = np.maximum.accumulate(last[order])
    before = np.cumsum(np.bincount(load_cases.pose, minlength=len(first))[order])
    begins = [
        k
        for k in range(FEWEST, len(order) - FEWEST + 1)
        if ended[k - 1] < first[order[k]] and LEAST <= before[k - 1] <= before[-1] - LEAST
    ]
    if len(begins) > most:
        begins = [begins[int(k)] for k in np.linspace(0, len(begins) - 1, most).round()]
    for k in begins:
        after = (clock >= first[order[k]]).astype(float)
        yield Cut(load_cases.poses[order[k]], after, clock)


def changed_at(name: str) -> str | None:
    """The pose from which on a suspect of that name yields otherwise; None: it is no change."""
    return name.partition(YIELDS_SINCE)[2].removesuffix(" on") or None


def _clock(load_cases: LoadCases) -> Array:
    """(N,) place of each reading in the order in which they were read, or else stand."""
    for since, zero in (
        (load_cases.order, load_cases.order_at_zero),
        (load_cases.time, load_cases.time_at_zero),
    ):
        if since is not None and (zero is not None or load_cases.absolute):
            return np.asarray(since if zero is None else since + zero, dtype=float)
    return np.arange(load_cases.count, dtype=float)
