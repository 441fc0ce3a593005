"""Simulated readings: their noise against its law, their files against themselves."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from sk120stiff.effects import effect, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.measurements import (
    Instrument,
    NoiseModel,
    read_measurements,
    write_measurements,
)
from sk120stiff.plan import Schedule, as_positions, scheduled, simulate

STEPS = Schedule("ascending", 4)


def test_without_noise_it_is_the_prediction(springs, plan) -> None:
    made = simulate(springs, plan, schedule=STEPS)
    readings = scheduled(plan, STEPS)
    expected = springs.predict(load_cases_of(springs.robot, readings))
    np.testing.assert_array_equal(made.measurements.displacement, expected)
    assert made.measurements.noise.sigma is None


def test_an_instrument_errs_along_its_ray_and_across_it(springs, plan, tmp_path) -> None:
    tracker = Instrument((3.0, -2.0, 0.5), 5e-6, 20e-6, across_per_m=3e-6)
    many = Schedule("as-given", repeats=200, zero="separate")
    made = simulate(springs, plan, noise=tracker, schedule=many, seed=4)
    readings = made.measurements
    points = springs.robot.screws(readings.joints, point=readings.point).position
    rays, along, across = tracker.at(points)
    error = readings.displacement - made.exact  # of a loaded and of a zero reading
    onto = (error * rays).sum(axis=1)
    rest = error - onto[:, None] * rays
    count = len(onto)
    assert np.mean((onto / along) ** 2) / 2 == pytest.approx(1.0, abs=4 * np.sqrt(2 / count))
    size = np.mean((rest**2).sum(axis=1) / across**2) / 4
    assert size == pytest.approx(1.0, abs=4 * np.sqrt(1 / count))
    write_measurements(readings, tmp_path / "made.csv")
    back = read_measurements(tmp_path / "made.csv", springs.robot.actuated)
    assert back.noise.instrument == tracker
    assert back.sigma is None
    with pytest.raises(InputError, match="axes of the base"):
        simulate(springs, replace(plan, displacement_frame="tool"), noise=tracker)


def test_seeds_decide(springs, plan) -> None:
    noise = NoiseModel(1e-5)
    one, two, other = (simulate(springs, plan, noise=noise, seed=s) for s in (1, 1, 2))
    np.testing.assert_array_equal(one.measurements.displacement, two.measurements.displacement)
    assert np.all(one.measurements.displacement != other.measurements.displacement)


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_the_covariance_is_that_of_the_noise_model(springs, plan, zero: str) -> None:
    """400 draws: sample covariance of all rows of an axis, growing noise included."""
    noise = NoiseModel(1e-5, 0.02, zero)
    steps = Schedule("ascending", 3, 1, zero)
    draws = np.array(
        [
            (made := simulate(springs, plan, noise=noise, schedule=steps, seed=s)).measurements
            .displacement - made.exact
            for s in range(400)
        ]
    )  # fmt: skip
    made = simulate(springs, plan, noise=noise, schedule=steps)
    sizes = np.linalg.norm(made.exact, axis=1)
    expected = noise.covariance(made.measurements, sizes)
    for axis in range(3):
        sample = np.cov(draws[:, :, axis].T)
        scale = np.sqrt(np.outer(np.diag(expected[axis]), np.diag(expected[axis])))
        np.testing.assert_allclose(sample / scale, expected[axis] / scale, atol=0.25)
        np.testing.assert_allclose(np.diag(sample).mean(), np.diag(expected[axis]).mean(), rtol=0.1)


def test_rows_that_state_their_uncertainty_are_drawn_with_it(springs, plan) -> None:
    sigma = np.full((5, 3), 1e-7)
    sigma[:, 2] = 1e-4
    made = simulate(springs, replace(plan, sigma=sigma), noise=NoiseModel(1e-8), seed=3)
    error = np.abs(made.measurements.displacement - made.exact)
    assert error[:, :2].max() < 1e-6 < error[:, 2].max()


def test_outliers_are_as_many_and_as_large_as_said(springs, plan) -> None:
    many = Schedule("ascending", 40, 5)
    made = simulate(springs, plan, noise=NoiseModel(1e-5), schedule=many, outliers=0.05, seed=2)
    share = made.outliers.sum()
    assert stats.binomtest(int(share), 1000, 0.05).pvalue > 1e-3
    off = np.linalg.norm(made.measurements.displacement - made.exact, axis=1)
    assert off[made.outliers].min() > off[~made.outliers].mean()
    assert 5e-5 < np.median(off[made.outliers]) < 20e-5


def test_what_makes_no_sense_is_refused(springs, plan) -> None:
    with pytest.raises(InputError, match="outliers are measured in units of the noise"):
        simulate(springs, plan, outliers=0.1)
    with pytest.raises(InputError, match="no share"):
        simulate(springs, plan, noise=NoiseModel(1e-5), outliers=1.5)


@pytest.mark.parametrize("zero", ["shared", "separate"])
@pytest.mark.parametrize("kind", ["as-given", "up-down"])
def test_both_files_read_back_as_the_same_readings(
    springs, plan, tmp_path, kind: str, zero: str
) -> None:
    made = simulate(
        springs, plan, noise=NoiseModel(1e-5), schedule=Schedule(kind, 3, 2, zero), seed=1
    )
    write_measurements(made.measurements, tmp_path / "d.csv")
    write_measurements(as_positions(springs, made), tmp_path / "p.csv", as_positions=True)
    header = (tmp_path / "p.csv").read_text().splitlines()[0]
    assert "x[mm],y[mm],z[mm]" in header
    read = [
        read_measurements(tmp_path / name, springs.robot.actuated) for name in ("d.csv", "p.csv")
    ]
    for back in read:
        np.testing.assert_allclose(back.displacement, made.measurements.displacement, atol=2e-15)
        np.testing.assert_array_equal(back.order, made.measurements.order)
        np.testing.assert_array_equal(back.zero_order, made.measurements.zero_order)
        np.testing.assert_array_equal(back.zero_group, made.measurements.zero_group)
        assert back.branch == made.measurements.branch
        assert back.noise.sigma == pytest.approx(1e-5)


def test_positions_start_where_the_rigid_arm_is(springs, plan, robot) -> None:
    made = simulate(springs, plan)
    rows = as_positions(springs, made)
    zero = ~rows.wrench.any(axis=1)
    assert zero.sum() == 3
    expected = robot.placement(rows.joints[zero])
    at = expected[:, :3, :3] @ plan.point + expected[:, :3, 3]
    np.testing.assert_allclose(rows.displacement[zero], at, atol=1e-12)
    with pytest.raises(InputError, match="axes of the base frame"):
        as_positions(springs, simulate(springs, replace(plan, displacement_frame="tool")))


def test_effects_of_time_and_branch_are_simulated(springs, plan, robot) -> None:
    model = (
        springs + effect(robot, "reading_drift") + effect(robot, "friction_hysteresis", "joint_1_s")
    )
    truth = model.with_public(
        **{
            "reading_drift:tracker.rate_z": 1e-6,
            "friction_hysteresis:joint_1_s.half_width": 5e-5,
        }
    )
    steps = Schedule("up-down", 3)
    change = (
        simulate(truth, plan, schedule=steps).exact - simulate(springs, plan, schedule=steps).exact
    )
    readings = scheduled(plan, steps)
    since = readings.order - readings.zero_order
    up, down = change[0], change[4]  # equal loads on both branches
    assert up[2] - down[2] == pytest.approx(1e-6 * (since[0] - since[4]), abs=1e-6 * 8)
    assert np.linalg.norm(up[:2] - down[:2]) > 1e-5


def test_loaded_positions_know_nothing_of_the_zero_reading(springs, plan) -> None:
    """A tracker reads each position by itself: the errors of both have the same size."""
    noise, steps = NoiseModel(1e-5), Schedule("ascending", 10)
    exact = as_positions(springs, simulate(springs, plan, schedule=steps))
    zero = ~exact.wrench.any(axis=1)
    errors = np.array(
        [
            as_positions(springs, simulate(springs, plan, noise=noise, schedule=steps, seed=s))
            .displacement - exact.displacement
            for s in range(60)
        ]
    )  # fmt: skip
    assert errors[:, zero].std() == pytest.approx(1e-5, rel=0.1)
    assert errors[:, ~zero].std() == pytest.approx(1e-5, rel=0.1)
