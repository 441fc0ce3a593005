"""Plans of positions, single readings and turns: each row with a reading, as the plan has it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.measurements import Measurements
from tests.measurements.files.test_write_positions import KINDS, written
from tests.positions.arm import Arm, poses, write
from tests.positions.loaded_arm import SPRINGS, moved, write_moved

LENGTH, ANGLE = 1e-5, 3e-5
POINT = "point: {xyz: [150, 0, 100], unit: mm}\n"
PLAIN = "noise: {sigma: 10, unit: um}\n"


def model_of(plan: Measurements) -> sk.Model:
    robot = sk.load_robot(plan.robot, base="base", tool="tool")
    return sk.base_model(robot).with_values(SPRINGS)


def blank(plan: Measurements) -> Measurements:
    said = plan.absolute
    assert said is not None
    nothing = said.channels.without(np.ones(plan.n_readings, dtype=bool))
    return replace(plan, absolute=replace(said, channels=nothing))


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_reading_is_made(kind: str, tmp_path: Path) -> None:
    """Without noise a model is right to rounding; with it as far off as was asked."""
    read = written(tmp_path, kind, "", "")
    model = model_of(read)
    plan = blank(read)
    exact = sk.simulate(model, plan).measurements
    assert exact.absolute is not None and read.absolute is not None
    channels = exact.absolute.channels
    assert channels.present and set(channels.present) >= set(read.absolute.channels.present)
    np.testing.assert_allclose(_gap(model, exact), 0.0, atol=1e-12)
    many = plan.select(np.tile(np.arange(plan.n_readings), 200))
    noisy = sk.simulate(
        model, many, noise=sk.NoiseModel(LENGTH), rotation_noise=ANGLE, seed=3
    ).measurements
    gap, sigma = _gap(model, noisy), _sigma(noisy)
    assert np.std(gap / sigma) == pytest.approx(1.0, abs=0.05)
    assert noisy.absolute is not None
    stated = noisy.absolute.channels.sigma
    assert (stated["rotation"], stated["position"]) == (ANGLE, LENGTH)
    again = sk.read(sk.write_measurements(exact, tmp_path / "again.csv"))
    assert again.absolute is not None and again.absolute.channels.present == channels.present


def _gap(model: sk.Model, readings: Measurements) -> np.ndarray:
    return _problem(model, readings).channel_gap(model.values)[0]


def _sigma(readings: Measurements) -> np.ndarray:
    assert readings.absolute is not None
    channels = readings.absolute.channels
    return np.concatenate([channels.scale(kind) for kind in channels.present])


def _problem(model: sk.Model, readings: Measurements):  # type: ignore[no-untyped-def]
    from sk120stiff.identify.positions.solve.pose_problem import PoseProblem

    noise = sk.NoiseModel(LENGTH, zero="separate")
    return PoseProblem(model, readings, noise, sigma=dict.fromkeys(("rotation",), ANGLE))


def test_turns_and_displacements_as_another_code_has_them(tmp_path: Path) -> None:
    a = poses(6, 1)
    force = 400.0 * np.random.default_rng(0).normal(size=(6, 3))
    empty = {name: np.full(6, np.nan) for name in
             ("dx[mm]", "dy[mm]", "dz[mm]", "drx[mrad]", "dry[mrad]", "drz[mrad]")}  # fmt: skip
    plan = sk.read(write_moved(tmp_path, a, force, empty, POINT))
    assert plan.is_plan
    made = sk.simulate(model_of(plan), plan).measurements.absolute
    d, turn = moved(Arm(compliance=SPRINGS, weighs=False), a, force, np.array([0.15, 0.0, 0.1]))
    assert made is not None
    np.testing.assert_allclose(made.channels.displacement, d, atol=2e-8)
    np.testing.assert_allclose(made.channels.turn, turn, atol=2e-8)
    own = sk.simulate(
        model_of(plan), plan, noise=sk.NoiseModel(LENGTH), schedule=sk.Schedule(zero="separate")
    ).measurements
    assert own.absolute is not None
    assert own.absolute.channels.sigma["displacement"] == pytest.approx(np.sqrt(2.0) * LENGTH)


def test_what_was_not_read_stays_blank(tmp_path: Path) -> None:
    x = Arm(compliance=SPRINGS).stands(poses(8, 2))[0]
    x[2, 1] = np.nan
    plan = sk.read(write(tmp_path, poses(8, 2), x, PLAIN))
    made = sk.simulate(model_of(plan), plan, noise=sk.NoiseModel(LENGTH)).measurements
    assert made.absolute is not None and made.absolute.channels.position is not None
    np.testing.assert_array_equal(np.isnan(made.absolute.channels.position), np.isnan(x))


def test_a_campaign_that_was_simulated_is_identified(tmp_path: Path) -> None:
    empty = np.full((60, 3), np.nan)
    plan = sk.read(write(tmp_path, poses(60, 3), empty, PLAIN))
    truth = model_of(plan)
    made = sk.simulate(truth, plan, noise=sk.NoiseModel(LENGTH), outliers=0.05, seed=2)
    assert 0 < made.outliers.sum() < 10 and "rows" not in repr(made)
    found = sk.fit(sk.base_model(truth.robot), made.measurements)
    assert isinstance(found, Calibration) and found.misfit[2] > 1e-3
    spring = found.model.parameter("joint_springs:j2.stiffness")
    assert abs(spring.internal - SPRINGS[1]) < 3.5 * spring.internal_std
    assert set(np.flatnonzero(found.wild)) <= set(np.flatnonzero(made.outliers))


def test_what_has_no_meaning_is_refused(tmp_path: Path) -> None:
    plan = sk.read(write(tmp_path, poses(4, 4), np.full((4, 3), np.nan), PLAIN))
    model = model_of(plan)
    with pytest.raises(InputError, match="read row by row"):
        sk.simulate(model, plan, schedule=sk.Schedule(repeats=2))
    with pytest.raises(InputError, match="read row by row"):
        sk.simulate(model, plan, noise=sk.NoiseModel(LENGTH, growth=0.1))
    unknown = "position: {frame: unknown}\n"
    away = sk.read(write(tmp_path, poses(4, 4), np.full((4, 3), np.nan), unknown))
    there = sk.simulate(model, away).measurements  # nobody has put the tracker anywhere yet
    here = sk.simulate(model, plan).measurements
    np.testing.assert_array_equal(there.absolute.channels.position, here.absolute.channels.position)
    assert "axes are those of the base" in there.notes[0] and not here.notes
    with pytest.raises(InputError, match="where the tracker stands"):
        sk.simulate(model, there)
    loads = sk.plan(sk.base_model(sk.load_robot("motoman_sk120")), 3)
    with pytest.raises(InputError, match="no angle is read"):
        sk.simulate(sk.base_model(sk.load_robot("motoman_sk120")), loads, rotation_noise=ANGLE)
