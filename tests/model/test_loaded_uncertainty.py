"""± of principal stiffness and deflection against the same questions put to drawn parameters."""

from __future__ import annotations

import numpy as np
import pytest

from sk120stiff.model import (
    LoadedStiffness,
    Model,
    Uncertainty,
    joint_spring_model,
    loaded_stiffness,
    loaded_uncertainty,
)
from sk120stiff.robot import load_robot

POSE = np.array([0.3, 0.2, -0.4, 0.1, 0.5, 0.0])
LOAD = np.array([200.0, -100.0, -350.0, 0.0, 30.0, 0.0])


def known(model: Model, share: float, **changes: object) -> Model:
    std = share * model.values
    correlation = np.array([[1.0, 0.6, -0.3], [0.6, 1.0, 0.1], [-0.3, 0.1, 1.0]])
    parts = {
        "names": model.names,
        "values": model.values,
        "covariance": correlation * np.outer(std, std),
        "unseen": np.zeros((0, 3)),
        "noise": 10e-6,
    }
    return model.known(Uncertainty(**{**parts, **changes}))


@pytest.fixture(scope="module")
def model() -> Model:
    robot = load_robot("motoman_sk120")
    return joint_spring_model(robot, [1.4e6, 4e5, 9e5, np.inf, np.inf, np.inf])


@pytest.fixture(scope="module")
def drawn(model: Model) -> list[LoadedStiffness]:
    """The same questions for springs that are known to a tenth; two principal values are near."""
    told = known(model, 0.1)
    rng = np.random.default_rng(1)
    values = rng.multivariate_normal(told.values, told.uncertainty.covariance, size=300)
    return [loaded_stiffness(told.with_values(one), POSE, LOAD) for one in values]


def test_plus_minus_is_the_scatter_of_drawn_springs(
    model: Model, drawn: list[LoadedStiffness]
) -> None:
    told = known(model, 0.1)
    doubt = loaded_uncertainty(told, POSE, LOAD, loaded_stiffness(told, POSE, LOAD))
    stiffness = np.array([one.principal.values for one in drawn])
    np.testing.assert_allclose(doubt.principal, stiffness.std(axis=0), rtol=0.15)
    for k, (low, high) in enumerate(doubt.principal_interval):
        assert 0.92 < np.mean((stiffness[:, k] > low) & (stiffness[:, k] < high)) < 0.98
    bent = np.array([one.deflection_equilibrium for one in drawn])
    np.testing.assert_allclose(doubt.deflection.std_parameters[0], bent.std(axis=0), rtol=0.15)
    assert doubt.deflection.std_remainder is None and doubt.blame == ()


def test_an_interval_of_a_stiffness_is_lopsided_and_may_be_open(model: Model) -> None:
    for share, finite in ((0.2, True), (0.8, False)):
        told = known(model, share)
        found = loaded_stiffness(told, POSE, LOAD)
        low, high = loaded_uncertainty(told, POSE, LOAD, found).principal_interval[2]
        value = found.principal.values[2]
        assert 0.0 < low < value and high - value > value - low
        assert np.isfinite(high) == finite


def test_what_does_not_show_is_unknown(model: Model) -> None:
    told = known(model, 0.03, unseen=np.array([[0.0, 0.0, 5.0 * model.values[2]]]))
    doubt = loaded_uncertainty(told, POSE, LOAD, loaded_stiffness(told, POSE, LOAD))
    assert doubt.blame == ("joint_springs:joint_3_u.stiffness",)
    assert np.isinf(doubt.principal).any()
    lost = np.isinf(doubt.principal)
    assert np.isinf(doubt.principal_interval[lost]).all()


def test_a_model_without_uncertainty_has_no_plus_minus(model: Model) -> None:
    assert loaded_uncertainty(model, POSE, LOAD, loaded_stiffness(model, POSE, LOAD)) is None


def test_what_nothing_tells_of_one_direction_leaves_the_others_their_own(model: Model) -> None:
    """No load turned the first joint: it yields sideways, and along its axis nothing changes."""
    aside = np.array([0.0, 0.2, -0.4, 0.0, 0.5, 0.0])  # in the plane of the arm
    down = np.array([0.0, 0.0, -350.0, 0.0, 0.0, 0.0])
    found = loaded_stiffness(known(model, 0.1), aside, down)
    unseen = np.zeros((1, 3))
    unseen[0, 0] = 1e-4  # rad/(N·m): far softer than anything else
    doubts = [
        loaded_uncertainty(known(model, 0.1, **more), aside, down, found)
        for more in ({}, {"unseen": unseen})
    ]
    told, other = (doubt.principal for doubt in doubts if doubt is not None)
    lost = np.isinf(other)
    assert lost.any() and not lost.all()
    np.testing.assert_allclose(other[~lost], told[~lost], rtol=0.05)
