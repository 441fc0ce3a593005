"""Where what named causes leave lives."""

from __future__ import annotations

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array, Index
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.measurements import Measurements

LARGEST = 5  # places told
MOSTLY = 0.4  # share of a smooth error that one joint must carry to be told


def where_it_lives(
    linear: Linear, gap: Array, seen: Calibration, readings: Measurements, counted: Index
) -> tuple[str, ...]:
    """Rows with the largest gaps left (M,), and joints whose angle it goes with most.

    `counted` are the numbers that count.
    """
    rows = np.flatnonzero(readings.use & ~seen.wild)
    unit = seen.problem.unit
    square = seen.problem.of_channels.undo(gap)[counted] ** 2
    size = np.sqrt(np.bincount(linear.row[counted], square, minlength=len(rows)))
    worst = np.argsort(-size)[:LARGEST]
    markers = () if readings.absolute is None else readings.absolute.markers
    several = len(set(markers)) > 1
    places = ", ".join(
        f"{readings.pose[rows[k]]}{f' marker {markers[rows[k]]}' if several else ''} "
        f"({1e6 * size[k]:.0f} {unit})"
        for k in worst
    )
    said = [f"The largest gaps left at poses left out: {places}."]
    form = seen.form
    if form is not None and form.by_joint.max() > MOSTLY:
        k = int(np.argmax(form.by_joint))
        joint = seen.model.robot.actuated[k]
        said.append(
            f"It looks as if {joint} stood off by an unknown function of the joints' angles "
            f"({100 * form.by_joint[k]:.0f} % of it)."
        )
    a = readings.joints[rows]
    strength = {}
    for k, name in enumerate(readings.joint_names):
        if np.ptp(a[:, k]) > 1e-3:
            order = stats.spearmanr(np.abs(a[:, k] - np.median(a[:, k])), size)
            strength[name] = abs(float(order.statistic))
    if strength and max(strength.values()) > 4.0 / np.sqrt(len(rows)):
        joint = max(strength, key=lambda name: strength[name])
        said.append(f"What is left grows most as {joint} leaves the middle of its range.")
    return tuple(said)
