"""± of where a compensated tool stands, against tools that stand by drawn or changed parameters."""

import numpy as np
import pytest

from sk120stiff.effects import effect, load_case
from sk120stiff.model import Model, Uncertainty, joint_spring_model
from sk120stiff.model.sensitivities import standing_sensitivities
from sk120stiff.robot import load_robot
from sk120stiff.workspace import standing, standing_budgets, standing_uncertainty
from tests.oracles.sample_urdfs import six_axis_arm

LOAD = np.array([30.0, -20.0, -80.0, 0.0, 2.0, 1.0])
POSES = np.array([[0.3, 0.2, -0.4, 0.1, 0.5, 0.0], [-0.7, 0.5, -0.1, 1.0, -0.6, 0.3]])


@pytest.fixture(scope="module")
def model() -> Model:
    """An arm that sags under its own weight, with one joint that stands off its zero."""
    robot = load_robot(six_axis_arm(seed=3))
    springs = joint_spring_model(robot, np.linspace(3e4, 6e4, 6))
    offset = effect(robot, "joint_offset", robot.actuated[1])
    values = np.array([*springs.values, 1e-3])
    return (springs + offset).with_values(values)


def known(model: Model, **changes: object) -> Model:
    std = np.array([*(0.05 * model.values[:-1]), 1e-4])
    parts = {
        "names": model.names,
        "values": model.values,
        "covariance": np.diag(std**2),
        "unseen": np.zeros((0, len(std))),
        "noise": 10e-6,
    }
    return model.known(Uncertainty(**{**parts, **changes}))


def test_derivatives_are_those_of_where_the_tool_stands(model: Model) -> None:
    assert model.robot.total_mass > 0.0
    load = np.tile(LOAD, (2, 1))
    load_cases = load_case(model.robot, POSES, load)
    exact = standing_sensitivities(model.assembly, model.solve(load_cases), model.values)
    for k, parameter in enumerate(model.parameters):
        step = 1e-4 * max(abs(parameter.internal), 1e-6 * parameter.spec.typical)
        ends = []
        for side in (step, -step):
            values = model.values.copy()
            values[k] += side
            ends.append(standing(model.with_values(values), POSES, POSES, load).away)
        difference = (ends[0] - ends[1]) / (2.0 * step)
        np.testing.assert_allclose(
            exact[:, :, k], difference, rtol=1e-4, atol=1e-6 * np.abs(difference).max()
        )


def test_the_distance_is_that_of_drawn_arms(model: Model) -> None:
    told = known(model)
    found = standing_uncertainty(told, POSES, LOAD)
    rng = np.random.default_rng(5)
    drawn = rng.multivariate_normal(model.values, told.uncertainty.covariance, size=200)
    here = standing(model, POSES, POSES, LOAD).away
    away = [standing(model.with_values(one), POSES, POSES, LOAD).away - here for one in drawn]
    rms = np.sqrt(np.mean(np.sum(np.square(away), axis=2), axis=0))
    np.testing.assert_allclose(found.std_parameters, rms, rtol=0.15)
    assert found.std_remainder is None and found.blame == ()
    assert standing_uncertainty(model, POSES, LOAD) is None


def test_what_does_not_show_is_unknown_and_what_cannot_stand_has_none(model: Model) -> None:
    blind = np.zeros((1, 7))
    blind[0, 1] = 3.0 * model.values[1]
    found = standing_uncertainty(known(model, unseen=blind), POSES, LOAD)
    assert np.isinf(found.std_parameters).all()
    assert found.blame == (model.names[1],)
    budget, _ = standing_budgets(known(model, unseen=blind), POSES, LOAD)
    unknown = [share.name for share in budget if share.std is None]
    assert unknown == [model.parameters[1].effect.id]
    loads = np.stack([LOAD, 1e5 * LOAD])
    found = standing_uncertainty(known(model), POSES, loads)
    assert np.isfinite(found.std_parameters[0]) and np.isnan(found.std_parameters[1])
