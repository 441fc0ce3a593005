"""Where the tracker stands: the axes in which positions are read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects.base import Viewpoint, scale_of
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.errors import InputError, listed
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import left_jacobian, rotation_of


@dataclass(frozen=True)
class TrackerFrame(Viewpoint):
    """Turn and shift of the base frame as the tracker sees it, from each of its stations."""

    stations: tuple[str, ...] = ("",)
    name: ClassVar[str] = "tracker_frame"
    place: ClassVar[str] = "tracker"
    equation: ClassVar[str] = "x_read = R(r) x_base + t"
    says: ClassVar[str] = "The tracker stands elsewhere, and turned, against the base frame."
    axes: ClassVar[str] = "axes of the tracker"
    needs: ClassVar[str] = "positions"
    only_absolute: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """One frame of every station."""
        return cls(where, scale_of(robot), options.stations)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The stations that the names of the parameters tell: `STATION.x`, or `x` of one alone."""
        return Options(stations=tuple(dict.fromkeys(n.rpartition(".")[0] for n in parameters)))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Origin of the base frame and rotation vector of its axes, as each station sees them."""
        return tuple(spec for label in self.stations for spec in _seen_from(label))

    def frames(self, load_cases: LoadCases, values: Array) -> tuple[Array, Array]:
        """See `Viewpoint.frames`."""
        stood, frames = self._stood(load_cases), values.reshape(-1, 6)
        return rotation_of(frames[:, 3:])[stood], frames[stood, :3]

    def columns(self, load_cases: LoadCases, turned: Array, values: Array) -> Array:
        """A change of the rotation vector turns about J_l(r) dr (Chirikjian 2012, ch. 10)."""
        stood, frames = self._stood(load_cases), values.reshape(-1, 6)
        out = np.zeros((len(turned), 6, *frames.shape))
        for k, frame in enumerate(frames):
            J, own = left_jacobian(frame[3:]), stood == k
            out[own, :3, k, :3] = np.eye(3)
            out[own, :3, k, 3:] = np.cross(J.T[None], turned[own, None, :]).swapaxes(1, 2)
            out[own, 3:, k, 3:] = J
        return out.reshape(len(turned), 6, -1)

    def _stood(self, load_cases: LoadCases) -> Index:
        """(N,) which of the stations each reading was taken from.

        Raises:
            InputError: One that the model does not know.
        """
        named, stood = load_cases.station_names, load_cases.station
        unknown = [label or "(none)" for label in named if label not in self.stations]
        if unknown:
            raise InputError(
                f"the model does not know where the tracker stood for {listed(unknown)}; it knows "
                + listed([label or "(none)" for label in self.stations]),
                where="column station",
                remedy="Let 'identify' or 'explain' fit readings of that station too, or name it "
                "as the model does.",
            )
        if stood is None:
            return np.zeros(load_cases.count, dtype=np.intp)
        return np.array([self.stations.index(label) for label in named], dtype=np.intp)[stood]


def _seen_from(station: str) -> tuple[ParameterSpec, ...]:
    prefix, at = (f"{station}.", f", from station {station}") if station else ("", "")
    origin = "origin of the base frame along {} of the tracker" + at
    turn = "turn of the base frame: component {} of the rotation vector" + at
    return (
        *of_axes(prefix + "{}", "m", plausible=200.0, typical=1e-3, meaning=origin),
        *of_axes(prefix + "r{}", "rad", plausible=6.3, typical=1e-3, meaning=turn),
    )
