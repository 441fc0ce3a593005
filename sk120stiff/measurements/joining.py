"""Several measurements of one robot as one: a second campaign, or poses drawn with replacement."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import PER_ROW, Measurements
from sk120stiff.measurements.directions import along_axes

_SAME = (
    "robot", "base_frame", "tool_frame", "joint_names", "joint_kinds", "point", "force_point",
    "force_frame", "displacement_frame", "noise",
)  # fmt: skip


def join_measurements(parts: Sequence[Measurements]) -> Measurements:
    """The rows of all parts one after another; zero readings are never shared between parts.

    A part may come twice (a bootstrap over poses): its copies count as separate poses' worth of
    zero readings. Notes, path, source and settings are the first part's; an extra column stays
    if every part has it.

    Raises:
        InputError: No part, or parts that differ in robot, frames, points, noise, or in which
            columns they have; or a pose label that stands for differing joint values.
    """
    if not parts:
        raise InputError("there are no measurements to join")
    first = parts[0]
    for part in parts[1:]:
        for name in _SAME:
            here, there = getattr(first, name), getattr(part, name)
            if not (np.array_equal(here, there) if isinstance(here, np.ndarray) else here == there):
                raise InputError(
                    f"measurements with different {name} cannot be joined ({here} and {there})",
                    where=str(part.path) if part.path else None,
                    remedy="Let both say the same, or use them one after the other.",
                )
    words = {part.zero for part in parts}
    if len(words) > 1 and "unknown" in words:
        raise InputError(
            "one part says how zero readings are shared, another does not",
            remedy="Write displacement.zero in both settings: shared or separate.",
        )
    gauges = any(part.directions is not None for part in parts)
    changes: dict[str, Any] = {"zero": first.zero if len(words) == 1 else "shared"}
    for name in PER_ROW:
        if name == "by_force":  # of a model, and not of a file
            changes[name] = None
            continue
        values = [_along(part) if gauges and name == "directions" else getattr(part, name)
                  for part in parts]  # fmt: skip
        if any((value is None) != (values[0] is None) for value in values):
            raise InputError(
                f"one part has the column {name}, another has not",
                remedy="Give it to both, or to neither.",
            )
        if isinstance(values[0], tuple):
            changes[name] = tuple(cell for value in values for cell in value)
        elif values[0] is not None:
            changes[name] = np.concatenate(values)
    if gauges and along_axes(changes["directions"]).all():
        changes["directions"] = None  # their axes are those of the base
    groups = [np.unique(part.zero_group, return_inverse=True)[1] for part in parts]
    start = np.cumsum([0, *(int(group.max()) + 1 for group in groups)])
    changes["zero_group"] = np.concatenate([g + s for g, s in zip(groups, start, strict=False)])
    common = [key for key in first.extra if all(key in part.extra for part in parts)]
    changes["extra"] = {k: tuple(c for part in parts for c in part.extra[k]) for k in common}
    return dataclasses.replace(first, **changes)


def _along(part: Measurements) -> Array:
    """(N, 3) what each row was read along; of rows in axes of the base that is x of these axes."""
    if part.directions is not None:
        return part.directions
    return np.tile(np.eye(3)[0], (part.n_readings, 1))
