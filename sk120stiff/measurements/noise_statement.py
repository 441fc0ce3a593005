"""What data say of their own noise: its size, its growth, and the instrument that has it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError


@dataclass(frozen=True)
class Instrument:
    """Where an instrument stands, and what one of its readings is worth.

    Args:
        place: (3,) in the base frame, m.
        along, across: Standard uncertainty along its ray, and in each direction across it, m.
        along_per_m, across_per_m: What each metre of distance adds to them, in squares, m per m.

    Examples:
        >>> import sk120stiff as sk
        >>> tracker = sk.Instrument((3.0, -2.0, 0.5), 5e-6, 10e-6, across_per_m=3e-6)
        >>> tracker.along, tracker.along_per_m
        (5e-06, 0.0)
    """

    place: tuple[float, float, float]
    along: float
    across: float
    along_per_m: float = 0.0
    across_per_m: float = 0.0

    def at(self, points: Array) -> tuple[Array, Array, Array]:
        """Unit rays (N, 3) to the points (N, 3), and what holds along and across them (N,), m.

        Examples:
            >>> import numpy as np
            >>> import sk120stiff as sk
            >>> tracker = sk.Instrument((3.0, 0.0, 0.0), 5e-6, 10e-6, across_per_m=3e-6)
            >>> _, along, across = tracker.at(np.array([[0.0, 4.0, 0.0]]))
            >>> print(f"{1e6 * along[0]:.1f} µm, {1e6 * across[0]:.1f} µm at 5 m")
            5.0 µm, 18.0 µm at 5 m
        """
        sight = np.asarray(points) - np.array(self.place)
        distance = np.linalg.norm(sight, axis=1)
        if not np.all(distance > 0.0):
            raise InputError(
                "the instrument stands where the tool is",
                remedy="Give its place in the base frame of the robot.",
            )
        along = np.hypot(self.along, self.along_per_m * distance)
        across = np.hypot(self.across, self.across_per_m * distance)
        return sight / distance[:, None], along, across


@dataclass(frozen=True)
class NoiseStatement:
    """What the data say of their own noise; None stands for "not said".

    Args:
        sigma: Standard uncertainty of one reading per axis, m.
        growth: Part that grows with the displacement: standard uncertainty per metre of
            displacement.
        instrument: What took the readings, where it is sharper along its ray than across.
        force: Standard uncertainty of every component of a force, as a share of the whole force, as
            a gauge held by hand has it: 0.017 is one degree.
    """

    sigma: float | None = None
    growth: float | None = None
    instrument: Instrument | None = None
    force: float | None = None

    def __post_init__(self) -> None:
        if self.sigma is not None and not 0 < self.sigma < np.inf:
            raise InputError(f"a noise sigma of {self.sigma} m is not positive")
        if self.growth is not None and not 0 <= self.growth < 1:
            raise InputError(f"a noise growth of {self.growth} is not between 0 and 1")
        if self.force is not None and not 0 <= self.force < 1:
            raise InputError(f"an error of forces of {self.force} is not between 0 and 1")


UNSTATED = NoiseStatement()


class HasSize(Protocol):
    """What a `NoiseModel` says as well."""

    @property
    def sigma(self) -> float | None:
        """Standard uncertainty of one reading per axis, m."""

    @property
    def growth(self) -> float | None:
        """Part that grows with the displacement."""

    @property
    def force(self) -> float | None:
        """Standard uncertainty of the components of a force, as a share of it."""


def stated(noise: HasSize) -> NoiseStatement:
    """What a noise model, or a statement, states of readings."""
    if isinstance(noise, NoiseStatement):
        return noise
    return NoiseStatement(noise.sigma, noise.growth, force=noise.force or None)
