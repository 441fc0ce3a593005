"""What happens around every command: options they share, messages, exit codes, the printing.

A command is a function that returns an `Answer`. It never prints to stdout, never exits and catches
nothing: all of that is done here, once.
"""

from __future__ import annotations

import errno
import functools
import inspect
import logging
import os
import re
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from copy import copy
from dataclasses import dataclass
from typing import Annotated, Any, NoReturn, TextIO

import typer

from sk120stiff.cli.environment import visible
from sk120stiff.cli.xacro_option import XacroArgs, takes_robot, with_xacro_arguments
from sk120stiff.errors import InputError, Refusal, ToolkitError
from sk120stiff.files import remembered, running
from sk120stiff.files.json_text import SCHEMA, as_json_text

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks and every log message.")]

INTERNAL = 3
INTERRUPTED = 130
NOBODY_READS = 141  # as a shell reports a process whose reader has gone
_ENTRY = re.compile(r"(\w+)(?: \(([^)]+)\))?: (.+?)(?: \[default: (.+)\])?")


@dataclass(frozen=True)
class Answer:
    """What a command has found.

    Attributes:
        document: The JSON document: plain containers, numbers, arrays, dataclasses; SI.
        parts: The same for people: lines of text and rich renderables, printed in order.
        exit_code: 1 where the answer is a refusal that `parts` and `document` explain.
        afterwards: What the command goes on with once its answer is printed (a server that runs).
    """

    document: Mapping[str, object]
    parts: Sequence[object] = ()
    exit_code: int = 0
    afterwards: Callable[[], None] | None = None


def framed(body: Callable[..., Answer]) -> Callable[..., None]:
    """`body` with --json and --debug, run under `guarded`, its answer printed.

    A command that takes a robot gets --xacro-arg too.
    """
    told, parameters = declared(body)
    robots = [p.name for p in parameters if takes_robot(p)]

    @functools.wraps(body)
    def run(
        *, as_json: bool, debug: bool, xacro_args: list[str] | None = None, **options: object
    ) -> None:
        with running(), _messages(debug=debug) as warned:
            with guarded(debug=debug, as_json=as_json), remembered():
                if xacro_args:
                    with_xacro_arguments(options, robots, xacro_args)
                answer = body(**options)
                if answer.afterwards is None:
                    emit(answer, as_json=as_json, warned=warned)
            if answer.afterwards is not None:
                # Once its address is printed, Ctrl-C is how a server ends: from the first letter
                # on. A document has been printed then: there is no second one for what goes wrong.
                with guarded(debug=debug), suppress(KeyboardInterrupt):
                    emit(answer, as_json=as_json, warned=warned)
                    answer.afterwards()
        if answer.exit_code:
            raise typer.Exit(answer.exit_code)

    keyword = inspect.Parameter.KEYWORD_ONLY
    if robots:
        parameters.append(
            inspect.Parameter("xacro_args", keyword, default=None, annotation=XacroArgs)
        )
    for name, annotation in (("as_json", AsJson), ("debug", Debug)):
        parameters.append(inspect.Parameter(name, keyword, default=False, annotation=annotation))
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    run.__doc__ = told
    return run


@contextmanager
def guarded(*, debug: bool, as_json: bool = False) -> Iterator[None]:
    """Turn whatever goes wrong inside into one message on stderr and an exit code.

    Args:
        debug: Show the traceback too.
        as_json: Print the message as a JSON document on stdout too.
    """
    try:
        yield
    except typer.Exit:
        raise
    except KeyboardInterrupt:
        said = "Interrupted. Files that were not finished are left as they were."
        _leave(Failure(INTERRUPTED, "interrupted", said), said, as_json=as_json)
    except ToolkitError as error:
        failure = Failure(error.exit_code, error.kind, error.what, error.where, error.remedy)
        _leave(failure, f"Error: {error}", trace=debug, as_json=as_json)
    except BrokenPipeError:
        hush(sys.stdout, sys.stderr)
        raise typer.Exit(NOBODY_READS) from None
    except OSError as error:
        place = str(error.filename) if error.filename else None
        if error.errno == errno.ENAMETOOLONG:
            bad = InputError("this name is longer than the system allows", where=f"{place}"[:80])
            failure = Failure(bad.exit_code, bad.kind, bad.what, bad.where)
            _leave(failure, f"Error: {bad}", trace=debug, as_json=as_json)
        failure = Failure(INTERNAL, "system", str(error.strerror or error), place)
        said = f"Error: {place + ': ' if place else ''}{failure.message}."
        _leave(failure, said, trace=debug, as_json=as_json)
    except MemoryError:
        failure = Failure(INTERNAL, "system", "not enough memory for this request")
        _leave(failure, f"Error: {failure.message}.", trace=debug, as_json=as_json)
    except Exception as error:  # noqa: BLE001  (the last resort, and it says so)
        what = f"{type(error).__name__}: {str(error) or 'no message'}"
        remedy = (
            "This is a fault of the program, not of your input; "
            "run the command again with --debug and report what it prints."
        )
        failure = Failure(INTERNAL, "internal", what, remedy=remedy)
        _leave(failure, f"Internal error: {what}\n{remedy}", trace=debug, as_json=as_json)


@dataclass(frozen=True)
class Failure:
    """What a failed command says in JSON.

    Attributes:
        exit_code: Of the process.
        kind: ``usage``, ``input``, ``refusal``, ``system`` (disk, memory), ``internal``,
            ``interrupted``.
        message, where, remedy: What is wrong, where, and what to do; None where there is nothing to
            say.
    """

    exit_code: int
    kind: str
    message: str
    where: str | None = None
    remedy: str | None = None

    @property
    def document(self) -> dict[str, object]:
        """The JSON document."""
        told = {"kind": self.kind, "message": self.message}
        return {"schema": SCHEMA, "error": {**told, "where": self.where, "remedy": self.remedy}}


def emit(answer: Answer, *, as_json: bool, warned: Sequence[str] = ()) -> None:
    """Print an answer on stdout: one JSON document, or its parts for people.

    Raises:
        Refusal: There is no standard output.
    """
    if sys.stdout is None:
        raise Refusal("standard output is closed, so the answer cannot be printed")
    refused: Mapping[str, object] = {}
    if answer.exit_code:
        said = next((part for part in answer.parts if isinstance(part, str)), "no result to give")
        refused = Failure(answer.exit_code, "refusal", said).document
    if as_json:
        print(as_json_text({"schema": SCHEMA, "warnings": warned, **answer.document, **refused}))
    elif answer.parts:
        print(_text(answer.parts))
    sys.stdout.flush()


def _text(parts: Sequence[object]) -> str:
    from rich.console import Console

    console = Console(highlight=False, markup=False, emoji=False)
    if not console.is_terminal:  # a pipe has no width: nothing is to be cut off
        console.width = 200
    with console.capture() as capture:
        for before, part in zip([None, *parts], parts, strict=False):
            if before is not None and not (isinstance(before, str) and isinstance(part, str)):
                console.print()  # a table stands apart
            shown = visible(part) if isinstance(part, str) else part
            console.print(shown, soft_wrap=isinstance(part, str))
    return "\n".join(line.rstrip() for line in capture.get().splitlines())


def note(text: str) -> None:
    """Tell the user something beside the answer, on stderr."""
    print(visible(text), file=sys.stderr)


def ahead(parts: Sequence[object]) -> None:
    """Tell the user, on stderr, what comes before the answer: what is about to be done."""
    print(_text(parts), file=sys.stderr, flush=True)


@contextmanager
def _messages(*, debug: bool) -> Iterator[list[str]]:
    """Warnings and the package's log as single lines on stderr; yields the warnings, each once."""
    seen: list[str] = []

    def show(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        del category, file, line  # the signature is Python's
        text = " ".join(str(message).split())
        if text not in seen:
            seen.append(text)
            note(f"Warning: {text}" + (f" ({filename}:{lineno})" if debug else ""))

    log = logging.getLogger("sk120stiff")
    handler = logging.StreamHandler(sys.stderr)
    before = log.level
    log.addHandler(handler)
    log.setLevel(logging.DEBUG if debug else logging.INFO)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = show
            yield seen
    finally:
        log.removeHandler(handler)
        log.setLevel(before)


def _leave(
    failure: Failure, message: str, *, trace: bool = False, as_json: bool = False
) -> NoReturn:
    try:
        if trace:
            traceback.print_exc(file=sys.stderr)
        note(message)
        if as_json:
            print(as_json_text(failure.document), flush=True)
    except BrokenPipeError:
        hush(sys.stdout, sys.stderr)
    raise typer.Exit(failure.exit_code) from None


def hush(*streams: TextIO | None) -> None:
    """Nobody reads these any more: keep the interpreter from complaining when it flushes them."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in streams:
        if stream is not None:  # closed from the beginning
            os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def declared(body: Callable[..., Any]) -> tuple[str, list[inspect.Parameter]]:
    """The help of a command, and its parameters as typer takes them.

    The section `Args` of the docstring has an entry ``name (METAVAR): help [default: words]`` for
    every parameter that is none of `options`. One without a default is an argument, a flag has no
    ``--no-...``; other names and bounds stand in the signature, as `typer.Option`.
    """
    told, _, section = (inspect.getdoc(body) or "").partition("\n\nArgs:\n")
    entries = [" ".join(text.split()) for text in re.split(r"\n    (?=\w)", f"\n{section}")]
    words = {match[1]: match for match in map(_ENTRY.fullmatch, entries) if match}
    given = inspect.signature(body, eval_str=True).parameters.values()
    return told, [_declared(p, words.get(p.name)) for p in given]


def _declared(p: inspect.Parameter, said: re.Match[str] | None) -> inspect.Parameter:
    kind, info = p.annotation, None
    if hasattr(kind, "__metadata__"):
        kind, info = kind.__origin__, copy(kind.__metadata__[0])
    elif p.default is p.empty:
        info = typer.Argument()
    else:
        info = typer.Option(*([f"--{p.name.replace('_', '-')}"] if kind is bool else []))
    if said is not None:
        info.metavar, info.help = said[2], said[3]
        info.show_default = said[4] or info.show_default
    return p.replace(kind=p.KEYWORD_ONLY, annotation=Annotated[kind, info])
