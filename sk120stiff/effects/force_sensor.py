"""The load is not what was reported: the force sensor misreads, or the load acts elsewhere.

A sensor sits on the tool, and its axes are those of the tool frame. What a rig of weights, cables
or cylinders gets wrong is constant in axes of the base instead: the hook that nobody weighed, the
pulley that rubs. So an error has two laws, one in each frame.
An error of the sensor is what it adds to the truth: reported minus true.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import LoadError, scale_of
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.effects.reference import ORDER, TIME
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import crossed

AXES = "xyz"
OF_RIG = "base_"
FRICTION = "friction"
RATE, ABOUT = "rate_", "_about_"


class _SensorError(LoadError):
    place: ClassVar[str] = "sensor"
    calibrated: ClassVar[bool] = True
    axes: ClassVar[str] = "axes of the tool frame at each pose, in which the sensor is mounted"


@dataclass(frozen=True)
class _RigError(_SensorError):
    """An error in axes of the tool, as of a sensor, or of the base, as of a rig of weights."""

    of_rig: bool = False
    also: ClassVar[str] = (
        f"..._{OF_RIG}x and so on: along axes of the base, as of a rig of weights, cables or "
        "cylinders"
    )

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The error in the frame that the names of the parameters tell."""
        return cls(where, scale_of(robot), any(f"_{OF_RIG}" in name for name in options.shape))

    def other_laws(self, load_cases: LoadCases) -> tuple[Self, ...]:
        """The same in the other frame."""
        return (replace(self, of_rig=not self.of_rig),)

    @property
    def _along(self) -> str:
        return f"{OF_RIG}{{}}" if self.of_rig else "{}"

    @property
    def _frame(self) -> str:
        return "base" if self.of_rig else "tool frame"

    def columns(self, x: Array, load_cases: LoadCases) -> Array:
        """(N, 6, P) derivative of the true load by the parameters."""
        if not self.of_rig:
            return super().columns(x, load_cases)
        turn = _of_wrench(load_cases.rotation)
        there = super().columns(np.einsum("nij,nj->ni", turn, x), load_cases)
        return np.asarray(np.swapaxes(turn, 1, 2) @ there)

    def matrix(self, values: Array, load_cases: LoadCases) -> Array:
        """(6, 6) derivative of the true load by the reported one, or (N, 6, 6) if poses differ."""
        here = super().matrix(values, load_cases)
        if not self.of_rig:
            return here
        turn = _of_wrench(load_cases.rotation)
        return np.asarray(np.swapaxes(turn, 1, 2) @ here @ turn)


def _of_wrench(rotation: Array) -> Array:
    """(N, 6, 6) what turns force and moment as (N, 3, 3) turns vectors."""
    out = np.zeros((len(rotation), 6, 6))
    out[:, :3, :3] = out[:, 3:, 3:] = rotation
    return out


@dataclass(frozen=True)
class ForceScale(_RigError):
    """Each force axis reads too much or too little by a share of its own, or a pulley rubs.

    Attributes:
        rubs: A pulley, or a guide, takes a share of the load while it grows and gives it while it
            falls.
    """

    rubs: bool = False
    name: ClassVar[str] = "force_scale"
    former: ClassVar[Mapping[str, str]] = {f"gain_{axis}": f"scale_{axis}" for axis in AXES}
    equation: ClassVar[str] = "F_reported - F_true = s * F_reported, axis by axis"
    says: ClassVar[str] = "The force sensor's axes read too much or too little in proportion."
    also: ClassVar[str] = (
        f"{_RigError.also}; {FRICTION}: of the whole load, taken while it grows and given while it "
        "falls, as by a pulley that rubs"
    )

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The law that names of the parameters tell."""
        found = super().at(robot, where, options)
        return replace(found, rubs=FRICTION in options.shape)

    def other_laws(self, load_cases: LoadCases) -> tuple[Self, ...]:
        """The same in the other frame; a pulley rubs where loads went up and down."""
        plain = replace(self, of_rig=False, rubs=False)
        laws = [plain, replace(plain, of_rig=True)]
        if load_cases.branch.min(initial=1.0) < 0.0 < load_cases.branch.max(initial=-1.0):
            laws.append(replace(plain, rubs=True))
        return tuple(law for law in laws if law != self)

    def sentence(self) -> str:
        """What happens."""
        if not self.rubs:
            return super().sentence()
        return "What the load goes over rubs: a pulley or a guide takes a share of it each way."

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Relative errors of the three force axes, or of the load as it goes up and down."""
        if self.rubs:
            means = (
                "share of the load that friction takes while it grows, and that is left on while "
                "it falls"
            )
            return (ParameterSpec(FRICTION, "1", "1", plausible=0.15, typical=0.01, lower=0.0,
                                  meaning=means),)  # fmt: skip
        return of_axes(
            f"scale_{self._along}", "1", plausible=0.12, typical=0.01,
            meaning=f"(reported - true) / reported force along {{}} of the {self._frame}; positive:"
            " the sensor reads too much",
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """One diagonal element of the force each: what the sensor adds is taken away."""
        if self.rubs:
            return -np.eye(6)[None]
        out = np.zeros((3, 6, 6))
        out[range(3), range(3), range(3)] = -1.0
        return out

    def columns(self, x: Array, load_cases: LoadCases) -> Array:
        """(N, 6, P) derivative of the true load by the parameters."""
        found = super().columns(x, load_cases)
        return found * load_cases.branch[:, None, None] if self.rubs else found

    def matrix(self, values: Array, load_cases: LoadCases) -> Array:
        """(6, 6) derivative of the true load by the reported one; (N, 6, 6) if rows differ."""
        if not self.rubs:
            return super().matrix(values, load_cases)
        return np.asarray(np.eye(6) * (1.0 - values[0] * load_cases.branch)[:, None, None])


@dataclass(frozen=True)
class ForceBias(_RigError):
    """The sensor adds a force that the unloaded reading did not have: a constant one, or a drift.

    Strain gauges creep and warm up: what they add goes on steadily, by the clock, or by the order
    of the readings where no time is known. The offset is that in the middle of the series.

    Attributes:
        drifts: `TIME` or `ORDER`, with which it goes on; empty: it is constant.
        about: The middle of the series [s or readings from the first one on].
    """

    drifts: str = ""
    about: float = 0.0
    name: ClassVar[str] = "force_bias"
    former: ClassVar[Mapping[str, str]] = {f"force_{axis}": f"offset_{axis}" for axis in AXES}
    equation: ClassVar[str] = "F_reported - F_true = b, under load alone"
    says: ClassVar[str] = "The force sensor has a constant offset under load."
    also: ClassVar[str] = (
        f"{_RigError.also}; with {RATE}x{ABOUT}300 and so on, what the sensor adds grows by so "
        "much each second, or reading; the offset is that 300 of them after the first reading"
    )

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The law that names and units of the parameters tell.

        Raises:
            InputError: They tell of no moment, or of several.
        """
        found = super().at(robot, where, options)
        told = {name.partition(ABOUT)[2] for name in options.shape if name.startswith(RATE)}
        if not told:
            return found
        try:
            (about,) = (float(each or 0.0) for each in told)
        except ValueError as error:
            raise InputError(
                "the names of the parameters do not tell about which moment the offset drifts",
                remedy=f"Write {RATE}x{ABOUT}300, and the same number for y and z.",
            ) from error
        return replace(found, drifts=TIME if options.timed else ORDER, about=about)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The clock that the units of the parameters tell, and the law that their names tell."""
        return Options(timed="N/s" in parameters.values(), shape=tuple(parameters))

    def other_laws(self, load_cases: LoadCases) -> tuple[Self, ...]:
        """The same in the other frame; a sensor's may drift where the file tells a clock."""
        plain = replace(self, of_rig=False, drifts="", about=0.0)
        laws = [plain, replace(plain, of_rig=True)]
        for each in (TIME, ORDER):
            clock = _clock(load_cases, each)
            if clock is not None:
                middle = float(f"{0.5 * clock.max():.3g}")
                laws.append(replace(plain, drifts=each, about=middle))
                break
        return tuple(law for law in laws if law != self)

    def sentence(self) -> str:
        """What happens."""
        return "The zero of the force sensor drifts." if self.drifts else super().sentence()

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """What the sensor adds to the true force."""
        size = self.scale**2
        offset = of_axes(
            f"offset_{self._along}", "N", plausible=50.0 * size, typical=5.0 * size,
            meaning=f"reported minus true force along {{}} of the {self._frame}; positive: the "
            "sensor reads too much",
        )  # fmt: skip
        if not self.drifts:
            return offset
        by_clock = self.drifts == TIME
        typical = size * (5e-3 if by_clock else 0.1)
        return (
            *offset,
            *of_axes(
                f"{RATE}{{}}{ABOUT}{self.about:g}", "N/s" if by_clock else "N",
                plausible=100.0 * typical, typical=typical,
                meaning="by how much that grows, about the middle of the series, for each "
                f"{'second' if by_clock else 'reading'}, along {{}} of the {self._frame}",
            ),
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the load."""
        return np.zeros((len(self.parameters), 6, 6))

    def offsets(self, load_cases: LoadCases) -> Array:
        """A unit force along each sensor axis, taken away; times the clock where it drifts."""
        unit = np.broadcast_to(-np.eye(6)[:, :3], (load_cases.count, 6, 3))
        if not self.drifts:
            return unit
        clock = _clock(load_cases, self.drifts)
        gone = np.full(load_cases.count, self.about) if clock is None else clock
        return np.concatenate([unit, (gone - self.about)[:, None, None] * unit], axis=2)


def _clock(load_cases: LoadCases, of: str) -> Array | None:
    """(N,) time [s] or number of each reading from the first of all on; None: not told."""
    since: Array | None = getattr(load_cases, of)
    begun: Array | None = getattr(load_cases, f"{of}_at_zero")
    return since if since is None or begun is None else since + begun


@dataclass(frozen=True)
class ForceRotation(_RigError):
    """The sensor is mounted turned by a small angle: W_true = W + φ × W."""

    name: ClassVar[str] = "force_rotation"
    equation: ClassVar[str] = "F_true = F_reported + a x F_reported, and moments alike"
    says: ClassVar[str] = (
        "The force sensor is mounted turned, so it sees the load in a wrong direction."
    )

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Mounting angles about the sensor axes."""
        return of_axes(
            f"angle_{self._along}", "rad", plausible=0.15, typical=0.0175,
            meaning=f"angle about {{}} of the {self._frame} by which the sensor is mounted turned, "
            "right-handed",
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """φ × acts on force and moment."""
        out = np.zeros((3, 6, 6))
        for k in range(3):
            out[k, :3, :3] = out[k, 3:, 3:] = crossed(np.eye(3)[k])
        return out


@dataclass(frozen=True)
class ForceCrosstalk(_SensorError):
    """A force along one sensor axis shows on another."""

    name: ClassVar[str] = "force_crosstalk"
    former: ClassVar[Mapping[str, str]] = {
        f"{source}_to_{target}": f"{source}_on_{target}" for source, target in permutations(AXES, 2)
    }
    equation: ClassVar[str] = "F_reported - F_true on one axis = c * F_reported along another"
    says: ClassVar[str] = "The force sensor's axes talk to each other."

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Share of each axis's force that the sensor adds to another's."""
        return tuple(
            ParameterSpec(
                f"{source}_on_{target}", "1", "1", plausible=0.12, typical=0.01,
                meaning=f"share of the reported force along {source} that the sensor adds along "
                f"{target} (tool frame)",
            )
            for source, target in permutations(AXES, 2)
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """One element off the diagonal each: what the sensor adds is taken away."""
        out = np.zeros((6, 6, 6))
        for k, (source, target) in enumerate(permutations(range(3), 2)):
            out[k, target, source] = -1.0
        return out


@dataclass(frozen=True)
class ForcePoint(_SensorError):
    """The load acts at another point of the tool than stated: M_true = M + o × F.

    Attributes:
        hung: It is a mass, of which people hardly know where its centre lies; a cable or a cylinder
            pulls where it is hooked.
    """

    hung: bool = False
    name: ClassVar[str] = "force_point"
    calibrated: ClassVar[bool] = False  # a place that was measured, no reading of the sensor
    of_payload: ClassVar[bool] = True
    equation: ClassVar[str] = "M_true = M_reported + o x F"
    says: ClassVar[str] = "The load acts at another point of the tool than stated."
    axes: ClassVar[str] = "axes of the tool frame"

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The place of a mass, or of whatever else pulls."""
        return cls(where, scale_of(robot), options.hung)

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """True place minus stated place."""
        plausible, typical = (0.5, 0.02) if self.hung else (0.2, 5e-3)
        return of_axes(
            "offset_{}", "m", plausible=plausible * self.scale, typical=typical * self.scale,
            meaning="true minus stated place of the load along {} of the tool frame",
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """The moment that the force has about the stated place."""
        out = np.zeros((3, 6, 6))
        for k in range(3):
            out[k, 3:, :3] = crossed(np.eye(3)[k])
        return out
