"""An arm that weighs, by a URDF that states no masses: what one payload tells of its springs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.own_weight import own_weight
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.identify.written import with_values
from tests.positions.arm import Array, errors, poses, tracked, write
from tests.positions.shared import FIT

SIGMA = 2e-5  # m
COMPLIANCE = np.array([0.5e-6, 1 / 6e5, 1 / 5e5, 1 / 1.5e5, 1 / 1e5, 1 / 1e5])
SETTINGS = (
    "massless" + FIT + "noise: {sigma: 20, unit: um}\n"
    "payload: {point: {xyz: [0, 0, 0], unit: mm}}\n"
)


def fitted(folder: Path, payloads: list[float], seed: int) -> Calibration:
    a, rng = poses(60, seed + 10), np.random.default_rng(seed)
    arms = [replace(errors(seed), compliance=COMPLIANCE, payload=load) for load in payloads]
    x = np.concatenate([tracked(arm.stands(a)[0]) for arm in arms])
    cells = [str(load) for load in payloads for _ in a]
    path = write(
        folder, np.tile(a, (len(payloads), 1)), x + SIGMA * rng.normal(size=x.shape), SETTINGS,
        more=",payload[kg]", cells=cells,
    )  # fmt: skip
    robot = sk.load_robot(folder / "six.urdf", base="base", tool="tool")
    found = sk.fit(sk.joint_spring_model(robot), sk.read(path))
    assert isinstance(found, Calibration)
    return found


def springs(found: Calibration) -> tuple[Array, Array]:
    """Errors of the compliances of joints 2 to 5 in standard errors, and these as shares."""
    own = [p for p in found.parameters if p.effect.joint_spring]
    told = [p for p in own if p.effect.where in ("j2", "j3", "j4", "j5")]
    value, std = (
        np.array([getattr(p, name) for p in told]) for name in ("internal", "internal_std")
    )
    return (value - COMPLIANCE[1:5]) / std, std / value


@pytest.mark.parametrize("seed", range(2))
def test_springs_of_one_payload_hold_what_the_arm_itself_may_weigh(
    seed: int, tmp_path: Path
) -> None:
    found = fitted(tmp_path, [20.0], seed)
    off, share = springs(found)
    assert np.abs(off).max() < 2.0  # four to eleven by the noise alone
    assert share[:2].min() > 0.3
    (said,) = [note for note in found.notes if "no masses" in note]
    assert "two payloads" in said and "errors hold" in said


def test_two_payloads_tell_springs_without_it(tmp_path: Path) -> None:
    found = fitted(tmp_path, [0.0, 20.0], 0)
    assert np.abs(springs(found)[0]).max() < 3.0
    off, share = springs(with_values(replace(found, parts=None)))  # links that may bend apart
    assert np.abs(off).max() < 3.0 and share[:2].max() < 0.03
    (said,) = [note for note in found.notes if "no masses" in note]
    assert "two payloads" not in said


def test_its_columns_are_the_torques_of_moments_of_links(tmp_path: Path) -> None:
    """Any mass at any place of a link is some sum of them, by central differences of its energy."""
    found = fitted(tmp_path, [20.0], 0)
    problem = found.problem
    assert isinstance(problem, PoseProblem)
    columns = own_weight(problem)
    assert columns.shape == (len(problem.rows), 24)
    few = found.problem.measurements.select(np.arange(7))
    part = replace(problem, measurements=few)
    np.testing.assert_allclose(own_weight(part), columns[problem.rows < 7], rtol=1e-9, atol=1e-12)
    true = replace(errors(0), shift=np.zeros((6, 3)), turn=np.zeros((6, 3)))
    a = problem.load_cases.a
    torque = true.torque_of_weight(a)
    c = {p.effect.where: p.internal for p in found.parameters if p.effect.joint_spring}
    sag = torque * np.array([c.get(f"j{k + 1}", 0.0) for k in range(6)])
    moved = (problem.by_joints * sag[problem.rows]).sum(axis=1)
    left = moved - columns @ np.linalg.lstsq(columns, moved, rcond=1e-10)[0]
    assert np.linalg.norm(left) < 1e-3 * np.linalg.norm(moved)
