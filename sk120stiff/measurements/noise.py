"""The noise of displacement readings: its law, and the candidates that data leave open.

The law, per axis and in the axes of the readings: a displacement is a loaded reading minus the mean
of `zero_count` zero readings. The loaded reading has the variance σ² + (growth·|d|)², or s² where
the row states its own, plus (growth·|d|)². The zero reading has σ²/zero_count. Rows that subtract
the same zero reading share its error, whatever the number of rows.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.repeats import pure_error
from sk120stiff.measurements.whitening import Whitener

Floats = NDArray[np.float64]

# Growths that a search over noise models tries where the data do not state one.
GROWTHS = (0.0, 0.003, 0.01, 0.02, 0.05)
# Where nothing says how large the noise is, a model needs a scale to start from: a laser tracker's.
_START = 10e-6  # m
_FINEST = 1e-9  # m; a smaller scatter is that of copied rows or computed data, of no instrument


@dataclass(frozen=True)
class NoiseModel:
    """What one reading is worth.

    Parameters
    ----------
    sigma
        Standard uncertainty of one reading per axis, m.
    growth
        Standard uncertainty per metre of displacement, added in squares to the loaded reading.
    zero
        ``"shared"``: rows of equal `Measurements.zero_group` share the error of their zero
        reading; ``"separate"``: each row has a zero reading of its own.
    stated
        Whether sigma is known (stated, or found from repeats) or only a scale to start from.

    Raises
    ------
    InputError
        A sigma that is not positive, a growth below zero or from 1 up, an unknown zero.
    """

    sigma: float
    growth: float = 0.0
    zero: Literal["shared", "separate"] = "shared"
    stated: bool = True

    def __post_init__(self) -> None:
        if not 0 < self.sigma < np.inf:
            raise InputError(f"a noise sigma of {self.sigma} m is not positive")
        if not 0 <= self.growth < 1:
            raise InputError(f"a noise growth of {self.growth} is not between 0 and 1")
        if self.zero not in ("shared", "separate"):
            raise InputError(f"a zero reading that is {self.zero!r} has no covariance")

    def scaled(self, factor: float) -> NoiseModel:
        """The same model with sigma and growth times `factor`.

        V is multiplied by factor², except for what rows state of their own (sx, sy, sz).
        """
        return dataclasses.replace(self, sigma=self.sigma * factor, growth=self.growth * factor)

    def variances(
        self, measurements: Measurements, sizes: ArrayLike | None = None
    ) -> tuple[Floats, Floats]:
        """Variance of the loaded reading (N, 3) and of its zero reading (N, 3), m².

        Parameters
        ----------
        measurements
            The N readings.
        sizes
            Size of each displacement, m, that the growth applies to: (N,), or (N, 3) per axis.
            None takes the length of the measured displacement.

        Raises
        ------
        InputError
            A growth without sizes in a plan, or sizes of another shape.
        """
        count = measurements.n_readings
        own = np.full((count, 3), self.sigma**2)
        if measurements.sigma is not None:
            own = measurements.sigma**2
        if self.growth > 0:
            own = own + (self.growth * _sizes(measurements, sizes)) ** 2
        zero = np.repeat(self.sigma**2 / measurements.zero_count[:, None], 3, axis=1)
        return own, zero

    def whitener(self, measurements: Measurements, sizes: ArrayLike | None = None) -> Whitener:
        """The whitener of these readings; parameters and errors as in `variances`."""
        own, zero = self.variances(measurements, sizes)
        if self.zero == "separate":
            return Whitener(own + zero, np.zeros_like(own), np.arange(len(own)))
        return Whitener(own, zero, measurements.zero_group)

    def covariance(self, measurements: Measurements, sizes: ArrayLike | None = None) -> Floats:
        """Dense covariance (3, N, N) per axis, m²: for a look at few readings, not for fits."""
        own, zero = self.variances(measurements, sizes)
        same = np.eye(len(own), dtype=bool)
        if self.zero == "shared":
            same = measurements.zero_group[:, None] == measurements.zero_group[None, :]
        full: Floats = np.where(same, zero.T[:, :, None], 0.0)
        return full + np.eye(len(own)) * own.T[:, :, None]

    def describe(self) -> str:
        """The model in plain words."""
        size = f"{self.sigma * 1e6:.3g} µm per axis"
        words = f"One reading has a standard uncertainty of {size}"
        if not self.stated:
            words = f"The standard uncertainty of one reading is to be estimated, from {size} on"
        if self.growth > 0:
            words += f", and the loaded one {self.growth * 100:.3g} % of its displacement besides"
        if self.zero == "shared":
            return f"{words}. Rows that subtract the same zero reading share its error."
        return f"{words}. Each row subtracts a zero reading of its own, so errors are independent."


def candidates(measurements: Measurements) -> list[NoiseModel]:
    """The noise models that the data leave open, simplest first.

    Sigma is the stated one, else the median of the rows' own, else from repeats, else a start value
    marked ``stated=False``. A zero that nobody described is tried both ways; a growth that is
    neither stated nor part of the rows' own uncertainties is tried over `GROWTHS`.
    """
    usable = measurements.masked()
    own_group = len(np.unique(usable.zero_group)) == usable.n_readings
    zeros: list[Literal["shared", "separate"]] = ["shared", "separate"]
    if usable.zero != "unknown":
        zeros = [usable.zero]
    elif own_group:
        zeros = ["separate"]
    growths = GROWTHS if usable.sigma is None else (0.0,)
    if usable.noise.growth is not None:
        growths = (usable.noise.growth,)
    models = []
    for growth in growths:
        for zero in zeros:
            sigma, stated = _sigma(usable, zero)
            models.append(NoiseModel(sigma, growth, zero, stated))
    return models


def _sigma(measurements: Measurements, zero: Literal["shared", "separate"]) -> tuple[float, bool]:
    if measurements.noise.sigma is not None:
        return measurements.noise.sigma, True
    if measurements.sigma is not None:
        return float(np.median(measurements.sigma)), True
    found = pure_error(measurements, zero)
    # Fewer than ten degrees of freedom leave σ open by a quarter or more: a start, not knowledge.
    if found is not None and found[0] > _FINEST:
        return found[0], found[1] >= 10
    return _START, False


def _sizes(measurements: Measurements, sizes: ArrayLike | None) -> Floats:
    if sizes is None:
        if measurements.displacement is None:
            raise InputError(
                "noise that grows with the displacement needs displacements, and a plan has none",
                remedy="Give their predicted sizes.",
            )
        sizes = np.linalg.norm(measurements.displacement, axis=1)
    array = np.abs(np.asarray(sizes, dtype=np.float64))
    if array.shape not in ((measurements.n_readings,), (measurements.n_readings, 3)):
        raise InputError(
            f"displacement sizes have shape {array.shape}",
            remedy=f"Give ({measurements.n_readings},) or ({measurements.n_readings}, 3).",
        )
    return array[:, None] if array.ndim == 1 else array
