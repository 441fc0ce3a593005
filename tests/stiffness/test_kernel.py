"""The compiled kernel against Pinocchio's Jacobians with K_C by plain loops, and against NumPy."""

from __future__ import annotations

import logging
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray

import sk120stiff
from sk120stiff.effects import effect
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.model import joint_spring_model, model_compliance
from sk120stiff.robot import Mechanism, Robot, VirtualJoint, load_robot
from sk120stiff.robot.loops.coupling import LoopCoupling
from sk120stiff.stiffness import CLASSES, COMPILED, ConstantCompliance, UnderLoad, under_load
from sk120stiff.stiffness.elastic import Compliant
from sk120stiff.stiffness.kernel import run
from sk120stiff.stiffness.kernel.compiled import part, told_of_compiling
from sk120stiff.stiffness.kernel.run import announced
from sk120stiff.stiffness.on_arrays import on_arrays
from tests.oracles.pinocchio_jacobian import pinocchios
from tests.oracles.sample_urdfs import mimic_tree, six_axis_arm
from tests.robot.loop_arms import cylinder, four_bar, sk120_loop

Array = NDArray[np.float64]
FORCE = np.array([310.0, -220.0, 430.0, 0.0, 0.0, 0.0])
WRENCH = np.array([310.0, -220.0, 430.0, 51.0, -37.0, 23.0])


PUBLIC = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"

ROBOTS = {
    "sk120": lambda: "motoman_sk120",
    "six axes": six_axis_arm,
    "skew axes": lambda: six_axis_arm(seed=7),
    "mimics and slides": mimic_tree,
    "ur5": lambda: str(PUBLIC / "ur_description/urdf/ur5_robot.urdf"),
    "seven axes": lambda: str(PUBLIC / "panda_description/urdf/panda.urdf"),
}


@pytest.fixture(params=list(ROBOTS), scope="module")
def robot(request: pytest.FixtureRequest) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        return load_robot(ROBOTS[request.param]())


DEFAULT = ("position", "compliance", "values", "stiffness_class")


def stiffness_batch(robot, a, springs, wrench, *, want=DEFAULT, threads=None, **arm):
    """`under_load` of springs at many poses, which go through the kernel."""
    elastic = ConstantCompliance.of_springs(robot, springs, **arm)
    return under_load(elastic, a, wrench, want, threads=threads)


def poses(robot: Robot, count: int, seed: int = 1) -> Array:
    return np.random.default_rng(seed).uniform(-2.5, 2.5, (count, robot.n))


def K_C_by_loops(robot: Robot, a: Array, wrench: Array, point: Array) -> tuple[Array, Array]:
    """J from Pinocchio, and K_C entry by entry from its columns; one pose."""
    motion = robot.coupling.motion(a)
    chain = robot.mechanism().chain
    columns = pinocchios(robot.tree, motion.q, robot.tool_frame, point)[:, chain.coordinates]
    F, M = wrench[:3], wrench[3:]
    m = columns.shape[1]
    K_C = np.zeros((m, m))
    for i in range(m):
        for j in range(m):
            near, far = min(i, j), max(i, j)
            K_C[i, j] = F @ np.cross(columns[3:, near], columns[:3, far])
            if j < i:
                K_C[i, j] += M @ np.cross(columns[3:, j], columns[3:, i])
    A = motion.first[chain.coordinates]
    return columns @ A, A.T @ K_C @ A


@pytest.mark.parametrize("wrench", [FORCE, WRENCH], ids=["force", "force and moment"])
def test_agrees_with_pinocchio(robot: Robot, wrench: Array) -> None:
    point = np.array([0.05, -0.11, 0.2])
    springs = np.linspace(3e5, 6e5, robot.n)
    a = poses(robot, 70)
    found = stiffness_batch(robot, a, springs, wrench, point=point, want=COMPILED)
    for k in range(len(a)):
        J, K_C = K_C_by_loops(robot, a[k], wrench, point)
        compliance = J[:3] @ np.linalg.solve(np.diag(springs) - K_C, J[:3].T)
        for ours, theirs in (
            (found.jacobian[k], J),
            (found.K_C[k], K_C),
            (found.compliance[k], compliance),
        ):
            assert np.abs(ours - theirs).max() <= 1e-12 * np.abs(theirs).max()


def with_virtual_joints(robot: Robot) -> Mechanism:
    """Bearing tilts, a sliding base and a twisting last link."""
    T = np.eye(4)
    T[:3, 3] = (0.02, -0.1, 0.3)
    return robot.mechanism().with_virtual_joints(
        [
            VirtualJoint("base.slide", -1, np.eye(4), np.array([0.6, 0.8, 0.0]), revolute=False),
            VirtualJoint("tilt.x", 0, T, np.array([1.0, 0.0, 0.0])),
            VirtualJoint("tilt.y", 0, T, np.array([0.0, 1.0, 0.0])),
            VirtualJoint("twist", robot.mechanism().chain.m - 1, T, np.array([0.0, 0.0, 1.0])),
        ]
    )


def arms(robot: Robot) -> dict[str, ConstantCompliance]:
    """Springs, some of them rigid, ones that tie coordinates together, and the robot's weight."""
    some = np.full(robot.n, np.inf)
    some[: max(1, robot.n // 2)] = 4e5
    mechanism = with_virtual_joints(robot)
    root = np.random.default_rng(5).normal(size=(mechanism.n, mechanism.n))
    tied = 1e5 * (root @ root.T + 5.0 * np.eye(mechanism.n))
    of = ConstantCompliance.of_springs
    point, v, g = np.array([0.05, -0.11, 0.2]), [0.03, -0.02, 0.05, 0.01], robot.gravity_in_base
    return {
        "springs": of(robot, np.linspace(3e5, 6e5, robot.n), point=point),
        "rigid joints": of(robot, some),
        "tied virtual joints": of(mechanism, tied, virtual=v, point=point),
        "heavy": of(robot, np.linspace(3e4, 6e4, robot.n), gravity=g),
        "heavy, tied": of(mechanism, 0.2 * tied, virtual=v, point=point, gravity=g),
    }


@pytest.mark.parametrize("kind", ["springs", "rigid joints", "tied virtual joints", "heavy",
                                  "heavy, tied"])  # fmt: skip
def test_the_kernel_gives_what_the_formulas_on_arrays_give(robot: Robot, kind: str) -> None:
    """All that it computes, for loads that the arm holds, loads beyond, and none."""
    arm = arms(robot)[kind]
    found = agreeing(arm, poses(robot, 203))
    if kind == "springs":
        assert (found.of("stiffness_class")[:2] == 0).all()
        assert (found.of("stiffness_class")[2] == CLASSES.index("indefinite")).any()
    if kind == "heavy" and robot.total_mass > 0.0 and robot.name != "motoman_sk120":
        assert found.of("K_gravity").any()


def agreeing(arm: Compliant, a: Array) -> UnderLoad:
    """What the kernel gives, after it was held against NumPy."""
    loads = np.array([[FORCE], [WRENCH], [3e3 * FORCE], [3e3 * WRENCH], [np.zeros(6)]])
    assert arm.fold is not None
    found, expected = under_load(arm, a, loads, COMPILED), on_arrays(arm, a, loads, COMPILED)
    soft = arm.soft
    K_theta = np.linalg.inv(arm.compliance_at(a)[..., soft[:, None], soft])
    K = K_theta - expected["K_gravity"] - expected["K_C"]
    reach = np.linalg.norm(expected["jacobian"][:, :3], axis=(-2, -1))
    inverse = np.linalg.norm(np.linalg.inv(K), axis=(-2, -1))
    parts = np.linalg.norm(K_theta, axis=(-2, -1)) + np.linalg.norm(K - K_theta, axis=(-2, -1))
    rounding = 1e-15 * (100.0 + parts * inverse) * reach**2 * inverse  # (Q, N) of a compliance
    force = np.abs(loads).max(axis=-1)
    for name, value in expected.items():
        ours = found.of(name)
        assert ours.shape == value.shape
        if name.endswith("_class"):
            np.testing.assert_array_equal(ours, value)
        elif name in ("compliance", "deflection_enhanced"):
            np.testing.assert_array_equal(np.isnan(ours), np.isnan(value))
            off = np.abs(ours - value).max(axis=(-2, -1) if name == "compliance" else -1)
            bound = rounding if name == "compliance" else rounding * force
            assert (off <= bound)[~np.isnan(off)].all(), name
        elif name == "values":
            clear = np.abs(1.0 / value) > 1e3 * rounding[..., None]
            assert clear[-1].any()  # without a load at least
            off = np.abs(1.0 / ours - 1.0 / value)
            assert (off <= 10.0 * rounding[..., None])[clear].all()
        elif name == "directions":
            gaps = -np.diff(1.0 / expected["values"], axis=-1)
            clear = (gaps > 1e10 * rounding[..., None]).all(axis=-1)
            assert clear[-1].any() or len(soft) < 3
            along = np.abs((ours * value).sum(-1))[clear]
            np.testing.assert_allclose(along, 1.0, atol=1e-9)
        elif name == "critical":
            np.testing.assert_allclose(ours, value, rtol=1e-9)
        else:
            share = 3e-8 if name == "condition" else 1e-12
            np.testing.assert_allclose(ours, value, atol=share * max(1.0, np.abs(value).max()))
    return found


LOOPS = {"five-bar": sk120_loop, "four-bar": four_bar, "cylinder": cylinder}


@pytest.mark.parametrize("loop", list(LOOPS))
def test_the_kernel_follows_closed_loops(
    loop: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Joints that follow no straight line, light and hanging from their weight, tilts and all."""
    robot = heavy(LOOPS[loop](tmp_path), tmp_path)
    assert isinstance(robot.coupling, LoopCoupling) and robot.total_mass > 0.0
    a = robot.coupling.start[: robot.n] + 0.1 * poses(robot, 90)
    a = a[robot.closes(a, 0.05)]
    assert len(a) > 60
    through = []
    door = sys.modules["sk120stiff.stiffness.under_load"]
    monkeypatch.setattr(door, "run", lambda *a: through.append(1) or run.run(*a))
    for kind, arm in arms(robot).items():
        found = agreeing(arm, a)
        assert found.of("K_gravity").any() == ("heavy" in kind)
    assert len(through) == len(arms(robot))


def heavy(robot: Robot, folder: Path) -> Robot:
    """The same robot with 20 kg in each link."""
    text = (folder / "robot.urdf").read_text(encoding="utf-8")
    mass = (
        '><inertial><origin xyz="0.1 0.02 0.2"/><mass value="20"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
    )
    (folder / "robot.urdf").write_text(re.sub(r"(<link[^>]*)/>", rf"\1{mass}", text))
    return load_robot(folder)


@pytest.mark.parametrize("name", ["gravity_compensator:joint_2_l", "closure_rod:rod"])
def test_the_kernel_follows_springs_that_change_with_the_pose(name: str) -> None:
    robot = load_robot("motoman_sk120")
    kind, where = name.split(":")
    added = effect(robot, kind, where)
    model = joint_spring_model(robot, np.linspace(3e5, 6e5, 6)) + added
    sizes = [0.3 * spec.typical for spec in added.parameters]
    arm = model_compliance(model.with_values(np.append(model.values[: -len(sizes)], sizes)))
    assert arm.constant is None
    agreeing(arm, 0.4 * poses(robot, 90))


def test_one_load_for_each_pose_and_threads(robot: Robot) -> None:
    count = 40_000  # more than one piece, so that threads do share
    a = poses(robot, count)
    loads = np.random.default_rng(3).normal(size=(count, 6)) * 100.0
    springs = np.full(robot.n, 4e5)
    one = stiffness_batch(robot, a, springs, loads, threads=1)
    two = stiffness_batch(robot, a, springs, loads, threads=3)
    np.testing.assert_array_equal(one.compliance, two.compliance)
    alone = stiffness_batch(robot, a[-7:], springs, loads[-7:])
    np.testing.assert_allclose(one.compliance[-7:], alone.compliance, rtol=1e-13, atol=1e-20)


def test_singular_poses_are_rigid_in_the_lost_direction() -> None:
    planar = load_robot(
        '<robot name="p"><link name="a"/><link name="b"/><link name="c"/><link name="t"/>'
        '<joint name="1" type="continuous"><parent link="a"/><child link="b"/>'
        '<axis xyz="0 0 1"/></joint><joint name="2" type="continuous"><parent link="b"/>'
        '<child link="c"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>'
        '<joint name="3" type="fixed"><parent link="c"/><child link="t"/>'
        '<origin xyz="0.5 0 0"/></joint></robot>'
    )
    found = stiffness_batch(
        planar, [[0.0, 0.0], [0.3, 0.9]], [2.0, 5.0], np.zeros(6), want=("values", "condition")
    )
    # stretched out, only y yields: 1.5²/2 + 0.5²/5 metres per newton
    np.testing.assert_allclose(found.values[0, 0], 1.0 / (1.5**2 / 2 + 0.25 / 5), rtol=1e-12)
    assert np.isinf(found.values[0, 1:]).all()
    assert np.isinf(found.values[1]).tolist() == [False, False, True]
    assert found.condition.tolist() == [0.0, 0.0]


def test_equal_principal_values_lose_no_digits() -> None:
    """A gantry of three slides: its compliance is its springs, turned by its axes."""
    rng = np.random.default_rng(2)
    for spread in ([1.0, 1.0, 1.0], [1.0, 1.0, 1.0 + 1e-9], [1.0, 1.0 + 1e-7, 3.0], [1, 3, 3.0]):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        links = "".join(f'<link name="l{k}"/>' for k in range(4))
        joints = "".join(
            f'<joint name="s{k}" type="prismatic"><parent link="l{k}"/><child link="l{k + 1}"/>'
            f'<axis xyz="{" ".join(map(repr, turn[k].tolist()))}"/>'
            '<limit lower="-1" upper="1" effort="0" velocity="0"/></joint>'
            for k in range(3)
        )
        gantry = load_robot(f'<robot name="gantry">{links}{joints}</robot>')
        springs = 1e6 * np.array(spread)
        want = ("values", "directions", "compliance")
        found = stiffness_batch(gantry, np.zeros((1, 3)), springs, FORCE, want=want)
        np.testing.assert_allclose(found.values[0], np.sort(springs), rtol=4e-15)
        R = found.directions[0]
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
        rebuilt = R.T @ np.diag(1.0 / found.values[0]) @ R
        np.testing.assert_allclose(rebuilt, found.compliance[0], atol=1e-14 * 1e-6)


def test_exactly_critical_load_gives_no_number() -> None:
    pendulum = load_robot(
        '<robot name="p"><link name="a"/><link name="b"/><link name="t"/>'
        '<joint name="1" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
        '</joint><joint name="3" type="fixed"><parent link="b"/><child link="t"/>'
        '<origin xyz="2 0 0"/></joint></robot>'
    )
    loads = np.array([[[0.0, 0, 0]], [[-3.0, 0, 0]], [[-4.0, 0, 0]], [[-5.0, 0, 0]]])
    loads = np.concatenate([loads, np.zeros((4, 1, 3))], axis=-1)
    want = ("values", "stiffness_class", "critical")
    found = stiffness_batch(pendulum, [[0.0]], [8.0], loads, want=want)
    names = [CLASSES[k].short for k in found.stiffness_class[:, 0]]
    assert names == ["PD", "PD", "PSD", "ND"]
    assert np.isnan(found.values[2]).all()
    np.testing.assert_allclose(found.values[:2, 0, 0], [2.0, 0.5])
    np.testing.assert_allclose(found.values[3, 0, 2], -0.5)  # 2² / (8 − 5·2), the wrong way
    np.testing.assert_allclose(found.critical[1:, 0], [4 / 3, 1.0, 0.8])
    assert np.isinf(found.critical[0, 0])


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"a": np.zeros((4, 5))}, "6 actuated"),
        ({"a": np.full((4, 6), np.nan)}, "pose 0"),
        ({"a": np.full((4, 6), 1e7)}, "radians"),
        ({"wrench": [1.0, np.nan, 0, 0, 0, 0]}, "load is not a finite"),
        ({"wrench": np.zeros((5, 6))}, "loads of shape"),
        ({"wrench": np.zeros((2, 1, 5))}, "loads of shape"),
        ({"springs": np.full(6, np.inf)}, "no joint has a finite spring"),
        ({"springs": [1, 1, -1, 1, 1, 1]}, "positive definite"),
        ({"springs": [1, 1, np.nan, 1, 1, 1]}, "not a number"),
        ({"springs": [1, 1]}, "for 6 coordinates"),
        ({"want": ["stifness"]}, "stifness"),
        ({"point": [0, 0]}, "three finite"),
    ],
)
def test_bad_input_is_refused(changes: dict[str, object], says: str) -> None:
    robot = load_robot("motoman_sk120")
    given: dict[str, object] = {"a": np.zeros((4, 6)), "springs": np.ones(6), "wrench": np.zeros(6)}
    with pytest.raises(InputError, match=says):
        stiffness_batch(robot, **{**given, **changes})


def test_no_poses_give_empty_arrays() -> None:
    robot = load_robot("motoman_sk120")
    found = stiffness_batch(robot, np.zeros((0, 6)), np.ones(6), np.zeros(6))
    assert found.compliance.shape == (0, 3, 3)


def test_a_long_start_is_announced(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "PATIENCE", 0.01)
    with caplog.at_level(logging.INFO, logger="sk120stiff"), announced():
        time.sleep(0.2)
    assert "Loading" in caplog.text


def test_compiling_is_announced_once() -> None:
    said: list[str] = []
    inner = part(lambda x: 2.0 * x)
    outer = njit(lambda x: inner(x))
    with told_of_compiling(lambda: said.append("compiling")):
        assert [outer(1.0), outer(2.0)] == [2.0, 4.0]
    assert said == ["compiling"]


def test_a_second_process_compiles_nothing() -> None:
    """Neither for another kind of arm: all share one signature."""
    program = """
import logging, numpy as np
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import ConstantCompliance, under_load
from sk120stiff.stiffness.kernel import run
logging.basicConfig(level="INFO"); run.PATIENCE = 0.0
for springs in (np.full(6, 1e6), [np.inf, 1e6, *4 * [np.inf]]):
    arm = ConstantCompliance.of_springs(load_robot("motoman_sk120"), springs)
    under_load(arm, np.zeros((3, 6)), np.ones(6))
from sk120stiff.stiffness.kernel.block import work
print(sum(work.stats.cache_hits.values()), sum(work.stats.cache_misses.values()))
"""
    under_load(arms(load_robot("motoman_sk120"))["springs"], np.zeros((2, 6)), FORCE)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["1", "0"]
    assert "Loading the batch kernel" in done.stderr and "Preparing" not in done.stderr


def test_compiled_code_is_kept_where_the_package_is_read_only(tmp_path: Path) -> None:
    package = tmp_path / "site"
    shutil.copytree(Path(sk120stiff.__file__).parent, package / "sk120stiff")
    cache = tmp_path / "cache"
    program = "from sk120stiff.stiffness.kernel.block import work; print(work._cache.cache_path)"
    environment = {**os.environ, "PYTHONPATH": str(package), "NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith(str(cache))
