"""Positions of a pose under several loads: kept as positions, or made differences of."""

from __future__ import annotations

from typing import Literal

import numpy as np

from sk120stiff.arrays import Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.told import Mode
from sk120stiff.measurements.importers.tracker.frames import VAGUE, Placed
from sk120stiff.measurements.importers.tracker.stations import loads_apart
from sk120stiff.measurements.table.branches import branches_by_order

TakenAs = Literal["positions", "displacements"]
OPTION = "--as"
ENOUGH = 10  # poses, as many as 'explain' of positions asks for; of fewer, differences tell as much
_KEEP = f"{OPTION} positions keeps the positions, which show the arm's geometry, too."


def first_mode(draft: Draft, pairs: Mask, taken_as: TakenAs | None) -> Mode:
    """What the rows of a file may become, before the robot is laid onto them.

    Args:
        draft: The rows of the file.
        pairs: (N,) Rows whose load is another than the lightest of their pose.
        taken_as: What was asked for.

    Raises:
        InputError: It cannot be had of this file.
    """
    if draft.displaced:
        if taken_as == "positions":
            raise InputError(
                "this file holds displacements, and where the marker stood is not in them",
                where=f"{OPTION} positions",
                remedy="Leave it out, or import the positions that they were made of.",
            )
        return "displacements"
    several = len(set(draft.marker_of)) > 1
    if taken_as == "displacements" and (several or not pairs.any()):
        raise InputError(
            "of several markers no differences are made"
            if several
            else "no pose was read under two loads, so that there are no differences",
            where=f"{OPTION} displacements",
            remedy="Import one of them: --marker NAME."
            if several
            else "Leave it out: positions show the geometry, and what weight and payload bend.",
        )
    return "load pairs" if pairs.any() and not several else "positions"


def unless_apart(draft: Draft, mode: Mode, taken_as: TakenAs | None) -> Mode:
    """Positions where a pose was read from several places of the tracker: what lies between two of
    these is no displacement.

    Raises:
        InputError: Differences were asked for.
    """
    if mode != "load pairs" or not loads_apart(draft):
        return mode
    if taken_as == "displacements":
        raise InputError(
            "the loads of a pose were read from several places of the tracker: what lies between "
            "two of these is no displacement of the arm",
            where=f"{OPTION} displacements",
            remedy="Leave it out: as positions they tell geometry and springs.",
        )
    return "positions"


def last_mode(
    draft: Draft, laid: Placed, taken_as: TakenAs | None, *, turns: bool
) -> tuple[Mode, str]:
    """What load pairs become, and why, with how to get the other, in a sentence.

    Masses that hang on the tool leave positions what they are, and these tell springs and geometry
    together, from `ENOUGH` poses on springs better than differences do. Differences alone tell
    friction. Of known forces they are what was measured.

    Args:
        draft: The rows of the file.
        laid: The robot laid onto those under the lightest load of their pose.
        taken_as: What was asked for.
        turns: Do orientations stand beside the positions? Differences would leave them out.
    """
    if taken_as == "displacements":
        return "load pairs", f"Displacements were asked for ({OPTION} displacements)."
    if taken_as == "positions":
        return "positions", f"Positions were asked for ({OPTION} positions)."
    other = f"{OPTION} displacements makes differences of them, which show springs alone."
    if turns:
        return "positions", f"With orientations positions stay, for these show turns. {other}"
    if draft.loads.payload is None:
        return "load pairs", f"Of rows under other forces differences are made. {_KEEP}"
    fitted = laid.fitted
    if fitted is None:
        return "load pairs", f"The robot could not be laid onto these positions. {_KEEP}"
    poses = len(laid.rows)
    if poses < ENOUGH:
        few = "differences tell springs as well as positions do"
        more = f"from {ENOUGH} on positions under payloads stay"
        return "load pairs", f"Of {poses} poses {few}; {more}. {_KEEP}"
    if not float(fitted.std[:, :3].max()) <= VAGUE:
        return "load pairs", f"These poses do not tell how the tracker is turned. {_KEEP}"
    if _both_ways(draft):
        return "load pairs", (
            "Loads rise and fall, and friction is sought in displacements alone: differences are "
            f"made. {_KEEP}"
        )
    return "positions", f"Positions under payloads tell geometry and springs together. {other}"


def _both_ways(draft: Draft) -> bool:
    """Were loads put on and taken off again at most poses, by a column or the order of rows?"""
    if any(header == "branch" for header, _ in draft.other):
        return True
    number = np.unique(draft.pose, return_inverse=True)[1]
    used = np.flatnonzero(draft.use)
    W = draft.loads.wrench[used]
    return branches_by_order(number[used], W, used.astype(float)) is not None
