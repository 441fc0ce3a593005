"""What a command takes: names, types and defaults by its signature, words by its docstring."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from copy import copy
from typing import Annotated, Any

import typer

_ENTRY = re.compile(r"(\w+)(?: \(([^)]+)\))?: (.+?)(?: \[default: (.+)\])?")


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
