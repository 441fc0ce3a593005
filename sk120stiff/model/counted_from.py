"""From where a model's effects count, and readings of which they do not know how late they are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from sk120stiff.effects import Counting, Effect, Reference, references_of, referred
from sk120stiff.effects.reference import ORDER, TEMPERATURE, TIME
from sk120stiff.errors import listed, warn
from sk120stiff.measurements import Measurements
from sk120stiff.model.model import Model
from sk120stiff.model.reference_file import reference_example

UNITS = {TEMPERATURE: " degC", TIME: " s", ORDER: ""}


def counted_from(model: Model, references: Iterable[Reference]) -> Model:
    """The model as it is fitted to readings that have these references; see `Counting`."""
    known = tuple(references)
    return replace(
        model,
        parameters=tuple(replace(p, effect=referred(p.effect, known)) for p in model.parameters),
    )


def warn_of_references(model: Model, readings: Measurements) -> None:
    """Say what effects that go with temperature or a clock count from, where that is in doubt.

    Warns:
        ToolkitWarning: The model has no reference; or the readings do not state what an effect goes
            with, or state it by another clock.
    """
    if readings.absolute is None:
        return
    here = {known.of: known for known in references_of(readings)}
    groups: dict[tuple[str, Reference | None], list[Effect]] = {}
    for effect in model.effects:
        if isinstance(effect, Counting):
            groups.setdefault((effect.goes_with, effect.reference), []).append(effect)
    for (of, reference), effects in groups.items():
        told = _doubt(of, reference, here.get(of))
        if told:
            names = listed([effect.id for effect in effects])
            warn(f"Effects that go with the {of} ({names}): {told}", stacklevel=3)


def _doubt(of: str, reference: Reference | None, own: Reference | None) -> str:
    """What is in doubt, in sentences; empty where nothing is."""
    if own is None:
        if reference is None:
            return ""
        at = f"{reference.value:.6g}{UNITS[of]}"
        return (
            f"these readings state no {of}; they count as read at {at}, the reference of the "
            "readings that the model was identified from."
        )
    if reference is None:
        start = "their mean" if of == TEMPERATURE else "the first of them"
        return (
            f"the model does not say from which {of} they count, as files of earlier versions do "
            f"not. Here it is from {start}, and the same rows in another file may be predicted "
            f"otherwise. Identify the model again, or write {reference_example(of)} with your "
            "number below 'where'."
        )
    if reference.until(own) is None:
        return (
            f"the {of} of these readings goes from {_stretch(own)}, that of the readings which the "
            f"model was identified from went from {_stretch(reference)}. That is taken for another "
            "clock, and these count from their own first."
        )
    return ""


def _stretch(clock: Reference) -> str:
    return f"{clock.value:.10g} to {clock.last:.10g}{UNITS[clock.of]}"
