"""What a file may hold beside positions, each put to use: jitter, warmth, order, tilt."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain.options import Options
from sk120stiff.explain.positions.select.candidates import candidates_at
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.solve.start import options_of
from tests.positions.arm import ORIGINS, Arm, Array, errors, poses, tracked, write
from tests.positions.test_forms import FIT, NOISE, SIGMA

A = poses(60, 2)
SPRINGS = errors(1).compliance


def fitted(path: Path, *effects: str) -> Calibration:
    """Springs and the effects, everything else as drawn."""
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    readings, model = data.with_joints(robot.actuated), sk.base_model(robot)
    for name, _, where in (text.partition(":") for text in effects):
        model = model + sk.CATALOGUE.effect(robot, name, where, options_of(readings))
    return calibrate(model, readings, geometry=False, waves=False)


def noisy(x: Array) -> Array:
    return tracked(x) + SIGMA * np.random.default_rng(7).normal(size=x.shape)


def test_encoder_values_of_one_pose_that_differ_go_through_the_kinematics(tmp_path: Path) -> None:
    """Half a milliradian at two metres is fifty times the noise; folds keep poses together."""
    a = np.repeat(A[:40], 2, axis=0)
    a[1::2] += np.random.default_rng(1).uniform(-9e-4, 9e-4, (40, 6))
    labels = [f"P{k // 2}" for k in range(80)]
    x = noisy(Arm(compliance=SPRINGS).stands(a)[0])
    found = fitted(write(tmp_path, a, x, FIT + NOISE, more=",pose", cells=labels))
    assert found.misfit[2] > 1e-3
    assert len(found.problem.measurements.poses) == 40
    a[1::2, 1] += 2e-3
    with pytest.raises(InputError, match="the pose 'P0' has"):
        sk.read(write(tmp_path, a, x, FIT + NOISE, more=",pose", cells=labels))


@pytest.mark.parametrize("clock", ["temperature[degC]", "time[min]"])
def test_a_link_that_grows_while_it_warms(clock: str, tmp_path: Path) -> None:
    warm = 8.0 * (1.0 - np.exp(-np.arange(60) / 20.0))
    rate = 1.1e-5 * 0.9  # of 0.9 m, per kelvin
    shift = rate * warm[:, None] * ORIGINS[2] / 0.9
    x = np.array([
        Arm(compliance=SPRINGS, shift=np.outer(np.arange(6) == 2, s)).stands(a[None])[0][0]
        for a, s in zip(A, shift, strict=True)
    ])  # fmt: skip
    cells = [f"{20.0 + t:.6f}" for t in warm]
    path = write(tmp_path, A, noisy(x), FIT + NOISE, more=f",{clock}", cells=cells)
    found = fitted(path, "thermal_growth:l2")
    (growth,) = [p for p in found.parameters if p.effect.name == "thermal_growth"]
    per = 1.0 if "temp" in clock else 1.0 / 60.0  # a minute of this clock is a kelvin
    assert abs(growth.internal - rate * per) < 4.0 * growth.internal_std < 0.7 * rate * per
    assert found.misfit[2] > 1e-3


def test_sides_of_approach_follow_from_the_order_of_the_rows(tmp_path: Path) -> None:
    half = 1e-4
    sides = np.sign(np.diff(A[:, 1], prepend=A[0, 1]))
    moved = A + half * sides[:, None] * (np.arange(6) == 1)
    x = noisy(Arm(compliance=SPRINGS).stands(moved)[0])
    order = [str(k) for k in range(60)]
    found = fitted(
        write(tmp_path, A, x, FIT + NOISE, more=",order", cells=order), "approach_side:j2"
    )
    p = found.model.parameter("approach_side:j2.half_width")
    assert abs(p.internal - half) < 4.0 * p.internal_std < 0.2 * half
    data = sk.read(write(tmp_path, A, x, FIT + NOISE))  # no order: the cause cannot be seen
    robot = found.model.robot
    readings = data.with_joints(robot.actuated)
    load_cases = sk.effects.load_cases_of(robot, readings)
    shown = candidates_at(robot, load_cases, readings, (), Options(), sk.CATALOGUE)
    assert not any(effect.name in ("approach_side", "thermal_growth") for effect in shown)


def test_gravity_stands_in_base_axes(tmp_path: Path) -> None:
    """An arm on a wall: sag goes sideways, and read as if it stood it does not fit."""
    q = A.copy()
    for _ in range(3):
        q = A + SPRINGS * -_torque_of_a_push(q)
    x = noisy(Arm().pose(q)[0])
    good = fitted(write(tmp_path, A, x, FIT + NOISE + "gravity: [9.80665, 0, 0]\n"))
    assert good.misfit[2] > 1e-3
    spring = good.model.parameter("joint_springs:j2.stiffness")
    assert abs(spring.internal - SPRINGS[1]) < 4.0 * spring.internal_std
    assert fitted(write(tmp_path, A, x, FIT + NOISE)).misfit[2] < 1e-6


def _torque_of_a_push(q: Array) -> Array:
    """(N, 6) slope of the energy of all masses along minus x."""
    from scipy.spatial.transform import Rotation

    from tests.positions.arm import AXES, CENTRES, MASSES, G

    def energy(q: Array) -> Array:
        R, p, out = Rotation.identity(len(q)), np.zeros((len(q), 3)), np.zeros(len(q))
        for k in range(6):
            p = p + R.apply(ORIGINS[k])
            R = R * Rotation.from_rotvec(AXES[k] * q[:, k, None])
            out -= MASSES[k] * G * (p + R.apply(CENTRES[k]))[:, 0]
        return out

    step = 1e-5 * np.eye(6)
    return np.stack([(energy(q + s) - energy(q - s)) / 2e-5 for s in step], axis=1)
