"""What instruments make of a load or of a displacement, one misreading after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.effects.base import Misreading


@dataclass(frozen=True, eq=False)
class Misread:
    """Values after a series of misreadings, and their derivatives.

    Attributes:
        value: (N, d) what comes out.
        matrix: (d, d) derivative of the output by the input; (N, d, d) where poses differ.
        columns: For each effect its part of the vector of values, and (N, d, p) derivatives.
    """

    value: Array
    matrix: Array
    columns: tuple[tuple[slice, Array], ...]


def misread(
    effects: list[tuple[Misreading, slice]], load_cases: LoadCases, values: Array, x: Array
) -> Misread:
    """Readings `x` (N, d) as they come out of a series of misreadings."""
    matrix = np.eye(x.shape[-1])
    columns: list[tuple[slice, Array]] = []
    for effect, part in effects:
        own = effect.columns(x, load_cases)
        step = effect.matrix(values[part], load_cases)
        x = x + own @ values[part]
        columns = [(earlier, step @ found) for earlier, found in columns]
        columns.append((part, own))
        matrix = step @ matrix
    return Misread(x, matrix, tuple(columns))
