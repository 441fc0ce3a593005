"""A marker that sits elsewhere on the tool once a payload was changed.

Who hangs a payload touches the tool, and springs are told by what payloads do. Where the marker
took another place with them, springs would stand for it.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.geometry import ToolOffset
from sk120stiff.errors import listed, two_digits
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.change_points import Steps
from sk120stiff.identify.positions.residuals.pure_error import cells_of_numbers
from sk120stiff.identify.positions.solve.pose_problem import absolute_of
from sk120stiff.measurements import Measurements, MovedBetween
from sk120stiff.measurements.moved import labelled


def refuse_remounted(
    found: Calibration, readings: Measurements, others: Array, prior: Array
) -> tuple[str, ...]:
    """Stop where the marker moved with the payload, and the file tells nothing of it.

    From some payload on it sits elsewhere then, whatever the order of the rows. Where an error of
    the model might still be mistaken for it, a sentence says what it looks like.

    Args:
        found: A calibration.
        readings: Where it comes from.
        others, prior: Whitened columns (M, P) of all that may be at work beside it, and inverse
            variances (P,) of their factors.

    Raises:
        MovedBetween: Another place takes off half the square of what all else leaves.
    """
    problem = found.problem
    said, measured = problem.said, problem.measurements
    place = [k for k, p in enumerate(found.parameters) if isinstance(p.effect, ToolOffset)]
    if said.stated_series is not None or not place or "position" not in problem.channels.present:
        return ()
    masses, heavier = np.unique(said.payload, return_inverse=True)
    own, rows = found.jacobian[:, place], problem.rows
    pose = cells_of_numbers(problem, measured.pose_index[:, None])
    joints = measured.joints[rows]
    steps = Steps(others, prior, found.residual, own, heavier[rows], joints, pose, own)
    change = steps.at(range(1, len(masses)))
    if not change.cuts:
        return ()
    sizes = steps.sizes(change.cuts) * problem.scale[place]
    moved = listed(
        [
            f"by {1e3 * np.linalg.norm(size):.2g} mm from {masses[k]:g} kg on"
            for k, size in zip(change.cuts, sizes, strict=True)
        ]
    )
    looks = (
        f"the marker looks moved on the tool with the payload, {moved}: with another place there "
        f"the gap falls to {two_digits(100.0 * change.share)} % of what all else leaves"
    )
    remedy = (
        "Add a column series with a label for each time that the payload was changed, as a and b. "
        "Or one label for all, if nothing was moved."
    )
    if change.sure:
        part = np.searchsorted(masses[list(change.cuts)], absolute_of(readings).payload, "right")
        raise MovedBetween(
            looks, where=readings.place, remedy=remedy, apart=labelled(readings, "series", part),
            taken="Taken so here: a place of its own under each.",
        )  # fmt: skip
    return (f"T{looks[1:]}. {remedy}",)
