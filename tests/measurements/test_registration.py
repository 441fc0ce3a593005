"""A tracker's frame from positions: recovered exactly, and as surely as drawn noise says."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.measurements.registration import kabsch, register

TURN = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()
SHIFT = np.array([5.0, -3.0, 1.2])
MARKER = np.array([0.05, -0.02, 0.11])


def arm(count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Flange positions and orientations, and where a tracker sees the marker."""
    rng = np.random.default_rng(seed)
    flange = rng.uniform(-1.5, 1.5, (count, 3))
    rotation = Rotation.random(count, random_state=seed).as_matrix()
    return flange, rotation, (flange + rotation @ MARKER) @ TURN.T + SHIFT


def test_frame_and_marker_are_recovered():
    flange, rotation, seen = arm(12)
    found = register(seen, flange, rotation, np.zeros(3))
    assert np.allclose(found.turn, TURN, rtol=0, atol=1e-9)
    assert np.allclose(found.shift, SHIFT, rtol=0, atol=1e-9)
    assert np.allclose(found.marker, MARKER, rtol=0, atol=1e-9)
    assert np.allclose(found.in_base(seen), flange + rotation @ MARKER, rtol=0, atol=1e-9)


def test_points_in_one_plane_are_not_mirrored():
    """A mirror fits them as well as a turn does, and noise decides which of both fits better."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        flat = rng.normal(size=(6, 3)) * [1.0, 1.0, 1e-7]
        turn, shift = kabsch(flat, flat @ TURN.T + SHIFT + 1e-6 * rng.normal(size=flat.shape))
        assert np.linalg.det(turn) == pytest.approx(1.0)
        assert np.allclose(turn, TURN, atol=1e-4) and np.allclose(shift, SHIFT, atol=1e-4)


@pytest.mark.parametrize("fit_marker", [True, False])
def test_rms_and_standard_errors_are_those_of_drawn_noise(fit_marker):
    flange, rotation, seen = arm(8)
    rng, sigma = np.random.default_rng(5), 1e-4
    point = np.zeros(3) if fit_marker else MARKER
    turns, shifts, rms = [], [], []
    for _ in range(300):
        noise = sigma * rng.normal(size=seen.shape)
        found = register(seen + noise, flange, rotation, point, fit_marker=fit_marker)
        turns.append(Rotation.from_matrix(found.turn @ TURN.T).as_rotvec())
        shifts.append(found.shift - SHIFT)
        rms.append(found.rms)
    assert np.sqrt(np.mean(np.square(rms))) == pytest.approx(np.sqrt(3.0) * sigma, rel=0.05)
    drawn = np.concatenate([np.std(turns, axis=0), np.std(shifts, axis=0)])
    assert found.std * np.sqrt(3.0) * sigma / found.rms == pytest.approx(drawn, rel=0.15)
