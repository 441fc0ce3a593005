"""What an effect and its parameters mean, in words: the one source for commands, reports, files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sk120stiff.effects.base import Effect
from sk120stiff.effects.catalogue import CATALOGUE, Catalogue


@dataclass(frozen=True)
class ParameterWords:
    """One parameter: its name, its unit, and what its value means, sign included."""

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class EffectWords:
    """One effect of the catalogue.

    Attributes:
        name: Public identifier.
        where: What it acts at, in words.
        sentence: What happens.
        equation: The law, in the symbols that `axes` and `parameters` explain.
        axes: The frame of its parameters.
        also: Its other laws, by the names of their parameters; empty where it has none.
        parameters: What is to be known about it.
    """

    name: str
    where: str
    sentence: str
    equation: str
    axes: str
    also: str
    parameters: tuple[ParameterWords, ...]


def words_of(effect: Effect) -> EffectWords:
    """An effect in words."""
    return EffectWords(
        name=effect.name,
        where=effect.where,
        sentence=effect.sentence(),
        equation=effect.equation,
        axes=effect.axes,
        also=effect.also,
        parameters=tuple(
            ParameterWords(spec.name, spec.unit, spec.meaning) for spec in effect.parameters
        ),
    )


def catalogue_words(
    name: str | None = None, catalogue: Catalogue = CATALOGUE
) -> tuple[EffectWords, ...]:
    """Every effect of the catalogue in words, or the one of that name.

    Raises:
        InputError: There is no such effect.
    """
    if name is None:
        return tuple(words_of(kind.sample()) for kind in catalogue)
    return (words_of(catalogue[name].sample()),)


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
