"""Critical forces against K_C by hand."""

import numpy as np
import pytest

from sk120stiff.paper.forces import critical, parts_at
from sk120stiff.paper.setting import even_directions
from tests.paper.closed_forms import K_C, SPRINGS, grid


def by_hand(angles, unit):
    """Force at which K_theta - F K_C(unit) becomes singular first, per pose."""
    root = 1 / np.sqrt(SPRINGS)
    largest = np.linalg.eigvalsh(root[:, None] * K_C(angles, unit) * root)[:, -1]
    return np.where(largest > 0, 1 / np.where(largest > 0, largest, 1), np.inf)


def test_the_smallest_is_that_of_a_column(found):
    forces = found.critical
    assert forces.smallest == pytest.approx(SPRINGS[1] / 1.1, rel=1e-9)
    assert forces.column == pytest.approx(SPRINGS[1] / 1.1, rel=1e-12)
    assert forces.everywhere == pytest.approx(forces.smallest, rel=1e-6)
    there = by_hand(forces.pose[None], forces.direction)
    assert there[0] == pytest.approx(forces.smallest, rel=1e-9)
    # it presses the elbow towards the shoulder
    lean = forces.pose[1]
    assert np.allclose(forces.direction, [-np.sin(lean), 0, -np.cos(lean)], atol=1e-5)


def test_no_direction_is_worse(found):
    poses = grid()[::37]
    for unit in even_directions(300):
        assert by_hand(poses, unit).min() > found.critical.smallest * (1 - 1e-9)


def test_it_is_not_ten_kilonewtons(found):
    assert found.critical.smallest > 30 * 10e3
    assert found.critical.share == pytest.approx(10e3 / found.critical.smallest)
    assert 0.02 < found.critical.share < 0.03


def test_quantiles_by_hand(found):
    poses = grid().reshape(32, 13 * 14, 3)[0] * [0, 1, 1]
    forces = np.array([by_hand(poses, unit) for unit in even_directions(200)])
    assert found.critical.without == pytest.approx(np.mean(np.isinf(forces)))
    for q, value in found.critical.quantiles.items():
        assert value == pytest.approx(np.quantile(forces, q, method="inverted_cdf"), rel=1e-9)
    assert sorted(found.critical.quantiles.values()) == list(found.critical.quantiles.values())


def test_more_directions_change_nothing_below(found):
    finer = critical(found.setting, directions=600)
    assert finer.smallest == pytest.approx(found.critical.smallest, rel=1e-6)
    assert finer.quantiles[0.5] == pytest.approx(found.critical.quantiles[0.5], rel=0.02)


def test_parts_of_the_diagonal_by_hand(found):
    poses = grid()[::101]
    parts = parts_at(found.setting, poses)  # (P, element, component)
    for axis in range(3):
        expected = np.diagonal(K_C(poses, np.eye(3)[axis]), axis1=1, axis2=2)
        assert np.allclose(parts[:, :, axis], expected, rtol=0, atol=1e-12)


def test_figures_7_to_9_are_slices_of_the_parts(found):
    assert [s.figure for s in found.parts.surfaces] == ["7", "8", "9"]
    for number, surface in enumerate(found.parts.surfaces):
        assert surface.element == f"C{number + 1}{number + 1}"
        for ix, iy in ((0, 0), (7, 40), (60, 13)):
            pose = np.empty(3)
            pose[surface.joints[0] - 1] = surface.x[ix]
            pose[surface.joints[1] - 1] = surface.y[iy]
            pose[surface.held[0] - 1] = surface.held[1]
            for axis in range(3):
                expected = K_C(pose[None], np.eye(3)[axis])[0, number, number]
                assert surface.parts[axis, iy, ix] == pytest.approx(expected, abs=1e-12)
    inside = found.parts.surfaces[0].parts
    assert (inside[2] == 0).all()  # a vertical force has no arm about a vertical axis
