"""Gauges that read along directions of their own, as displacements of which one axis was read.

The number of a gauge that reads along a unit vector u stands in the column of the base axis nearest
to u. The axes of such a row are those of the displacements, turned the shortest way onto u (or -u,
the number then negated), so that along an axis of the base they are these axes themselves.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array, Index, Integers, Mask

if TYPE_CHECKING:
    from sk120stiff.measurements.data import Measurements

ROUNDING = 1e-6  # of a component of a unit vector: less is along an axis
NEAR = 6  # decimals to which components are alike


def nearest_axes(directions: Array) -> tuple[Index, Array]:
    """(N,) axis that is nearest to each direction (N, 3), and (N,) its sign, 1 or -1."""
    axis = np.abs(np.round(directions, NEAR)).argmax(axis=1)
    along = np.take_along_axis(directions, axis[:, None], axis=1)[:, 0]
    return axis, np.where(along < 0.0, -1.0, 1.0)


def along_axes(directions: Array) -> Mask:
    """(N,) directions (N, 3) that are axes, or against them, but for rounding."""
    axis, sign = nearest_axes(directions)
    off = np.abs(directions * sign[:, None] - np.eye(3)[axis]).max(axis=1)
    return np.asarray(off < ROUNDING)


def turns_onto(directions: Array) -> Array:
    """(N, 3, 3) rotations by which axes come to lie along directions (N, 3) or against them.

    R = 1 + [v] + [v]²/(1 + c), with v = e × u and c = e · u.
    """
    axis, sign = nearest_axes(directions)
    e, u = np.eye(3)[axis], directions * sign[:, None]
    v = np.cross(e, u)
    v[along_axes(directions)] = 0.0
    cross = np.cross(v[:, None], np.eye(3)).swapaxes(1, 2)
    c = np.einsum("ni,ni->n", e, u)
    turns: Array = np.eye(3) + cross + cross @ cross / (1.0 + c)[:, None, None]
    return turns


def axes_in_base(measurements: Measurements, tool: Array) -> Array:
    """(N, 3, 3) axes in which displacements are stated, in base axes; `tool` (N, 3, 3) the tool's.

    Those of the frame, turned onto the directions of gauges.
    """
    frame = tool if measurements.displacement_frame == "tool" else np.eye(3)
    if measurements.directions is None:
        return np.broadcast_to(frame, tool.shape)
    return np.asarray(frame @ turns_onto(measurements.directions))


def in_columns(directions: Array, read: Array) -> Array:
    """(N, 3) displacements along own axes, of what gauges read along directions; NaN elsewhere."""
    axis, sign = nearest_axes(directions)
    out = np.full((len(read), 3), np.nan)
    out[np.arange(len(read)), axis] = sign * read
    return out


def of_columns(directions: Array, moved: Array) -> Array:
    """(N,) what gauges read along directions, of displacements (N, 3) along own axes."""
    axis, sign = nearest_axes(directions)
    return np.asarray(sign * moved[np.arange(len(moved)), axis])


def in_the_frame(measurements: Measurements) -> Measurements:
    """The poses and loads of the readings, to be predicted along the axes of their frame."""
    if measurements.directions is None:
        return measurements
    return replace(measurements, directions=None)


def read_apart(directions: Array | None, groups: Integers) -> Integers:
    """(N,) numbers of groups (N,), apart where axes of their own differ."""
    if directions is None:
        return groups
    axis, sign = nearest_axes(directions)
    off = np.where(along_axes(directions), 0, 1 + axis)
    u = np.where(off[:, None] > 0, np.round(directions * sign[:, None], NEAR), 0.0)
    keys = np.column_stack([groups, off, u])
    apart: Integers = np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1)
    return apart
