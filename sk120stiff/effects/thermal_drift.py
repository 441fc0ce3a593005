"""Arm and instrument move apart as it gets warmer: a stand, a tripod or a pedestal grows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import ReadingError
from sk120stiff.effects.counting import Counting
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.effects.reference import TEMPERATURE


@dataclass(frozen=True)
class ThermalDrift(Counting, ReadingError):
    """All positions shift alike with the temperature, whatever the pose is.

    At the reference, the mean temperature of the readings that the model was identified from,
    nothing is shifted. Steel of 1 m grows by 11 µm per kelvin, aluminium by 23 µm.
    """

    name: ClassVar[str] = "thermal_drift"
    needs: ClassVar[str] = "positions with a column temperature[degC]"
    place: ClassVar[str] = "tracker"
    equation: ClassVar[str] = "x_read = x + r * (temperature since the reference)"
    says: ClassVar[str] = (
        "The instrument and the base of the arm move apart as it gets warmer: what one of them "
        "stands on grows."
    )
    axes: ClassVar[str] = "the axes in which positions are read"
    only_absolute: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Shift per kelvin along the axes of the positions, those of the instrument or the base."""
        meaning = "read minus true along {} of the axes of the positions, for each kelvin"
        return of_axes("rate_{}", "m/K", plausible=1e-4, typical=1e-5, meaning=meaning)

    @property
    def goes_with(self) -> str:
        """See `Counting.goes_with`."""
        return TEMPERATURE

    def applies_to(self, load_cases: LoadCases) -> bool:
        """Positions have to say at which temperatures they were read."""
        warmer = load_cases.since(TEMPERATURE, self.reference)
        return load_cases.absolute and warmer is not None and bool(np.ptp(warmer) > 0.0)

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the position."""
        return np.zeros((len(self.parameters), 3, 3))

    def offsets(self, load_cases: LoadCases) -> Array:
        """(N, 3, 3) kelvin since the reference, along every axis."""
        warmer = load_cases.since(TEMPERATURE, self.reference)
        kelvin = np.zeros(load_cases.count) if warmer is None else warmer
        return kelvin[:, None, None] * np.eye(3)
