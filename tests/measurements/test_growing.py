"""Noise that grows with the displacement, found in what a model leaves over."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.measurements import ModelForm, NoiseModel, NoiseStatement, growing
from tests.explain.readings import hidden

START = NoiseModel(1e-5, freedom=0)
READINGS = hidden(poses=20, loads=5, stated=False)


def scattered(sigma: float, growth: float, seed: int = 3) -> np.ndarray:
    """What a true model would leave over (N, 3), the zero reading's error shared by a pose."""
    rng = np.random.default_rng(seed)
    size = np.linalg.norm(READINGS.displacement, axis=1)[:, None]
    zero = rng.normal(scale=sigma, size=(len(READINGS.poses), 3))[READINGS.pose_index]
    own = rng.normal(size=size.shape[:1] + (3,))
    return np.hypot(sigma, growth * size) * own - zero


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_noise_of_one_size_does_not_grow(seed: int) -> None:
    assert not growing(START, READINGS, scattered(8e-6, 0.0, seed))


def test_a_share_of_the_displacement_is_found() -> None:
    found = growing(START, READINGS, scattered(8e-6, 0.02))
    assert found.growth / found.sigma == pytest.approx(0.02 / 8e-6, rel=0.25)
    assert not found.known and found.zero == START.zero
    again = growing(found, READINGS, scattered(8e-6, 0.02))
    assert again.growth / again.sigma == pytest.approx(found.growth / found.sigma, rel=0.02)


def test_a_share_alone_is_found_too() -> None:
    found = growing(START, READINGS, scattered(1e-9, 0.02))
    assert 0.0 < found.growth < 1.0
    assert found.growth * np.median(np.linalg.norm(READINGS.displacement, axis=1)) > found.sigma


def test_what_was_stated_or_found_otherwise_stays() -> None:
    left = scattered(8e-6, 0.02)
    told = replace(READINGS, noise=NoiseStatement(growth=0.0))
    assert not growing(START, told, left)
    for noise in (
        replace(START, freedom=np.inf),
        replace(START, freedom=40.0),
        replace(START, form=ModelForm(0.1)),
    ):
        assert not growing(noise, READINGS, left)
