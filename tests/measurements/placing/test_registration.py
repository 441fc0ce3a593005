"""A tracker's frame from positions: recovered exactly, and as surely as drawn noise says."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.measurements.placing.laying import kabsch
from sk120stiff.measurements.placing.registration import register

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
    assert np.allclose(found.turns, TURN, rtol=0, atol=1e-9)
    assert np.allclose(found.shifts, SHIFT, rtol=0, atol=1e-9)
    assert np.allclose(found.marker, MARKER, rtol=0, atol=1e-9)
    here = np.zeros(len(seen), dtype=int)
    assert np.allclose(found.in_base(seen, here), flange + rotation @ MARKER, rtol=0, atol=1e-9)


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
        turns.append(Rotation.from_matrix(found.turns[0] @ TURN.T).as_rotvec())
        shifts.append(found.shifts[0] - SHIFT)
        rms.append(found.rms)
    assert np.sqrt(np.mean(np.square(rms))) == pytest.approx(np.sqrt(3.0) * sigma, rel=0.05)
    drawn = np.concatenate([np.std(turns, axis=0), np.std(shifts, axis=0)])
    assert found.std[0] * np.sqrt(3.0) * sigma / found.rms == pytest.approx(drawn, rel=0.15)


ELSEWHERE = Rotation.from_rotvec([-0.2, 0.7, -2.2]).as_matrix()
AWAY = np.array([-4.0, 0.5, 1.1])


def from_two(count: int, seed: int = 1) -> tuple[np.ndarray, ...]:
    """The same arm seen from two stations in turn, and which of both."""
    flange, rotation, seen = arm(count, seed)
    station = np.arange(count) % 2
    there = (flange + rotation @ MARKER) @ ELSEWHERE.T + AWAY
    return flange, rotation, np.where(station[:, None] == 0, seen, there), station


def test_two_stations_share_the_marker_and_each_has_its_frame():
    flange, rotation, seen, station = from_two(16)
    found = register(seen, flange, rotation, np.zeros(3), station=station)
    assert np.allclose(found.turns, [TURN, ELSEWHERE], rtol=0, atol=1e-9)
    assert np.allclose(found.shifts, [SHIFT, AWAY], rtol=0, atol=1e-9)
    assert np.allclose(found.marker, MARKER, rtol=0, atol=1e-9)
    at = flange + rotation @ MARKER
    assert np.allclose(found.in_base(seen, station), at, rtol=0, atol=1e-9)
    assert np.allclose(found.seen(at, station), seen, rtol=0, atol=1e-9)


def test_standard_errors_of_two_stations_are_those_of_drawn_noise():
    flange, rotation, seen, station = from_two(14)
    rng, sigma, drawn, rms = np.random.default_rng(6), 1e-4, [], []
    for _ in range(300):
        noise = sigma * rng.normal(size=seen.shape)
        found = register(seen + noise, flange, rotation, np.zeros(3), station=station)
        turns = Rotation.from_matrix(found.turns @ np.swapaxes([TURN, ELSEWHERE], 1, 2))
        drawn.append(np.concatenate([turns.as_rotvec(), found.shifts - [SHIFT, AWAY]], axis=1))
        rms.append(found.rms)
    assert np.sqrt(np.mean(np.square(rms))) == pytest.approx(np.sqrt(3.0) * sigma, rel=0.05)
    assert found.std * np.sqrt(3.0) * sigma / found.rms == pytest.approx(
        np.std(drawn, axis=0), rel=0.15
    )


def test_two_positions_of_a_station_tell_no_frame():
    flange, rotation, seen, _ = from_two(8)
    station = np.array([0, 0, 0, 0, 0, 0, 1, 1])
    assert register(seen, flange, rotation, np.zeros(3), station=station) is None
