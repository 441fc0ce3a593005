"""A path under load as a CSV file: joints or positions, and the wrench at each point.

::

    point,joint_1_s[deg],joint_2_l[deg],…,fx[N],fy[N],fz[N]          joints
    point,x[mm],y[mm],z[mm],roll[deg],pitch[deg],yaw[deg],fx[N],…    placement of the tool

Where both stand there, the joints are driven and the positions are held against them.
``point`` is any label. Moments ``mx my mz`` are optional, and so is the orientation: without it
only the position is meant. Everything is in base axes; roll, pitch and yaw are as in a URDF.
``feed[mm/min]`` and ``rapid`` (1: a rapid move) go into robot programs. Further columns are kept as
they are.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError, Refusal, warn
from sk120stiff.files import csv_text, write_atomically
from sk120stiff.measurements.table.columns import DISPLACEMENTS, FORCES, MOMENTS, POSITIONS
from sk120stiff.measurements.table.table import Table, read_table
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import rotation_from_rpy, rotation_vector
from sk120stiff.stiffness.wrench import rotate
from sk120stiff.units import from_si, is_kind, to_si
from sk120stiff.workspace.arm import ElasticArm
from sk120stiff.workspace.inverse import Task, near, solve_inverse, starting_poses
from sk120stiff.workspace.reach import why_unreached

FIRST = np.array([0])
ANGLES = ("roll", "pitch", "yaw")
STARTS = 32  # poses from which the first point of a path is sought
SAME_BRANCH = 0.05  # rad or m between solutions that count as one
NEIGHBOURS = 0.1  # rad or m: neighbours of one block that are farther apart are sought one by one
LONGEST_BLOCK = 1024  # points sought together
# m and rad by which joints and placement of one point may differ, as rounded by people
AGREE, AGREE_TURNED = 1e-4, 2e-3


@dataclass(frozen=True, eq=False)
class LoadedPath:
    """N points with the wrench that acts there.

    Attributes:
        wrench: (N, 6) on the robot, base axes [N, N·m].
        joints: (N, n) joint coordinates, where the file gives them [rad or m].
        position, rotation: (N, 3) and (N, 3, 3) of the tool, where the file gives them [m].
        table: The file.
        feed: (N,) speed on the way to each point [m/s], NaN where the file does not say.
        rapid: (N,) is the move to the point a rapid one?
    """

    wrench: Array
    joints: Array | None
    position: Array | None
    rotation: Array | None
    table: Table
    feed: Array
    rapid: Mask

    @property
    def count(self) -> int:
        """Number of points N."""
        return len(self.wrench)

    def turned_to_base(self, robot: Robot, a: Array, frame: str | None) -> LoadedPath:
        """The path in base axes, of loads that are stated in those of the tool at joints (N, n)."""
        R = robot.placement(a, frame)[:, :3, :3]
        return replace(self, wrench=rotate(R, self.wrench))


def read_path(
    path: str | os.PathLike[str],
    robot: Robot,
    *,
    wrench: Array | None = None,
    part: Array | None = None,
) -> LoadedPath:
    """Read a path.

    Args:
        wrench: (6,) the load at every point, where the file holds none [N, N·m].
        part: (4, 4) where the axes of its places lie in the base [m].

    Raises:
        InputError: The file cannot be read, or columns are missing, doubled or without unit.
    """
    table = read_table(Path(path))
    has = set(table.headers)
    loads = _loads(table, wrench)
    by_joint = [name for name in robot.actuated if name in has]
    by_place = [name for name in POSITIONS if name in has and name not in robot.actuated]
    if not by_joint and not by_place:
        raise InputError(
            "the path has no points",
            where=str(table.path),
            remedy=f"Give the columns {', '.join(f'{j}[deg]' for j in robot.actuated)}, or x[mm], "
            "y[mm], z[mm]. The name of a machining program ends in .nc or .apt.",
        )
    count = len(table.lines)
    feed, rapid = np.full(count, np.nan), np.zeros(count, dtype=bool)
    if is_kind(table.column_units.get("feed") or "", "m/s"):
        feed = table.quantity("feed", "m/s", allow_blank=True)
    if "rapid" in has and set(table.cells["rapid"]) <= {"0", "1", ""}:
        rapid = np.array([cell == "1" for cell in table.cells["rapid"]])
    joints = None
    if by_joint:
        kinds = zip(robot.actuated, robot.kinds, strict=True)
        joints = np.hstack([table.quantities((name,), kind) for name, kind in kinds])
    read = [name for name in DISPLACEMENTS if name in has]
    if by_joint and read:
        warn(
            f"{table.path} looks like readings: displacements stand beside its joints "
            f"({', '.join(read)}). They are no part of a path; the joints and loads of its rows "
            "are taken as points to drive to"
        )
    if not by_place:
        if part is not None:
            raise InputError("a path by joints lies in no frame", where=str(table.path))
        return LoadedPath(loads, joints, None, None, table, feed, rapid)
    rotation = None
    if has & set(ANGLES):
        rotation = np.array([rotation_from_rpy(row) for row in table.quantities(ANGLES, "angle")])
    position = table.quantities(POSITIONS, "length")
    if part is not None:
        position = position @ part[:3, :3].T + part[:3, 3]
        rotation = None if rotation is None else part[:3, :3] @ rotation
    return LoadedPath(loads, joints, position, rotation, table, feed, rapid)


def _loads(table: Table, constant: Array | None) -> Array:
    """(N, 6) of the columns, or the constant one where there are none."""
    has = set(table.headers)
    if constant is not None and not has & {*FORCES, *MOMENTS}:
        return np.tile(constant, (len(table.lines), 1))
    if constant is not None:
        raise InputError(
            "the path holds forces, and a load is given besides",
            where=str(table.path),
            remedy="Leave --wrench out, or delete the columns.",
        )
    missing = [name for name in FORCES if name not in has]
    if missing:
        raise InputError(
            f"the column {missing[0]!r} is missing",
            where=table.place(missing[0]),
            remedy="Give the force on the robot as fx[N], fy[N], fz[N], zeros where nothing acts; "
            "'compensate' takes one for all points by --wrench too.",
        )
    moments = np.zeros((len(table.lines), 3))
    if has & set(MOMENTS):
        moments = table.quantities(MOMENTS, "moment")
    return np.column_stack([table.quantities(FORCES, "force"), moments])


def joints_along(
    path: LoadedPath,
    arm: ElasticArm,
    start: Array | None = None,
    *,
    stays_above: Callable[[Array], Mask] | None = None,
    stands: Callable[[Array], Mask] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Array:
    """(N, n) joint coordinates of a path, found by inverse kinematics where it gives positions.

    The first point is sought from `start` and from poses all over the joints' ranges; every further
    one from one before it, so the arm stays in one branch. Of the branches that reach the first
    point the one nearest to `start` is taken if that was given; else those come first that stay
    above the floor, of these those that touch nothing there, and of these the one nearest to the
    pose with all joints at zero. A branch that does not reach the whole path gives way to the next.

    Args:
        path, arm: Where to go, and with what.
        start: (n,) coordinates whose branch is wanted [rad or m].
        stays_above, stands: Tell of poses (M, n) which stay above the floor, and which can be
            taken up.
        progress: Called with (points done, points in all).

    Raises:
        InputError: Joints and positions of one point do not agree; its line is named.
        Refusal: A point cannot be reached; its line is named.
    """
    if path.joints is not None:
        _agree(path, arm)
        return path.joints
    if path.position is None:
        raise ValueError("a path has joints or positions")
    task = Task(path.position, rotation=path.rotation)
    lost = 0
    for first in _branches(arm, task.rows(FIRST), start, (stands, stays_above)):
        joints, end = _followed(arm, task, first, progress)
        if end == path.count:
            return without_turns(arm, joints)
        lost = max(lost, end)
        if start is not None:
            break
    why = "from the one before it" if lost else f"({why_unreached(arm, task.rows(FIRST))})"
    raise Refusal(
        f"the arm cannot reach this point {why}",
        where=f"{path.table.path}, line {path.table.lines[lost]}",
        remedy="Look at what can be reached with 'sk120stiff map', or give the path by joints."
        if start is None
        else "Try another start pose, or none: then all branches are tried.",
    )


def _agree(path: LoadedPath, arm: ElasticArm) -> None:
    """Positions and orientations that stand beside joints, held against them."""
    if path.joints is None or path.position is None:
        return
    stands = arm.kinematics(path.joints)
    away = np.linalg.norm(stands.position - path.position, axis=1)
    worst, what = int(np.argmax(away)), "position"
    far = f"{1e3 * away[worst]:.3g} mm"
    if away[worst] <= AGREE:
        if path.rotation is None:
            return
        turn = np.swapaxes(stands.rotation, 1, 2) @ path.rotation
        off = np.linalg.norm(rotation_vector(turn), axis=1)
        worst, what = int(np.argmax(off)), "orientation (roll, pitch, yaw)"
        far = f"{np.rad2deg(off[worst]):.3g} deg"
        if off[worst] <= AGREE_TURNED:
            return
    raise InputError(
        f"the joints put {arm.frame} {far} away from the {what} beside them",
        where=f"{path.table.path}, line {path.table.lines[worst]}",
        remedy="Delete the columns that are not meant: the joints, or x, y, z (with roll, pitch, "
        "yaw). Positions that an instrument read are no path.",
    )


def _branches(
    arm: ElasticArm,
    first: Task,
    start: Array | None,
    asked: Sequence[Callable[[Array], Mask] | None],
) -> Array:
    """(M, n) different coordinates that reach the first point, the wanted one first.

    Without a `start` what is `asked` of them counts, the last question most.
    """
    rest = np.clip(np.zeros(arm.n) if start is None else start, arm.lower, arm.upper)
    starts = starting_poses(arm, STARTS, rest)
    reached = solve_inverse(arm, first.rows(np.zeros(STARTS, dtype=np.intp)), starts)
    # a joint that turns more than once stands in one posture by several numbers
    found = different(near(arm, reached.a[reached.found], rest))
    distance = np.linalg.norm(found - rest, axis=1)
    faults = [~ask(found) for ask in asked if ask and start is None and len(found)]
    return np.asarray(found[np.lexsort((distance, *faults))])


def different(poses: Array) -> Array:
    """(K, n) of coordinates (M, n) those that are not one and the same pose."""
    kept: list[Array] = []
    for a in poses:
        if all(np.abs(a - other).max() > SAME_BRANCH for other in kept):
            kept.append(a)
    return np.array(kept).reshape(-1, poses.shape[1])


def without_turns(arm: ElasticArm, joints: Array) -> Array:
    """(N, n) the same poses, each within half a turn of the one before it where limits allow it.

    Inverse kinematics finds a turning joint up to whole turns; a robot that moves by joints makes
    them.
    """
    a = joints.copy()
    for k in range(1, len(a)):
        a[k] = near(arm, a[k], a[k - 1])
    return a


def _followed(
    arm: ElasticArm,
    task: Task,
    first: Array,
    progress: Callable[[int, int], None] | None,
) -> tuple[Array, int]:
    """Coordinates (N, n) from the first point on, and how many points were reached.

    Points are solved in blocks that start from the last one found, and kept as long as neighbours
    stay neighbours; a block shrinks to a single point where they do not.
    """
    joints = np.empty((task.count, arm.n))
    joints[0] = first
    done, block = 1, 1
    while done < task.count:
        rows = np.arange(done, min(done + block, task.count))
        reached = solve_inverse(arm, task.rows(rows), np.tile(joints[done - 1], (len(rows), 1)))
        moves = np.abs(np.diff(reached.a, axis=0, prepend=joints[None, done - 1])).max(axis=1)
        good = reached.found & ((moves <= NEIGHBOURS) | (len(rows) == 1))
        kept = len(rows) if good.all() else int(np.argmin(good))
        if not kept and len(rows) == 1:
            break
        joints[done : done + kept] = reached.a[:kept]
        done += kept
        block = min(2 * block, LONGEST_BLOCK) if kept == len(rows) else max(1, kept)
        if progress:
            progress(done, task.count)
    return joints, done


def write_joints(
    target: str | os.PathLike[str],
    path: LoadedPath,
    robot: Robot,
    joints: Array,
    notes: Mapping[str, list[str]],
) -> Path:
    """Write a path with other joint coordinates, in the units of the file it was read from.

    What is written is held against the coordinates before the file takes its place.

    Args:
        notes: Further columns as text, header → N cells; they replace columns of that name.
    """
    table = path.table
    columns: dict[str, list[str]] = {}
    for k, (name, kind) in enumerate(zip(robot.actuated, robot.kinds, strict=True)):
        unit = table.column_units.get(name) or ("deg" if kind == "angle" else "mm")
        values = np.asarray(from_si(joints[:, k], unit, kind))
        columns[f"{name}[{unit}]"] = [f"{value:.10g}" for value in values]
    kept = {
        table.headers[name]: list(cells)
        for name, cells in table.cells.items()
        if name not in robot.actuated and table.headers[name] not in notes
    }
    order = list(kept)
    # labels first, then joints, then what the file has besides, then the notes
    labels = [header for header in order if header == "point"]
    merged = {**{header: kept.pop(header) for header in labels}, **columns, **kept, **notes}
    for k, (header, kind) in enumerate(zip(columns, robot.kinds, strict=True)):
        unit = header.partition("[")[2].rstrip("]")
        read = to_si([float(cell) for cell in merged[header]], unit, kind)
        if not np.allclose(read, joints[:, k], rtol=1e-9, atol=1e-9):
            raise RuntimeError(f"{header} is written otherwise than it was meant")
    return write_atomically(target, csv_text(merged.items()))
