"""Appendix I: the misprint is found, and nothing else is."""

import numpy as np

from sk120stiff.paper.formulation import (
    LENGTHS,
    mended_jacobian,
    paper_angles,
    printed_jacobian,
    slips,
)
from tests.oracles.mujoco_sk120 import REFLECTOR
from tests.oracles.numpy_kinematics import UrdfTree
from tests.oracles.table2_reference import ROBOT

TREE = UrdfTree(ROBOT / "sk120.urdf")
NAMES = ["joint_1_s", "joint_2_l", "joint_3_u", "joint_4_r", "joint_5_b", "joint_6_t"]
PAPER = {"L1": 0.215, "L2": 1.1, "L3": 0.25, "D4": 1.3, "D6": 0.23 + 0.11265, "L6": 0.20532}


def poses(count, seed):
    low, high = (
        np.radians([-180, -70, -115, -180, -120, -180]),
        np.radians([180, 70, 35] + [120] * 3),
    )
    return np.random.default_rng(seed).uniform(low, high, (count, 6))


def test_mended_it_is_the_slope_of_the_reflectors_position():
    for a in poses(8, 0):
        values = dict(zip(NAMES, a, strict=True))
        J = TREE.jacobian(values, "tool0", NAMES[:3], REFLECTOR)[:3] * [1, 1, -1]
        assert np.allclose(mended_jacobian(paper_angles(a), PAPER), J, rtol=0, atol=1e-9)
        off = np.abs(printed_jacobian(paper_angles(a), PAPER) - J) > 1e-6
        assert off.sum() == 1 and off[1, 0]


def test_the_appendix_is_wrong_in_one_element(found):
    assert found.appendix.mended_error.max() < 1e-12
    wrong = found.appendix.printed_error > 1e-9
    assert wrong.sum() == 1 and wrong[1, 0]
    # twice the length times a cosine
    assert 2.0 < found.appendix.printed_error[1, 0] <= 2 * 1.3 + 1e-9


def test_slips_are_found_from_the_appendix_alone():
    assert [(slip.element, slip.length) for slip in slips()] == [
        ("J21", "D1"), ("J21", "D3"), ("J21", "D4"),
    ]  # fmt: skip


def test_every_other_length_is_consistent():
    """With any lengths at all the mended columns are slopes of one position."""
    rng = np.random.default_rng(4)
    lengths = dict(zip(LENGTHS, rng.uniform(0.1, 1.0, len(LENGTHS)), strict=True))
    angles, step = rng.uniform(-np.pi, np.pi, (20, 6)), 1e-5
    slopes = []
    for k in range(3):
        e = step * np.eye(6)[k]
        ahead, behind = (mended_jacobian(angles + s, lengths) for s in (e, -e))
        slopes.append((ahead - behind) / (2 * step))
    second = np.stack(slopes, axis=-1)  # (P, 3, column, by)
    assert np.allclose(second, np.swapaxes(second, -1, -2), rtol=0, atol=1e-8)


def test_batch_is_the_loop():
    angles = poses(6, 2).reshape(2, 3, 6)
    whole = printed_jacobian(angles, PAPER)
    assert whole.shape == (2, 3, 3, 3)
    for index in np.ndindex(2, 3):
        assert np.array_equal(whole[index], printed_jacobian(angles[index], PAPER))
