"""A recording of ROS 2, written by rosbags: positions while the arm stands still."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import Writer
from rosbags.typesys import Stores, get_typestore

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import FORMATS, Sheet, Source, Told
from sk120stiff.measurements.importers.drafting import drafted
from tests.measurements.importers.reading import SIX, written

STORE = get_typestore(Stores.ROS2_HUMBLE)
POSES = np.random.default_rng(5).uniform(-2.0, 2.0, (4, 6))
SEEN = np.random.default_rng(6).uniform(-2.0, 2.0, (4, 3))


def message(name: str, /, **fields: Any) -> Any:
    return STORE.types[name](**fields)


def header(seconds: float, frame: str = "tracker") -> Any:
    stamp = message(
        "builtin_interfaces/msg/Time", sec=int(seconds), nanosec=round(seconds % 1.0 * 1e9)
    )
    return message("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def record(
    folder: Path, names: tuple[str, ...] = SIX, kind: str = "PointStamped", more: bool = False
) -> Path:
    """Every pose for a second, joints at 50 Hz; one position while it stands, one as it moves."""
    path = folder / "recording"
    with Writer(path, version=9) as bag:
        joints = bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=STORE)
        seen = bag.add_connection("/marker", f"geometry_msgs/msg/{kind}", typestore=STORE)
        if more:
            bag.add_connection("/other", "geometry_msgs/msg/PointStamped", typestore=STORE)

        def write(connection: Any, at: float, content: Any) -> None:
            raw = STORE.serialize_cdr(content, connection.msgtype)
            bag.write(connection, int((at + 1000.0) * 1e9), raw)

        for step in range(200):
            q = POSES[step // 50] if step % 50 < 40 else POSES[step // 50] + 0.01 * (step % 50)
            empty = np.zeros(0)
            state = message("sensor_msgs/msg/JointState", header=header(0.02 * step + 1.0, ""),
                            name=list(names[::-1]), position=np.array(q[::-1]), velocity=empty,
                            effort=empty)  # fmt: skip
            write(joints, 0.02 * step, state)
        for k, xyz in enumerate(SEEN):
            for late, shift in ((0.41, 0.0), (0.93, 0.1)):
                at = k + late + 1.0
                x, y, z = (float(v) + shift for v in xyz)
                if kind == "PointStamped":
                    point = message("geometry_msgs/msg/Point", x=x, y=y, z=z)
                    content = message(
                        "geometry_msgs/msg/PointStamped", header=header(at), point=point
                    )
                else:
                    pose = message(
                        "geometry_msgs/msg/Pose",
                        position=message("geometry_msgs/msg/Point", x=x, y=y, z=z),
                        orientation=message("geometry_msgs/msg/Quaternion", x=0., y=0., z=0., w=1.),
                    )  # fmt: skip
                    content = message("geometry_msgs/msg/PoseStamped", header=header(at), pose=pose)
                write(seen, at - 1.0, content)
    return path


def read(path: Path, **known: Any) -> Sheet:
    source = Source(path, SIX, **known)
    return FORMATS.chosen(source)[0].read(source)


@pytest.mark.parametrize("kind", ["PointStamped", "PoseStamped"])
def test_positions_while_the_arm_stands(tmp_path: Path, kind: str) -> None:
    sheet = read(record(tmp_path, kind=kind))
    assert (sheet.frame, len(sheet.lines)) == ("tracker", 4)
    assert [reason for _, reason in sheet.skipped] == ["the arm moved"] * 4
    draft = drafted(sheet, Told(), SIX, ())
    columns = written(draft)
    assert [float(c) for c in columns["y[m]"]] == SEEN[:, 1].tolist()
    np.testing.assert_array_equal(draft.joints.values, POSES)
    assert [float(c) for c in columns["time[s]"]] == pytest.approx([0.0, 1.0, 2.0, 3.0])
    assert draft.pose == ("P1", "P2", "P3", "P4")
    assert draft.sheet.has("qw", "qx", "qy", "qz") == (kind == "PoseStamped")


def test_what_a_recording_lacks_is_told(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    with pytest.raises(InputError, match=r"holds all of the robot's joints.*joint_1"):
        read(record(tmp_path / "a", names=tuple("abcdef")))
    several = record(tmp_path / "b", more=True)
    with pytest.raises(InputError, match=r"/marker, /other.*--topic /marker"):
        read(several)
    assert len(read(several, topic="/marker").lines) == 4
    with pytest.raises(InputError, match="no topic of positions is called '/nothing'"):
        read(several, topic="/nothing")
    with pytest.raises(InputError, match="/other is empty"):
        read(several, topic="/other")
    with pytest.raises(InputError, match=r"no ROS 2 bag: it holds no metadata\.yaml"):
        read(tmp_path)
    (inside,) = several.glob("*.db3")
    assert len(read(inside, topic="/marker").lines) == 4
    inside.write_bytes(inside.read_bytes()[:200])
    with pytest.raises(InputError):
        read(several, topic="/marker")
