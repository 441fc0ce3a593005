"""`--xacro-arg`, on every command that takes a robot: the arguments become part of its name."""

from __future__ import annotations

import inspect
from typing import Annotated, Any

import typer

from sk120stiff.errors import InputError

OPTION = "--xacro-arg"

XacroArgs = Annotated[
    list[str] | None,
    typer.Option(
        OPTION,
        metavar="NAME:=VALUE",
        help="Value of an argument of the robot's xacro; may be repeated. Also: a key xacro in "
        "robot.yaml.",
        show_default=False,
    ),
]


def takes_robot(parameter: inspect.Parameter) -> bool:
    """Does this parameter of a command name a robot? Its metavar says so."""
    said = getattr(parameter.annotation, "__metadata__", ())
    return any("ROBOT" in (getattr(item, "metavar", None) or "") for item in said)


def with_xacro_arguments(options: dict[str, Any], robots: list[str], words: list[str]) -> None:
    """Put the words of `--xacro-arg` behind the robots that a command was given.

    Raises:
        InputError: A word is no ``NAME:=VALUE``, or a model was given, which knows its robot.
    """
    from sk120stiff.robot.naming import robot_name, xacro_arguments  # Pinocchio comes with it

    arguments = xacro_arguments(words, where=OPTION)
    for key in robots:
        if options[key] is None:
            continue
        name = robot_name(str(options[key]))
        if name.place.lower().endswith((".yaml", ".yml")) and not name.place.endswith("robot.yaml"):
            raise InputError(
                "a model knows its robot and the arguments of its xacro",
                where=OPTION,
                remedy=f"Write them behind the robot in {name.place}: robot: PATH NAME:=VALUE.",
            )
        options[key] = str(name.with_arguments(arguments))
