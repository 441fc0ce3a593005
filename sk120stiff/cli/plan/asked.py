"""What a plan is asked for: parameters and effects by their names."""

from __future__ import annotations

from sk120stiff.effects import Effect, effect
from sk120stiff.errors import InputError
from sk120stiff.model import Model


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
