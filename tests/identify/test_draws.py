"""Offsets of poses are draws of one size: what poses have in common is another cause's."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.identify import Fit, fit, known_model, weak_directions
from sk120stiff.identify.solve.beforehand import CHANCE
from sk120stiff.identify.solve.prior import Prior
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.model import Model
from sk120stiff.robot import Robot
from tests.identify.conftest import readings_of

SIGMA, SIZE = 3e-6, 1e-5
BIAS = np.array([12.0, -7.0, 9.0])


@pytest.fixture(scope="module")
def readings(springs: Model, robot: Robot) -> Measurements:
    """A force sensor that is off, and a zero reading of every pose that is off."""
    model = springs + effect(robot, "force_bias", "sensor")
    axes = zip("xyz", BIAS, strict=True)
    biased = model.with_public(**{f"force_bias:sensor.offset_{a}": b for a, b in axes})
    found = readings_of(biased, poses=20, sigma=SIGMA)
    rng = np.random.default_rng(7)
    offset = {pose: rng.normal(0.0, SIZE, 3) for pose in found.poses}
    moved = found.displacement + np.array([offset[pose] for pose in found.pose])
    return replace(found, displacement=moved, noise=NoiseStatement(sigma=SIGMA))


@pytest.fixture(scope="module")
def found(readings: Measurements, springs: Model, robot: Robot) -> Fit:
    offsets = effect(robot, "zero_offset", "tracker", poses=readings.poses)
    return fit(springs + effect(robot, "force_bias", "sensor") + offsets, readings)


def bias_of(found: Fit) -> tuple[np.ndarray, np.ndarray]:
    own = [k for k, p in enumerate(found.parameters) if p.effect.name == "force_bias"]
    value = np.array([found.parameters[k].value for k in own])
    return value, np.array([found.parameters[k].std for k in own])


def test_a_bias_is_told_beside_offsets_of_poses(found: Fit) -> None:
    """Against a dense solution of a linear mixed model, the size of the offsets known."""
    value, std = bias_of(found)
    assert found.identifiable.all()
    assert (np.abs(value - BIAS) < 2.5 * std).all()
    scale = found.problem.scale
    drawn = np.array([p.effect.random_effects for p in found.parameters])
    prior = np.where(drawn, (scale / SIZE) ** 2, 0.0)
    dense = np.linalg.inv(found.jacobian.T @ found.jacobian + np.diag(prior))
    shift = dense @ (found.jacobian.T @ found.residual + prior * found.x)
    own = np.flatnonzero([p.effect.name == "force_bias" for p in found.parameters])
    np.testing.assert_allclose(std, np.sqrt(np.diag(dense))[own] * scale[own], rtol=0.25)
    assert (np.abs(shift[own] * scale[own]) < 0.3 * std).all()


def test_it_is_in_what_the_model_says_of_itself(found: Fit) -> None:
    known = known_model(found).uncertainty
    assert known is not None
    own = [k for k, name in enumerate(known.names) if name.startswith("force_bias")]
    np.testing.assert_allclose(np.sqrt(np.diag(known.covariance))[own], bias_of(found)[1], rtol=0.1)
    assert not known.unseen[:, own].any()


def test_draws_without_a_rival_are_as_they_were_read(
    readings: Measurements, springs: Model, robot: Robot
) -> None:
    offsets = effect(robot, "zero_offset", "tracker", poses=readings.poses)
    alone = fit(springs + offsets, readings)
    assert alone.beforehand.draws.ways.shape[1] == 0
    np.testing.assert_array_equal(alone.informed, alone.small[0])
    slope = alone.jacobian.T @ alone.residual  # least squares, nothing shrunk
    assert np.abs(slope).max() < 1e-6 * np.abs(alone.jacobian).sum(axis=0).max()


@pytest.mark.parametrize("seen", [0.0, 0.5, 30.0])
def test_what_poses_have_in_common_is_weighed(seen: float) -> None:
    """Two draws, a cause that moves both alike, and readings that tell it apart, so faintly."""
    jacobian = np.array([[1e3, 0.0, 1e3], [0.0, 1e3, 1e3], [0.0, 0.0, seen]])
    usual, span = np.array([2.0, 2.0, np.inf]), np.full(3, 10.0)
    known = Prior.of(jacobian, np.zeros(3, dtype=bool), span, usual, 1.0, CHANCE)
    told = np.vstack([jacobian, known.rows()])
    # the mean of two draws is known to 2/√2
    assert np.linalg.inv(told.T @ told)[2, 2] == pytest.approx(1 / (seen**2 + 0.5), rel=2e-3)
    if not seen:
        x = np.array([5.0, 3.0, 0.0])
        np.testing.assert_allclose(x + known.step(x), [1.0, -1.0, 4.0], atol=1e-6)


def test_it_is_said(found: Fit) -> None:
    (said,) = [each for each in weak_directions(found) if "taken for chance" in each]
    assert "could take over what force bias offset x (sensor)" in said
    size = float(said.partition("zero offset (")[2].partition(" µm rms)")[0])
    assert size == pytest.approx(1e6 * SIZE, rel=0.2)
