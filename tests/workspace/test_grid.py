import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sk120stiff.errors import InputError
from sk120stiff.workspace import Axis, Grid, parse_axes
from sk120stiff.workspace.grid import Chunks

LIMITS = {
    "joint_1": (-math.pi, math.pi, "angle"),
    "slide": (0.0, 2.0, "length"),
    "free": (-math.inf, math.inf, "angle"),
}


def test_the_papers_grid_has_its_number_of_points() -> None:
    """Section VI: steps of 0.2 rad over −180…180, −70…70 and −115…35 degrees."""
    limits = dict.fromkeys("abc", (0.0, 0.0, "angle"))
    text = [f"a={-math.pi}:{math.pi}:0.2 rad"]
    text += [f"b={math.radians(-70)}:{math.radians(70)}:0.2; c={math.radians(-115)}:0.6108653:0.2"]
    grid = Grid(parse_axes(["; ".join(text) + " rad"], limits))
    assert grid.shape == (32, 13, 14)
    assert grid.size == 5824


def test_a_unit_holds_for_the_items_before_it() -> None:
    axes = parse_axes(["joint_1=-90:90:45, free=10 deg"], LIMITS)
    np.testing.assert_allclose(axes[1].values, [math.radians(10)])
    np.testing.assert_allclose(axes[0].values, np.radians([-90, -45, 0, 45, 90]))
    with pytest.raises(InputError, match="mm"):
        parse_axes(["joint_1=-90:90:45; slide=::500 mm"], LIMITS)


def test_each_item_may_have_its_own_unit() -> None:
    axes = parse_axes(["joint_1=-90:90:45 deg; slide=::500 mm; free=0.1 rad"], LIMITS)
    np.testing.assert_allclose(axes[0].values, np.radians([-90, -45, 0, 45, 90]))
    np.testing.assert_allclose(axes[1].values, [0.0, 0.5, 1.0, 1.5, 2.0])
    np.testing.assert_allclose(axes[2].values, [0.1])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("joint_9=0:1:0.1 rad", "joint_9"),
        ("joint_1=0:1:0.1", "unit"),
        ("joint_1=0:1:0.1 mm", "mm"),
        ("joint_1=0:1:0 rad", "no points"),
        ("joint_1=0:1:-0.1 rad", "no points"),
        ("joint_1=1:0:0.1 rad", "no points"),
        ("joint_1=0:1 rad", "start:stop:step"),
        ("joint_1=0:1: rad", "start:stop:step"),
        ("joint_1= rad", "start:stop:step"),
        ("joint_1=nan:1:0.1 rad", "axis|number"),
        ("free=::0.1 rad", "no limit"),
        ("joint_1", "no axis"),
        ("joint_1=0:1:1e-9 rad", "larger steps"),
    ],
)
def test_what_is_no_axis_is_refused(text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        parse_axes([text], LIMITS)


def test_an_axis_twice_or_none_is_refused() -> None:
    axis = Axis("a", np.zeros(1))
    with pytest.raises(InputError, match="twice"):
        Grid((axis, axis))
    with pytest.raises(InputError, match="no axes"):
        Grid(())
    with pytest.raises(InputError, match="no points"):
        Grid((Axis("a", np.zeros(0)),))
    with pytest.raises(InputError, match="not finite"):
        Grid((Axis("a", np.array([np.inf])),))


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4), st.integers(1, 300))
def test_chunks_cover_every_point_once_and_in_order(shape: list[int], target: int) -> None:
    chunks = Chunks(tuple(shape), target)
    assert math.prod(chunks.chunk_shape) <= target
    flat = np.arange(math.prod(shape)).reshape(shape)
    seen = []
    for chunk in range(chunks.number):
        begin, end = chunks.stretch(chunk)
        np.testing.assert_array_equal(flat[chunks.region(chunk)].ravel(), np.arange(begin, end))
        seen.extend(range(begin, end))
    assert seen == list(range(flat.size))
