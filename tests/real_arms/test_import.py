"""The published files themselves, one command each; not collected where they are missing."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot, read_measurements
from sk120stiff.measurements.importers import Told, import_readings
from tests.real_arms import fanuc, test_ur5_tracker

if fanuc.FOLDER.is_dir():

    def test_cable_pulls_of_three_files_without_headers(tmp_path: Path) -> None:
        told = Told(
            length="m", angle="rad", load="N", point=np.array([0.0069, 0.2453, 0.3193]),
            joints=("q1", "q2", "-(q2 + q3)", "-q4", "-q5", "-q6"),
        )  # fmt: skip
        robot = fanuc.robot(tmp_path, 1, 1, 1, 1, 1, 1)
        found = import_readings(
            fanuc.FOLDER / "deflections.csv",
            robot,
            told,
            columns=("dx", "dy", "dz"),
            joints_file=fanuc.FOLDER / "joint_angles.csv",
            loads_file=fanuc.FOLDER / "forces.csv",
        )
        found.write(tmp_path / "own.csv")
        back = read_measurements(tmp_path / "own.csv").with_joints(robot.actuated)
        expected = fanuc.readings(fanuc.MAPPED)
        np.testing.assert_allclose(back.joints, fanuc.MAPPED, atol=1e-12)
        np.testing.assert_array_equal(back.displacement, expected.displacement)
        np.testing.assert_array_equal(back.wrench, expected.wrench)
        assert found.mode == "displacements"


if test_ur5_tracker.FOLDER.is_dir() and test_ur5_tracker.urdf() is not None:

    def test_a_thousand_targets_and_differences(tmp_path: Path) -> None:
        robot = load_robot(test_ur5_tracker.urdf(), base="base_link", tool="tool0")
        source = test_ur5_tracker.FOLDER / "grid_1000.csv"
        found = import_readings(source, robot, Told(length="mm", angle="deg"))
        assert found.fitted is not None and found.reversed_rms is not None
        assert found.fitted.rms == pytest.approx(0.70e-3, abs=0.02e-3)
        assert found.reversed_rms > found.fitted.rms  # the sign that the file does not state
        assert len(found.draft.pose) == 1000 and not found.draft.unused
