"""Where the tracker stood, and was its marker mounted anew from file to file of a campaign?

A column or the names of the files say what may have changed; the placed arm tells whether it did.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from sk120stiff.errors import InputError, Refusal, listed
from sk120stiff.measurements.cloud import FEWEST
from sk120stiff.measurements.importers.contract import FILE
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.frames import left_over, placed
from sk120stiff.measurements.importers.told import Mode, Told
from sk120stiff.robot import Robot

WELL = 10  # positions that tell a frame so well that one more costs nothing
AS_WELL = 1.2  # times what is left with all that may have changed: so much is enough
Columns = tuple[str, ...]


def with_stations(draft: Draft, mode: Mode, robot: Robot, told: Told) -> Draft:
    """The draft with columns of what changed, station and series, or without where nothing did.

    Programs that bundle stations write all positions in one frame, and some number them for other
    reasons: where few positions were read from a station, one frame is enough if it fits as well.

    Raises:
        Refusal: No frame fits, and too few positions tell whether the tracker moved.
    """
    labels = draft.stations
    if labels is None or mode == "displacements":
        return draft
    counts = Counter(label for label, used in zip(labels, draft.use, strict=True) if used)
    files = any(column.header == FILE for column in draft.sheet.columns)
    ways: list[Columns] = [(), ("station",)]
    one_marker = len(set(draft.mounts)) == 1 and told.point is None
    if files and one_marker:
        ways += [("series",), ("station", "series")]
    if len(counts) == 1:
        return _with(draft, (), labels)
    few = [name for name, count in counts.items() if count < FEWEST]
    left = {way: left_over(_with(draft, way, labels), mode, robot, told) for way in ways}
    best = min(left.values())
    if few and not np.isfinite(best):
        raise _in_no_frame(_with(draft, (), labels), few, mode, robot, told)
    way = next((way for way in ways if left[way] <= AS_WELL * best), ("station",))
    if "station" not in way and min(counts.values()) >= WELL:
        way = ("station", *way)
    return _told(_with(draft, way, labels), way, list(counts), left)


def _with(draft: Draft, way: Columns, labels: Columns) -> Draft:
    """The draft with these columns of the labels, and no others of their kind."""
    kept = tuple(c for c in draft.other if c[0] != "station")
    return replace(draft, other=(*kept, *((header, labels) for header in way)))


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


def _told(draft: Draft, way: Columns, names: list[str], left: dict[Columns, float]) -> Draft:
    """The draft with a sentence on what changed."""
    said, unused = [], []
    if "station" in way:
        said.append(
            f"The tracker has a frame of its own for each of {listed(names)} (column station): it "
            "may have moved in between."
        )
    else:
        fits = f"{1e3 * left[way]:.3g} mm are left"
        if np.isfinite(own := left.get(("station", *way), np.inf)):
            fits += f", {1e3 * own:.3g} mm with one of each"
        unused.append(f"column station: one frame of the tracker fits all {len(names)} ({fits})")
    if "series" in way:
        before = left[tuple(h for h in way if h != "series")]
        was = f"{1e3 * before:.3g} mm" if np.isfinite(before) else "more than any arm is off"
        said.append(
            f"The marker was mounted anew from file to file (column series): {was} would be left "
            f"with it in one place, {1e3 * left[way]:.3g} mm are left with a place of its own in "
            "each."
        )
    return replace(draft, said=(*draft.said, *said), unused=(*draft.unused, *unused))
