"""Parts that turn about two axes, and whose stiff direction may lie askew of both.

Their compliance is a symmetric matrix of two by two: one number for each axis, and one by which a
moment about one turns about the other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.errors import two_digits

CROSS = "cross_stiffness"
CUSTOMARY = 6e5  # N·m/rad: the softest on an arm of `REFERENCE_LENGTH`
COUPLINGS = ((0, 1, 2),)  # see `Effect.couplings`


def cross_term(
    scale: float, first: str, second: str, end: str = "", softest: float | None = None
) -> ParameterSpec:
    """The third parameter, of an arm of a length over `REFERENCE_LENGTH`.

    `softest`: see `compliance`, where it lies beyond what is customary.
    """
    return compliance(
        f"{CROSS}{end}",
        softest=softest or CUSTOMARY,
        customary=CUSTOMARY if softest else None,
        typical=2e7,
        scale=scale,
        meaning=f"moment about {first} over the turn about {second} that it brings, and the other "
        "way round",
        signed=True,
    )


def softest_way(values: Sequence[float], from_: str, towards: str) -> str:
    """How soft the part is about which axis, in words; empty where it is rigid.

    Args:
        values: Stiffness about the first axis, about the second, and what couples the two
            [N*m/rad].
        from_, towards: The first axis and the second.
    """
    first, second, cross = (1.0 / value for value in values)
    (stiff, soft), ways = np.linalg.eigh([[first, cross], [cross, second]])
    if soft <= 0.0:
        return ""
    angle = np.degrees(np.arctan2(ways[1, 1], ways[0, 1]))
    angle = (angle + 90.0) % 180.0 - 90.0  # an axis has no sign
    side = towards if angle >= 0.0 else f"minus {towards}"
    across = "rigid" if stiff <= 0.0 else f"{two_digits(1.0 / stiff)} N*m/rad"
    return (
        f"softest, {two_digits(1.0 / soft)} N*m/rad, about an axis {abs(angle):.0f} deg from "
        f"{from_} towards {side}, and {across} about the one across"
    )


def patterns_of_two(askew: bool) -> Array:
    """(2 or 3, 2, 2) compliance per unit of each parameter."""
    own = [np.diag(row) for row in np.eye(2)]
    return np.array([*own, 1.0 - np.eye(2)] if askew else own)
