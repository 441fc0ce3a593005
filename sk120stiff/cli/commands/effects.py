"""`sk120stiff effects [NAME]`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.tables import table
from sk120stiff.effects import catalogue_words


def command(
    name: Annotated[str | None, typer.Argument()] = None,
) -> Answer:
    """What every effect and its numbers mean: law, axes, sign, unit.

    The same words stand beside every number in reports, verdicts and model files.

    Example: sk120stiff effects force_bias

    Args:
        name ([NAME]): One effect; all without a name.
    """
    found = catalogue_words(name)
    parts: list[object] = []
    for each in found:
        parts += _parts(each)
    return Answer({"effects": found}, parts)


def _parts(each: dict[str, Any]) -> list[object]:
    rows = [tuple(item.values()) for item in each["parameters"]]
    meanings = table("", ["parameter", "unit", "what it means"], rows)
    meanings.title = None
    for column in meanings.columns:
        column.justify = "left"
    return [
        f"{each['name']}, at {each['where']}. {each['sentence']}",
        f"    law:  {each['equation']}",
        f"    axes: {each['axes']}",
        *([f"    also: {each['also']}"] if each["also"] else []),
        meanings,
    ]
