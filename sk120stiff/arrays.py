"""Arrays by what they hold, so that a signature says it in one word."""

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
