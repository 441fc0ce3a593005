"""Joint columns of which some are in degrees and some in radians."""

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.measurements.placing.slips import slips
from sk120stiff.measurements.table.angle_units import like_degrees, like_radians
from tests.measurements.placing.test_conventions import NOISE, cloud_of

TURNING = np.ones(3, dtype=bool)
DEGREES = np.array([[-80.0, 2.0, 0.5], [40.0, -1.5, 0.6], [95.0, 0.3, 0.5]])


def test_columns_within_half_a_turn_of_radians_beside_large_ones() -> None:
    a = np.radians(DEGREES)
    assert like_radians(a, TURNING).tolist() == [1]  # the last was held
    assert like_radians(a[:, 1:], TURNING[1:]).size == 0  # nothing says that these are degrees
    assert like_radians(a, np.array([True, False, True])).size == 0


def test_columns_beyond_all_turns() -> None:
    assert like_degrees(DEGREES, TURNING).tolist() == [0]
    assert like_degrees(DEGREES[:, :1], TURNING[:1]).size == 0  # all of them: another slip


@pytest.mark.parametrize(
    ("factor", "columns", "words"),
    [
        (np.pi / 180.0, [3, 4, 5], "wrist_1_joint, wrist_2_joint and wrist_3_joint look like rad"),
        (180.0 / np.pi, [0, 1, 2], "shoulder_lift_joint and elbow_joint look like deg, not rad"),
    ],
)
def test_positions_tell_which(factor: float, columns: list[int], words: str) -> None:
    robot = sk.load_robot("ur5e")
    cloud = cloud_of(robot, np.ones(6), np.zeros(6), seed=2)
    cloud.a[:, columns] *= factor
    _, rms, said, remedy = min(slips(cloud, robot.actuated), key=lambda item: item[0])
    assert rms < 3.0 * NOISE
    assert words in said and "in those of the others" in remedy
