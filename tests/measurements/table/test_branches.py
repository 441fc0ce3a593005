"""Loading and unloading from the order of the rows."""

import numpy as np
import pytest

from sk120stiff.measurements.table.branches import branches_by_order

UP_DOWN = np.array([100.0, 200.0, 300.0, 200.0, 100.0])
WORDS = ["load", "load", "load", "unload", "unload"]


def loads(*forces: np.ndarray) -> np.ndarray:
    rows = np.vstack(forces)
    return np.hstack([rows, np.zeros_like(rows)])


def along(direction: list[float], sizes: np.ndarray = UP_DOWN) -> np.ndarray:
    return sizes[:, None] * np.asarray(direction)


@pytest.mark.parametrize("second", [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.98, 0.199, 0.0]])
def test_a_pose_loaded_in_one_direction_after_another_tells_both(second: list[float]) -> None:
    wrench = loads(along([1.0, 0.0, 0.0]), along(second))
    found = branches_by_order(np.zeros(10, dtype=int), wrench, np.arange(10.0))
    assert found is not None
    assert list(found[0]) == WORDS + WORDS


def test_a_direction_without_a_way_down_tells_nothing() -> None:
    wrench = loads(along([1.0, 0.0, 0.0]), along([0.0, 1.0, 0.0], UP_DOWN[:3]))
    assert branches_by_order(np.zeros(8, dtype=int), wrench, np.arange(8.0)) is None


def test_loads_in_all_directions_tell_nothing() -> None:
    wrench = loads(np.diag([100.0, 100.0, 100.0]))
    assert branches_by_order(np.zeros(3, dtype=int), wrench, np.arange(3.0)) is None


@pytest.mark.parametrize("foot", [True, False], ids=["taken off in between", "from the foot on"])
def test_a_ladder_that_is_climbed_again_tells_each_time(foot: bool) -> None:
    again = UP_DOWN if foot else UP_DOWN[1:]
    wrench = loads(along([0.0, 0.0, -1.0]), along([0.0, 0.0, -1.0], again), along([0.8, 0.6, 0.0]))
    count = len(wrench)
    found = branches_by_order(np.zeros(count, dtype=int), wrench, np.arange(float(count)))
    assert found is not None
    assert list(found[0]) == WORDS + (WORDS if foot else WORDS[1:]) + WORDS


def test_rises_that_are_repeated_without_a_way_down_tell_nothing() -> None:
    wrench = loads(*[along([0.0, 0.0, -1.0], np.array([100.0, 200.0, 300.0, 400.0]))] * 3)
    assert branches_by_order(np.zeros(12, dtype=int), wrench, np.arange(12.0)) is None
