"""What a YAML file of ours may hold, and what pydantic finds in one, as one message of ours."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Annotated, Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sk120stiff.errors import InputError, meant

WANTED = {
    "tuple_type": "several values in square brackets are wanted",
    "list_type": "several values in square brackets are wanted",
    "float_parsing": "a number is wanted",
    "float_type": "a number is wanted",
    "string_type": "a text is wanted",
    "model_type": "keys with their values are wanted",
    "model_attributes_type": "keys with their values are wanted",
    "dict_type": "keys with their values are wanted",
}
LONGEST = 60  # letters of a value that are repeated

Finite = Annotated[float, Field(allow_inf_nan=False)]
Vector = tuple[Finite, Finite, Finite]
Keys = TypeVar("Keys", bound=BaseModel)


class Strict(BaseModel):
    """Keys that are all known, read once."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def validated(
    model: type[Keys],
    content: Any,
    where: str | Callable[[str], str],
    like: Mapping[str, str] | None = None,
) -> Keys:
    """The content of a file as the keys of a model; an empty file has none.

    Args:
        where: The file, or what tells the place of a key in it.
        like: Examples of what can be written, by the key with its section (a.b) where its own name
            stands for another thing elsewhere, by its own name, or by that of its section.

    Raises:
        InputError: An unknown or missing key, or a value that does not fit.
    """
    try:
        return model.model_validate(content or {})
    except ValidationError as error:
        raise _slip(error, where, model, like or {}) from error


def _slip(
    error: ValidationError,
    where: str | Callable[[str], str],
    model: type[BaseModel],
    like: Mapping[str, str],
) -> InputError:
    """The first slip: which key, what stands there, and what to write."""
    # a misspelt key goes before what is missing because of it
    slip = min(error.errors(), key=lambda each: each["type"] != "extra_forbidden")
    place = list(slip["loc"])
    inside = bool(place) and isinstance(place[-1], int)  # one number of several
    path = [str(part) for part in place if isinstance(part, str)] or [""]
    key = ".".join(str(part) for part in (place[:-1] if inside else place))
    known = _keys(model, path[:-1])
    section = f" of {'.'.join(path[:-1])}" if path[1:] else ""
    remedy = f"Keys{section} are: {', '.join(known)}."
    example = like.get(".".join(path)) or like.get(path[-1]) or like.get(path[0])
    kind = slip["type"]
    if kind == "extra_forbidden":
        what = f"the key {key!r} is not known{meant(path[-1], known)}"
        example = None
    elif kind == "missing" and inside:
        what = f"key {key!r}: only {len(slip['input'])} numbers stand there"
    elif kind == "missing":
        what = f"the key {key!r} is missing"
    else:
        found = repr(slip["input"])
        found = found if len(found) <= LONGEST else f"{found[:LONGEST]}…"
        said = WANTED.get(kind, slip["msg"][0].lower() + slip["msg"][1:])
        what = f"key {key!r} is {found}: {said}" if key else f"the file holds {found}: {said}"
    return InputError(
        what,
        where=where if isinstance(where, str) else where(key),
        remedy=f"Write it like  {example}" if example else remedy,
    )


def _keys(model: type[BaseModel], path: Iterable[str]) -> list[str]:
    """What may stand in a section; parts of the path that are no keys are names of entries."""
    for part in path:
        field = model.model_fields.get(part)
        model = model if field is None else next(_models(field.annotation), model)
    return list(model.model_fields)


def _models(annotation: object) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)
