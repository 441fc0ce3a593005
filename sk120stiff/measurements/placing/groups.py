"""Places of markers in series that the placing does not see: they begin where that marker was.

Positions are placed under the least load of every pose, so that a series of the loaded ones alone
is none of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.measurements.absolute import Absolute


def of_all_groups(
    marker: Array, apart: Array, seen: Sequence[str], said: Absolute
) -> tuple[Array, Array]:
    """Place of the first group (3,), and how much farther each is off (G, 3), the first by zero.

    Args:
        marker, apart: The same of the groups that were seen; one row where all are one.
        seen: These, in their order.
        said: What tells the G groups.
    """
    labels = tuple(dict.fromkeys(said.groups or ()))
    if len(apart) == 1 or list(labels) == list(seen):
        return marker, apart
    of = dict(zip(said.groups or (), said.markers, strict=True))
    place = {of[label]: off for label, off in zip(reversed(seen), apart[::-1], strict=True)}
    place |= dict(zip(seen, apart, strict=True))
    off = np.array([place.get(label, place.get(of[label], np.zeros(3))) for label in labels])
    return np.asarray(marker + off[0]), np.asarray(off - off[0])
