"""Cells of a CSV file and entries of the YAML file beside it, as text that reads back the same."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.measurements.noise_statement import Instrument

Column = tuple[str, Iterable[str]]


def column(name: str, values: ArrayLike, unit: str, kind: str) -> Column:
    """Header with its unit, and cells; what was not read is a blank one."""
    return f"{name}[{unit}]", map(digits, in_unit(values, unit, kind))


def columns(names: tuple[str, ...], values: Array, unit: str, kind: str) -> Iterable[Column]:
    """One column of (N, k) values for each name."""
    for k, name in enumerate(names):
        yield column(name, values[:, k], unit, kind)


def bare(names: tuple[str, ...], values: Array) -> Iterable[Column]:
    """The same of numbers without a unit."""
    for k, name in enumerate(names):
        yield name, map(digits, values[:, k])


def digits(value: float) -> str:
    """The shortest text that reads back as the same float; NaN is an empty cell."""
    return "" if np.isnan(value) else repr(float(value) + 0.0)


def in_unit(values: ArrayLike, unit: str, kind: str) -> Array:
    """SI values (N,) in a unit, without its rounding: 0.015 mm, not 0.015000000000000001.

    What is not finite was not read, and stays so. Fifteen digits do where they read back within one
    rounding, or no further off than all digits.
    """
    out = np.array(values, dtype=np.float64)
    known = np.isfinite(out)
    si = out[known]
    whole = np.asarray(units.from_si(si, unit, kind), dtype=float)
    if not np.array_equal(whole, si):
        few = np.array([float(f"{number:.15g}") for number in whole])
        off, least = (np.abs(units.to_si(each, unit, kind) - si) for each in (few, whole))
        whole = np.where(off <= np.maximum(np.spacing(np.abs(si)), least), few, whole)
    out[known] = whole
    return out


def length_entry(metres: float, unit: str) -> float:
    """A length as it stands in an entry that states its unit."""
    return float(in_unit([metres], unit, "length")[0])


def point_entry(xyz: ArrayLike, unit: str) -> dict[str, Any]:
    """A point (3,) [m] with its unit."""
    shown = in_unit(xyz, unit, "length")
    return {"xyz": [float(number) + 0.0 for number in shown], "unit": unit}


def instrument_entry(stated: Instrument, unit: str) -> dict[str, Any]:
    """What an instrument has along its ray and across, as far as it is stated."""
    sizes = ("along", "across", "along_per_m", "across_per_m")
    return {
        name: length_entry(size, unit) for name in sizes if (size := getattr(stated, name)) > 0.0
    }
