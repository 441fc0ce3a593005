"""A suspect's free factors as parameters of a model: what has no name, and must be there."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.effects.base import ReadingError
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.errors import InputError
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.explain.localise.suspects import suspect_named
from sk120stiff.identify import Fit
from sk120stiff.model import Model

WIDEST = 0.1  # m; no factor moves a reading by more
SMALLEST = 1e-6  # of the largest singular value: what columns have of their own


@dataclass(frozen=True, eq=False)
class Nuisance(ReadingError):
    """A suspect's free factors as parameters: orthogonal combinations of its columns.

    Attributes:
        suspect: Its name.
        model: The base model, whose predictions the suspect may go with.
        factors: (k, P) combinations of its k columns, each 1 m rms long in the readings fitted.
        price: What which of several alike it is costs, in -2 ln L.
        fitted: The load cases of these readings.
    """

    suspect: str = field(kw_only=True)
    model: Model = field(kw_only=True)
    factors: Array = field(kw_only=True)
    fitted: LoadCases = field(kw_only=True)
    price: float = field(kw_only=True, default=0.0)
    name: ClassVar[str] = "nuisance"
    says: ClassVar[str] = "Something without a name is at work."

    def __eq__(self, other: object) -> bool:
        """Only with itself: that of another suspect, or of another fit, has other columns."""
        return self is other

    __hash__ = object.__hash__

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Size of every combination, rms of the readings fitted."""
        return tuple(
            ParameterSpec(f"factor_{k}", "m", "m", plausible=WIDEST, typical=1e-5)
            for k in range(self.factors.shape[1])
        )

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the displacement."""
        return np.zeros((self.factors.shape[1], 3, 3))

    @cached_property
    def _known(self) -> dict[int, tuple[LoadCases, Array]]:
        return {}

    def offsets(self, load_cases: LoadCases) -> Array:
        """The suspect's columns at these readings, base axes; zero where they do not tell it.

        Some of the readings that were fitted have the columns that they have among the others:
        what a few readings tell of waves, or of the hours of a day, is another suspect.
        """
        if id(load_cases) not in self._known:
            self._known[id(load_cases)] = load_cases, self._columns(load_cases)
        return self._known[id(load_cases)][1]

    def _columns(self, load_cases: LoadCases) -> Array:
        if load_cases is not self.fitted:
            rows = [self._row.get(key, -1) for key in _keys(load_cases)]
            if min(rows, default=-1) >= 0:
                return self.offsets(self.fitted)[rows]
        suspect = suspect_named(self.suspect, self.model, load_cases)
        nothing = np.zeros((load_cases.count, 3, len(self.factors)))
        return (nothing if suspect is None else suspect.columns) @ self.factors

    @cached_property
    def _row(self) -> dict[bytes, int]:
        """Which of the readings fitted has this load at this pose; repeats are alike."""
        return {key: row for row, key in enumerate(_keys(self.fitted))}


def nuisance(name: str, base: Fit) -> Nuisance:
    """A suspect as parameters of the model of a fit.

    Raises:
        InputError: The readings of the fit do not tell of it.
    """
    fitted = base.problem.load_cases
    suspect = suspect_named(name, base.model, fitted)
    if suspect is None:
        raise InputError(f"these readings do not tell of {name}")
    return nuisance_of(suspect, base.model, fitted)


def nuisance_of(suspect: Suspect, model: Model, fitted: LoadCases) -> Nuisance:
    """A suspect of these readings as parameters of a model."""
    columns = suspect.columns
    flat = columns.reshape(-1, columns.shape[2]) / np.sqrt(columns[..., 0].size)
    _, size, right = np.linalg.svd(flat, full_matrices=False)
    seen = size > SMALLEST * size[0]
    factors = right[seen].T / size[seen]
    price = suspect.price_of_choice
    return Nuisance(
        "", suspect=suspect.name, model=model, factors=factors, price=price, fitted=fitted
    )


def _keys(load_cases: LoadCases) -> list[bytes]:
    """What tells one reading of a campaign from another."""
    parts = [load_cases.a, load_cases.wrench, load_cases.branch[:, None]]
    parts += [x[:, None] for x in (load_cases.order, load_cases.time) if x is not None]
    return [row.tobytes() for row in np.hstack(parts)]
