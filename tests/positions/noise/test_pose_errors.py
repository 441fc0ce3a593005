"""What the readings of a pose have in common: whitening, its size, and what it does to answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.explain.options import Options
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.solve.pose_errors import Common, PoseWhitening, common_error
from sk120stiff.identify.positions.words import noise_of
from sk120stiff.model import Model
from tests.positions.arm import NAMES, Arm, Array, errors, poses, tracked, write
from tests.positions.shared import FIT, OFF, PLACES, SIGMA, campaign


def drawn(seed: int, count: int = 12) -> tuple[PoseWhitening, Array]:
    """Numbers of several poses, of different uncertainty, and their covariance in full."""
    rng = np.random.default_rng(seed)
    pose = rng.permutation(np.repeat(np.arange(4), count // 4))
    ways, sigma, common = rng.normal(size=(count, 3)), rng.uniform(0.5, 2.0, count), 0.7
    same = pose[:, None] == pose
    full = np.diag(sigma**2) + common**2 * same * (ways @ ways.T)
    return PoseWhitening(sigma, ways, pose, common), full


def test_whitening_makes_the_covariance_one() -> None:
    whitening, full = drawn(1)
    W = whitening.apply(np.eye(len(full)))
    np.testing.assert_allclose(W @ full @ W.T, np.eye(len(full)), atol=1e-12)
    assert whitening.logdet == pytest.approx(np.linalg.slogdet(full)[1])
    x = np.random.default_rng(2).normal(size=(len(full), 2))
    np.testing.assert_allclose(whitening.undo(whitening.apply(x)), x, atol=1e-12)
    np.testing.assert_allclose(whitening.apply(x[:, 0]), whitening.apply(x)[:, 0])


def test_without_a_common_size_numbers_are_independent() -> None:
    whitening = replace(drawn(1)[0], common=0.0)
    x = np.random.default_rng(2).normal(size=12)
    np.testing.assert_allclose(whitening.apply(x), x / whitening.sigma)
    assert common_error(x, np.zeros((12, 0)), PoseWhitening(np.ones(12)), stated=False) == Common(
        0.0, 1.0, 0.0
    )


@pytest.mark.parametrize("assumed", [1.0, 5.0])
def test_size_and_noise_come_back_whatever_noise_was_assumed(assumed: float) -> None:
    sizes, noises = [], []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        pose = np.repeat(np.arange(40), 9)
        ways, X = 1e4 * rng.normal(size=(360, 6)), rng.normal(size=(360, 20))
        gap = rng.normal(size=360) + OFF * np.einsum(
            "mk,mk->m", ways, rng.normal(size=(40, 6))[pose]
        )
        gap -= X @ np.linalg.lstsq(X, gap)[0]
        found = common_error(
            gap, X, PoseWhitening(assumed * np.ones(360), ways, pose), stated=False
        )
        sizes.append(found.size)
        noises.append(found.noise * assumed)
    assert np.mean(sizes) == pytest.approx(OFF, rel=0.05)
    assert np.mean(noises) == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("turning", [1.0, 4.0])
def test_turns_of_another_size_than_joints_make_come_back(turning: float) -> None:
    """A wrist that yields turns the tool farther than it shifts it; three markers show it."""
    turns, found = np.arange(6) >= 3, []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        pose = np.repeat(np.arange(40), 9)
        ways, X = 1e4 * rng.normal(size=(360, 6)), rng.normal(size=(360, 20))
        own = OFF * np.where(turns, turning, 1.0) * rng.normal(size=(40, 6))
        gap = rng.normal(size=360) + np.einsum("mk,mk->m", ways, own[pose])
        gap -= X @ np.linalg.lstsq(X, gap)[0]
        whitening = PoseWhitening(np.ones(360), ways, pose)
        found.append(common_error(gap, X, whitening, stated=False, turns=turns))
    assert np.exp(np.mean(np.log([each.turning for each in found]))) == pytest.approx(
        turning, rel=0.1
    )
    assert np.mean([each.size for each in found]) == pytest.approx(OFF, rel=0.1)
    if turning == 1.0:
        assert all(each.turning == 1.0 for each in found)


def test_noise_alone_has_nothing_in_common() -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        whitening = PoseWhitening(
            np.ones(120), 1e4 * rng.normal(size=(120, 6)), np.arange(120) // 6
        )
        found = common_error(rng.normal(size=120), np.ones((120, 1)), whitening, stated=False)
        assert found.size == 0.0 and found.chance > 1e-4


def test_an_arm_whose_errors_are_no_draws_is_registered_as_one_marker_registers_it(
    tmp_path: Path,
) -> None:
    """Wrong zeros of joints are the same at all poses, however sharp differences of markers are."""
    m = campaign(tmp_path, 3, 30, loads=(0.0,), markers="ABC", off=0.0)
    model = Model(sk.load_robot(m.robot, base="base", tool="tool"))
    plain, shared = (
        calibrate(model, m, geometry=False, waves=False, shared=each) for each in (False, True)
    )
    assert shared.problem.common > 0.0
    sizes = [np.sqrt(np.mean(each.distances**2)) for each in (plain, shared)]
    assert sizes[1] < 1.25 * sizes[0]


def test_where_nothing_is_named_the_arm_is_registered_by_least_squares(tmp_path: Path) -> None:
    m = campaign(tmp_path, 3, 30, loads=(0.0,), markers="ABC")
    model = Model(sk.load_robot(m.robot, base="base", tool="tool"))
    answer = explain_positions(model, m, options=Options(only=("joint_offset:j1",)))
    assert not answer.findings
    left = np.sqrt(np.mean(answer.base.distances**2) / 3.0)
    assert answer.steps[0].fit_rms == pytest.approx(left, rel=1e-3)
    assert np.sqrt(np.mean(answer.final.distances**2) / 3.0) == pytest.approx(left, rel=1e-6)


def test_the_first_row_of_the_gap_is_the_arm_registered_by_least_squares(tmp_path: Path) -> None:
    m = campaign(tmp_path, 3, 30, loads=(0.0,), markers="ABC", off=2 * OFF)
    answer = explain_positions(Model(sk.load_robot(m.robot, base="base", tool="tool")), m)
    assert answer.findings and answer.final.problem.common > 0.0
    left = np.sqrt(np.mean(answer.base.distances**2) / 3.0)
    assert answer.steps[0].fit_rms == pytest.approx(left, rel=0.01)


@pytest.mark.parametrize("turned", [0.0, 4e-4])  # rad
def test_a_tool_that_turns_of_its_own_is_weighed_so(tmp_path: Path, turned: float) -> None:
    """Of a soft wrist turns say little; counted as joints turn it they would draw all else."""
    a, rng = poses(40, 3), np.random.default_rng(3)
    q = a + OFF * rng.normal(size=a.shape)
    turns = Rotation.from_rotvec(turned * rng.normal(size=(40, 3)))
    origin, axes = replace(Arm(), marker=np.zeros(3)).stands(q)[:2]
    x = np.concatenate(
        [origin + np.einsum("nij,nj->ni", axes, turns.apply(PLACES[name])) for name in "ABC"]
    )
    x = tracked(x + SIGMA * rng.normal(size=x.shape))
    cells = [f"{name},p{k}" for name in "ABC" for k in range(len(a))]
    path = write(tmp_path, np.tile(a, (3, 1)), x, FIT, more=",marker,pose", cells=cells)
    m = sk.read(path).with_joints(NAMES)
    model = Model(sk.load_robot(m.robot, base="base", tool="tool"))
    found = calibrate(model, m, geometry=False, waves=False).problem
    assert found.common > 0.0
    assert (found.turning > 3.0) if turned else (found.turning == 1.0)
    ways, own = found.of_channels.ways, found.by_pose
    assert ways is not None
    np.testing.assert_allclose(ways[:, :3], own[:, :3])
    np.testing.assert_allclose(ways[:, 3:], found.turning * own[:, 3:])


def springs(found: Calibration) -> tuple[Array, Array]:
    """Compliances of joints 2 and 3 and their standard errors."""
    own = [found.model.parameter(f"joint_springs:j{k}.stiffness") for k in (2, 3)]
    return np.array([p.internal for p in own]), np.array([p.std for p in own])


def test_loads_at_one_pose_tell_springs_beside_what_the_pose_has_of_its_own(tmp_path: Path) -> None:
    """Differences between loads are as sharp as the tracker, whatever the pose itself is off by."""
    m = campaign(tmp_path, 3, 20, loads=(0.0, 30.0), markers="AB", off=2 * OFF)
    model = sk.base_model(sk.load_robot(m.robot, base="base", tool="tool"))
    alone, shared = (calibrate(model, m, shared=each) for each in (False, True))
    truth = Arm().compliance + errors(3).compliance
    ends = dict(zip((p.name for p in shared.parameters), shared.intervals(), strict=True))
    for k in (1, 2):
        low, high = ends[f"joint_springs:j{k + 1}.stiffness"]
        assert low < 1.0 / truth[k] < high
        assert (high - low) * truth[k] < 0.06
    assert (springs(shared)[1] < 0.3 * springs(alone)[1]).all()
    assert noise_of(shared) == pytest.approx(SIGMA, rel=0.1)
    assert shared.problem.common == pytest.approx(2 * OFF, rel=0.4)


@pytest.mark.parametrize("markers", ["A", "ABC"])
def test_three_markers_at_a_pose_doubt_no_name_that_one_would_settle(
    tmp_path: Path, markers: str
) -> None:
    m = campaign(tmp_path, 102, 40, loads=(0.0,), markers=markers)
    found = explain_positions(Model(sk.load_robot(m.robot, base="base", tool="tool")), m)
    names = {item.effect.id: item.probability for item in found.findings}
    assert {"joint_springs:j2", "joint_springs:j3"} <= set(names)
    assert found.verdict == "named" and min(names.values()) > 0.95, names
    assert all(name.startswith(("joint_springs", "joint_frame")) for name in names), names
    if markers == "ABC":
        assert "in common that no law explains" in found.left_over()[0]
