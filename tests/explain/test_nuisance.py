"""A suspect as parameters of a model: its columns, at all readings and at some of them."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.explain.judge.nuisance import nuisance
from sk120stiff.explain.judge.steps import foretold_beside, foretold_on_file
from sk120stiff.explain.select.stepwise import select
from sk120stiff.identify import fit, held_out, refitted
from tests.explain.readings import NOISE, SIGMA, base_fit, hidden
from tests.hidden.generator.causes_joint import PeriodicGear

TEETH = PeriodicGear("joint_2_l", {"share": 0.2}, {"count": 1, "phase": 1.0})
ANGLE = "the position of joint_2_l, on which a drive's stiffness may depend"


def test_free_factors_are_the_columns_of_the_suspect():
    """Whatever a suspect can do to the readings, its parameters do, and nothing else."""
    base = base_fit(hidden(TEETH, poses=8, loads=4))
    load_cases = base.problem.load_cases
    free = nuisance("the load in axes of the base", base)
    force = load_cases.wrench[:, :3]
    columns = np.einsum("ij,nk->nijk", np.eye(3), force).reshape(-1, 9)
    made = free.offsets(load_cases).reshape(len(columns), -1)
    assert np.allclose(np.sqrt((made**2).mean(axis=0)), 1.0)
    assert np.allclose(made.T @ made / len(made), np.eye(9), atol=1e-9)
    left = columns - made @ (made.T @ columns) / len(made)
    assert np.abs(left).max() < 1e-9 * np.abs(columns).max()


def test_two_suspects_are_two_effects():
    """What is remembered of a model by its effects is never another suspect's."""
    base = base_fit(hidden(TEETH, poses=8, loads=4))
    gear = "the position of joint_2_l, on which a drive's stiffness may depend"
    loads = "the load in axes of the base"
    first, second, third = nuisance(gear, base), nuisance(loads, base), nuisance(gear, base)
    assert len({first, second, third}) == 3 and first == first and first != third
    values = np.append(base.model.values, 1e-5)
    cases = base.problem.load_cases
    moved = [
        (base.model + each).predict(cases, np.append(values, np.zeros(each.factors.shape[1] - 1)))
        for each in (first, second)
    ]
    assert np.abs(moved[0] - moved[1]).max() > 1e-6


def test_what_other_readings_do_not_tell_moves_nothing_there():
    """One stays with the readings it was found in: an order, branches, a joint that moved."""
    readings = hidden(TEETH, poses=8, loads=4)
    free = nuisance("the order of the readings", base_fit(readings))
    robot = base_fit(readings).model.robot
    unordered = load_cases_of(robot, replace(readings, order=None, zero_order=None))
    assert not free.offsets(unordered).any()
    with pytest.raises(InputError, match="do not tell of the moon"):
        nuisance("the moon", base_fit(readings))


def test_a_suspect_takes_from_a_fit_what_it_stands_for():
    """A gear that is softer at some angles: the fit beside the suspect holds to the noise."""
    readings = hidden(TEETH)
    base = base_fit(readings)
    beside = fit(base.model + nuisance(ANGLE, base), readings, noise=NOISE)
    assert base.exceeds and not beside.exceeds
    cases = load_cases_of(base.model.robot, readings)
    assert beside.model.predict(cases).shape == readings.displacement.shape


@pytest.mark.parametrize(
    "name",
    [
        "the torque of joint_2_l, not in proportion to it",
        "the position of joint_2_l, on which its own stiffness depends in 7 waves a turn",
    ],
)
def test_some_of_the_readings_have_the_columns_that_they_have_among_all(name: str):
    """Seven waves cannot be told at two poses, and there no torque is the largest of all."""
    readings = hidden(TEETH, poses=12, loads=3)
    base = base_fit(readings)
    free = nuisance(name, base)
    rows = readings.pose_index < 2
    some = free.offsets(load_cases_of(base.model.robot, readings.select(rows)))
    assert some.any()
    assert np.array_equal(some, free.offsets(base.problem.load_cases)[rows])


def test_a_cause_without_a_name_is_shown_on_poses_left_out():
    readings = hidden(TEETH)
    base = base_fit(readings)
    (plain,) = held_out(readings, refitted(base.model, noise=NOISE))
    alone = select(base.model, readings, NOISE, (), max_effects=0, alpha=0.01)
    others = hidden(TEETH, poses=9, seed=8)
    missed = fit(base.model, readings, noise=NOISE).model.predict(
        load_cases_of(base.model.robot, others)
    )
    apart = float(np.sqrt(np.mean((others.displacement - missed) ** 2)))
    for name, helps in ((ANGLE, True), ("a constant that no load changes", False)):
        model = base.model + nuisance(name, base)
        beside = select(model, readings, NOISE, (), max_effects=0, alpha=0.01)
        said = foretold_beside(beside, 0, plain.rms, seed=0)
        on_file = foretold_on_file(alone, beside, name, (), others, apart)
        assert (on_file is not None) == helps  # a constant of other readings is another
        if on_file is not None:
            assert on_file.gap == pytest.approx(np.sqrt(2.0) * SIGMA, rel=0.15)
            assert on_file.gap < apart and on_file.better
        assert said is not None and said.without == plain.rms
        expected = np.sqrt(2.0) * SIGMA if helps else plain.rms  # noise of a reading and its zero
        assert said.gap == pytest.approx(expected, rel=0.1)
        assert said.better is helps
