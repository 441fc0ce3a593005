"""Where the tracker stood, and was its marker mounted anew from file to file of a campaign?

A column or the names of the files say what may have changed; the placed arm tells whether it did.
Six numbers of a frame for each file take off what differs from file to file, be it the tracker's
place or how a load bends the arm: a tracker that moved is farther off than any arm sags.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Index
from sk120stiff.errors import InputError, Refusal, listed
from sk120stiff.measurements.importers.columns.pose_labels import near_poses
from sk120stiff.measurements.importers.contract import FILE
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.loads.hung_masses import OPTION
from sk120stiff.measurements.importers.told import Mode, Told
from sk120stiff.measurements.importers.tracker.frames import counted_poses, laid_over, placed
from sk120stiff.measurements.importers.tracker.moved_or_bent import moved
from sk120stiff.measurements.placing.cloud import FEWEST
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_length

WELL = 10  # poses that tell a frame so well that one more costs nothing
AS_WELL = 1.2  # times what is left with all that may have changed: so much is enough
# Of the arm's length: no arm sags more under its payload, nor is an arm that fits at all farther
# off from one part of its workspace to another (as delivered 0.1 to 0.3 %). A tracker that stands
# elsewhere is off by centimetres, or by tenths of a degree at metres.
SAGS = 0.005
TOLD = 9  # poses that two files share, from which on `moved` tells a move from a load
SHOWN = 4  # files that are told by name
Columns = tuple[str, ...]


def with_stations(draft: Draft, mode: Mode, robot: Robot, told: Told) -> Draft:
    """The draft with columns of what changed, station and series, or without where nothing did.

    Programs that bundle stations write all positions in one frame, and some number them for other
    reasons: where few poses were read from a station, or where files may differ in load, one frame
    is enough if it fits as well, or but for what an arm may sag.

    Raises:
        Refusal: No frame fits, and too few poses tell whether the tracker moved.
    """
    labels = draft.stations
    if labels is None or mode == "displacements":
        return draft
    files = any(column.header == FILE for column in draft.sheet.columns)
    mode = "positions" if files else mode  # of a file's own load the lightest is in another file
    read = np.flatnonzero(draft.use & np.isfinite(draft.measured).all(axis=1))
    poses = np.array(near_poses(draft.joints.values))
    counts = counted_poses(poses, np.array(labels), read)
    counts = {name: count for name, count in counts.items() if count}
    ways: list[Columns] = [(), ("station",)]
    one_marker = len(set(draft.mounts)) == 1 and told.point is None
    if files and one_marker:
        ways += [("series",), ("station", "series")]
    if len(counts) == 1:
        return _with(draft, (), labels)
    few = [name for name, count in counts.items() if count < FEWEST]
    left = {way: _left_over(_with(draft, way, labels), mode, robot, told, poses) for way in ways}
    best = min(left.values())
    if few and not np.isfinite(best):
        raise _in_no_frame(_with(draft, (), labels), few, mode, robot, told)
    well = min(counts.values()) >= WELL and not (files and _may_sag_apart(labels, poses))
    sag = 0.0 if well else SAGS * arm_length(robot)
    as_well = [w for w in ways if left[w] <= AS_WELL * best] or [("station",)]
    way = next((w for w in ways if left[w] <= np.hypot(AS_WELL * best, sag)), as_well[0])
    if "station" not in way and well:
        way = ("station", *way)
    names = {name: name for name in counts}
    if files and "station" in way and sag:
        names = _merged(draft, way, labels, mode, robot, told, sag, poses)
    elif files and sag and not few:
        own = _pushed(_with(draft, way, labels), labels, read, poses, mode, robot, told)
        if len(set(own.values())) > 1 and np.isfinite(left["station", *way]):
            way, names = ("station", *way), own
        elif way not in as_well and _looks_moved(_with(draft, way, labels), mode, robot, told):
            way = as_well[0]
    return _told(_with(draft, way, labels, names), way, names, left, few, sag)


def loads_apart(draft: Draft) -> bool:
    """Are rows of one pose from several stations? Their difference then is no displacement."""
    if draft.stations is None:
        return False
    pairs = zip(draft.pose, draft.stations, draft.use, strict=True)
    pairs_used = {(pose, station) for pose, station, used in pairs if used}
    return len({pose for pose, _ in pairs_used}) < len(pairs_used)


def _left_over(
    draft: Draft, mode: Mode, robot: Robot, told: Told, poses: NDArray[np.str_]
) -> float:
    """What is left of the positions [m]; infinite where no arm leaves as much, or few tell it."""
    laid = laid_over(draft, mode, robot, told, poses)
    return np.inf if laid is None else laid[1].rms


def _with(
    draft: Draft, way: Columns, labels: Columns, names: Mapping[str, str] | None = None
) -> Draft:
    """The draft with these columns of the labels, and no others of their kind; `names`: stations
    under other names.
    """
    kept = tuple(c for c in draft.other if c[0] != "station")
    of = {"station": tuple((names or {}).get(label, label) for label in labels), "series": labels}
    return replace(draft, other=(*kept, *((header, of[header]) for header in way)))


def _may_sag_apart(labels: Columns, poses: NDArray[np.str_]) -> bool:
    """Was every file read at poses of another one, as under other loads? Then these tell whether
    the tracker moved; else a frame for each costs little, and a tracker that moved is seen.
    """
    at = {name: set(poses[np.array(labels) == name]) for name in dict.fromkeys(labels)}
    return all(
        any(len(own & others) >= TOLD for other, others in at.items() if other != name)
        for name, own in at.items()
    )


def _pushed(
    draft: Draft,
    labels: Columns,
    read: Index,
    poses: NDArray[np.str_],
    mode: Mode,
    robot: Robot,
    told: Told,
) -> dict[str, str]:
    """File → the first one from the same place of the tracker, where poses of both tell it."""
    names = list(dict.fromkeys(labels))
    laid = laid_over(draft, mode, robot, told, poses)
    if laid is None:
        return dict.fromkeys(names, names[0])
    number = np.unique(poses, return_inverse=True)[1].astype(float)
    rows = {name: read[np.array(labels)[read] == name] for name in names}
    out: dict[str, str] = {}
    for name in names:
        heads = list(dict.fromkeys(out.values()))
        off = {h: moved(draft, rows[h], rows[name], number, robot, laid[1]) for h in heads}
        same = [head for head, by in off.items() if by == 0.0]
        if not same and len(heads) == 1 and off[heads[0]] is None:
            same = heads  # it shares no poses with any other: nothing says that it was moved
        out[name] = same[0] if same else name
    return out


def _looks_moved(draft: Draft, mode: Mode, robot: Robot, told: Told) -> bool:
    """Are these positions in no one frame by far more than springs could explain?"""
    try:
        placed(draft, mode, robot, told)
    except Refusal:
        return True
    return False


def _merged(
    draft: Draft,
    way: Columns,
    labels: Columns,
    mode: Mode,
    robot: Robot,
    told: Told,
    sag: float,
    poses: NDArray[np.str_],
) -> dict[str, str]:
    """Station → the first one that stood where it did: their frames have its positions, and those
    of the other, within `sag` [m] of one another.
    """
    names = list(dict.fromkeys(labels))
    alone = {name: name for name in names}
    laid = laid_over(_with(draft, way, labels), mode, robot, told, poses)
    if laid is None:
        return alone
    cloud, found = laid
    at = found.in_base(cloud.x, cloud.station)
    out: dict[str, str] = {}
    for k, name in enumerate(names):
        for j, other in enumerate(names[:k]):
            here = at[np.isin(cloud.station, (j, k))]
            seen = [found.seen(here, np.full(len(here), n)) for n in (j, k)]
            apart = float(np.sqrt(((seen[0] - seen[1]) ** 2).sum(axis=1).mean()))
            if out[other] == other and apart <= sag:
                out[name] = other
                break
        out.setdefault(name, name)
    again = _left_over(_with(draft, way, labels, out), mode, robot, told, poses)
    return out if again <= np.hypot(AS_WELL * found.rms, sag) else alone


def _in_no_frame(
    draft: Draft, few: list[str], mode: Mode, robot: Robot, told: Told
) -> InputError | Refusal:
    """Positions that one frame of the tracker does not fit, with too few for several frames."""
    moved = (
        f"Or the tracker moved: from {FEWEST} positions on a station has a frame, and fewer were "
        f"read from {listed(few)}."
    )
    try:
        placed(draft, mode, robot, told)
    except Refusal as error:
        return Refusal(error.what, where=error.where, remedy=f"{error.remedy} {moved}")
    return InputError(
        "these positions are in no one frame", where=str(draft.sheet.path), remedy=moved
    )


def _told(
    draft: Draft,
    way: Columns,
    names: dict[str, str],
    left: dict[Columns, float],
    few: list[str],
    sag: float,
) -> Draft:
    """The draft with a sentence on what changed."""
    said, unused = [], []
    if "station" in way:
        kept = list(dict.fromkeys(names.values()))
        said.append(
            f"The tracker has a frame of its own for each of {listed(kept)} (column station): it "
            "may have moved in between."
        )
        said += [
            f"The tracker stood where it did at {first}, within what an arm may sag "
            f"({1e3 * sag:.2g} mm): {listed(more)}."
            for first in kept
            if (more := [n for n, of in names.items() if of == first and n != first])
        ]
    else:
        fits, how = "is taken for", "they do not tell"
        if np.isfinite(left[way]):
            fits, how = "fits", f"{1e3 * left[way]:.3g} mm are left"
            if np.isfinite(own := left.get(("station", *way), np.inf)):
                how += f", {1e3 * own:.3g} mm with one of each"
        unused.append(f"column station: one frame of the tracker {fits} all {len(names)} ({how})")
        said += _why_one(draft, names, few, sag)
    if "series" in way:
        before = left[tuple(h for h in way if h != "series")]
        was = f"{1e3 * before:.3g} mm" if np.isfinite(before) else "more than any arm is off"
        said.append(
            f"The marker was mounted anew from file to file (column series): {was} would be left "
            f"with it in one place, {1e3 * left[way]:.3g} mm are left with a place of its own in "
            "each."
        )
    return replace(draft, said=(*draft.said, *said), unused=(*draft.unused, *unused))


def _why_one(draft: Draft, names: dict[str, str], few: list[str], sag: float) -> list[str]:
    """Why one frame of the tracker is taken for all files or stations, in a sentence."""
    one = f"The tracker is taken to have stood in one place for all {len(names)}: "
    masses = "" if draft.loads.taken else f" If masses differed, say them: {OPTION} 'FILE=5 kg'."
    if few:
        return [
            f"{one}fewer than {FEWEST} poses, as of {listed(few, most=SHOWN)}, tell no frame of "
            f"their own.{masses}"
        ]
    if not sag:
        return []
    return [
        f"{one}what they differ by is no more than an arm may sag ({1e3 * sag:.2g} mm, "
        f"{SAGS:.1%} of its length).{masses} If it was moved, add a column station with a label "
        "for each place."
    ]
