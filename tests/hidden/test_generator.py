"""The generator against an engine, textbook beams, energy, and its own promises."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.hidden.generator.arm import Arm, ArmJoint, Typical
from tests.hidden.generator.build import BUILDERS, build, rebuild
from tests.hidden.generator.causes_elastic import (
    BaseRocking,
    ClosureRod,
    JointTilt,
    LinkBending,
    LinkTorsion,
    WristSpring,
)
from tests.hidden.generator.causes_joint import FrictionHysteresis, GearHardening, Memory
from tests.hidden.generator.design import plan
from tests.hidden.generator.mechanism import Mechanism
from tests.hidden.generator.noise import Noise
from tests.hidden.generator.robots import random_arm, six_axis, telescope, varied
from tests.hidden.generator.rotations import placement
from tests.hidden.generator.rows import Rows
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import World
from tests.hidden.generator.writing import write_case
from tests.hidden.mujoco_check import model_of, rest_position

HERE = Path(__file__).resolve().parent
POINT = np.array([-0.06, 0.04, 0.15])


def rows_for(arm: Arm, seed: int = 1, **keywords: object) -> Rows:
    return plan(arm, np.random.default_rng(seed), poses=6, loads=3, point=POINT, **keywords)


@pytest.mark.parametrize("make", [six_axis, telescope])
def test_serial_arm_rests_where_mujoco_says(make) -> None:  # type: ignore[no-untyped-def]
    arm = make()
    joint = arm.actuated[1]
    tilt = JointTilt(joint, {"first": 2.0 / arm.typical.tilt, "second": 0.7 / arm.typical.tilt})
    rock = BaseRocking(
        arm.base_link, {"x": 1.0 / arm.typical.rocking, "y": 2.0 / arm.typical.rocking}
    )
    world = World(arm, varied(arm, np.random.default_rng(2)), (tilt, rock))
    rows = rows_for(arm, schedule="scattered", moments=True)
    displacement = world.displacement(rows)

    inserts = tilt.inserts(arm) + rock.inserts(arm)
    mechanism = Mechanism(arm, inserts)
    commanded = mechanism.commanded(rows.coordinates)
    by_label = {**world.springs, **{entry.label: entry.compliance for entry in inserts}}
    compliance = np.array([by_label[label] for label in mechanism.labels])
    for row in range(rows.count):
        model = model_of(mechanism, commanded[:, row], compliance, POINT)
        ends = [
            rest_position(model, commanded[:, row], compliance, share * rows.force[row],
                          share * rows.moment[row])
            for share in (1.0, 0.0)
        ]  # fmt: skip
        assert np.allclose(displacement[row], ends[0] - ends[1], rtol=0, atol=1e-9)


def cantilever(length: float) -> tuple[Arm, Rows]:
    y = np.array([0.0, 1.0, 0.0])
    joints = tuple(
        ArmJoint(f"j{i}", placement(((0.0, 0, 0), (length, 0, 0))[i]), y, False, -1, 1, f"l{i}")
        for i in range(2)
    )
    limits = {"j0": (-1.0, 1.0), "j1": (-1.0, 1.0)}
    arm = Arm("beam", "beam.urdf", "base", "tip", joints, np.eye(4), ("j0", "j1"), limits,
              Typical(joint={}))  # fmt: skip
    force = np.array([[0.0, 0, -50.0], [0.0, 30.0, 0.0]])
    flat = np.zeros(2)
    rows = Rows(np.array([1, 1]), {"j0": flat, "j1": flat}, force, 0 * force, flat, flat,
                np.ones(2), np.ones(2, int), np.zeros(3), np.zeros(3))  # fmt: skip
    return arm, rows


@pytest.mark.parametrize("taper", [0.0, 0.5])
def test_beam_bends_as_the_textbook_says(taper: float) -> None:
    length, stiffness = 1.3, 6e6
    arm, rows = cantilever(length)
    # deflection of a clamped beam: integral of F (L - s)^2 / EI(s)
    s = (np.arange(200000) + 0.5) / 200000
    local = (1.0 - taper * s) ** -3.0
    local /= local.mean()
    unit = length**3 * np.mean(local * (1.0 - s) ** 2) / stiffness
    if taper == 0.0:
        assert unit == pytest.approx(length**3 / (3 * stiffness), rel=1e-9)
    misses = []
    for pieces in (20, 40):
        bend = LinkBending("l0", {"flexibility": 1 / stiffness}, {"taper": taper, "pieces": pieces})
        d = World(arm, {}, (bend,)).displacement(rows)
        misses.append(max(abs(d[0, 2] / (-50 * unit) - 1), abs(d[1, 1] / (30 * unit) - 1)))
    assert misses[0] < 2e-3
    assert misses[1] < 0.3 * misses[0]  # second order in the length of a piece


def test_shaft_twists_as_the_textbook_says() -> None:
    arm, rows = cantilever(1.3)
    lever = np.array([0.0, 0.2, 0.0])
    rows = replace(rows, point=lever, force_point=lever)
    d = World(arm, {}, (LinkTorsion("l0", {"flexibility": 1 / 4e6}),)).displacement(rows)
    assert d[0, 2] == pytest.approx(-50 * 0.2**2 * 1.3 / 4e6, rel=1e-5)


def sk120_world() -> tuple[World, Rows]:
    arm = sk120()
    causes = (
        LinkBending("link_2_l", {"flexibility": 2e-7}, {"taper": 0.4}),
        LinkBending("link_3_u", {"flexibility": 2e-7}),
        JointTilt("joint_3_u", {"first": 2e-7, "second": 1e-7}),
        ClosureRod("linkage", {"compliance": 3e-8}),
        WristSpring("joint_5_b", {"compliance": 3e-6}),
    )
    return World(arm, varied(arm, np.random.default_rng(3)), causes), rows_for(arm)


def test_sk120_stands_where_the_published_formula_says() -> None:
    arm = sk120()
    rows = rows_for(arm)
    mechanism = Mechanism(arm)
    q = rows.coordinates
    at = mechanism.stand(mechanism.commanded(q), np.zeros((8, rows.count)), q["joint_3_u"])
    two, three, five = q["joint_2_l"], q["joint_3_u"], q["joint_5_b"]
    straight = {**q, "joint_4_r": 0 * five, "joint_5_b": 0 * five}
    at = mechanism.stand(mechanism.commanded(straight), np.zeros((8, rows.count)), three)
    reach = 0.215 + 1.1 * np.sin(two) + 1.53 * np.cos(three) - 0.25 * np.sin(three)
    height = 1.1 * np.cos(two) + 1.53 * np.sin(three) + 0.25 * np.cos(three)
    assert np.allclose(np.hypot(*at.tool_position[:, :2].T), np.abs(reach), atol=1e-13)
    assert np.allclose(at.tool_position[:, 2], height, atol=1e-13)


def test_five_bar_closes_under_load() -> None:
    world, rows = sk120_world()
    _, _, rest = world.observe(rows)
    rear, pin = rest.standing.pins
    assert np.abs(rest.x[-1]).max() > 1e-6
    assert np.allclose(np.linalg.norm(rear - pin, axis=1), 1.1 + rest.x[-1], rtol=0, atol=1e-14)


def test_follower_moves_as_its_derivative_says() -> None:
    world, rows = sk120_world()
    inserts = [entry for cause in world.causes for entry in cause.inserts(world.arm)]
    mechanism = Mechanism(world.arm, inserts)
    commanded, crank = mechanism.commanded(rows.coordinates), rows.coordinates["joint_3_u"]
    x = 1e-3 * np.random.default_rng(0).normal(size=(len(mechanism.labels), rows.count))
    force = rows.force
    at = mechanism.stand(commanded, x, crank)
    f = mechanism.generalised(at, at.point(POINT), force, np.zeros_like(force))
    for k, label in enumerate(mechanism.labels):
        if label == "elbow":
            continue
        ends = []
        for step in (1e-5, -1e-5):
            moved = x.copy()
            moved[k] += step
            ends.append(mechanism.stand(commanded, moved, crank).point(POINT))
        slope = np.einsum("ni,ni->n", force, ends[0] - ends[1]) / 2e-5
        assert np.allclose(f[k], slope, rtol=1e-6, atol=1e-5), label


def test_work_of_the_load_is_stored_in_the_springs() -> None:
    world, rows = sk120_world()
    nodes, weights = np.polynomial.legendre.leggauss(10)
    _, _, rest = world.observe(rows)
    full = world.displacement(rows)
    along = sum(
        0.5 * w * np.einsum(
            "ni,ni->n", rows.force, world.displacement(replace(rows, force=rows.force * share))
        )
        for share, w in zip(0.5 * (nodes + 1.0), weights, strict=True)
    )  # fmt: skip
    work = np.einsum("ni,ni->n", rows.force, full) - along
    stored = 0.5 * np.einsum("kn,kn->n", rest.x, rest.f)
    assert np.allclose(work, stored, rtol=1e-9)


def test_first_order_misses_by_the_second_order_alone() -> None:
    world, rows = sk120_world()
    small = replace(rows, force=1e-2 * rows.force)
    full = np.abs(world.displacement(rows) - world.displacement(rows, iterations=1)).max()
    less = np.abs(world.displacement(small) - world.displacement(small, iterations=1)).max()
    assert full < 2e-5
    assert less == pytest.approx(1e-4 * full, rel=0.1)


def test_friction_lags_on_both_branches() -> None:
    arm = sk120()
    rows = rows_for(arm, schedule="up_down")
    plain = World(arm, varied(arm, np.random.default_rng(3)))
    cause = FrictionHysteresis("joint_1_s", {"half_width": 5e-5})
    change = plain.with_causes(cause).displacement(rows) - plain.displacement(rows)
    along = np.einsum("ni,ni->n", change, plain.displacement(rows)) * rows.branch
    assert np.all(along <= 1e-12)


def test_hardening_and_memory_vanish_without_size() -> None:
    arm = sk120()
    rows = rows_for(arm, schedule="up_down")
    plain = World(arm, varied(arm, np.random.default_rng(3)))
    for cause in (
        GearHardening("joint_2_l", {"first": 0.5}, {"T1": 100.0, "T2": 300.0}),
        Memory("joint_2_l", {"share": 0.2}, {"play": 80.0}),
    ):
        assert np.array_equal(
            plain.with_causes(cause.scaled(0.0)).displacement(rows), plain.displacement(rows)
        )
        assert np.abs(
            plain.with_causes(cause).displacement(rows) - plain.displacement(rows)
        ).max() > 1e-6  # fmt: skip


@pytest.mark.parametrize("shared", [True, False])
def test_noise_scatters_as_its_covariance_says(shared: bool) -> None:
    arm = sk120()
    rows = plan(arm, np.random.default_rng(1), poses=2, loads=3, shared_zero=shared)
    displacement = 1e-3 * np.random.default_rng(2).normal(size=(rows.count, 3))
    position = np.random.default_rng(3).normal(size=(2, 3))[rows.pose - 1]
    noise = Noise(1e-5, shared, growth=0.02, angular=3e-6, along=0.5)
    rng = np.random.default_rng(4)
    draws = []
    for _ in range(4000):
        error, zero = noise.sample(rows, displacement, position, rng)
        draws.append((error - zero).reshape(-1))
    seen = np.cov(np.array(draws).T)
    expected = noise.covariance(rows, displacement, position)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.abs((seen - expected) / scale).max() < 0.09  # 5 standard errors
    assert bool(expected[0, 3]) is shared


@pytest.mark.parametrize("schedule", ["repeated", "reloads"])
def test_a_repeat_has_the_load_of_the_first_time(schedule: str) -> None:
    rows = rows_for(sk120(), schedule=schedule, moments=True)
    again = np.flatnonzero(rows.repeat > 1)
    assert len(again)
    for row in again:
        alike = (rows.pose == rows.pose[row]) & (rows.force == rows.force[row]).all(axis=1)
        assert (rows.moment[alike] == rows.moment[row]).all() and alike.sum() > 1
    first = rows.moment[rows.repeat == 1]
    assert len(np.unique(first, axis=0)) == len(first)


def test_random_arms_differ_and_move() -> None:
    rng = np.random.default_rng(5)
    seen = set()
    for _ in range(8):
        arm, text = random_arm(rng)
        seen.add(len(arm.joints))
        d = World(arm, varied(arm, rng)).displacement(rows_for(arm))
        assert f'name="{arm.name}"' in text
        assert 1e-6 < np.abs(d).max() < 0.05
    assert seen == {6, 7}


STRENGTH = {"L1": (25.0, 81.0), "L2": (8.0, 25.1), "L3": (3.9, 8.1)}


@pytest.mark.parametrize("level", BUILDERS)
def test_case_keeps_its_level_and_its_seed(level: str) -> None:
    case = build(level, 11, 0)
    again = rebuild(level, case.truth()["seed"])
    assert json.dumps(case.truth()) == json.dumps(again.truth())
    if level in STRENGTH:
        (hidden,) = case.hidden
        low, high = STRENGTH[level]
        assert low < hidden.visibility < high
    if level in {"L0", "L8"}:
        assert not case.hidden
    if level == "L4":
        assert case.hidden[0].rivals[0].angle < 12.0
    if level == "L6":
        assert 2 <= len(case.hidden) <= 4
        assert all(entry.left >= 8.0 for entry in case.hidden)


def test_what_the_program_gets_does_not_hold_the_truth(tmp_path: Path) -> None:
    case = build("L1", 12, 0)
    write_case(case, "case_0000", tmp_path / "cases", tmp_path / "truth")
    seen = "".join(
        path.read_text(encoding="utf-8")
        for path in (tmp_path / "cases").rglob("*")
        if path.suffix in {".csv", ".yaml", ".json"}
    )
    assert case.hidden[0].cause.name not in seen
    assert "L1" not in seen
    lines = (tmp_path / "cases/case_0000/train.csv").read_text().splitlines()
    assert lines[0].startswith("pose,")
    assert len(lines) > case.train.count


def test_nothing_of_the_product_is_imported() -> None:
    for path in HERE.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            modules = []
            if isinstance(node, ast.Import):
                modules = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                modules = [node.module or ""]
            for module in modules:
                if module.split(".")[0] in {"sk120stiff", "pinocchio"}:
                    # the batch runner calls the command's entry point, nothing else
                    assert (path.name, module) == ("batch.py", "sk120stiff.cli.main")


def test_generator_runs_without_the_product() -> None:
    code = (
        "import sys; import tests.hidden.make_cases; "
        "from tests.hidden.generator.build import build; build('L1', 1, 0); "
        "bad = [m for m in sys.modules if m.split('.')[0] in ('sk120stiff', 'pinocchio')]; "
        "sys.exit(str(bad) if bad else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=HERE.parents[1], check=False)
    assert done.returncode == 0
