"""Model files of earlier versions: parameters that had another name, and the other sign."""

from __future__ import annotations

from typing import TypeVar

from pydantic import BaseModel

from sk120stiff.effects import Effect
from sk120stiff.errors import InputError, warn

Value = TypeVar("Value", bound=BaseModel)


def translated(kind: type[Effect], parameters: dict[str, Value], place: str) -> dict[str, Value]:
    """The parameters of an effect under their names of today, former ones with the sign turned.

    An instrument's error was once stated as true minus reported, under the former name; today it is
    what the instrument adds, reported minus true. A name has one sign for ever, so that no file is
    ever read the wrong way round.

    Raises:
        InputError: A parameter stands there under both names.

    Warns:
        ToolkitWarning: Something was translated.
    """
    former = kind.former
    found: dict[str, Value] = {}
    for key, item in parameters.items():
        now = former.get(key)
        if now is None:
            found[key] = item
            continue
        if now in parameters:
            raise InputError(
                f"{key!r} and {now!r} are one parameter, with opposite signs",
                where=place,
                remedy=f"Keep {now!r}: reported minus true.",
            )
        turned = -float(getattr(item, "value", 0.0)) + 0.0
        found[now] = item.model_copy(update={"value": turned})
    if found.keys() != parameters.keys():
        old = ", ".join(key for key in parameters if key in former)
        warn(
            f"{place}: {old} was written by an earlier version, as true minus reported. It is read "
            f"as {', '.join(former[key] for key in parameters if key in former)}, reported minus "
            f"true, with the other sign. 'sk120stiff effects {kind.name}' says what it means.",
            stacklevel=5,
        )
    return found
