"""What an effect and its parameters mean, in words: the one source for commands, reports, files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sk120stiff.effects.base import Effect
from sk120stiff.effects.catalogue import CATALOGUE


def words_of(effect: Effect) -> dict[str, Any]:
    """An effect in words, as `sk120stiff effects` prints them.

    `name`, `where` it acts, the `sentence` of what happens, the law as `equation` in the symbols
    that `axes` and `parameters` explain, and by which names `also` its other laws are told; of
    every parameter its `name`, `unit` and `meaning`, sign included.
    """
    return {
        "name": effect.name,
        "where": effect.where,
        "sentence": effect.sentence(),
        "equation": effect.equation,
        "axes": effect.axes,
        "also": effect.also,
        "parameters": [
            {"name": spec.name, "unit": spec.unit, "meaning": spec.meaning}
            for spec in effect.parameters
        ],
    }


def catalogue_words(name: str | None = None) -> list[dict[str, Any]]:
    """Every effect of the catalogue in words, or the one of that name.

    Raises:
        InputError: There is no such effect.
    """
    kinds = CATALOGUE if name is None else [CATALOGUE[name]]
    found = [words_of(kind.sample()) for kind in kinds]
    return [{**each, "sentence": _at_no_place(each["sentence"])} for each in found]


def _at_no_place(sentence: str) -> str:
    """A sentence on an effect at no place in particular, as English has it.

    "The link a link bends" is a link that bends.
    """
    sentence = re.sub(r"^The (\w+) (an? \1)\b", r"\2", sentence)
    return sentence[0].upper() + sentence[1:]


def comment_lines(effect: Effect, *, most: int = 6) -> Iterator[str]:
    """The words beside an effect's values in a file: law, axes, then each parameter.

    Of more than `most` parameters the first alone is explained; the others read like it.
    """
    if effect.equation:
        yield f"{effect.equation}; in {effect.axes}"
    shown = effect.parameters if len(effect.parameters) <= most else effect.parameters[:1]
    for spec in shown:
        if spec.meaning:
            yield f"{spec.name} [{spec.unit}]: {spec.meaning}"
