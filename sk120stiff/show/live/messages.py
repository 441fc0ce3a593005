"""What the page may ask: numbers in range and nothing else."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show.scene.frame import Request

MAX_BYTES = 16_384  # a request of a hundred joints needs a third of it
_KEYS = frozenset({"id", "a", "wrench", "point", "exaggeration"})
_SLACK = 1e-9  # a slider at its end, after conversion to degrees and back


@dataclass(frozen=True, eq=False)
class Bounds:
    """Ranges (k, 2) of the numbers in a request, taken from the payload of the page."""

    a: Array
    wrench: Array
    point: Array
    exaggeration: Array

    @classmethod
    def of(cls, payload: Mapping[str, Any]) -> Bounds:
        """The ranges that the controls of a page have."""
        limits = payload["limits"]
        force, moment, point = limits["force"], limits["moment"], limits["point"]
        return cls(
            a=np.array([(joint["lower"], joint["upper"]) for joint in payload["joints"]]),
            wrench=np.array([(-force, force)] * 3 + [(-moment, moment)] * 3),
            point=np.array([(-point, point)] * 3),
            exaggeration=np.array([limits["exaggeration"]]),
        )


def read_request(text: str | bytes, bounds: Bounds) -> tuple[int, Request]:
    """Number and content of a request.

    Raises:
        InputError: Not JSON of the agreed form, or a number out of range; the message is safe to
            send back.
    """
    if isinstance(text, bytes):
        raise InputError("a request is text, not bytes")
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError("a request is JSON") from error
    if not isinstance(content, dict) or set(content) != _KEYS:
        raise InputError(f"a request has the keys {', '.join(sorted(_KEYS))}")
    number = content["id"]
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < 2**53:
        raise InputError("the id of a request is a whole number")
    return number, Request(
        a=_numbers("a", content["a"], bounds.a),
        wrench=_numbers("wrench", content["wrench"], bounds.wrench),
        point=_numbers("point", content["point"], bounds.point),
        exaggeration=float(
            _numbers("exaggeration", [content["exaggeration"]], bounds.exaggeration)[0]
        ),
    )


def _numbers(name: str, values: object, bounds: Array) -> Array:
    if not isinstance(values, list) or len(values) != len(bounds):
        raise InputError(f"{name!r} is a list of {len(bounds)} numbers")
    for value, (lower, upper) in zip(values, bounds.tolist(), strict=True):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{name!r} holds something that is no number")
        slack = _SLACK * max(1.0, abs(lower), abs(upper))
        # Plain floats: against NumPy's, a whole number too large for a float would overflow.
        if not lower - slack <= value <= upper + slack or not math.isfinite(value):
            raise InputError(f"{name!r} holds a number outside {lower:g} .. {upper:g}")
    array = np.array(values, dtype=float)
    return np.asarray(np.clip(array, bounds[:, 0], bounds[:, 1]))
