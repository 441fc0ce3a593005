"""Signs and axes of loads and displacements, copied rows; good data are never called wrong."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.data_checks import look, without_copies
from sk120stiff.data_checks.copies import repeated_rows
from sk120stiff.errors import Refusal, ToolkitWarning
from sk120stiff.explain import explain
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from tests.explain.readings import hidden
from tests.hidden.generator.causes_elastic import BaseRocking


@pytest.fixture(scope="module")
def model() -> Model:
    found = base_model(load_robot("motoman_sk120"))
    assert found is not None
    return found


@pytest.fixture(scope="module")
def good() -> Measurements:
    return hidden(poses=8)


def moved(data: Measurements, change: np.ndarray) -> Measurements:
    return replace(data, displacement=data.displacement @ change)


def test_good_data_are_not_doubted(model: Model, good: Measurements) -> None:
    assert look(model, good).sentences == ()
    assert not len(repeated_rows(good))


def test_a_flipped_sign_is_told_and_nothing_is_named(model: Model, good: Measurements) -> None:
    (said,) = look(model, moved(good, -np.eye(3))).sentences
    assert "point against each other in " in said
    assert f" of {len(good.pose)} rows: check the sign convention" in said
    with pytest.raises(Refusal, match="check the sign convention"):
        explain(model, moved(good, -np.eye(3)))


@pytest.mark.parametrize("order", list(permutations(range(3)))[1:])
def test_swapped_axes_are_told_in_the_order_that_mends_them(
    model: Model, good: Measurements, order: tuple[int, int, int]
) -> None:
    swapped = replace(good, displacement=good.displacement[:, order])
    (said,) = look(model, swapped).sentences
    back = "".join("xyz"[order.index(k)] for k in range(3))
    assert f"dx, dy, dz look like {', '.join(back)}" in said


@pytest.mark.parametrize("axis", range(3))
def test_one_axis_with_the_wrong_sign(model: Model, good: Measurements, axis: int) -> None:
    signs = np.eye(3)
    signs[axis, axis] = -1.0
    (said,) = look(model, moved(good, signs)).sentences
    assert said.startswith(f"d{'xyz'[axis]} seems to have the wrong sign")


@pytest.mark.parametrize("factor", [1e3, 1e-3])
def test_a_wrong_unit(model: Model, good: Measurements, factor: float) -> None:
    (said,) = look(model, moved(good, factor * np.eye(3))).sentences
    assert "check the units" in said


def test_noise_alone_is_no_mistake(model: Model, good: Measurements) -> None:
    rng = np.random.default_rng(1)
    noise = rng.normal(0.0, 1e-5, good.displacement.shape)
    assert look(model, replace(good, displacement=noise)).sentences == ()


def test_copied_rows_are_masked_and_told(model: Model, good: Measurements) -> None:
    rows = np.r_[np.arange(len(good.pose)), 3, 17]
    twice = good.select(rows)
    single, told = without_copies(twice)
    np.testing.assert_array_equal(np.flatnonzero(~single.use), [len(rows) - 2, len(rows) - 1])
    assert told is not None
    assert "2 rows repeat" in told
    single, told = without_copies(good.select(rows[:-1]))
    assert told is not None and told.startswith("One row repeats an earlier one")


def test_repeats_that_coincide_on_a_coarse_instrument_are_kept(good: Measurements) -> None:
    """Equal to the last digit, but read at another time: a reading of its own."""
    rows = np.r_[np.arange(len(good.pose)), 3, 17]
    count = np.arange(len(rows), dtype=float)
    assert len(repeated_rows(replace(good.select(rows), order=None, time=None))) == 2
    assert not len(repeated_rows(replace(good.select(rows), order=None, time=count)))


def test_a_soft_foundation_is_no_mistake(model: Model) -> None:
    soft = hidden(BaseRocking("base_link", {"x": 5e-7, "y": 1e-6}), poses=8)
    assert look(model, soft).sentences == ()


def test_a_file_pasted_twice_names_what_it_would_name_once(
    model: Model, good: Measurements
) -> None:
    rows = np.tile(np.arange(len(good.pose)), 2)
    with pytest.warns(ToolkitWarning, match="repeat earlier ones"):
        answer = explain(model, good.select(rows))
    assert answer.verdict == "none"
