"""Load steps, repeats, zero readings and their order."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.plan import Schedule, scheduled


def test_as_given_adds_one_zero_reading_a_pose(plan) -> None:
    out = scheduled(plan, Schedule())
    np.testing.assert_array_equal(out.wrench, plan.wrench)
    assert out.pose == plan.pose
    np.testing.assert_array_equal(out.order, [1, 2, 4, 6, 7])
    np.testing.assert_array_equal(out.zero_order, [0, 0, 3, 5, 5])
    np.testing.assert_array_equal(out.zero_group, [0, 0, 1, 2, 2])
    assert out.zero == "shared"
    assert out.branch is None
    assert out.repeat is None


def test_up_and_down_with_repeats(plan) -> None:
    out = scheduled(plan, Schedule("up-down", 3, 2))
    assert out.n_readings == 5 * 5 * 2
    first = slice(0, 10)
    shares = out.wrench[first, 0] / plan.wrench[0, 0]
    np.testing.assert_allclose(shares, np.repeat([1 / 3, 2 / 3, 1, 2 / 3, 1 / 3], 2), rtol=1e-12)
    assert out.branch[:10] == ("load",) * 6 + ("unload",) * 4
    np.testing.assert_array_equal(out.repeat[first], [1, 2] * 5)
    assert out.order[0] == 1.0
    assert np.all(np.diff(out.order) >= 1.0)


def test_separate_zeros_come_before_every_reading(plan) -> None:
    out = scheduled(plan, Schedule("ascending", 2, 1, "separate"))
    assert out.n_readings == 10
    np.testing.assert_array_equal(out.zero_group, np.arange(10))
    np.testing.assert_array_equal(out.order - out.zero_order, np.ones(10))
    assert len(set(out.order) | set(out.zero_order)) == 20


def test_rows_of_one_pose_are_read_together(plan) -> None:
    mixed = plan.select([0, 2, 1, 3, 4])
    assert scheduled(mixed, Schedule()).pose == ("p0", "p0", "p1", "p2", "p2")


def test_zero_rows_and_masked_rows_are_left_out(plan) -> None:
    wrench = plan.wrench.copy()
    wrench[2] = 0.0
    out = scheduled(
        replace(plan, wrench=wrench, use=np.array([True, False, True, True, True])), Schedule()
    )
    assert out.pose == ("p0", "p2", "p2")
    with pytest.raises(InputError, match="no row of the plan has a load"):
        scheduled(replace(plan, wrench=np.zeros((5, 6))), Schedule())


def test_words_and_counts_are_checked(plan) -> None:
    for bad in (
        {"kind": "sideways"},
        {"zero": "maybe"},
        {"levels": 0},
        {"repeats": 0},
    ):
        with pytest.raises(InputError):
            Schedule(**bad)
    branched = replace(plan, branch=("load",) * 5)
    with pytest.raises(InputError, match="branches of its own"):
        scheduled(branched, Schedule("up-down"))
    assert scheduled(branched, Schedule("ascending")).branch == ("load",) * 25
