"""What pydantic finds in a YAML file, as one message of ours."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches

from pydantic import ValidationError

from sk120stiff.errors import InputError

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


def schema_error(
    error: ValidationError, where: str, keys: Iterable[str], like: Mapping[str, str] | None = None
) -> InputError:
    """The first slip: which key, what stands there, and what to write.

    Args:
        where: The file.
        keys: Those of its top level.
        like: Examples of what can be written, by the key's own name.
    """
    # a misspelt key goes before what is missing because of it
    slip = min(error.errors(), key=lambda each: each["type"] != "extra_forbidden")
    place = list(slip["loc"])
    inside = bool(place) and isinstance(place[-1], int)  # one number of several
    path = [str(part) for part in place if isinstance(part, str)] or [""]
    named = path[-1]
    key = ".".join(str(part) for part in (place[:-1] if inside else place))
    known = list(keys)
    remedy = f"Keys are: {', '.join(known)}."
    # a key that is not known has no example: that of what it stands in has its neighbours
    unknown = slip["type"] == "extra_forbidden"
    example = named if not unknown else path[-2] if len(path) > 1 else ""
    if like and example in like:
        remedy = f"Write it like  {like[example]}"
    if unknown:
        close = get_close_matches(named, known, n=1)
        what = f"the key {key!r} is not known" + (f" (did you mean {close[0]!r}?)" if close else "")
    elif slip["type"] == "missing" and inside:
        what = f"key {key!r}: only {len(slip['input'])} numbers stand there"
    elif slip["type"] == "missing":
        what = f"the key {key!r} is missing"
    else:
        found = repr(slip["input"])
        found = found if len(found) <= LONGEST else f"{found[:LONGEST]}…"
        said = WANTED.get(slip["type"], slip["msg"][0].lower() + slip["msg"][1:])
        what = f"key {key!r} is {found}: {said}" if key else f"the file holds {found}: {said}"
    return InputError(what, where=where, remedy=remedy)
