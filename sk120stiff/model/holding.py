"""Which loads a model's springs can hold at all, and at what bend they are not believed."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import LoadCases
from sk120stiff.errors import Refusal, warn
from sk120stiff.model.model import Model
from sk120stiff.robot.anatomy import arm_length

FAR = 0.05  # of the arm's length: a gear that yields by more than some mrad is no gear of a robot


def warn_of_far_bend(model: Model, displacement: Array) -> None:
    """Tell that displacements (..., 3) [m] are larger than any arm's.

    Warns:
        ToolkitWarning: One of them is.
    """
    size = np.linalg.norm(displacement, axis=-1)
    largest = float(np.max(size, initial=0.0, where=np.isfinite(size)))
    share = largest / max(arm_length(model.robot), 1e-9)
    if share > FAR:
        warn(
            f"the arm bends by {largest:.3g} m, {100 * share:.0f} % of the arm's length: no arm "
            "does. Check the units of springs and loads"
        )


def held_loads(model: Model, load_cases: LoadCases) -> Mask:
    """(N,) readings for which a static equilibrium exists, found by halving.

    Args:
        model: Robot and effects.
        load_cases: The N readings.
    """
    held = np.zeros(load_cases.count, dtype=bool)
    parts = [np.arange(load_cases.count)]
    while parts:
        rows = parts.pop()
        try:
            model.predict(load_cases.rows(rows))
        except Refusal:
            if len(rows) > 1:
                parts += list(np.array_split(rows, 2))
        else:
            held[rows] = True
    return held
