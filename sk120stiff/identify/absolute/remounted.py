"""A marker that sits elsewhere on the tool once a payload was changed.

Who hangs a payload touches the tool, and springs are told by what payloads do. Where the marker
took another place with them, springs would stand for it.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.geometry import ToolOffset
from sk120stiff.errors import listed
from sk120stiff.identify.absolute.calibrate import Calibration
from sk120stiff.identify.absolute.pushed import in_order
from sk120stiff.identify.absolute.repeated import cells_of_numbers
from sk120stiff.identify.absolute.steps import Steps


def remounted(found: Calibration, others: Array, prior: Array) -> list[str]:
    """That the marker looks to have moved where the payload was changed, and what to write.

    What drifts from row to row may look alike; the drift is held against it.

    Args:
        found: A calibration.
        others, prior: Whitened columns (M, P) of all that may be at work beside it, and inverse
            variances (P,) of their factors.
    """
    problem = found.problem
    said, measured = problem.said, problem.measurements
    place = [k for k, p in enumerate(found.parameters) if isinstance(p.effect, ToolOffset)]
    if said.series is not None or not place or "position" not in problem.channels.present:
        return []
    when = in_order(measured)
    order = np.argsort(when)
    changes = (np.flatnonzero(np.diff(said.payload[order])) + 1).tolist()
    own = found.jacobian[:, place]
    rows = problem.rows
    pose = cells_of_numbers(problem, measured.pose_index[:, None])
    joints = measured.joints[rows]
    steps = Steps(others, prior, found.residual, own, when[rows], joints, pose, own)
    change = steps.at(changes)
    if not change.cuts:
        return []
    line = measured.line[order]
    between = listed([f"{line[k - 1]} and {line[k]}" for k in change.cuts])
    sizes = steps.sizes(change.cuts) * problem.scale[place]
    moved = listed([f"{1e3 * np.linalg.norm(each):.2g} mm" for each in sizes])
    return [
        f"The marker looks moved on the tool (by {moved}) where the payload was changed, between "
        f"lines {between}: with another place from there on the gap falls to "
        f"{100.0 * change.share:.0f} % of it, and springs are others. Add a column series with a "
        "label for each time between, as a and b, if it may have been; one label for all if not."
    ]
