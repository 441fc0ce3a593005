"""Arms whose joints yield otherwise at every pose: alike under all loads of that pose."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.solve.gauss_newton import gauss_newton
from sk120stiff.model import Model
from tests.positions.arm import Arm, Array, poses
from tests.positions.loaded_arm import MARKERS, SPRINGS, moved, write_moved
from tests.positions.test_moved import PLAIN, POINT, ROCKING, SIGMA, TURNING, robot_of

UNEVEN = 0.06  # of each joint's compliance, drawn anew at every pose


def uneven(folder: Path, count: int, loads: int, seed: int, rocking: float = 0.0) -> Path:
    """A file of displacements and turns of such an arm."""
    rng = np.random.default_rng(seed)
    force = rng.normal(size=(loads * count, 3))
    force *= rng.uniform(300.0, 700.0, (len(force), 1)) / np.linalg.norm(
        force, axis=1, keepdims=True
    )
    a = np.repeat(poses(count, seed), loads, axis=0)
    parts: list[tuple[Array, Array]] = []
    for k in range(count):
        own = Arm(compliance=SPRINGS * (1.0 + UNEVEN * rng.normal(size=6)), weighs=False)
        rows = slice(k * loads, (k + 1) * loads)
        parts.append(moved(own, a[rows], force[rows], MARKERS["A"], rocking))
    d, turn = (np.vstack(each) for each in zip(*parts, strict=True))
    d, turn = d + SIGMA * rng.normal(size=d.shape), turn + TURNING * rng.normal(size=d.shape)
    columns = {f"d{axis}[mm]": 1e3 * d[:, k] for k, axis in enumerate("xyz")}
    columns |= {f"dr{axis}[mrad]": 1e3 * turn[:, k] for k, axis in enumerate("xyz")}
    return write_moved(folder, a, force, columns, POINT + PLAIN)


def beyond_springs(path: Path, *, rigid: bool = True) -> tuple[Explained, set[str]]:
    robot = robot_of(path)
    answer = sk.explain(Model(robot) if rigid else sk.base_model(robot), sk.read(path))
    assert isinstance(answer, Explained)
    names = {finding.effect.id for finding in answer.findings}
    return answer, {name for name in names if not name.startswith("joint_springs")}


@pytest.mark.parametrize("seed", range(2))
def test_no_impostor_is_named(seed: int, tmp_path: Path) -> None:
    answer, others = beyond_springs(uneven(tmp_path, 12, 2, seed))
    assert others == set()
    assert answer.final.problem.common > 0.0  # what the loads of a pose have in common


def test_a_cause_is_named_beside_it(tmp_path: Path) -> None:
    _, others = beyond_springs(uneven(tmp_path, 8, 3, 5, ROCKING))
    assert others == {"base_rocking:base"}


@pytest.mark.parametrize(
    ("count", "loads", "rocking"), [(6, 4, ROCKING), (8, 3, 0.0), (12, 2, ROCKING)]
)
def test_beside_springs_there_is_no_impostor(
    count: int, loads: int, rocking: float, tmp_path: Path
) -> None:
    """As the command has it: springs are the base, and what is left without a law has no name."""
    answer, others = beyond_springs(uneven(tmp_path, count, loads, 7, rocking), rigid=False)
    assert others == ({"base_rocking:base"} if rocking else set())
    assert answer.steps[0].label == "joint_springs"
    assert answer.verdict == ("named" if rocking else "outside")


def test_a_pose_yields_more_at_a_joint(tmp_path: Path) -> None:
    """The draw of a pose, against a joint whose spring is a little softer."""
    path = uneven(tmp_path, 6, 4, 1)
    robot = robot_of(path)
    read = sk.read(path).with_joints(robot.actuated)
    found = calibrate(sk.base_model(robot), read)
    problem = found.problem
    springs = found.model.values
    for j in range(6):
        softer = springs.copy()
        step = 1e-3 * springs[j]
        softer[j] += step
        change = problem.channel_gap(springs)[0] - problem.channel_gap(softer)[0]
        own = problem.by_joints[:, j]
        along = float(own @ change) / float(np.linalg.norm(own) * np.linalg.norm(change))
        assert along > 1.0 - 1e-5
    sizes = np.linalg.norm(problem.by_pose, axis=0)
    assert problem.by_pose.shape[1] == 6 and sizes.all()


def test_few_poses_are_refused(tmp_path: Path) -> None:
    path = uneven(tmp_path, 5, 3, 1)
    with pytest.raises(InputError, match=r"5 poses.*at 6 poses or more; displacements of one"):
        beyond_springs(path)


def test_steps_that_overshoot_are_halved() -> None:
    """A residual that bends the valley twice as much as its slope tells."""

    def evaluate(x: Array) -> tuple[Array, Array]:
        # half the curvature is the residual's own: Gauss and Newton go twice as far as they should
        return np.array([x[0], 1.0 + 0.495 * x[0] ** 2]), np.array([[1.0], [0.99 * x[0]]])

    found = gauss_newton(
        evaluate, np.array([0.3]), (np.array([-9.0]), np.array([9.0])), np.array([1e6]),
        np.zeros(1),
    )  # fmt: skip
    assert abs(found.x[0]) < 1e-2 and found.iterations < 40
