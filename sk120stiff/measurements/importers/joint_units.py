"""What speaks against joint columns: units that no positions check, and cells that were merged."""

from __future__ import annotations

import numpy as np

from sk120stiff.errors import listed
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.table.angle_units import mixed
from sk120stiff.robot import Robot

_SHARE = 0.25  # of the rows that are read, from which on rows without joints are told
_WORDS = {"rad": "radians", "deg": "degrees"}


def unit_doubts(draft: Draft, robot: Robot) -> list[str]:
    """Sentences on columns that look as if in another unit than the others."""
    if draft.joints.mapping:
        return []
    a, turning = draft.joints.values[draft.use], ~np.array(robot.prismatic)
    names = [unit_of_header(column.header)[0] for column in draft.joints.taken]
    out = []
    for some, _, meant, written in mixed(a, turning):
        size = np.abs(np.degrees(a) if written == "deg" else a).max(axis=0)
        others = np.setdiff1d(np.flatnonzero(turning), some)
        one = len(some) == 1
        goes = (
            f"stay{'s' * one} within ±{size[some].max():.3g} {written}, while "
            f"{names[others[np.argmax(size[others])]]} goes to {size[others].max():.3g} {written}"
            if meant == "rad"
            else f"go{'es' * one} to {size[some].max():.3g} {written}, beyond what a joint turns"
        )
        stated = all(draft.joints.taken[k].unit for k in some)
        looks = f"{'this looks' if one else 'these look'} like {_WORDS[meant]}"
        remedy = f"write {names[some[0]]}[{meant}]" + (
            " in the header."
            if stated
            else f" and {names[others[0]]}[{written}], the unit in the header of every joint, and "
            "leave --angle out."
        )
        said = f"{listed([names[k] for k in some])} {goes}"
        out.append(f"{said}: {looks}, and nothing here checks it. If so, {remedy}")
    return out


def blank_doubts(draft: Draft) -> list[str]:
    """A sentence where rows have readings and no joints, as merged cells leave them in text."""
    joints = {column.header for column in draft.joints.taken}
    without = [
        line
        for line, reason in draft.sheet.skipped
        if joints and joints <= set(reason.rpartition("nothing stands in ")[2].split(", "))
    ]
    if len(without) < _SHARE * len(set(draft.sheet.lines)):
        return []
    return [
        f"{len(without)} rows are left out because no joint value stands in them, as below merged "
        "cells of a spreadsheet that was saved as text. If they are of the pose above them, fill "
        "its cells down, or import the workbook (.xlsx) itself."
    ]
