"""The entry point: lists the commands, and imports one only when it is called."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup
from typer.main import get_command

PROGRAM = "sk120stiff"

# Command → what it answers. `sk120stiff/cli/NAME.py` holds its function `command`, whose docstring
# opens with the same line; the file is imported when the command is called, not before.
COMMANDS = {
    "check": "Does a robot load, what moves, what is suspicious.",
    "stiffness": "How stiff the arm is: here, this way, under this load.",
    "identify": "Spring values and their uncertainty from measured deflections.",
    "predict": "Predicted displacement of every reading, and the gap to it.",
    "explain": "What is missing when simulation and measurement disagree.",
    "plan": "The poses and loads to measure next.",
    "simulate": "Synthetic measurements from a model: loads, noise, zeros.",
    "import": "A calibration file of marker positions as measurements.",
    "compensate": "Joint commands that cancel the deflection along a loaded path.",
    "export": "The modelled arm as a file for MuJoCo or SDF simulators.",
    "posture": "The stiffest or least deflected posture for a tool path.",
    "map": "Stiffness over the workspace: extremes, directions, stability.",
    "paper": "The 2005 paper's tables, figures, claims: ours beside theirs.",
    "view": "The robot, its ellipsoids and its gaps, live in the browser.",
    "demo": "The main job on the paper's measured data, with a report.",
}


class LazyGroup(TyperGroup):
    """Lists stand-ins, and swaps in the real command when one is called or completed."""

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """The real command of `args[0]`, imported now."""
        name, command, rest = super().resolve_command(ctx, args)
        if name is not None and command is not None:
            command = _load(name)
        return name, command, rest


def _load(name: str) -> Any:
    from sk120stiff.cli.frame import framed, guarded

    with guarded():
        body = import_module(f"{__package__}.{name}").command
    return get_command(_application(name, framed(body)))


def _application(name: str, body: Callable[..., None]) -> typer.Typer:
    single = typer.Typer(add_completion=False, rich_markup_mode=None)
    single.command(name)(body)
    return single


def _version(asked: bool) -> None:
    if asked:
        from sk120stiff import __version__

        print(f"{PROGRAM} {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_version, help="Print the version.")
    ] = False,
) -> None:
    """How stiff a robot arm is under load, which springs it has, and what its model is missing.

    Every command takes --help, --json (one JSON document on stdout) and --debug.
    Exit codes: 0 done, 1 an explained refusal or failure, 2 bad usage or bad input.
    """


def _stand_in() -> None:
    raise AssertionError("LazyGroup puts the real command in my place")


def application() -> Any:
    """The whole command line as one command object."""
    app = typer.Typer(
        cls=LazyGroup,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        no_args_is_help=True,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_root)
    for name, answers in COMMANDS.items():
        app.command(name, help=answers)(_stand_in)
    return get_command(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 0, 1, 2, or 130 when interrupted.

    Parameters
    ----------
    arguments
        What follows the program's name; the process's own arguments by default.
    """
    try:
        application().main(args=arguments, prog_name=PROGRAM)
    except SystemExit as leaving:
        return leaving.code if isinstance(leaving.code, int) else int(leaving.code is not None)
    return 0


if __name__ == "__main__":
    sys.exit(main())
