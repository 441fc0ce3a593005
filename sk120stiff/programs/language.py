"""The contract of a robot language: a template, a grammar, and a check of one by the other.

A language is one file in `languages/`, its template in `templates/` and one line in `catalogue`.
Whatever it writes is read again by its own grammar and held against the targets before anybody
gets it: a slip of a template is an error here, not a motion of a robot.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cache
from textwrap import wrap
from typing import ClassVar

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, warn
from sk120stiff.programs.program import Program, Setting, Targets, positive
from sk120stiff.robot.rotations import rotation_vector

POSITION = 1e-6  # m: farther from its target no position may be written
ROUNDED = 0.505  # of a last digit; half of one, and the rounding of the halves
NOTICED = 0.01  # share of a speed: a rounding by more is said


class Language(ABC):
    """One robot language.

    Attributes:
        name: What ``--to`` calls it.
        ending: Of its files.
        title: Maker and language, for people.
        template: File in `templates/`.
        settings: What it needs beside the path, with defaults.
        frame: The setting that names the part's frame on the controller; while it has its default,
            targets are in the robot's base.
        axis_digit: Step of the last digit of a joint value as written.
        angle_digit: Step of the last digit of an orientation [rad].
        speed_digit: Step of the last digit of a speed [m/s].
        width: Longest line of a comment.
        longest_name: Letters of a program's name.
        most_axes: Axes that it can say.
        joint_moves: Can a move go by joint values?
    """

    name: ClassVar[str]
    ending: ClassVar[str]
    title: ClassVar[str]
    template: ClassVar[str]
    settings: ClassVar[Mapping[str, Setting]] = {}
    frame: ClassVar[str] = ""
    axis_digit: ClassVar[float]
    angle_digit: ClassVar[float]
    speed_digit: ClassVar[float]
    width: ClassVar[int] = 100
    longest_name: ClassVar[int] = 32
    most_axes: ClassVar[int] = 12
    joint_moves: ClassVar[bool] = True

    @abstractmethod
    def content(self, program: Program) -> dict[str, object]:
        """What the template is filled with beside `program`, `name` and `header`."""

    @abstractmethod
    def read(self, text: str) -> Targets:
        """The targets of a program that this language has written, by its own grammar.

        Raises:
            ValueError: It is none.
        """

    def axes(self, program: Program) -> Array:
        """(N, n) joint values as this language writes them: degrees and millimetres."""
        return program.shown_joints

    def axis_step(self, program: Program) -> float:
        """Step of the last digit of `axes`."""
        del program
        return self.axis_digit

    def remarks(self, settings: Mapping[str, str]) -> list[str]:
        """Sentences for the header: how its moves end."""
        blend = positive(settings, "blend", zero=True) if "blend" in settings else 0.0
        if blend:
            return [f"Targets are passed without a stop, corners rounded within {blend:g} mm."]
        return ["Every move ends in a stop at its target."]

    def in_part_frame(self, settings: Mapping[str, str]) -> bool:
        """Are targets stated in the frame of the part?"""
        return bool(self.frame) and settings[self.frame] != self.settings[self.frame].default

    def with_defaults(self, given: Mapping[str, str]) -> dict[str, str]:
        """Every setting with its value.

        Raises:
            InputError: One that the language does not have.
        """
        for key in given:
            if key not in self.settings:
                known = "; ".join(f"{k}: {s.meaning}" for k, s in self.settings.items())
                raise InputError(
                    f"{self.title} has no setting {key!r}",
                    where="--set",
                    remedy=f"It has: {known}." if known else "It has none.",
                )
        return {key: given.get(key, setting.default) for key, setting in self.settings.items()}

    def text(self, program: Program) -> str:
        """The program, read again and found right.

        Raises:
            InputError: The language cannot say it.
        """
        if len(program.axes) > self.most_axes:
            raise InputError(
                f"{self.title} has {self.most_axes} axes, this arm {len(program.axes)}",
                where=f"--to {self.name}",
                remedy="Choose another language, or --to csv.",
            )
        written = _environment().get_template(self.template).render(
            program=program,
            name=self.identifier(program.name),
            header=[part for line in program.header for part in self._wrapped(line)],
            settings=program.settings,
            **self.content(program),
        )  # fmt: skip
        self.check(program, written)
        return written

    def check(self, program: Program, written: str) -> None:
        """Hold a program's text against its targets.

        Raises:
            RuntimeError: They differ by more than the digits that are written.
        """
        found = self.read(written)
        if found.position.shape != program.position.shape:
            raise RuntimeError(f"{self.title}: {len(found.position)} of {program.count} targets")
        self.hold(found, program.position, program.rotation)
        joints = np.abs(found.joints - self.axes(program)).max()
        said = np.isfinite(found.speed)
        speed = np.abs(found.speed - program.speed)[said].max(initial=0.0)
        self._refuse("joint", joints, ROUNDED * self.axis_step(program) + 1e-9)
        self._refuse("speed", speed, ROUNDED * self.speed_digit)
        off = np.abs(found.speed / program.speed - 1.0)[said].max(initial=0.0)
        if off > NOTICED:
            warn(
                f"{self.title} states speeds in steps of {1e3 * self.speed_digit:.3g} mm/s: one is "
                f"rounded by {100 * off:.2g} %",
                stacklevel=3,
            )

    def hold(self, found: Targets, position: Array, rotation: Array) -> None:
        """Hold what was read against places (N, 3) [m] and (N, 3, 3).

        Raises:
            RuntimeError: They differ by more than the digits that are written.
        """
        away = np.linalg.norm(found.position - position, axis=1).max()
        self._refuse("position", away, POSITION)
        if found.rotation is not None:
            turn = found.rotation @ np.swapaxes(rotation, -1, -2)
            turned = np.linalg.norm(rotation_vector(turn), axis=1).max()
            self._refuse("orientation", turned, 2.0 * self.angle_digit)

    def _refuse(self, what: str, size: float, allowed: float) -> None:
        if not size <= allowed:
            raise RuntimeError(f"{self.title}: a {what} is written {size:.3g} off its target")

    def identifier(self, name: str) -> str:
        """The program's name as the language allows it."""
        plain = re.sub(r"\W+", "_", ascii_text(name)).strip("_") or "path"
        plain = plain if plain[0].isalpha() else f"p_{plain}"
        return plain[: self.longest_name]

    def _wrapped(self, line: str) -> list[str]:
        return wrap(ascii_text(line), self.width) or [""]


def ascii_text(text: str) -> str:
    """Text that every controller can show, on one line and without brackets of comments."""
    plain = text.translate(_PLAIN).encode("ascii", "replace").decode("ascii")
    return "".join(c if c.isprintable() else " " for c in plain)


_PLAIN = {ord(a): b for a, b in {"µ": "u", "±": "+-", "°": " deg", "−": "-", "·": "*", "–": "-",
                                 "(": "[", ")": "]", "²": "2", "…": "..."}.items()}  # fmt: skip


def numbers(text: str) -> list[float]:
    """Numbers separated by commas.

    Raises:
        ValueError: Something else stands there.
    """
    return [float(part) for part in text.split(",")]


@cache
def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("sk120stiff.programs"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
