"""The readings wander as the measurement goes on: steadily, or less and less as things warm up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import ReadingError, scale_of
from sk120stiff.effects.counting import Counting
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.effects.reference import ORDER, TIME
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot

COURSES = (0.1, 0.3, 1.0)  # of the series: over which a drift may die away
BRIEF = 0.03  # of the series: the same of what warms up at once
FEWEST = 2.0  # readings: what dies away faster is an error of single readings
OVER = "_over_"  # rate_x_over_40: at first, dying away over 40 readings


@dataclass(frozen=True)
class ReadingDrift(Counting, ReadingError):
    """Readings wander with time (or with their order, where no time is known) since the zero.

    A drift that goes on adds r (t − t₀) to a reading at t whose zero was read at t₀. What warms up
    drifts fast at first and then no more, with t counted from the first reading of the series::

        r T (exp(−t₀/T) − exp(−t/T))

    Positions have no zero: they count from the first of those that the model was identified from,
    before which nothing has warmed up.

    Attributes:
        per_second: By the clock, not by the order.
        over: Times T over which the drift dies away; 0: it goes on. Several together follow any
            slow course.
    """

    per_second: bool = False
    over: tuple[float, ...] = (0.0,)
    name: ClassVar[str] = "reading_drift"
    needs: ClassVar[str] = "a column order or time[s]"
    place: ClassVar[str] = "tracker"
    equation: ClassVar[str] = (
        "d_read = d + r * (time or number of the reading since its zero), r dying away where "
        "things warm up"
    )
    says: ClassVar[str] = "The readings drift as the measurement goes on."
    axes: ClassVar[str] = "axes of the base frame; of positions the axes in which they are read"
    also: ClassVar[str] = (
        "rate_x_over_40: the rate at first of a drift that dies away over 40 readings (40 s where "
        "there is a clock), as exp(-t / 40); several add up"
    )

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """Drift by the clock where there is one, else by the order of the readings."""
        told = {_time(name) for name in options.shape if OVER in name}
        steady = not told or any(name.startswith("rate_") and OVER not in name
                                 for name in options.shape)  # fmt: skip
        over = (*([0.0] if steady else []), *sorted(told))
        return cls(where, scale_of(robot), options.timed, over)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The clock that the units of the parameters tell, and the law that their names tell."""
        return Options(timed="m/s" in parameters.values(), shape=tuple(parameters))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Drift rates along the base axes, for every time over which they die away."""
        unit, typical = ("m/s", 1e-8) if self.per_second else ("m", 1e-6)
        step = "for each second" if self.per_second else "for each reading"
        clock = "s" if self.per_second else "readings"
        return tuple(
            spec
            for T in self.over
            for spec in of_axes(
                "rate_{}" + (f"{OVER}{T:g}" if T else ""), unit,
                plausible=100 * typical, typical=typical,
                meaning=f"read minus true along {{}} of the base, {step}"
                + (f" at first, dying away over {T:g} {clock}" if T else " since the zero reading"),
            )
        )  # fmt: skip

    @property
    def goes_with(self) -> str:
        """See `Counting.goes_with`."""
        return TIME if self.per_second else ORDER

    def applies_to(self, load_cases: LoadCases) -> bool:
        """The file must say in which order, or when, it was read."""
        return self._clock(load_cases)[0] is not None

    def other_laws(self, load_cases: LoadCases) -> tuple[ReadingDrift, ...]:
        """Drifts that die away over `BRIEF` or `COURSES` of the series, and the latter together."""
        shortest, whole = self._span(load_cases)
        if not whole:
            return ()
        brief, *times = (float(f"{share * whole:.3g}") for share in (BRIEF, *COURSES))
        at_once = [(brief,)] if brief >= shortest else []
        laws = [(0.0,), *at_once, *((T,) for T in times), (0.0, *times)]
        return tuple(replace(self, over=own) for own in laws if own != self.over)

    def _span(self, load_cases: LoadCases) -> tuple[float, float]:
        """`FEWEST` usual steps of the clock, and the whole series; zeros where nothing tells."""
        elapsed, begun = self._clock(load_cases)
        if elapsed is None or begun is None:
            return 0.0, 0.0
        clock = np.unique(begun + elapsed)
        steps = np.diff(clock)
        return (FEWEST * float(np.median(steps)), float(clock[-1])) if len(steps) else (0.0, 0.0)

    def _clock(self, load_cases: LoadCases) -> tuple[Array | None, Array | None]:
        """Since the zero reading, or the reference, and when the former was taken."""
        at_zero = load_cases.time_at_zero if self.per_second else load_cases.order_at_zero
        return load_cases.since(self.goes_with, self.reference), at_zero

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the displacement."""
        return np.zeros((len(self.parameters), 3, 3))

    def offsets(self, load_cases: LoadCases) -> Array:
        """Time or steps since the zero reading, and what of them counts where a drift dies away."""
        known, at = self._clock(load_cases)
        elapsed = np.zeros(load_cases.count) if known is None else known
        begun = np.zeros(load_cases.count) if at is None else at
        warming = np.maximum(elapsed, 0.0) if load_cases.absolute else elapsed
        courses = [
            elapsed if T == 0.0 else T * np.exp(-begun / T) * -np.expm1(-warming / T)
            for T in self.over
        ]
        return np.concatenate([c[:, None, None] * np.eye(3) for c in courses], axis=2)


def warm_ups(load_cases: LoadCases) -> tuple[Array, ...]:
    """(N, 3, 3) each: readings of drifts along x, y, z that die away over longer and longer times.

    From `FEWEST` readings on, by doubling, up to the whole series; none where nobody says in which
    order or when the readings were taken.
    """
    drift = ReadingDrift("tracker", 1.0, load_cases.time is not None)
    shortest, whole = drift._span(load_cases)
    if not shortest:
        return ()
    times = shortest * 2.0 ** np.arange(int(np.log2(max(whole / shortest, 1.0))) + 1)
    return tuple(replace(drift, over=(float(T),)).offsets(load_cases) for T in times)


def _time(name: str) -> float:
    text = name.partition(OVER)[2]
    try:
        T = float(text)
    except ValueError:
        T = np.nan
    if not (np.isfinite(T) and T > 0.0 and f"{T:g}" == text):
        raise InputError(
            f"the parameter {name!r} does not say over how long the drift dies away",
            remedy="Write rate_x_over_40 for 40 readings, or for 40 s where there is a clock.",
        )
    return T
