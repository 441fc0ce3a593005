"""`Measurements`: poses, applied wrenches and measured displacements, checked once at birth."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Integers, Mask
from sk120stiff.errors import InputError, meant
from sk120stiff.measurements.absolute import SAME_POSE, Absolute
from sk120stiff.measurements.cells_read import refuse_unread
from sk120stiff.measurements.frame import Tabular
from sk120stiff.measurements.noise_statement import UNSTATED, NoiseStatement, stated
from sk120stiff.measurements.poses import (
    SAME_JOINT,
    refuse_differing_joints,
    refuse_joint_column,
    refuse_strange_joints,
    rows_by_label,
)
from sk120stiff.measurements.sensor_axes import Rpy
from sk120stiff.measurements.zero import since_zero

Frame = Literal["base", "tool"]
Zero = Literal["shared", "separate", "unknown"]

# Row fields, cut together by `select`.
PER_ROW = (
    "pose", "joints", "wrench", "displacement", "directions", "sigma", "along", "by_force", "order",
    "time", "branch", "repeat", "use", "zero_group", "zero_count", "zero_order", "zero_time",
    "zero_joints", "line",
)  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(Tabular):
    """N readings of one robot; arrays are read-only, SI throughout.

    Args:
        pose: N labels; rows of one label have the same joint values.
        joint_names, joint_kinds: The n joint columns; each an ``"angle"`` or a ``"length"``.
        joints: (N, n) coordinates, rad or m.
        wrench: (N, 6) force and moment as reported, N and N·m, in axes of `force_frame`.
        sensor_rpy: Roll, pitch, yaw [rad] by which they were turned into these; None: not at all.
        displacement: (N, 3) loaded minus unloaded, m, in axes of `displacement_frame`; NaN in an
            axis that was not read, None in a plan.
        directions: (N, 3) unit vectors that gauges read along, in the same axes; displacements are
            then in axes of each row, see `directions.py`. None: in those of the frame.
        point, force_point: (3,) measured point and point of attack in the tool frame, m; the force
            acts at the measured point unless said otherwise.
        noise: What the data say of the uncertainty of one reading.
        zero: ``"shared"``: rows of equal `zero_group` subtract the same zero reading;
            ``"separate"``: each its own; ``"unknown"``: nobody said.
        sigma: (N, 3) standard uncertainty of each loaded reading, m (NaN where not read), or None.
        along: (N, 3) standard uncertainty along the ray of the instrument, as a vector along it, m,
            base axes; NaN: errors of the three axes are independent (`noise/line_of_sight.py`).
        by_force: (N, 3, 3) m that each component of the force moves, off by all of it, or None.
        order, time, branch, repeat: When and how each was read; `branch`: load, unload, "".
        use: (N,) False masks a row. Nothing is deleted.
        zero_group, zero_count, zero_order, zero_time: (N,) which zero reading a row subtracts, how
            many readings it is of, and their mean order and time (NaN where not known).
        zero_joints: (N, n) mean joint values of that zero reading where encoders read a little
            otherwise than under load, rad or m; None: the same.
        line: (N,) line in the file, 0 where there is none.
        absolute: Readings of where markers stand, in the place of displacements, or None.
        gravity: (3,) acceleration of weight in base axes, m/s², or None: as the robot has it.
        extra: Further columns as text, under their header as written.
        notes: What reading the file decided, in sentences.
        data_hash: SHA-256 of the bytes of both files.

    Raises:
        InputError: A shape, a sign, a label or a number that does not fit.

    Examples:
        >>> import sk120stiff as sk
        >>> readings = sk.read(sk.bundled_robots()["motoman_sk120"] / "data/table2_measured.csv")
    """

    pose: tuple[str, ...]
    joint_names: tuple[str, ...]
    joints: Array
    wrench: Array
    displacement: Array | None
    path: Path | None = None
    robot: str | None = None
    base_frame: str | None = None
    tool_frame: str | None = None
    joint_kinds: tuple[str, ...] = ()
    point: Array = field(default_factory=lambda: np.zeros(3))
    force_point: Array = field(default_factory=lambda: np.zeros(0))
    force_frame: Frame = "base"
    sensor_rpy: Rpy | None = None
    displacement_frame: Frame = "base"
    directions: Array | None = None
    noise: NoiseStatement = UNSTATED
    zero: Zero = "unknown"
    sigma: Array | None = None
    along: Array | None = None
    by_force: Array | None = None
    order: Array | None = None
    time: Array | None = None
    branch: tuple[str, ...] | None = None
    repeat: Integers | None = None
    use: Mask = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))
    zero_group: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    zero_count: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    zero_order: Array | None = None
    zero_time: Array | None = None
    zero_joints: Array | None = None
    line: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    absolute: Absolute | None = None
    gravity: Array | None = None
    spare: tuple[str, ...] = ()
    source: str = ""
    extra: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    data_hash: str = ""

    def __post_init__(self) -> None:
        count, n = len(self.pose), len(self.joint_names)
        if count == 0:
            raise InputError("there is no reading", where=self._file())
        self._put("pose", tuple(self.pose))
        self._put("joint_names", tuple(self.joint_names))
        self._put("joint_kinds", tuple(self.joint_kinds) or ("angle",) * n)
        if len(self.joint_kinds) != n or set(self.joint_kinds) - {"angle", "length"}:
            raise InputError(f"joint_kinds {self.joint_kinds} do not fit {n} joints")
        self._array("joints", (count, n))
        self._put("noise", stated(self.noise))
        self._array("wrench", (count, 6))
        self._array("point", (3,))
        self._array("force_point", (3,), default=self.point)
        self._array("gravity", (3,))
        for name in ("displacement", "sigma", "along"):
            self._array(name, (count, 3), may_be_nan=True)
        for name in ("order", "time"):
            self._array(name, (count,))
        for name in ("zero_order", "zero_time"):
            self._array(name, (count,), may_be_nan=True)
        self._array("zero_joints", (count, n))
        self._array("by_force", (count, 3, 3))
        self._array("directions", (count, 3))
        self._array("use", (count,), np.bool_, np.ones(count))
        self._array("line", (count,), np.int64, np.zeros(count))
        self._array("repeat", (count,), np.int64)
        own = np.arange(count) if self.zero == "separate" else self.pose_index
        self._array("zero_group", (count,), np.int64, own)
        self._array("zero_count", (count,), np.int64, np.ones(count))
        self._check_words(count)
        self._check_joints()
        self._check_zero()
        refuse_unread(self.read, self.sigma, self.use, self.line, self._file())

    def __repr__(self) -> str:
        masked = int((~self.use).sum())
        return (
            f"<Measurements: {self.n_readings} readings at {len(self.poses)} poses"
            + (f", {masked} masked" if masked else "")
            + (", a plan" if self.is_plan else "")
            + (f", {self.path.name}>" if self.path else ">")
        )

    @property
    def n_readings(self) -> int:
        """Number of rows N, masked ones included."""
        return len(self.pose)

    @property
    def place(self) -> str:
        """Where they stand, for a message: their file, if they came from one."""
        return str(self.path or "measurements")

    @property
    def is_plan(self) -> bool:
        """No row holds a reading."""
        if self.absolute is not None:
            return not self.absolute.channels.present
        return self.displacement is None

    @cached_property
    def read(self) -> Mask:
        """(N, 3) axes of the displacements that were read; all of them in a plan."""
        if self.displacement is None:
            return np.ones((self.n_readings, 3), dtype=np.bool_)
        return np.isfinite(self.displacement)

    @cached_property
    def row_of_number(self) -> Index:
        """(R,) row of each number that was read, row by row and axis by axis."""
        return np.nonzero(self.read)[0]

    @cached_property
    def moved(self) -> Array:
        """(N, 3) displacements, zero in an axis that was not read [m]; nothing in a plan."""
        found = np.zeros((0, 3)) if self.displacement is None else self.displacement
        return np.where(np.isnan(found), 0.0, found)

    @cached_property
    def poses(self) -> tuple[str, ...]:
        """The pose labels in the order of their first row."""
        return tuple(dict.fromkeys(self.pose))

    @cached_property
    def _rows_of_each(self) -> dict[str, Index]:
        return dict(zip(self.poses, rows_by_label(self.pose_index), strict=True))

    @cached_property
    def pose_index(self) -> Integers:
        """(N,) position of each row's label in `poses`."""
        position = {label: k for k, label in enumerate(self.poses)}
        return np.array([position[label] for label in self.pose], dtype=np.int64)

    @property
    def order_since_zero(self) -> Array | None:
        """(N,) order of each row minus that of its zero reading; None without an order."""
        if self.order is None:
            return None
        return since_zero(self.order, self.zero_order, self.zero_group)

    @property
    def time_since_zero(self) -> Array | None:
        """(N,) time since the zero reading of each row [s]; None without times."""
        if self.time is None:
            return None
        return since_zero(self.time, self.zero_time, self.zero_group)

    def rows_of(self, pose: str) -> Integers:
        """Indices of the rows with this label.

        Raises:
            InputError: No row has the label; the message lists those that exist.

        Examples:
            >>> import sk120stiff as sk
            >>> home = sk.bundled_robots()["motoman_sk120"]
            >>> sk.read(home / "data/table2_measured.csv").rows_of("2").tolist()
            [5, 6, 7, 8, 9]
        """
        if pose not in self._rows_of_each:
            shown = ", ".join(self.poses[:20]) + (", ..." if len(self.poses) > 20 else "")
            raise InputError(
                f"no row has the pose {pose!r}{meant(pose, self.poses)}",
                where=self._file(),
                remedy=f"The poses are {shown}.",
            )
        return self._rows_of_each[pose].copy()

    def select(self, rows: ArrayLike) -> Measurements:
        """The chosen rows as measurements of their own: a mask (N,) or indices.

        Zero groups keep their numbers, so chosen rows share a zero reading as they did before.

        Examples:
            >>> import sk120stiff as sk
            >>> home = sk.bundled_robots()["motoman_sk120"]
            >>> sk.read(home / "data/table2_measured.csv").select([0, 5, 10]).poses
            ('1', '2', '3')
        """
        chosen = np.asarray(rows)
        index = np.flatnonzero(chosen) if chosen.dtype == bool else chosen.astype(np.int64)
        changes: dict[str, Any] = {}
        for name in PER_ROW:
            value = getattr(self, name)
            if isinstance(value, tuple):
                changes[name] = tuple(value[i] for i in index)
            elif value is not None:
                changes[name] = value[index]
        if self.absolute is not None:
            changes["absolute"] = self.absolute.select(index)
        changes["extra"] = {k: tuple(v[i] for i in index) for k, v in self.extra.items()}
        return dataclasses.replace(self, **changes)

    def masked(self) -> Measurements:
        """The rows in use, without the masked ones.

        Examples:
            >>> import sk120stiff as sk
            >>> home = sk.bundled_robots()["motoman_sk120"]
            >>> sk.read(home / "data/table2_measured.csv").masked().n_readings  # no row is masked
            15
        """
        return self if bool(self.use.all()) else self.select(self.use)

    def with_joints(self, names: Sequence[str], kinds: Sequence[str] | None = None) -> Measurements:
        """The same readings with the joint columns in the order of a robot's actuated joints.

        Args:
            names: The robot's actuated joints.
            kinds: ``"angle"`` or ``"length"`` for each; None takes the file's word.

        Raises:
            InputError: A column is no actuated joint, a joint has no column, or its unit is of
                another kind.

        Examples:
            >>> import sk120stiff as sk
            >>> home = sk.bundled_robots()["motoman_sk120"]
            >>> readings = sk.read(home / "data/table2_measured.csv")
            >>> readings.with_joints(sk.load_robot("motoman_sk120").actuated).joint_names[0]
            'joint_1_s'
        """
        listed = f"The actuated joints are {', '.join(names)}."
        refuse_strange_joints(self.joint_names, names, self.spare, listed, self._file())
        for k, name in enumerate(names):
            kind = kinds[k] if kinds is not None else None
            own = self.joint_names, self.joint_kinds, tuple(self.extra)
            refuse_joint_column(name, kind, *own, listed, self._file())
        index = [self.joint_names.index(name) for name in names]
        return dataclasses.replace(
            self,
            joint_names=tuple(names),
            joint_kinds=tuple(self.joint_kinds[i] for i in index),
            joints=self.joints[:, index],
            zero_joints=None if self.zero_joints is None else self.zero_joints[:, index],
        )

    def _put(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _array(
        self,
        name: str,
        shape: tuple[int, ...],
        dtype: type[np.generic] = np.float64,
        default: ArrayLike | None = None,
        may_be_nan: bool = False,
    ) -> None:
        value = getattr(self, name)
        if value is None:
            return
        array = np.array(value, dtype=dtype)
        if array.size == 0 and default is not None:
            array = np.array(default, dtype=dtype)
        if array.shape != shape:
            raise InputError(f"{name} has shape {array.shape}, expected {shape}", where=name)
        if dtype is np.float64 and np.any(np.isinf(array) if may_be_nan else ~np.isfinite(array)):
            raise InputError(f"{name} holds a number that is not finite", where=name)
        array.setflags(write=False)
        self._put(name, array)

    def _check_words(self, count: int) -> None:
        for name, value, words in (
            ("force_frame", self.force_frame, ("base", "tool")),
            ("displacement_frame", self.displacement_frame, ("base", "tool")),
            ("zero", self.zero, ("shared", "separate", "unknown")),
        ):
            if value not in words:
                raise InputError(f"{name} is {value!r}", remedy=f"It is one of {', '.join(words)}.")
        if self.branch is not None:
            self._put("branch", tuple(self.branch))
            if len(self.branch) != count or set(self.branch) - {"load", "unload", ""}:
                raise InputError("branch holds load, unload or nothing for each row")
        if self.sigma is not None and np.any(self.sigma <= 0):
            raise InputError("a standard uncertainty is not positive", where="sigma")
        for label in self.poses:
            if label != label.strip() or label[:1] in ("", "#") or len(label.splitlines()) > 1:
                raise InputError(f"{label!r} cannot be a pose label")
        extra = {key: tuple(value) for key, value in self.extra.items()}
        if any(len(value) != count for value in extra.values()):
            raise InputError(f"an extra column has not {count} rows")
        self._put("extra", extra)

    def _check_joints(self) -> None:
        refuse_differing_joints(
            self.pose,
            self.pose_index,
            self.joints,
            self.joint_names,
            self.joint_kinds,
            self.line,
            self._file(),
            SAME_JOINT if self.absolute is None and self.zero_joints is None else SAME_POSE,
        )

    def _check_zero(self) -> None:
        group, count = self.zero_group, self.zero_count
        if np.any(count < 1):
            raise InputError("zero_count is the number of zero readings, at least 1")
        _, first, back = np.unique(group, return_index=True, return_inverse=True)
        if np.any(self.pose_index != self.pose_index[first][back]):
            raise InputError("a zero reading belongs to one pose", where=self._file("zero_group"))
        if np.any(count != count[first][back]):
            raise InputError("rows with the same zero reading differ in zero_count")

    def _file(self, place: str | None = None) -> str | None:
        parts = [str(self.path) if self.path else None, place]
        return ", ".join(part for part in parts if part) or None
