"""What a robot program says, before it is put into any language."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError


@dataclass(frozen=True, eq=False)
class Program:
    """N targets of one arm, the first approached by its joints, the others in straight lines.

    Attributes:
        name: Of the program, as its file is called.
        header: What stands at the top: model, data, branch, conventions, settings.
        axes: (n,) names of the controller's axes.
        slides: (n,) does the axis slide?
        joints: (N, n) values of the controller's axes [rad or m].
        position, rotation: (N, 3) and (N, 3, 3) of the unloaded tool at these joints [m].
        speed: (N,) on the way to each target [m/s].
        rapid: (N,) is the move to the target a rapid one?
        lines: (N,) line of the source file.
        by_joints: Move by the joint values instead of in straight lines.
        settings: What the language is told beside this, every key with a value.
        date: Of the writing, ``2026/11/22 09:30``.
        halts: (N,) does it wait for its operator at the target? None: nowhere.
    """

    name: str
    header: tuple[str, ...]
    axes: tuple[str, ...]
    slides: tuple[bool, ...]
    joints: Array
    position: Array
    rotation: Array
    speed: Array
    rapid: Mask
    lines: Index
    by_joints: bool
    settings: Mapping[str, str]
    date: str
    halts: Mask | None = None

    def waits(self, target: int) -> bool:
        """Does the program wait for its operator at a target, counted from 0?"""
        return self.halts is not None and bool(self.halts[target])

    def waited(self, target: int) -> int:
        """How often it waits before a target, counted from 0."""
        return 0 if self.halts is None else int(self.halts[:target].sum())

    def __post_init__(self) -> None:
        N, n = self.joints.shape
        if self.position.shape != (N, 3) or self.rotation.shape != (N, 3, 3):
            raise ValueError("positions, rotations and joints of different numbers of targets")
        if len(self.axes) != n or len(self.slides) != n or self.speed.shape != (N,):
            raise ValueError("axes or speeds that do not fit the joints")
        for values in (self.joints, self.position, self.rotation, self.speed):
            if not np.isfinite(values).all():
                raise ValueError("a target that is not finite")
        if not N or (self.speed <= 0.0).any():
            raise ValueError("a program without targets, or a speed that is not positive")

    @property
    def count(self) -> int:
        """Number of targets N."""
        return len(self.joints)

    @property
    def shown_joints(self) -> Array:
        """(N, n) axes in degrees and millimetres."""
        return self.joints * np.where(self.slides, 1e3, 180.0 / np.pi)


@dataclass(frozen=True, eq=False)
class Targets:
    """What a reader finds in a program.

    Attributes:
        position: (N, 3) [m].
        rotation: (N, 3, 3); None where the language has none.
        joints: (N, n) axes in degrees and millimetres, or in counts of the controller.
        speed: (N,) [m/s]; NaN where a move has none.
    """

    position: Array
    rotation: Array | None
    joints: Array
    speed: Array


@dataclass(frozen=True)
class Setting:
    """Something a language needs that the path does not tell.

    Attributes:
        default: Its value where nobody says otherwise.
        meaning: A phrase for messages and the program's header.
    """

    default: str
    meaning: str


def whole_number(settings: Mapping[str, str], key: str) -> int:
    """A setting that counts.

    Raises:
        InputError: It is no whole number from 0 on.
    """
    text = settings[key].strip()
    if not (text.isascii() and text.isdigit()):
        raise InputError(f"{text!r} is no number", where=f"--set {key}", remedy="Write 0, 1, 2, …")
    return int(text)


def percent(settings: Mapping[str, str], key: str) -> int:
    """A setting from 1 to 100.

    Raises:
        InputError: It is none.
    """
    if not 1 <= (value := whole_number(settings, key)) <= 100:
        raise InputError(f"{value} % is no speed", where=f"--set {key}", remedy="Write 1 to 100.")
    return value


BLEND = Setting("0", "how far corners may be rounded [mm]; 0: a stop at every target")


def positive(settings: Mapping[str, str], key: str, *, zero: bool = False) -> float:
    """A setting that is a positive number, or zero where that is allowed.

    Raises:
        InputError: It is none.
    """
    text = settings[key].strip()
    value = float(text) if re.fullmatch(r"[+-]?[0-9]*\.?[0-9]+([eE][+-]?[0-9]+)?", text) else -1.0
    if not (0.0 < value < 1e6 or (zero and value == 0.0)):
        raise InputError(f"{settings[key]!r} is no positive number", where=f"--set {key}")
    return value
