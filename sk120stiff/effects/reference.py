"""From which temperature, or which moment, an effect counts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array

if TYPE_CHECKING:
    from sk120stiff.measurements import Measurements

TEMPERATURE, TIME, ORDER = "temperature", "time", "order"


@dataclass(frozen=True)
class Reference:
    """The temperature or the stretch of a clock of the readings that an effect was fitted to.

    A temperature is the same wherever it is read. A clock is taken for the same one where it shows
    times about those of the fit, no further off than the fit's readings lasted; one that shows
    others (seconds since 1970 and seconds since the start, or another day) is another clock.

    Attributes:
        of: ``temperature``, ``time`` or ``order``.
        value: Mean temperature [degC]; first time [s] or number in the series.
        last: Last time or number; None of temperatures, and where nobody says.
    """

    of: str
    value: float
    last: float | None = None

    def until(self, other: Reference) -> float | None:
        """From here to there [K, s or 1]; None where the other is of another clock."""
        if self.last is not None and other.last is not None:
            lasted = self.last - self.value
            if other.last < self.value - lasted or other.value > self.last + lasted:
                return None
        return other.value - self.value

    def beside(self, other: Reference) -> Reference:
        """What an effect counts from that counted from here and is fitted to other readings.

        Of the same clock it goes on, of another one it begins anew.
        """
        if self.until(other) is None:
            return other
        if self.last is None or other.last is None:
            return self
        return replace(self, last=max(self.last, other.last))


def references_of(measurements: Measurements) -> tuple[Reference, ...]:
    """What effects count from that are fitted to these readings; of displacements it is the zero.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
        >>> from sk120stiff.effects.reference import references_of
        >>> references_of(sk.read(data))
        ()
    """
    said = measurements.absolute
    if said is None:
        return ()
    clocks = ((TIME, measurements.time), (ORDER, measurements.order))
    found = [_stretch(of, clock) for of, clock in clocks if clock is not None]
    if said.temperature is not None:
        found.append(Reference(TEMPERATURE, float(said.temperature.mean())))
    return tuple(found)


def _stretch(of: str, clock: Array) -> Reference:
    return Reference(of, float(np.min(clock)), float(np.max(clock)))
