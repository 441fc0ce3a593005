"""What stands in the file, as arrays that a correction can change."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.data_checks.passive import unit_displacements, unit_turns
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.data import Frame
from sk120stiff.measurements.directions import turns_onto
from sk120stiff.measurements.sensor_axes import Rpy
from sk120stiff.robot import Robot, Screws

MOST = 2000  # rows that tell what is wrong with a file as well as all of them
STRETCH = 100  # rows that are taken together, so that rows that moved still have their neighbours
APART = 2  # rows between stretches, as far as a row is sought
ALIKE = 0.01  # rad or m, and of a unit load: nearer to one another rows tell the same


@dataclass(frozen=True, eq=False)
class Sheet:
    """N readings as the file states them.

    Attributes:
        robot: The rigid robot.
        joints: (N, n) actuated coordinates [rad or m].
        wrench: (N, 6) in axes of `force_frame` [N, N·m].
        displacement: (N, 3) in axes of `displacement_frame` [m]; NaN where not read.
        force_frame, displacement_frame: ``"base"`` or ``"tool"``.
        directions: (N, 3) along which gauges read, or None; displacements are in their columns.
        sensor_rpy: Roll, pitch, yaw [rad] by which loads were turned into their frame, if at all.
        point, force_point: (3,) in the tool frame [m].
        kept: (N,) rows that are in use.
        stretch: Mean logarithm, over all numbers read, of the factors by which corrections changed
            them: noise that was equal on all axes was changed by it too.
    """

    robot: Robot
    joints: Array
    wrench: Array
    displacement: Array
    force_frame: Frame
    displacement_frame: Frame
    point: Array
    force_point: Array
    kept: Mask
    stretch: float = 0.0
    sensor_rpy: Rpy | None = None
    directions: Array | None = None

    @property
    def measured(self) -> Array:
        """(M, 3) displacements of the rows in use [m]."""
        return self.displacement[self.kept]

    @property
    def axes(self) -> Array:
        """(3,) share that each axis has of the numbers read."""
        count = np.isfinite(self.measured).sum(axis=0)
        return np.asarray(count / max(int(count.sum()), 1))

    @property
    def moves(self) -> bool:
        """Any reading differs from zero."""
        return bool(np.nan_to_num(self.measured).any())

    @cached_property
    def told(self) -> int:
        """Numbers read that could tell something of their own.

        Larger loads along one line at one pose move the point further, and the other way with the
        opposite sign: where the law of an arm is not quite right, it is off alike under all.
        """
        load = self.wrench[self.kept]
        length = np.linalg.norm(load, axis=1, keepdims=True)
        line = load / np.where(length > 0.0, length, 1.0)
        largest = np.abs(line).argmax(axis=1)[:, None]
        line *= np.sign(np.take_along_axis(line, largest, axis=1))
        near = cKDTree(np.hstack([self.joints[self.kept], line])).query_pairs(
            ALIKE, p=np.inf, output_type="ndarray"
        )
        links = coo_array((np.ones(len(near)), near.T), shape=(len(load), len(load)))
        groups, group = connected_components(links, directed=False)
        read = np.zeros((groups, 3), dtype=bool)
        np.logical_or.at(read, group, np.isfinite(self.measured))
        return int(read.sum())

    def same_columns(self, other: Sheet) -> bool:
        """Would unit compliances displace the point just as on the other sheet?"""
        return (
            self.joints is other.joints
            and self.wrench is other.wrench
            and self.kept is other.kept
            and self.force_frame == other.force_frame
            and self.displacement_frame == other.displacement_frame
            and self.directions is other.directions
        )

    def columns(self) -> Array:
        """(M, 3, k) see `unit_displacements`."""
        at = self.at()
        return self._stated(at, unit_displacements(at, self.force_point, self._in_base(at)))

    def turning_columns(self) -> Array:
        """(M, 3, k) see `unit_turns`."""
        at = self.at()
        return self._stated(at, unit_turns(at, self.force_point, self._in_base(at)))

    def _in_base(self, at: Screws) -> Array:
        """(M, 6) loads in base axes."""
        wrench = self.wrench[self.kept]
        if self.force_frame == "base":
            return wrench
        turned = at.rotation @ wrench.reshape(-1, 2, 3).swapaxes(1, 2)
        return np.asarray(turned.swapaxes(1, 2).reshape(-1, 6))

    def _stated(self, at: Screws, columns: Array) -> Array:
        """What base axes have, in the axes of the displacements."""
        if self.displacement_frame == "tool":
            columns = np.asarray(at.rotation.swapaxes(1, 2) @ columns)
        if self.directions is not None:
            columns = np.swapaxes(turns_onto(self.directions[self.kept]), 1, 2) @ columns
        return columns

    def at(self) -> Screws:
        """The M poses of the rows in use; each is worked out once, whatever its loads."""
        unique, row = np.unique(self.joints[self.kept], axis=0, return_inverse=True)
        row = row.reshape(-1)
        at = self.robot.screws(unique, point=self.point)
        return replace(
            at,
            axes=at.axes[row],
            origins=at.origins[row],
            rotation=at.rotation[row],
            frame_position=at.frame_position[row],
            first=at.first[row] if at.first.ndim == 3 else at.first,
            second=None,
            carried=None,
        )

    def exists(self) -> bool:
        """Are there readings left, and can the arm stand as they say?"""
        if not self.kept.any():
            return False
        return bool(self.robot.closes(np.unique(self.joints[self.kept], axis=0)).all())

    def thinned(self, most: int) -> Sheet:
        """No more than `most` of the rows in use, spread evenly."""
        rows = np.flatnonzero(self.kept)
        if len(rows) <= most:
            return self
        kept = np.zeros_like(self.kept)
        kept[rows[np.linspace(0, len(rows) - 1, most).astype(np.intp)]] = True
        return replace(self, kept=kept)

    def in_part(self) -> Sheet:
        """About `MOST` of the rows in use, in stretches that mirror each other in the file.

        A slip of the pen is one of whole columns: it stands in every part of them. Masked rows part
        the stretches, so that nothing moves from one into the next.
        """
        rows, used = len(self.kept), int(self.kept.sum())
        if used <= MOST:
            return self
        first = np.linspace(0, rows - STRETCH, MOST * rows // (used * STRETCH))
        first = np.where(first < 0.5 * first[-1], np.floor(first), np.ceil(first)).astype(np.intp)
        taken = (first[:, None] + np.arange(STRETCH + APART)).ravel()[:-APART]
        taken = np.minimum(taken, rows - 1)
        kept = self.kept[taken] & (np.arange(len(taken)) % (STRETCH + APART) < STRETCH)
        return replace(
            self,
            joints=self.joints[taken],
            wrench=self.wrench[taken],
            displacement=self.displacement[taken],
            directions=None if self.directions is None else self.directions[taken],
            kept=kept,
        )

    def moved(self, rows: Index, *, joints: bool = False, wrench: bool = False) -> Sheet:
        """The displacements (or these columns) of row `rows[i]` in row i; -1: of no row."""
        known = rows >= 0
        kept = self.kept & known & self.kept[rows]
        if joints:
            return replace(self, kept=kept, joints=self.joints[rows])
        if wrench:
            return replace(self, kept=kept, wrench=self.wrench[rows])
        along = None if self.directions is None else self.directions[rows]
        return replace(self, kept=kept, displacement=self.displacement[rows], directions=along)


def sheet_of(robot: Robot, measurements: Measurements) -> Sheet | None:
    """The readings on a robot, of very many a part; None for a plan.

    Raises:
        InputError: The file's joints are not the robot's actuated joints.
    """
    measurements = measurements.with_joints(robot.actuated, robot.kinds)
    if measurements.displacement is None:
        return None
    return Sheet(
        robot=robot,
        joints=measurements.joints,
        wrench=measurements.wrench,
        displacement=measurements.displacement,
        force_frame=measurements.force_frame,
        displacement_frame=measurements.displacement_frame,
        point=measurements.point,
        force_point=measurements.force_point,
        kept=measurements.use & measurements.wrench.any(axis=1),
        sensor_rpy=measurements.sensor_rpy,
        directions=measurements.directions,
    ).in_part()
