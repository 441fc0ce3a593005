"""What a plan is asked for: parameters and effects by their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TypedDict

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect, effect
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.loads.masses_in_words import mass_told
from sk120stiff.model import Model
from sk120stiff.units import parse_values


def named_parameters(model: Model, text: str) -> tuple[Model, list[str]]:
    """The model with the parameter's effect in it, and the parameters that are meant."""
    head, dot, _ = text.rpartition(".")
    if dot and text in model.names:
        return model, [text]
    present = [p.name for p in model.parameters if text in (p.effect.id, p.effect.name)]
    if present:
        return model, present
    name, _, where = (head if dot else text).partition(":")
    added = effect(model.robot, name, where or None)
    larger = model if added.id in {e.id for e in model.effects} else model + added
    if not dot:
        return larger, [p.name for p in larger.parameters if p.effect.id == added.id]
    return larger, [larger.parameter(text).name]


LIKE = "Write it with its unit, like '5 kg'; several as '0; 5; 10 kg', or repeat the option."


class Hung(TypedDict, total=False):
    """What hangs on the tool, as `plan_positions` takes it."""

    payloads: list[float]
    payload_point: Array


def hung_on(
    masses: Sequence[str] | None, point: str | None, force: str | None, absolute: bool
) -> Hung:
    """--payload and --payload-point.

    Raises:
        InputError: They are no masses, positions are not what is planned, or a force is (--force).
    """
    if absolute and force is not None:
        raise InputError(
            "nothing pulls the tool where positions are read",
            where="--force",
            remedy="State what hangs on it: --payload '0; 5 kg'.",
        )
    if not absolute and (masses or point is not None):
        raise InputError(
            "nothing is hung on the tool where displacements by a pull are planned",
            where="--payload" if masses else "--payload-point",
            remedy="Add --positions to plan readings of where a marker stands; loads that pull the "
            "tool aside have --force.",
        )
    hung = Hung()
    if masses:
        hung["payloads"] = [mass for text in masses for mass in _kilograms(text)]
    if point is not None:
        hung["payload_point"] = parse_values(
            point, "length", where="--payload-point", like="0,0,80 mm"
        )
    return hung


def masses_understood(masses: Sequence[float]) -> str:
    """Which masses --payload was understood as, in a sentence."""
    several = listed([f"{mass:g} kg" for mass in masses])
    return f"Payloads are {several} (--payload)." if len(masses) > 1 else f"Payload: {several}."


def _kilograms(text: str) -> list[float]:
    """Masses of one --payload: '5 kg', or several as '0; 2.5 kg', '0, 5 kg' or '0,5,10 kg'.

    A comma without a blank parts whole numbers, or those with a point, and is no decimal comma. A
    number without a unit has that of the last.

    Raises:
        InputError: No mass, or a comma that may be a decimal one.
    """
    words = [word.strip() for word in re.split(r";|,\s", text)]
    if len(words) == 1 and "," in text:
        words = [word.strip() for word in text.split(",")]
    unit = words[-1].lstrip("0123456789. ")
    found = []
    for word in words:
        if "," in word or re.match(r"0\d", word):  # 0,05 kg; and 0,5 kg beside others
            raise InputError(
                f"a comma in {text.strip()!r} may be a decimal one, or part two masses",
                where="--payload",
                remedy="Write decimals with a point, '0.5 kg'; several masses as '0; 0.5 kg'.",
            )
        bare = re.fullmatch(r"\d+(?:\.\d+)?", word)
        found.append(mass_told(f"{word} {unit}" if bare else word, "--payload", LIKE))
    return found


def two_effects(model: Model, text: str) -> tuple[Effect, Effect]:
    """Two effects in one text; the name of a place may hold a comma itself."""
    words = text.split(",")
    failure: InputError | None = None
    for cut in range(1, len(words)):
        try:
            first, second = (
                _effect(model, ",".join(part).strip()) for part in (words[:cut], words[cut:])
            )
        except InputError as error:
            failure = failure or error
            continue
        if first.id == second.id:
            raise InputError(f"{first.id!r} stands there twice", where="--between")
        return first, second
    if failure is not None:
        raise failure
    raise InputError(
        f"{text!r} does not name two effects",
        where="--between",
        remedy="Write two with a comma between them: 'base_rocking,joint_tilt:joint_1_s'.",
    )


def _effect(model: Model, text: str) -> Effect:
    for present in model.effects:
        if text in (present.id, present.name):
            return present
    name, _, where = text.partition(":")
    return effect(model.robot, name, where or None)
