"""What an effect may look at: the readings of an experiment as arrays, in base axes."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Integers, Mask
from sk120stiff.effects.latest import Latest
from sk120stiff.effects.reference import Reference, references_of
from sk120stiff.measurements.directions import axes_in_base
from sk120stiff.robot import Robot, Screws, VirtualJoint
from sk120stiff.stiffness.wrench import rotate, wrenches

if TYPE_CHECKING:
    from sk120stiff.measurements import Absolute, Measurements

MOVED = 1e-4  # rad or m: a joint that moves by less has not changed sides

IDLE = -1  # in a history: no load, at a zero reading or before a repeat

# What was worked out of the load cases of these readings serves every fit to them.
_of_readings: WeakKeyDictionary[Measurements, LoadCases] = WeakKeyDictionary()


OF_EACH_READING = (
    "a", "wrench", "rotation", "reading_axes", "order", "time", "branch", "pose", "payload",
    "temperature", "series", "station", "side", "zero_a", "zero_group", "repeat", "order_at_zero",
    "time_at_zero",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class LoadCases:
    """N readings of a robot under load.

    Attributes:
        robot: The rigid robot.
        a: (N, n) commanded coordinates [rad or m].
        wrench: (N, 6) load as reported, base axes of the unloaded arm, at `force_point` [N, N·m].
        rotation: (N, 3, 3) unloaded tool frame in base axes.
        point, force_point: (3,) measured point, or (N, 3) where it differs, and (3,) point of the
            force, in the tool frame [m].
        reading_axes: (N, 3, 3) axes in which displacements are stated, in base axes.
        order, time: (N,) position in the series [1] and instant [s] of each reading minus that of
            its zero, or None.
        order_at_zero, time_at_zero: (N,) the same of that zero, counted from the first of all; None
            where the file does not tell.
        branch: (N,) +1 while the load grows, -1 while it falls.
        pose: (N,) index into `poses`.
        poses: Labels of the poses.
        follows: The load was read by a sensor on the tool: it turns with it, but for `hanging`.
        absolute: Readings say where the point stands, not how far it went under a load.
        payload: (N,) mass that hangs on the tool as stated [kg], or None.
        payload_point: (3,) where a payload hangs, in the tool frame [m]; None where there is none.
        temperature: (N,) temperature over its mean [K], or None.
        series, series_names: (N,) series that each reading belongs to, and their labels.
        station, station_names: (N,) place that the instrument stood at, and their labels.
        zero_a: (N, n) coordinates of the zero reading [rad or m]; None: those of the reading.
        side: (N, n) side from which each joint came to its pose, -1, 0 or 1; None without an order.
        zero_group, repeat: (N,) which zero reading a row subtracts, and the how-manieth repeat it
            is; None where every row stands alone, and where nothing was repeated.
        references: From where `order`, `time` and `temperature` of positions count.
    """

    robot: Robot
    a: Array
    wrench: Array
    rotation: Array
    point: Array
    force_point: Array
    reading_axes: Array
    order: Array | None
    time: Array | None
    branch: Array
    pose: Index
    poses: tuple[str, ...]
    follows: bool = False
    absolute: bool = False
    payload: Array | None = None
    payload_point: Array | None = None
    temperature: Array | None = None
    series: Index | None = None
    series_names: tuple[str, ...] = ()
    station: Index | None = None
    station_names: tuple[str, ...] = ("",)
    side: Array | None = None
    zero_a: Array | None = None
    zero_group: Integers | None = None
    repeat: Integers | None = None
    order_at_zero: Array | None = None
    time_at_zero: Array | None = None
    references: tuple[Reference, ...] = ()

    @property
    def count(self) -> int:
        """Number of readings N."""
        return len(self.a)

    @property
    def of_another_file(self) -> LoadCases:
        """The same readings to a model that was fitted to others: labels of poses say nothing.

        Pose 3 of one file is not that of another, and its zero reading was another one.
        """
        return replace(self, poses=tuple(f"{label} of another file" for label in self.poses))

    @property
    def hanging(self) -> Array:
        """(N, 6) weight of the stated payload, part of `wrench`, base axes [N, N·m]."""
        out = np.zeros((self.count, 6))
        if self.payload is not None and self.payload_point is not None:
            out[:, :3] = self.payload[:, None] * self.robot.gravity_in_base
            lever = np.einsum("nij,j->ni", self.rotation, self.payload_point - self.force_point)
            out[:, 3:] = np.cross(lever, out[:, :3])
        return out

    def since(self, of: str, reference: Reference | None) -> Array | None:
        """(N,) `temperature`, `time` or `order` since a reference [K, s or 1]; None: not read.

        Without one, and by another clock than that of the reference, it is since these readings'
        own.
        """
        values: Array | None = getattr(self, of)
        own = next((known for known in self.references if known.of == of), None)
        if values is None or reference is None or own is None:
            return values
        return np.asarray(values + (reference.until(own) or 0.0))

    @cached_property
    def gravity_torque(self) -> Array:
        """(N, n) torque of the arm's own weight on the actuated joints [N·m or N]."""
        if self.robot.total_mass == 0.0:
            return np.zeros_like(self.a)
        unique, inverse = np.unique(self.a, axis=0, return_inverse=True)
        return self.robot.gravity_torque(unique)[inverse.reshape(-1)]

    def weight_torques(self, virtual: tuple[VirtualJoint, ...]) -> Array:
        """(N, k) torques of the arm's own weight on joints that an effect adds [N·m or N]."""
        if self.robot.total_mass == 0.0:
            return np.zeros((self.count, len(virtual)))
        return self._on(virtual)[0]

    def torques_on(self, virtual: tuple[VirtualJoint, ...]) -> Array:
        """(N, k) torques of load and weight on them at the unloaded pose [N·m or N]."""
        weight, load = self._on(virtual)
        return weight + load

    def _on(self, virtual: tuple[VirtualJoint, ...]) -> tuple[Array, Array]:
        """(N, k) torques of the weight and of the load on virtual joints, worked out once."""
        names = tuple(joint.name for joint in virtual)
        if names not in self._on_virtual:
            mechanism = self.robot.mechanism().with_virtual_joints(virtual)
            z = np.concatenate([self.a, np.zeros((self.count, len(virtual)))], axis=1)
            screws = mechanism.screws(z, self.force_point)
            own = slice(self.robot.n, None)
            self._on_virtual[names] = (
                screws.gravity_torques(self.robot.gravity_in_base)[:, own],
                screws.torques(self.wrench)[:, own],
            )
        return self._on_virtual[names]

    @cached_property
    def _on_virtual(self) -> dict[tuple[str, ...], tuple[Array, Array]]:
        return {}

    @cached_property
    def pose_column(self) -> Index:
        """(N,) column of each row's pose in `history`."""
        return np.unique(self.pose, return_inverse=True)[1].reshape(-1)

    @cached_property
    def history(self) -> tuple[Index, Index, Index]:
        """In which order every pose met its loads.

        Returns:
            steps, zero, own: (S, g) row whose load is on, or `IDLE`, the poses side by side; (N,)
                the step at which a row's zero was read, and the one at which the row itself was.
        """
        group = np.arange(self.count) if self.zero_group is None else self.zero_group
        again = np.zeros(self.count, dtype=int) if self.repeat is None else self.repeat
        sequence = np.arange(self.count) if self.order is None else self.order
        zero, own = np.zeros(self.count, dtype=np.intp), np.zeros(self.count, dtype=np.intp)
        series: list[list[int]] = []
        for pose in range(int(self.pose_column.max(initial=-1)) + 1):
            rows = np.flatnonzero(self.pose_column == pose)
            # order counts from the zero reading, so zeros first, in the order of the file
            first = {g: k for k, g in reversed(list(enumerate(group[rows])))}
            ranks = [first[g] for g in group[rows]]
            steps: list[int] = []
            last, at = None, 0
            for row in rows[np.lexsort((sequence[rows], ranks))]:
                if last is None or group[row] != group[last]:
                    at = len(steps)
                    steps.append(IDLE)
                elif again[row] != again[last]:
                    steps.append(IDLE)
                zero[row], own[row], last = at, len(steps), row
                steps.append(int(row))
            series.append(steps)
        longest = max((len(steps) for steps in series), default=0)
        padded = [steps + [IDLE] * (longest - len(steps)) for steps in series]
        return np.array(padded, dtype=np.intp).T, zero, own

    @cached_property
    def latest(self) -> Latest:
        """What was predicted of them last."""
        return Latest()

    @cached_property
    def patterns(self) -> dict[Hashable, Array]:
        """Compliance per unit of each parameter, of the linear effects that were asked of it."""
        return {}

    @cached_property
    def nominal(self) -> Screws:
        """`Screws` of the unloaded, rigid robot at the measured point."""
        return self.robot.screws(self.a, point=self.point)

    def blocks(self, size: int) -> tuple[LoadCases, ...]:
        """The readings in stretches of so many, the same objects every time."""
        if self.count <= size:
            return (self,)
        if size not in self._in_blocks:
            starts = range(0, self.count, size)
            self._in_blocks[size] = tuple(self.rows(slice(k, k + size)) for k in starts)
        return self._in_blocks[size]

    @cached_property
    def _in_blocks(self) -> dict[int, tuple[LoadCases, ...]]:
        return {}

    def rows(self, pick: slice | Index | Mask) -> LoadCases:
        """Part of the readings."""
        whole = {name: getattr(self, name) for name in OF_EACH_READING}
        part: dict[str, Any] = {
            name: None if each is None else each[pick] for name, each in whole.items()
        }
        point = self.point if self.point.ndim == 1 else self.point[pick]
        return replace(self, point=point, **part)


def load_case(
    robot: Robot,
    a: ArrayLike,
    wrench: ArrayLike,
    *,
    point: ArrayLike | None = None,
    force_point: ArrayLike | None = None,
    absolute: bool = False,
) -> LoadCases:
    """Readings made of coordinates (N, n) and base-axes wrenches (N, 6) alone.

    Args:
        robot: The robot.
        a, wrench: Coordinates and loads.
        point, force_point: The measured and the loaded point (3,), tool frame [m].
        absolute: Where the point stands is asked, with all that the weight does in gears, and not
            how far the load moves it.

    Raises:
        InputError: Wrenches of another shape, or not finite.
    """
    coordinates = np.atleast_2d(robot.coordinates(a))
    one = len(coordinates) == 1
    count = len(np.atleast_2d(np.asarray(wrench))) if one else len(coordinates)
    coordinates = np.broadcast_to(coordinates, (count, robot.n))
    load = wrenches(wrench, count)
    at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    return LoadCases(
        robot=robot,
        a=coordinates,
        wrench=load,
        rotation=robot.screws(coordinates).rotation,
        point=at,
        force_point=at if force_point is None else np.asarray(force_point, dtype=float),
        reading_axes=np.broadcast_to(np.eye(3), (count, 3, 3)),
        order=None,
        time=None,
        branch=np.ones(count),
        pose=np.arange(count),
        poses=tuple(str(k + 1) for k in range(count)),
        absolute=absolute,
    )


def load_cases_of(robot: Robot, measurements: Measurements) -> LoadCases:
    """Readings of a measurement file on a robot; the same object as long as both are the same.

    Raises:
        InputError: The file's joints are not the robot's actuated joints.
    """
    known = _of_readings.get(measurements)
    if known is None or known.robot is not robot:
        known = _of_readings[measurements] = _load_cases_of(robot, measurements)
    return known


def _load_cases_of(robot: Robot, measurements: Measurements) -> LoadCases:
    measurements = measurements.with_joints(robot.actuated, robot.kinds)
    a = measurements.joints
    rotation = robot.screws(a).rotation
    wrench, follows = measurements.wrench, measurements.force_frame == "tool"
    if follows:
        wrench = rotate(rotation, wrench)
    labels = measurements.poses
    index = {label: k for k, label in enumerate(labels)}
    plain = LoadCases(
        robot=robot,
        a=a,
        wrench=wrench,
        rotation=rotation,
        point=measurements.point,
        force_point=measurements.force_point,
        reading_axes=axes_in_base(measurements, rotation),
        order=measurements.order_since_zero,
        time=measurements.time_since_zero,
        branch=_branch_signs(measurements),
        pose=np.array([index[label] for label in measurements.pose], dtype=np.intp),
        poses=labels,
        follows=follows and bool(wrench.any()),
        zero_a=measurements.zero_joints,
        zero_group=measurements.zero_group,
        repeat=measurements.repeat,
        order_at_zero=_begun(measurements.order, measurements.order_since_zero),
        time_at_zero=_begun(measurements.time, measurements.time_since_zero),
    )
    if measurements.absolute is None:
        return plain
    return _standing(plain, measurements, measurements.absolute)


def _standing(plain: LoadCases, measurements: Measurements, said: Absolute) -> LoadCases:
    """The same readings as positions: with payload, markers, series, temperature, approach."""
    hung = replace(
        plain,
        force_point=plain.force_point if plain.wrench.any() else said.payload_point,
        payload=said.payload,
        payload_point=said.payload_point,
    )
    labels = said.groups
    names = () if labels is None else tuple(dict.fromkeys(labels))
    stations, stood = said.stood
    temperature, references = said.temperature, references_of(measurements)
    clock = measurements.order if measurements.order is not None else measurements.time
    return replace(
        hung,
        wrench=plain.wrench + hung.hanging,
        point=said.point,
        order=_since_first(measurements.order),
        time=_since_first(measurements.time),
        order_at_zero=None,
        time_at_zero=None,
        absolute=True,
        temperature=None if temperature is None else temperature - temperature.mean(),
        series=None if labels is None else np.array([names.index(label) for label in labels]),
        series_names=names,
        station=stood,
        station_names=stations,
        side=None if clock is None else approach_sides(plain.a, clock),
        references=references,
    )


def _begun(clock: Array | None, since: Array | None) -> Array | None:
    """When the zero of each row was read, from the first of all on."""
    return None if clock is None or since is None else _since_first(clock - since)


def _since_first(clock: Array | None) -> Array | None:
    return None if clock is None else clock - clock.min()


def approach_sides(a: Array, clock: Array) -> Array:
    """(N, n) sign of the last movement of each joint, 0 before it has moved at all.

    Args:
        a: (N, n) coordinates of the readings [rad or m].
        clock: (N,) their order.
    """
    order = np.argsort(clock, kind="stable")
    steps = np.diff(a[order], axis=0, prepend=a[order[:1]])
    signs = np.where(np.abs(steps) > MOVED, np.sign(steps), 0.0)
    rows = np.where(signs != 0.0, np.arange(len(a))[:, None], 0)
    last = np.maximum.accumulate(rows, axis=0)
    sides = np.empty_like(signs)
    sides[order] = np.take_along_axis(signs, last, axis=0)
    return sides


def _branch_signs(measurements: Measurements) -> Array:
    if measurements.branch is None:
        return np.ones(measurements.n_readings)
    return np.array([-1.0 if branch == "unload" else 1.0 for branch in measurements.branch])
