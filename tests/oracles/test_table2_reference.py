"""The printed calculated column comes out of the geometry, the springs and the sign rules."""

import itertools

import numpy as np
import pytest

from tests.oracles import table2_reference
from tests.oracles.table2_reference import SIGNS, jacobian, reach, residuals_um, rms


def test_calculated_column_reproduces():
    gaps = residuals_um()
    assert rms(gaps["1"]) == pytest.approx(0.18, abs=0.005)
    assert rms(gaps["2"]) == pytest.approx(0.24, abs=0.005)
    assert rms(gaps["3"]) == pytest.approx(0.06, abs=0.005)


def test_printed_signs_do_not_reproduce():
    gaps = residuals_um(convert_signs=False)
    assert [round(rms(gaps[pose])) for pose in "123"] == [114, 217, 47]


def test_only_one_choice_of_signs_reproduces_up_to_a_common_one(monkeypatch):
    good: dict[str, list[tuple[int, ...]]] = {"1": [], "2": [], "3": []}
    for signs in itertools.product([1, -1], repeat=6):
        pair = (np.array(signs[:3]), np.array(signs[3:]))
        monkeypatch.setattr(table2_reference, "SIGNS", dict.fromkeys("123", pair))
        for pose, gap in residuals_um().items():
            if rms(gap) < 45:
                good[pose].append(signs)
    for pose, found in good.items():
        ours = tuple(int(x) for x in np.concatenate(SIGNS[pose]))
        assert sorted(found) == sorted([ours, tuple(-x for x in ours)])


def test_gap_of_the_measured_column():
    gaps = residuals_um(measured=True)
    assert [round(rms(gaps[pose]), 1) for pose in "123"] == [29.2, 22.8, 26.8]


def test_jacobian_is_the_derivative_of_the_reach():
    def position(q):
        r, z = reach(q[1], q[2])
        return np.array([r * np.cos(q[0]), r * np.sin(q[0]), z])

    angles = np.array([0.3, -0.4, 0.2])
    numeric = np.array(
        [(position(angles + e) - position(angles - e)) / 2e-6 for e in 1e-6 * np.eye(3)]
    ).T
    assert np.allclose(jacobian(angles), numeric, atol=1e-5)
