"""Parts that turn about two axes, and whose stiff direction may lie askew of both.

Their compliance is a symmetric matrix of two by two: one number for each axis, and one by which a
moment about one turns about the other.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.parameter import ParameterSpec, compliance

CROSS = "cross_stiffness"
COUPLINGS = ((0, 1, 2),)  # see `Effect.couplings`


def cross_term(scale: float, first: str, second: str, end: str = "") -> ParameterSpec:
    """The third parameter, of an arm of a length over `REFERENCE_LENGTH`."""
    return compliance(
        f"{CROSS}{end}",
        softest=6e5,
        typical=2e7,
        scale=scale,
        meaning=f"moment about {first} over the turn about {second} that it brings, and the other "
        "way round",
        signed=True,
    )


def patterns_of_two(askew: bool) -> Array:
    """(2 or 3, 2, 2) compliance per unit of each parameter."""
    own = [np.diag(row) for row in np.eye(2)]
    return np.array([*own, 1.0 - np.eye(2)] if askew else own)
