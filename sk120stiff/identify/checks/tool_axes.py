"""Forces in axes of the tool that no sensor there has read: turned so by the joint angles alone.

A sensor's axes turn with the tool as the arm bends (`model/true_load.py`). The difference between
the two readings of a file is known, so its share t in what a fit leaves is estimated like one
parameter more: 0 of a sensor, 1 where the axes were worked out from the joint angles.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.errors import short
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.fit import Fit

SURE = 5.0  # standard errors that the share has to be from zero
NEAR = 0.5  # by how much it may be off one where other causes are in what is left, too


def axes_of_joint_angles(fit: Fit) -> str | None:
    """Where the forces look turned into the tool's axes by the joint angles, what to write."""
    cases, model = fit.problem.load_cases, fit.model
    if not cases.follows:
        return None
    otherwise = model.predict(replace(cases, follows=False)) - model.predict(cases)
    white, left = fit.problem.whitener.apply(otherwise), fit.residual
    inside = orthonormal(fit.jacobian)
    own = white - inside @ (inside.T @ white)
    size = float(own @ own)
    free = len(left) - inside.shape[1] - 1
    if not size > 0.0 or free < 1:
        return None
    share = float(own @ left) / size
    noise = float(np.sum((left - share * own) ** 2)) / free
    if not (share > SURE * np.sqrt(noise / size) and abs(share - 1.0) < NEAR):
        return None
    turned = model.solve(cases).rest.screws.rotation @ np.swapaxes(cases.rotation, 1, 2)
    cosine = 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1.0)
    angle = float(np.arccos(np.clip(cosine, -1.0, 1.0)).max())
    return (
        "The forces look turned into axes of the tool by the joint angles alone. Those of a sensor "
        f"turn with the tool as the arm bends, here by up to {1e3 * angle:.2g} mrad, and that "
        f"moves the readings by {short(1e6 * rms(otherwise))} µm rms per axis, "
        "which springs and names have to make up for. Turn the forces back by the same joint "
        "angles, and write 'force: {frame: base}'."
    )
