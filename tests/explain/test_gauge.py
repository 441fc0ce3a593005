"""A dial gauge reads one axis, and a tracker loses some: causes are named all the same."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import all_effects
from sk120stiff.explain import localise
from sk120stiff.explain.candidates.regression import regression_at
from sk120stiff.explain.judge.adequacy import unlike_scatter
from sk120stiff.explain.localise.places import line_up, look_at
from sk120stiff.explain.select.outliers import outlying_rows
from sk120stiff.identify import Fit, yardstick
from sk120stiff.measurements import Measurements
from tests.explain.readings import base_fit, hidden
from tests.hidden.generator.causes_elastic import JointTilt

TILT = JointTilt("joint_2_l", {"first": 5e-7, "second": 5e-7})
RNG = np.random.default_rng(2)


def along_z(readings: Measurements) -> Measurements:
    """What a gauge along z reads."""
    only = np.where([False, False, True], readings.displacement, np.nan)
    return replace(readings, displacement=only)


def some_lost(readings: Measurements) -> Measurements:
    """A third of the cells lost, none of a row whole."""
    read = RNG.random(readings.displacement.shape) > 1 / 3
    read[np.arange(len(read)), RNG.integers(0, 3, len(read))] = True
    return replace(readings, displacement=np.where(read, readings.displacement, np.nan))


@pytest.fixture(scope="module", params=[along_z, some_lost])
def fitted(request: pytest.FixtureRequest) -> Fit:
    return base_fit(request.param(hidden(TILT, poses=20, loads=3, schedule="ascending")))


def test_sizes_are_of_the_numbers_that_were_read(fitted) -> None:
    problem = fitted.problem
    found = localise(fitted)
    square = np.nansum(fitted.gap**2, axis=1)
    count = problem.read.sum(axis=1)
    for k, pose in enumerate(problem.load_cases.poses):
        rows = problem.load_cases.pose == k
        share = next(p for p in found.poses if p.label == pose)
        assert share.rms == pytest.approx(np.sqrt(square[rows].sum() / count[rows].sum()))
        assert share.noise == pytest.approx(8e-6 * np.sqrt(2.0))
    assert found.noise == pytest.approx(8e-6 * np.sqrt(2.0))
    assert sum(level.count for level in found.levels) == problem.measurements.n_readings
    whole = (square.sum() - 2.0 * (8e-6) ** 2 * count.sum()) or 1.0
    world = {d.word: d.share for d in found.directions if d.axes == "world"}
    per_axis = np.nansum(fitted.gap**2, axis=0) - 2.0 * (8e-6) ** 2 * problem.read.sum(axis=0)
    assert list(world.values()) == pytest.approx(list(per_axis / whole))
    assert sum(world.values()) == pytest.approx(1.0)


def test_what_no_read_axis_shows_is_no_suspect(fitted) -> None:
    look = look_at(fitted, yardstick(fitted))
    lineup = line_up(look)
    assert lineup.white.shape[0] == fitted.problem.read.sum() == len(look.white)
    columns = np.concatenate(lineup.reading, axis=2)
    read = np.linalg.norm(np.where(fitted.problem.read[:, :, None], columns, 0.0), axis=(0, 1))
    seen = read > 1e-9 * np.linalg.norm(columns, axis=(0, 1))
    np.testing.assert_array_equal((lineup.white != 0.0).any(axis=0), seen)
    picture = localise(fitted).suspects[0]
    assert np.isfinite(picture.partial).all()


def test_the_tilt_is_what_the_gap_goes_with(fitted) -> None:
    found = localise(fitted)
    assert found.real
    near = [s for s in found.suspects if s.explained > 0.9 * found.suspects[0].explained]
    assert any("joint_2_l" in s.name for s in near)


def test_a_slip_of_a_single_axis_stands_out(fitted) -> None:
    problem = fitted.problem
    d = problem.measured.copy()
    row, axis = (int(k[30]) for k in np.nonzero(problem.read))
    clean = _outliers(fitted)
    d[row, axis] += 4e-4
    assert len(clean) == 0
    assert _outliers(base_fit(replace(problem.measurements, displacement=d))).tolist() == [row]


def _outliers(fit: Fit) -> np.ndarray:
    names = [each.id for each in fit.model.effects]
    effects = [
        each
        for each in all_effects(fit.model.robot, poses=fit.problem.load_cases.poses, timed=True)
        if each.id not in names and not each.only_absolute
    ]
    regression = regression_at(fit, effects, names, alpha=0.05)
    assert regression.rows == fit.problem.read.sum() == len(regression.group)
    return outlying_rows(regression, fit.problem.whitener)


def test_poses_that_scatter_alike_are_told_alike() -> None:
    found = base_fit(some_lost(hidden(poses=12, loads=8, schedule="ascending")))
    ((chance, _),) = unlike_scatter(found).values()
    assert chance > 0.01
