"""Displacements of one marker alone: what the checks of displacements look at."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from sk120stiff.measurements import Measurements


def of_one_marker(measurements: Measurements) -> Measurements:
    """Displacements beside turns or of several markers as those of the marker most often read.

    Other readings come back as they are.
    """
    said = measurements.absolute
    if said is None or said.channels.displacement is None:
        return measurements
    marker = Counter(said.markers).most_common(1)[0][0]
    rows = np.array([own == marker for own in said.markers])
    rows &= np.isfinite(said.channels.displacement).any(axis=1) | ~measurements.use
    if not (rows & measurements.use).any():
        return measurements
    own = measurements.select(rows)
    read = own.absolute
    if read is None:
        raise ValueError("channels that were there")
    return replace(own, displacement=read.channels.displacement, point=read.point[0], absolute=None)
