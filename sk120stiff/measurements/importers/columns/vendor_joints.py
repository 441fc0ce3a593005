"""Axes by the names that makers of robots give them: S, L, U, R, B, T of a Motoman."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sk120stiff.measurements.importers.contract import Meanings

_MAKERS: tuple[tuple[str, ...], ...] = (
    ("s", "l", "u", "r", "b", "t"),
    ("s", "l", "e", "u", "r", "b", "t"),  # a Motoman of seven axes
    ("base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3"),  # Universal Robots
)
_AXIS = re.compile(r"(?:axis|achse) |(?<=[a-z\d]) (?:axis|achse)")


def with_vendor_joints(
    names: Sequence[str], meanings: Meanings, actuated: Sequence[str]
) -> Meanings:
    """Meanings with the axes of a maker as ``joint 1`` and so on, in their order.

    One such letter alone may be anything: all of them have to be there, once each, as many as the
    robot has actuated joints, and no joint by another name.
    """
    out = list(meanings)
    if any(known and known[0].startswith("joint ") for known in out):
        return out
    plain = [_AXIS.sub("", re.sub(r"[\s_.\-]+", " ", name).strip().lower()) for name in names]
    words = ["" if known else name.replace(" ", "") for name, known in zip(plain, out, strict=True)]
    there = [axes for axes in _MAKERS if all(words.count(axis) == 1 for axis in axes)]
    axes = max(there, key=len, default=())
    if len(axes) == len(actuated):
        for k, axis in enumerate(axes, 1):
            out[words.index(axis)] = f"joint {k}", 1.0
    return out
