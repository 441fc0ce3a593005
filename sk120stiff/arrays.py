"""Arrays by what they hold, so that a signature says it in one word; their size in one number."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Real numbers, in SI units unless a docstring says otherwise."""
Index = NDArray[np.intp]
"""Places in another array."""
Integers = NDArray[np.int64]
"""Whole numbers that are no places: group labels, counts."""
Mask = NDArray[np.bool_]
"""Yes or no for each entry of another array."""


def rms(values: Array) -> float:
    """Root mean square of what is finite; NaN where nothing is."""
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if len(finite) else float("nan")


def largest(values: Array) -> float:
    """Largest of what is finite; NaN where nothing is."""
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else float("nan")
