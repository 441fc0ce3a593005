"""Positions that are refused: nothing places them, another arm gave them, or a fit went astray."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.errors import InputError, Refusal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.noise.sizes import START, of_poses
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.placing.distances import EACH
from sk120stiff.measurements.placing.placing import Placing
from sk120stiff.robot.anatomy import arm_length

ASTRAY = 5.0  # times what the rigid arm leaves, placed under the lightest load
LARGEST = 0.03  # of the reach of the arm, which the fitted model of the right arm does not leave


def nowhere(readings: Measurements) -> InputError:
    """Nothing tells where the instrument stands: why, and what to do."""
    present = () if readings.absolute is None else readings.absolute.channels.present
    if "distance" in present:
        why = f"fewer than {EACH} distances to each fixed point (ax, ay, az)"
        remedy = f"Measure {EACH} poses or more against each, or state the points in base axes."
    elif "position" in present:
        why, remedy = "fewer than three whole positions", "Measure more poses."
    else:
        why = "there is no position and no distance"
        remedy = (
            "Leave 'position: {frame: unknown}' out and state directions and rotations in axes of "
            "the base frame; or read positions beside them."
        )
    return InputError(
        f"{why}: nothing tells where the instrument stands", where=readings.place, remedy=remedy
    )


def refuse_another_robot(found: Fit, readings: Measurements) -> None:
    """Single axes or distances that no placing has looked at.

    Raises:
        InputError: The fit leaves more than any arm of that size does.
    """
    problem = of_poses(found)
    gap = problem.of_channels.undo(found.residual)
    left = rms(gap[problem.lengths]) if len(problem.lengths) else 0.0
    reach = arm_length(found.model.robot)
    if left <= LARGEST * reach:
        return
    worst = problem.lengths[np.argsort(-np.abs(gap[problem.lengths]))[:3]]
    lines = ", ".join(str(problem.measurements.line[problem.rows[k]]) for k in worst)
    raise InputError(
        f"these readings are not of this robot's marker: {1e3 * left:.4g} mm are left, on an arm "
        f"that reaches {1e3 * reach:.4g} mm",
        where=f"{readings.path or 'measurements'}, worst in lines {lines}",
        remedy="Check units, signs and order of the joint columns, and the frame: readings in the "
        "tracker's own axes need 'position: {frame: unknown}' and some whole positions.",
    )


def refuse_a_wrong_end(found: Fit, placed: Placing, readings: Measurements) -> None:
    """A fit that ends farther off than the rigid arm where it was placed.

    Raises:
        Refusal: It went astray.
    """
    problem = of_poses(found)
    left = rms(problem.distances(problem.channel_gap(problem.values(found.x))[0]))
    reach = arm_length(found.model.robot)
    if left > max(ASTRAY * max(placed.rms, START["position"]), LARGEST * reach):
        raise Refusal(
            f"the fit went astray: it leaves {1e3 * left:.3g} mm, where the rigid arm, placed "
            f"alone, leaves {1e3 * placed.rms:.3g} mm",
            where=readings.place,
            remedy="Start from another model: values in this one are far from the arm's.",
        )
