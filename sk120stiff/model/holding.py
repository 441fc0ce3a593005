"""Which loads a model's springs can hold at all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sk120stiff.effects import Situation
from sk120stiff.errors import Refusal
from sk120stiff.model.model import Model


def held_loads(model: Model, situation: Situation) -> NDArray[np.bool_]:
    """(N,) readings for which a static equilibrium exists, found by halving.

    Parameters
    ----------
    model
        Robot and effects.
    situation
        The N readings.
    """
    held = np.zeros(situation.count, dtype=bool)
    parts = [np.arange(situation.count)]
    while parts:
        rows = parts.pop()
        try:
            model.predict(situation.rows(rows))
        except Refusal:
            if len(rows) > 1:
                parts += list(np.array_split(rows, 2))
        else:
            held[rows] = True
    return held
