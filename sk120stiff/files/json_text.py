"""An answer as strict JSON text."""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Mapping, Set
from enum import Enum

SCHEMA = 2  # of every JSON document: raised when a key changes its meaning or goes away


def as_json_text(document: Mapping[str, object]) -> str:
    """One JSON object, one line per key.

    Arrays become nested lists, numbers keep their full precision, and what JSON has no word for
    (NaN, infinity) becomes null.

    Raises:
        TypeError: A value has no JSON form.
    """
    lines = [f"  {json.dumps(str(key))}: {_dumps(value)}" for key, value in document.items()]
    return "{\n" + ",\n".join(lines) + "\n}"


def _dumps(value: object) -> str:
    return json.dumps(_plain(value), allow_nan=False)


def _plain(value: object) -> object:
    """`value` in the types that JSON knows."""
    if isinstance(value, Enum):
        return _plain(value.value)
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: _plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, Set):
        return sorted((_plain(item) for item in value), key=str)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    tolist = getattr(value, "tolist", None)  # NumPy arrays and scalars, without importing NumPy
    if callable(tolist):
        return _plain(tolist())
    raise TypeError(f"a {type(value).__name__} has no JSON form")
