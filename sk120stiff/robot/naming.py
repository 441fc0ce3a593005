"""How a robot is named in a command or a file: what it is, and the arguments of its xacro.

``ur.urdf.xacro name:=ur ur_type:=ur5e`` reads as ROS writes it. A robot carries this name, so a
model that was made with arguments finds the same robot again.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Mapping
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


def robot_name(text: str) -> RobotName:
    """Read the name of a robot.

    Raises
    ------
    InputError
        Something behind the first argument is none.
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

    Raises
    ------
    InputError
        A word is none of these.
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
