"""Grids over joints or over positions, and how a map is cut into chunks."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.units import to_si

_NUMBERS = r"(?:[^\sA-Za-z°µ]|(?<=[\d.])[eE](?=[+-]?\d))*"
_ITEM = re.compile(rf"\s*([^=\s]+)\s*=\s*({_NUMBERS})\s*(.*?)\s*")
LONGEST_AXIS = 10_000_000
_EXAMPLE = (
    "Write it like 'joint_2_l=-70:70:5 deg' (start:stop:step; an empty start or stop is the "
    "joint's limit)."
)
CARTESIAN = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Axis:
    """One dimension of a grid.

    Attributes:
        name: A joint, or x, y, z.
        values: (k,) where the grid has points [rad or m].
    """

    name: str
    values: Array


@dataclass(frozen=True, eq=False)
class Grid:
    """Points at every combination of the values of some axes, the last axis fastest.

    Attributes:
        axes: The dimensions.
    """

    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        names = [axis.name for axis in self.axes]
        for axis in self.axes:
            if names.count(axis.name) > 1:
                raise InputError("this axis is given twice", where=axis.name)
            if axis.values.ndim != 1 or not len(axis.values):
                raise InputError("this axis of the grid has no points", where=axis.name)
            if not np.isfinite(axis.values).all():
                raise InputError("this axis has a value that is not finite", where=axis.name)
        if not self.axes:
            raise InputError("the grid has no axes", remedy=_EXAMPLE)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def points(self, begin: int, end: int) -> Array:
        """(end − begin, d) values of the axes at a stretch of points [rad or m]."""
        where = np.unravel_index(np.arange(begin, end), self.shape)
        return np.stack([a.values[i] for a, i in zip(self.axes, where, strict=True)], axis=1)


@dataclass(frozen=True, eq=False)
class Chunks:
    """A grid cut into chunks of neighbouring points.

    Attributes:
        shape: Shape of the grid.
        target: Number of points that a chunk should have at most.
    """

    shape: tuple[int, ...]
    target: int

    @cached_property
    def chunk_shape(self) -> tuple[int, ...]:
        """Whole trailing axes, a part of the one before them, and single values of the rest."""
        chunk = [1] * len(self.shape)
        room = max(1, self.target)
        for k in reversed(range(len(self.shape))):
            chunk[k] = min(self.shape[k], room)
            if chunk[k] < self.shape[k]:
                break
            room = max(1, room // self.shape[k])
        return tuple(chunk)

    @cached_property
    def counts(self) -> tuple[int, ...]:
        """Number of chunks along each axis."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk_shape, strict=True))

    @property
    def number(self) -> int:
        """Number of chunks."""
        return math.prod(self.counts)

    def region(self, chunk: int) -> tuple[slice, ...]:
        """Where a chunk lies along each axis."""
        where = np.unravel_index(chunk, self.counts)
        return tuple(
            slice(int(i) * c, min((int(i) + 1) * c, n))
            for i, c, n in zip(where, self.chunk_shape, self.shape, strict=True)
        )

    def stretch(self, chunk: int) -> tuple[int, int]:
        """First point of a chunk and the one after its last; its points follow one another."""
        region = self.region(chunk)
        begin = int(np.ravel_multi_index([part.start for part in region], self.shape))
        return begin, begin + math.prod(part.stop - part.start for part in region)


def parse_axes(
    texts: Sequence[str],
    limits: Mapping[str, tuple[float, float, str]],
    *,
    where: str = "--grid",
    ranges: bool = False,
) -> tuple[Axis, ...]:
    """Axes from text like ``"joint_2_l=-70:70:5 deg; joint_3_u=0 deg"``.

    Items are separated by semicolons or commas; a unit holds for the items before it that have
    none. A single number makes an axis of one point.

    Args:
        texts: One text or several.
        limits: Name → (lower limit, upper limit, kind of number) of everything that can be an axis.
        ranges: Take ``start:stop`` without a step, as an axis of these two points.

    Raises:
        InputError: An unknown name, numbers that make no axis, a missing unit or limit.
    """
    items = [item for text in texts for item in re.split(r"[;,]", text) if item.strip()]
    axes: list[Axis] = []
    unit = ""
    for item in reversed(items):
        found = _ITEM.fullmatch(item)
        if found is None:
            raise InputError(f"{item.strip()!r} is no axis", where=where, remedy=_EXAMPLE)
        name, numbers, own = found.groups()
        unit = own or unit
        if name not in limits:
            raise InputError(
                f"there is no axis {name!r}",
                where=where,
                remedy=f"Axes are: {', '.join(limits)}.",
            )
        axes.append(Axis(name, _values(numbers, unit, limits[name], f"{where}, {name}", ranges)))
    return tuple(reversed(axes))


def _values(
    text: str, unit: str, limit: tuple[float, float, str], where: str, ranges: bool
) -> Array:
    lower, upper, kind = limit
    parts = text.split(":")
    if ranges and len(parts) == 2:
        parts = [*parts, parts[1]]
    if len(parts) not in (1, 3) or (len(parts) == 3 and not parts[2]) or parts == [""]:
        raise InputError(
            f"{text!r} is neither a number nor start:stop:step", where=where, remedy=_EXAMPLE
        )
    ends: list[float] = []
    for part, bound in zip(parts, (lower, upper, 0.0), strict=False):
        if part:
            try:
                ends.append(float(to_si(float(part), unit or None, kind, where=where)))
            except ValueError as error:
                raise InputError(f"{part!r} is no number", where=where, remedy=_EXAMPLE) from error
        elif math.isfinite(bound):
            ends.append(bound)
        else:
            raise InputError("no limit of this axis is known", where=where, remedy=_EXAMPLE)
    if len(ends) == 1:
        return np.array(ends)
    start, stop, step = ends
    if ranges:
        if stop < start:
            raise InputError(f"{text!r} ends before it starts", where=where)
        return np.array([start, stop])
    if not step > 0.0 or stop < start:
        raise InputError(
            f"{text!r} has no points", where=where, remedy="start ≤ stop and step > 0 are needed."
        )
    if (stop - start) / step > LONGEST_AXIS:
        raise InputError(
            f"{text!r} has {(stop - start) / step:.3g} points",
            where=where,
            remedy="Take larger steps.",
        )
    # A billionth of a step keeps a stop that is a whole number of steps away.
    steps = np.arange(math.floor((stop - start) / step + 1e-9) + 1, dtype=float)
    return np.asarray(start + step * steps)
