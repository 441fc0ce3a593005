"""Arrays by what they hold, so that a signature says it in one word; their size in one number."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

P = ParamSpec("P")
T = TypeVar("T")

Array = NDArray[np.float64]
"""Real numbers, in SI units unless a docstring says otherwise."""
Index = NDArray[np.intp]
"""Places in another array."""
Integers = NDArray[np.int64]
"""Whole numbers that are no places: group labels, counts."""
Mask = NDArray[np.bool_]
"""Yes or no for each entry of another array."""

ROUNDING = 1e-13  # of the longest column, below which one is rounding


def rms(values: Array) -> float:
    """Root mean square of what is finite; NaN where nothing is."""
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if len(finite) else float("nan")


def largest(values: Array) -> float:
    """Largest of what is finite; NaN where nothing is."""
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else float("nan")


def lengths_of(columns: Array) -> Array:
    """(k,) lengths of columns (..., k); 0 of one that is rounding beside the longest.

    What no reading shows comes out of finite arithmetic as some 1e-16, in no direction at all.
    """
    lengths = np.linalg.norm(columns, axis=0)
    return np.where(lengths > ROUNDING * lengths.max(initial=0.0), lengths, 0.0)


def of_length_one(columns: Array) -> Array:
    """(R, k) the columns that are not zero, each divided by its length."""
    lengths = lengths_of(columns)
    return np.asarray(columns[:, lengths > 0.0] / lengths[lengths > 0.0])


def on_one_thread(function: Callable[P, T]) -> Callable[P, T]:
    """Linear algebra on one thread while the function runs.

    Arrays of readings have some hundred rows: to hand their parts to other threads and to wait for
    them takes longer than the work. Afterwards the process has as many threads as before.
    """

    @wraps(function)
    def alone(*args: P.args, **kwargs: P.kwargs) -> T:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return alone
