"""What happens around every command: options they share, messages, exit codes, the printing.

A command is a function that returns an `Answer`. It never prints to stdout, never exits and catches
nothing: all of that is done here, once.
"""

from __future__ import annotations

import functools
import inspect
import logging
import os
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, NoReturn, TextIO

import typer

from sk120stiff.cli.document import as_json_text
from sk120stiff.errors import ToolkitError
from sk120stiff.files import running

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks and every log message.")]

INTERRUPTED = 130


@dataclass(frozen=True)
class Answer:
    """What a command has found.

    Attributes
    ----------
    document
        The JSON document: plain containers, numbers, arrays, dataclasses; SI.
    parts
        The same for people: lines of text and rich renderables, printed in order.
    exit_code
        1 where the answer is a refusal that `parts` and `document` explain.
    afterwards
        What the command goes on with once its answer is printed (a server that runs).
    """

    document: Mapping[str, object]
    parts: Sequence[object] = ()
    exit_code: int = 0
    afterwards: Callable[[], None] | None = None


def framed(body: Callable[..., Answer]) -> Callable[..., None]:
    """`body` with --json and --debug, run under `guarded`, its answer printed."""
    signature = inspect.signature(body, eval_str=True)

    @functools.wraps(body)
    def run(*, as_json: bool, debug: bool, **options: object) -> None:
        with guarded(debug=debug), running(), _messages(debug=debug):
            answer = body(**options)
            emit(answer, as_json=as_json)
            if answer.afterwards is not None:
                answer.afterwards()
        if answer.exit_code:
            raise typer.Exit(answer.exit_code)

    keyword = inspect.Parameter.KEYWORD_ONLY
    parameters = [p.replace(kind=keyword) for p in signature.parameters.values()]
    for name, annotation in (("as_json", AsJson), ("debug", Debug)):
        parameters.append(inspect.Parameter(name, keyword, default=False, annotation=annotation))
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    return run


@contextmanager
def guarded(*, debug: bool | None = None) -> Iterator[None]:
    """Turn whatever goes wrong inside into one message on stderr and an exit code.

    Parameters
    ----------
    debug
        Show the traceback too. Default: whether ``--debug`` stands on the command line.
    """
    show = "--debug" in sys.argv if debug is None else debug
    try:
        yield
    except typer.Exit:
        raise
    except KeyboardInterrupt:
        _leave(INTERRUPTED, "Interrupted. Files that were not finished are left as they were.")
    except ToolkitError as error:
        _leave(error.exit_code, f"Error: {error}", trace=show)
    except BrokenPipeError:
        _hush(sys.stdout, sys.stderr)
        raise typer.Exit(1) from None
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        _leave(1, f"Error: {place}{error.strerror or error}.", trace=show)
    except MemoryError:
        _leave(1, "Error: not enough memory for this request.", trace=show)
    except Exception as error:  # noqa: BLE001  (the last resort, and it says so)
        what = str(error) or "no message"
        _leave(
            1,
            f"Internal error: {type(error).__name__}: {what}\n"
            "This is a fault of the program, not of your input; "
            "run the command again with --debug and report what it prints.",
            trace=show,
        )


def emit(answer: Answer, *, as_json: bool) -> None:
    """Print an answer on stdout: one JSON document, or its parts for people."""
    if as_json:
        print(as_json_text(answer.document))
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
            console.print(part, soft_wrap=isinstance(part, str))
    return "\n".join(line.rstrip() for line in capture.get().splitlines())


def note(text: str) -> None:
    """Tell the user something beside the answer, on stderr."""
    print(text, file=sys.stderr)


@contextmanager
def _messages(*, debug: bool) -> Iterator[None]:
    """Warnings and the package's log as single lines on stderr, each warning once."""
    seen: set[str] = set()

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
            seen.add(text)
            note(f"Warning: {text}" + (f" ({filename}:{lineno})" if debug else ""))

    log = logging.getLogger("sk120stiff")
    handler = logging.StreamHandler(sys.stderr)
    before = log.level
    log.addHandler(handler)
    log.setLevel(logging.DEBUG if debug else logging.INFO)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = show
            yield
    finally:
        log.removeHandler(handler)
        log.setLevel(before)


def _leave(code: int, message: str, *, trace: bool = False) -> NoReturn:
    try:
        if trace:
            traceback.print_exc(file=sys.stderr)
        note(message)
    except BrokenPipeError:
        _hush(sys.stderr)
    raise typer.Exit(code) from None


def _hush(*streams: TextIO) -> None:
    """Nobody reads these any more: keep the interpreter from complaining when it flushes them."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in streams:
        os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
