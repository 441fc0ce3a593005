"""A pose of which one joint was written down wrongly is set aside, and told what it would be."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.words import findings
from sk120stiff.measurements import Measurements
from tests.positions.shared import campaign

COUNT, POSE = 30, 7


def told(folder: Path, readings: Measurements) -> list[str]:
    robot = sk.load_robot(readings.robot, base="base", tool="tool")
    found = calibrate(sk.base_model(robot), readings)
    assert found.wild.any(), folder
    return [said.strip() for said in findings(found, readings) if "would explain" in said]


@pytest.mark.parametrize(("joint", "off"), [(1, 10.0), (3, -1.0), (4, 60.0)])
def test_the_joint_and_its_value_are_told(tmp_path: Path, joint: int, off: float) -> None:
    data = campaign(tmp_path, 3, COUNT, loads=(0.0,), markers="AB")
    joints = data.joints.copy()
    rows = np.array(data.pose) == f"p{POSE}"
    meant = np.degrees(joints[rows, joint][0])
    joints[rows, joint] += np.radians(off)
    (said,) = told(tmp_path, replace(data, joints=joints))
    assert said.startswith(f"Pose p{POSE}: j{joint + 1} = ")
    assert float(said.split(" = ")[1].split(" deg")[0]) == pytest.approx(meant, abs=0.1)


def test_a_position_that_was_read_wrongly_is_no_joint(tmp_path: Path) -> None:
    data = campaign(tmp_path, 3, COUNT, loads=(0.0,), markers="AB")
    assert data.absolute is not None and data.absolute.channels.position is not None
    x = data.absolute.channels.position.copy()
    x[np.array(data.pose) == f"p{POSE}"] += [[0.03, -0.02, 0.05], [-0.04, 0.01, 0.02]]
    channels = replace(data.absolute.channels, position=x)
    assert told(tmp_path, replace(data, absolute=replace(data.absolute, channels=channels))) == []
