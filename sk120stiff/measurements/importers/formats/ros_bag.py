"""Recordings of ROS 2 (and 1): joint states and marker positions, matched by time.

A position counts where the arm stands still: joint states before and after it agree. Units are
those of ROS (m, rad; REP 103).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff import files
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, require
from sk120stiff.measurements.importers.contract import NO, Column, Guess, Sheet, Source
from sk120stiff.measurements.poses import rows_at_rest
from sk120stiff.measurements.table.columns import QUATERNION

STILL = 1e-3  # rad or m between the joint states around a position
LATE = 0.1  # s from a position to the nearest joint state
_MAGIC = (b"\x89MCAP0\r\n", b"SQLite format 3\0", b"#ROSBAG V2.0")
_JOINTS = "sensor_msgs/msg/JointState"
_POINTS = {  # type of message → where position and quaternion stand in it
    "geometry_msgs/msg/PointStamped": ("point", None),
    "geometry_msgs/msg/PoseStamped": ("pose.position", "pose.orientation"),
    "geometry_msgs/msg/PoseWithCovarianceStamped": ("pose.pose.position", "pose.pose.orientation"),
    "geometry_msgs/msg/TransformStamped": ("transform.translation", "transform.rotation"),
}


@dataclass(frozen=True)
class RosBag:
    """A folder with metadata.yaml and .db3 or .mcap files, or one of those files."""

    name: str = "rosbag"
    title: str = "a ROS bag"

    def sniff(self, source: Source) -> Guess:
        """The folder's metadata, or the first bytes of the file."""
        if source.path.is_dir():
            meta = source.path / "metadata.yaml"
            known = meta.is_file() and b"rosbag2_bagfile_information" in files.read_bytes(meta)
            return Guess(1.0, "metadata.yaml of rosbag2") if known else NO
        if source.given is None and source.data.startswith(_MAGIC):
            return Guess(1.0, "its first bytes")
        return NO

    def read(self, source: Source) -> Sheet:
        """Positions of one topic with the joint values at their time.

        Raises:
            InputError: Topics that are missing or several, joints that the robot does not have, or
                no position while the arm stood still.
            MissingPart: rosbags is not installed.
        """
        joints, points, topic, others = _messages(source)
        if not joints:
            raise InputError(
                f"no {_JOINTS} holds all of the robot's joints",
                where=str(source.path),
                remedy=f"The actuated joints are {', '.join(source.actuated)}. {others}",
            )
        at = np.array([stamp for stamp, _ in joints])
        order = np.argsort(at, kind="stable")
        at, q = at[order], np.array([values for _, values in joints])[order]
        kept, skipped, values = [], [], []
        for number, (stamp, position, _, _) in enumerate(points, 1):
            reason, value = _joints_at(stamp, at, q)
            if not np.isfinite(position).all():
                reason = "the position is not finite"
            if reason:
                skipped.append((number, reason))
            else:
                kept.append(number - 1)
                values.append(value)
        if not kept:
            raise InputError(
                f"no position of {topic} can be used: {skipped[0][1]}"
                if skipped
                else f"{topic} is empty",
                where=str(source.path),
                remedy="Record joint states and positions together, while the arm stands still.",
            )
        return _sheet(source, topic, [points[k] for k in kept], kept, np.array(values), skipped,
                      len(points), others)  # fmt: skip


def _sheet(
    source: Source,
    topic: str,
    points: list[Any],
    kept: list[int],
    q: Array,
    skipped: list[tuple[int, str]],
    total: int,
    others: str,
) -> Sheet:
    def column(header: str, meaning: str, unit: str, cells: Sequence[float]) -> Column:
        return Column(header, meaning, unit, "REP 103", tuple(map(repr, cells)))

    stamps = np.array([stamp for stamp, *_ in points])
    xyz = np.array([position for _, position, *_ in points])
    turns = [turn for *_, turn in points if turn is not None]
    columns = [column(f"{topic} {a}", a, "m", xyz[:, k].tolist()) for k, a in enumerate("xyz")]
    columns += [
        column(name, f"joint {k + 1}", "SI", q[:, k].tolist())
        for k, name in enumerate(source.actuated)
    ]
    if turns:
        columns += [
            Column(f"{topic} {name}", name, None, "REP 103", tuple(repr(turn[k]) for turn in turns))
            for k, name in enumerate(QUATERNION)
        ]
    runs = rows_at_rest(q, STILL)
    labels = tuple(f"P{k}" for k, run in enumerate(runs, 1) for _ in run)
    columns.append(column("time stamp", "time", "s", (stamps - stamps[0]).tolist()))
    columns.append(Column("standstill", "pose", None, "", labels))
    frames = sorted({frame for _, _, frame, _ in points})
    return Sheet(
        path=source.path,
        title="a ROS bag",
        why="its metadata" if source.path.is_dir() else "its first bytes",
        columns=tuple(columns),
        lines=tuple(k + 1 for k in kept),
        skipped=tuple(skipped),
        rank=tuple(kept),
        total=total,
        frame=", ".join(frames) or None,
        unused=(others,) if others else (),
        notes=(
            f"Positions of {topic}, counted as they were recorded, with the joint values at their "
            f"time: between two joint states that differ by less than {STILL:g} rad or m.",
            "Joint values that differ by less are one pose.",
        ),
    )


def _joints_at(stamp: float, at: Array, q: Array) -> tuple[str, Array]:
    """Why there are no joint values at a time, or those (n,)."""
    after = int(np.searchsorted(at, stamp))
    around = [k for k in (after - 1, after) if 0 <= k < len(at)]
    near = [k for k in around if abs(at[k] - stamp) <= LATE]
    if not near:
        return f"no joint state within {LATE:g} s", q[0]
    if np.abs(q[near[0]] - q[near[-1]]).max() > STILL:
        return "the arm moved", q[0]
    best = min(near, key=lambda k: abs(at[k] - stamp))
    return "", q[best]


def _messages(source: Source) -> tuple[list[Any], list[Any], str, str]:
    """Joint states and positions with their times, the topic of these, and what is not used."""
    require("rosbags", needed_for="reading a ROS bag")
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    path = _folder(source.path)
    joints: list[Any] = []
    points: list[Any] = []
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            topics = {c.topic: c.msgtype for c in reader.connections}
            topic = _chosen(source, [t for t, kind in topics.items() if kind in _POINTS])
            wanted = [c for c in reader.connections if c.topic == topic or c.msgtype == _JOINTS]
            for connection, recorded, raw in reader.messages(wanted):
                message: Any = reader.deserialize(raw, connection.msgtype)
                stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
                stamp = stamp or 1e-9 * recorded
                if connection.msgtype == _JOINTS:
                    known = dict(zip(message.name, message.position, strict=False))
                    if set(source.actuated) <= known.keys():
                        joints.append((stamp, [float(known[name]) for name in source.actuated]))
                else:
                    where, turned = _POINTS[connection.msgtype]
                    place, turn = _part(message, where), None
                    xyz = (float(place.x), float(place.y), float(place.z))
                    if turned is not None:
                        q = _part(message, turned)
                        turn = (float(q.w), float(q.x), float(q.y), float(q.z))
                    points.append((stamp, xyz, message.header.frame_id, turn))
    except InputError:
        raise
    except Exception as error:  # whatever a broken recording makes of it
        raise InputError(
            f"this recording cannot be read ({error})",
            where=str(source.path),
            remedy="Give the folder that holds metadata.yaml, or make it with: ros2 bag reindex.",
        ) from error
    rest = [f"{t} ({k})" for t, k in topics.items() if t != topic and k != _JOINTS]
    return joints, points, topic, f"Topics: {'; '.join(rest)}." if rest else ""


def _part(message: Any, path: str) -> Any:
    """What stands in a message under ``pose.position`` and the like."""
    for part in path.split("."):
        message = getattr(message, part)
    return message


def _folder(path: Path) -> Path:
    """The folder of a file that has its metadata beside it."""
    beside = path.parent / "metadata.yaml"
    return path.parent if path.is_file() and beside.is_file() else path


def _chosen(source: Source, topics: list[str]) -> str:
    """The topic of positions.

    Raises:
        InputError: None, several, or another one was named.
    """
    listed = ", ".join(topics)
    if source.topic is not None and source.topic not in topics:
        raise InputError(
            f"no topic of positions is called {source.topic!r}",
            where="--topic",
            remedy=f"There are {listed}." if topics else "The recording holds none.",
        )
    if source.topic is None and len(topics) != 1:
        raise InputError(
            f"positions stand in {listed}" if topics else "the recording holds no positions",
            where=str(source.path),
            remedy=f"Choose one: --topic {topics[0]}."
            if topics
            else f"They are of the types {', '.join(_POINTS)}.",
        )
    return source.topic or topics[0]
