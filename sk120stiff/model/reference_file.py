"""From where an effect counts, as a part of its entry in a model's file.

::

    - name: thermal_growth
      where: link_2
      reference: {temperature: 24.3, unit: degC}      # or {time: 60, last: 4800, unit: s}
      parameters: ...                                 # or {order: 1, last: 80}
"""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict

from sk120stiff.effects import Counting, Effect, Reference
from sk120stiff.effects.reference import ORDER, TEMPERATURE, TIME
from sk120stiff.errors import InputError
from sk120stiff.model.uncertainty_file import Line

UNITS = {TEMPERATURE: "degC", TIME: "s", ORDER: ""}


class ReferenceSection(BaseModel):
    """The entry as it stands in a file."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    temperature: float | None = None
    time: float | None = None
    order: float | None = None
    last: float | None = None
    unit: str = ""


def reference_document(effect: Effect) -> dict[str, object]:
    """The entry of an effect, under its key; none of one that counts from nothing."""
    known = effect.reference if isinstance(effect, Counting) else None
    if known is None:
        return {}
    last = {} if known.last is None else {"last": known.last}
    unit = {"unit": UNITS[known.of]} if UNITS[known.of] else {}
    return {"reference": Line({known.of: known.value, **last, **unit})}


def with_reference(effect: Effect, section: ReferenceSection | None) -> Effect:
    """The effect as it counts by its entry.

    Raises:
        InputError: It goes with something else, or the unit is another one.
    """
    if section is None:
        return effect
    stated = {of: value for of in UNITS if (value := getattr(section, of)) is not None}
    if not isinstance(effect, Counting):
        raise InputError(
            f"the effect {effect.name!r} counts from no reference", remedy="Take 'reference' out."
        )
    of, remedy = effect.goes_with, f"Write {reference_example(effect.goes_with)}."
    if list(stated) != [of]:
        raise InputError(
            f"the reference states {' and '.join(stated) or 'nothing'}, and this effect goes with "
            f"the {of}",
            remedy=remedy,
        )
    if section.unit != UNITS[of]:
        given = f"{section.unit!r}" if section.unit else "no unit"
        raise InputError(f"the reference has {given}", remedy=remedy)
    last = None if of == TEMPERATURE else section.last
    return effect.referred([Reference(of, stated[of], last)])


def reference_example(of: str) -> str:
    """How the entry is written."""
    example: dict[str, Any] = {
        TEMPERATURE: "{temperature: 20, unit: degC}",
        TIME: "{time: 0, unit: s}",
        ORDER: "{order: 1}",
    }
    return f"'reference: {example[of]}'"
