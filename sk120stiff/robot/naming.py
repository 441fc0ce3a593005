"""How a robot is named in a command or a file: what it is, and the arguments of its xacro.

``ur.urdf.xacro name:=ur ur_type:=ur5e`` reads as ROS writes it. A robot carries this name, so a
model that was made with arguments finds the same robot again.
"""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from sk120stiff.errors import InputError

_ARGUMENT = re.compile(r"\s([A-Za-z_][\w.-]*):=")


class RobotName(NamedTuple):
    """A bundled name, a path or URDF text, and the values of xacro arguments."""

    place: str
    arguments: dict[str, str]

    def __str__(self) -> str:
        words = (f"{name}:={shlex.quote(value)}" for name, value in self.arguments.items())
        return " ".join([self.place, *words])

    def with_arguments(self, arguments: Mapping[str, str]) -> RobotName:
        """The same robot with more arguments; a later value of one name holds."""
        return RobotName(self.place, {**self.arguments, **arguments})

    def found_from(self, folder: Path) -> RobotName:
        """A relative path that holds from `folder`, as it reads here; anything else as it is."""
        there = folder / self.place
        return RobotName(str(there), self.arguments) if self._is_file(there) else self

    def seen_from(self, folder: Path) -> RobotName:
        """A relative path that holds here, as it reads from `folder`; anything else as it is."""
        if Path(self.place).is_absolute() or not self._is_file(Path(self.place)):
            return self
        return RobotName(Path(os.path.relpath(self.place, folder)).as_posix(), self.arguments)

    def _is_file(self, path: Path) -> bool:
        if not self.place.strip() or self.place.lstrip("\ufeff \t\r\n").startswith("<"):
            return False
        try:
            return path.exists()
        except (OSError, ValueError):  # names that are too long or hold zero bytes
            return False


def robot_name(text: str) -> RobotName:
    """Read the name of a robot.

    Raises:
        InputError: Something behind the first argument is none.
    """
    first = None if text.lstrip("\ufeff \t\r\n").startswith("<") else _ARGUMENT.search(text)
    if first is None:
        return RobotName(text, {})
    try:
        words = shlex.split(text[first.start() :])
    except ValueError as error:  # a quote that is not closed
        raise InputError(
            f"the arguments cannot be read ({error})", where=text, remedy="Write NAME:=VALUE ..."
        ) from error
    return RobotName(text[: first.start()].rstrip(), xacro_arguments(words, where=text))


def xacro_arguments(words: Iterable[str], *, where: str) -> dict[str, str]:
    """Values by name of words like ``name:=value``.

    Raises:
        InputError: A word is none of these.
    """
    found: dict[str, str] = {}
    for word in words:
        name, sign, value = word.partition(":=")
        if not sign or not name.strip():
            raise InputError(
                f"{word!r} is no argument of a xacro",
                where=where,
                remedy="Write NAME:=VALUE, without blanks around ':='.",
            )
        found[name.strip()] = value
    return found
