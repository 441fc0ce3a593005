"""The bundled SK120 through the product, against matrices and against the closed loop of bodies."""

import itertools

import numpy as np
import pytest

from sk120stiff.robot import load_robot
from sk120stiff.stiffness import complementary_stiffness
from tests.oracles.mujoco_sk120 import PAPER_SPRINGS, REFLECTOR, deflect_sk120
from tests.oracles.numpy_kinematics import UrdfTree
from tests.oracles.table2_reference import ROBOT
from tests.stiffness.arms import deflection

SK120 = load_robot("motoman_sk120")
TREE = UrdfTree(ROBOT / "sk120.urdf")
LOWER = np.radians([-180, -70, -115, -180, -130, -180])
UPPER = np.radians([180, 70, 35, 180, 130, 180])

# The whole range of joints 1 to 3, ends included
GRID = np.array(
    [
        (t1, t2, t3, 0, 0, 0)
        for t1, t2, t3 in itertools.product(
            np.radians(np.linspace(-180, 180, 9)),
            np.radians(np.linspace(-70, 70, 15)),
            np.radians(np.linspace(-115, 35, 16)),
        )
    ]
)


def position(frame: str) -> np.ndarray:
    return SK120.placement(GRID, frame)[..., :3, 3]


def regular_poses(count: int, seed: int) -> np.ndarray:
    """Poses where crank and rod are not in line: there the loop has no unique rest."""
    poses = np.random.default_rng(seed).uniform(LOWER, UPPER, (10 * count, 6))
    return poses[np.abs(np.cos(poses[:, 1] + poses[:, 2])) > 0.1][:count]


def test_loop_closes_over_the_whole_range():
    assert np.max(np.abs(position("rod_end") - position("forearm_lever_end"))) < 1e-12


def test_crank_and_rod_move_with_their_drivers():
    crank = position("crank_end") - position("link_2_l")
    lever = position("rod_end") - position("link_3_u")
    assert np.max(np.abs(crank - lever)) < 1e-12
    rod, arm = (
        position("rod_end") - position("crank_end"),
        position("link_3_u") - position("link_2_l"),
    )
    assert np.max(np.abs(rod - arm)) < 1e-12
    assert np.ptp(rod[:, 2]) > 0.5 and np.ptp(crank[:, 2]) > 0.5


def test_actuated_coordinate_is_the_absolute_elevation():
    ahead = SK120.placement(GRID, "link_3_u")[..., :3, 0]
    assert np.max(np.abs(ahead[:, 2] - np.sin(GRID[:, 2]))) < 1e-12
    toward = np.cos(GRID[:, 0]) * ahead[:, 0] + np.sin(GRID[:, 0]) * ahead[:, 1]
    assert np.max(np.abs(toward - np.cos(GRID[:, 2]))) < 1e-12


@pytest.mark.parametrize("frame", ["tool0", "reflector", "rod", "link_5_b"])
def test_placement_and_jacobian_agree_with_matrices(frame):
    point = np.array([0.1, -0.2, 0.3])
    for pose in np.random.default_rng(3).uniform(LOWER, UPPER, (5, 6)):
        values = dict(zip(SK120.actuated, pose, strict=True))
        assert np.allclose(SK120.placement(pose, frame), TREE.placement(values, frame), atol=1e-12)
        theirs = TREE.jacobian(values, frame, list(SK120.actuated), point)
        assert np.allclose(SK120.jacobian(pose, frame, point), theirs, atol=1e-10)


@pytest.mark.parametrize("wrist", [(np.inf,) * 3, (2e5, 3e5, 2.5e5)])
@pytest.mark.parametrize("moment", [(0, 0, 0), (80, -60, 140)])
def test_deflection_agrees_with_the_closed_loop_of_bodies(wrist, moment):
    wrench = np.array([300, -400, 500, *moment], float)
    springs = np.array([*PAPER_SPRINGS, *wrist])
    elastic = [k if np.isfinite(k) else None for k in wrist]
    for pose in regular_poses(8, seed=7):
        loop = deflect_sk120(pose, wrench, wrist=elastic, point=REFLECTOR)
        assert loop.closure < 1e-12
        assert np.linalg.norm(loop.displacement) > 1e-4
        ours = deflection(SK120.mechanism("reflector"), pose, wrench, springs)
        assert np.allclose(ours.equilibrium, loop.displacement, rtol=0, atol=1e-9)
        # the crude formula is off by more than the tolerance: the oracle can tell
        assert np.max(np.abs(ours.conventional - loop.displacement)) > 1e-8


def test_complementary_stiffness_is_the_slope_of_the_torques():
    wrench, step = np.array([300, -400, 500, 80, -60, 140.0]), 1e-4
    for pose in regular_poses(4, seed=9):

        def torques(by: np.ndarray, pose: np.ndarray = pose) -> np.ndarray:
            values = dict(zip(SK120.actuated, pose + by, strict=True))
            return TREE.jacobian(values, "reflector", list(SK120.actuated)).T @ wrench

        slope = np.array([(torques(e) - torques(-e)) / (2 * step) for e in step * np.eye(6)]).T
        K_C = complementary_stiffness(SK120.screws(pose, "reflector"), wrench)
        assert np.allclose(K_C, slope, atol=1e-4)
        assert np.max(np.abs(K_C)) > 100
