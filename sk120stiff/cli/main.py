"""The entry point: lists the commands, and imports one only when it is called."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from importlib import import_module
from typing import Annotated, Any, cast

import typer
from typer.core import TyperGroup
from typer.main import get_command

from sk120stiff.cli.environment import prepare

PROGRAM = "sk120stiff"
BAD_USAGE = 2
_ASKED_FOR_JSON = ContextVar("asked for JSON", default=False)
# typer shows the base class of its usage errors under no public name.
_UsageError = cast(type[Exception], typer.BadParameter.__mro__[1])

# Command → what it answers. `commands/NAME.py`, or the folder of that name, holds its function
# `command`, whose docstring opens with the same line; it is imported when the command is called,
# not before.
COMMANDS = {
    "check": "Does a robot load, what moves, what is suspicious.",
    "new": "A folder to start from: robot, model, empty measurements.",
    "stiffness": "How stiff the arm is: here, this way, under this load.",
    "identify": "Spring values and their uncertainty from measured deflections.",
    "predict": "Predicted displacement of every reading ± error, and the gap.",
    "explain": "What is missing when simulation and measurement disagree.",
    "effects": "What every effect and its numbers mean: law, axes, sign, unit.",
    "plan": "The poses and loads to measure next.",
    "pilot": "Which reading comes next, what is known, and when to stop.",
    "simulate": "Synthetic measurements from a model: loads, noise, zeros.",
    "import": "Readings of trackers and calibration programs as measurements.",
    "compensate": "Joint commands that cancel the deflection along a loaded path.",
    "export": "A calibrated URDF, DH tables, or an arm for a simulator.",
    "posture": "The stiffest or least deflected posture for a tool path.",
    "map": "Stiffness over the workspace: extremes, directions, stability.",
    "paper": "The 2005 paper's tables, figures, claims: ours beside theirs.",
    "view": "The robot, its ellipsoids and its gaps, live in the browser.",
    "demo": "The main job on measured data, and on a hidden cause.",
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

    with guarded(debug="--debug" in sys.argv, as_json=_ASKED_FOR_JSON.get()):
        body = import_module(f"{__package__}.commands.{name}").command
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
    Exit codes: 0 done, 1 an explained refusal, 2 bad usage or bad input, 3 an internal error.
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
    """Run one command and return its exit code: 0, 1, 2, 3, or 130 when interrupted.

    With ``--json`` among the arguments every failure prints one JSON document on stdout.

    Args:
        arguments: What follows the program's name; the process's own arguments by default.
    """
    prepare()
    words = list(sys.argv[1:] if arguments is None else arguments)
    _ASKED_FOR_JSON.set("--json" in words)
    try:
        code = application().main(args=words, prog_name=PROGRAM, standalone_mode=False)
    except OSError as error:  # nobody takes the help
        return _unheard(error)
    except _UsageError as error:
        return _misused(error, as_json=_ASKED_FOR_JSON.get())
    except SystemExit as leaving:
        code = leaving.code
    return code if isinstance(code, int) else int(code is not None)


def _unheard(error: OSError) -> int:
    """A stream that takes no more: say so on the other, and let the interpreter end quietly."""
    from sk120stiff.cli.frame import INTERNAL, NOBODY_READS, hush

    if isinstance(error, BrokenPipeError):
        hush(sys.stdout, sys.stderr)
        return NOBODY_READS
    hush(sys.stdout)
    print(f"Error: {error.strerror or error}.", file=sys.stderr)
    return INTERNAL


def _misused(error: Any, *, as_json: bool) -> int:
    """Say what is wrong with the command line, on stderr and where wanted as JSON."""
    error.message = error.message.replace("Value error, ", "")  # the parser's own words
    error.message += _elsewhere(error)
    error.show()
    if as_json:
        from sk120stiff.cli.frame import Failure
        from sk120stiff.files.json_text import as_json_text

        where = error.ctx.command_path if error.ctx is not None else PROGRAM
        said = (error.format_message(), where, f"Try '{where} --help'.")
        print(as_json_text(Failure(BAD_USAGE, "usage", *said).document))
    return BAD_USAGE


def _elsewhere(error: Any) -> str:
    """Where a command takes what somebody gave by an option that it does not have."""
    option = getattr(error, "option_name", "")
    if option not in ("--robot", "--model", "--data") or error.ctx is None:
        return ""
    name = option.removeprefix("--")
    arguments = [p for p in error.ctx.command.params if p.param_type_name == "argument"]
    if any(name.upper() in (p.metavar or "").split("|") for p in arguments):
        order = " ".join(str(p.metavar) for p in arguments)
        return f" (the {name} is given without an option: {error.ctx.command_path} {order})"
    if name == "robot":
        return " (the robot stands in the YAML file beside the readings, as 'import' writes it)"
    return ""


if __name__ == "__main__":
    sys.exit(main())
