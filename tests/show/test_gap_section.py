"""The gap per pose where there are too many poses for bars."""

import numpy as np
import pytest

from sk120stiff.show.stories.gap_pictures import per_pose, rms_of_poses

POSES = tuple(map(str, range(400)))


@pytest.mark.parametrize(
    ("names", "end"),
    [(("model",), "is 673 µm."), (("before", "after"), "is 673 µm before, 673 µm after.")],
)
def test_one_model_is_not_named(names: tuple[str, ...], end: str) -> None:
    said = per_pose(POSES, dict.fromkeys(names, np.full(400, 673e-6)), None)
    assert isinstance(said, str) and said.endswith(f"the largest gap of one {end}")


def test_every_pose_has_the_rms_of_its_own_numbers() -> None:
    found = rms_of_poses(np.array([3.0, 4.0, 1.0]), np.array([2, 2, 0]), 4)
    np.testing.assert_allclose(found, [1.0, 0.0, np.sqrt(12.5), 0.0])
