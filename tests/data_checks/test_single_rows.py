"""Slips of a hand at single rows: the one that would explain a reading is told, and no other."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.data_checks import slips_of_rows
from sk120stiff.measurements import Measurements
from tests.explain.readings import hidden

LIMIT = 3e-5
ROW, OTHER = 25, 40


def _slips(read: np.ndarray, readings: Measurements, *rows: int) -> dict[int, str]:
    """What is told of some rows where the truth is what stood there before."""
    told = np.asarray(readings.displacement)
    return slips_of_rows(replace(readings, displacement=read), rows, told, LIMIT)


@pytest.fixture(scope="module")
def readings() -> Measurements:
    return hidden(poses=12, loads=4, seed=4)


@pytest.mark.parametrize(
    ("factors", "said"),
    [
        ([-1.0, 1.0, 1.0], "dx would fit with the other sign"),
        ([1.0, -1.0, -1.0], "dy and dz would fit with the other sign"),
        ([1.0, 10.0, 1.0], "dy would fit with its decimal point one place to the left"),
        ([1.0, 1.0, 0.1], "dz would fit with its decimal point one place to the right"),
    ],
)
def test_signs_and_decimal_points(readings: Measurements, factors: list[float], said: str):
    read = np.array(readings.displacement)
    read[ROW] *= factors
    assert _slips(read, readings, ROW) == {ROW: said}


def test_axes_that_changed_places(readings: Measurements):
    read = np.array(readings.displacement)
    read[ROW] = read[ROW][[1, 0, 2]]
    assert _slips(read, readings, ROW) == {ROW: "dx and dy would fit in one another's place"}


def test_rows_that_were_exchanged(readings: Measurements):
    read = np.array(readings.displacement)
    read[[ROW, OTHER]] = read[[OTHER, ROW]]
    said = _slips(read, readings, ROW, OTHER)
    assert set(said) == {ROW, OTHER}
    assert readings.pose[OTHER] in said[ROW]
    assert readings.pose[ROW] in said[OTHER]
    assert _slips(read, readings, ROW) == {}


def test_a_reading_copied_into_another_row_is_no_exchange(readings: Measurements):
    read = np.array(readings.displacement)
    read[ROW] = read[OTHER]
    read[OTHER] += [3e-4, -2e-4, 5e-4]
    assert _slips(read, readings, ROW, OTHER) == {}


def test_a_bump_is_no_slip_of_the_pen(readings: Measurements):
    read = np.array(readings.displacement)
    read[ROW] += [3e-4, -2e-4, 5e-4]
    assert _slips(read, readings, ROW) == {}


def test_axes_that_were_not_read_are_not_asked(readings: Measurements):
    read = np.array(readings.displacement)
    read[ROW, 0] *= -1.0
    read[ROW, 1:] = np.nan
    assert _slips(read, readings, ROW) == {ROW: "dx would fit with the other sign"}


def test_an_axis_that_fits_as_it_stands_has_no_slip(readings: Measurements):
    """It lies near zero, and would fit with the other sign as well; what is off is another."""
    read = np.array(readings.displacement)
    told = read.copy()
    told[ROW, 1] = read[ROW, 1] = 0.3 * LIMIT
    read[ROW, 2] += 0.9 * LIMIT
    assert slips_of_rows(replace(readings, displacement=read), [ROW], told, LIMIT) == {}
    read[ROW, 0] *= -1.0
    assert list(
        slips_of_rows(replace(readings, displacement=read), [ROW], told, LIMIT).values()
    ) == ["dx would fit with the other sign"]


@pytest.mark.parametrize(("beside", "slipped"), [(0.3, True), (0.9, False)])
def test_what_is_mended_fits_as_the_others_do(readings: Measurements, beside: float, slipped: bool):
    """A row off on two axes is no slip of one of them because both lie just within the limit."""
    read, told = (np.array(readings.displacement) for _ in range(2))
    read[ROW, 0] *= -1.0
    told[ROW, 0] += 0.9 * LIMIT  # what the model says beside what stood there
    told[ROW, 1] += beside * LIMIT
    found = slips_of_rows(replace(readings, displacement=read), [ROW], told, LIMIT)
    assert (ROW in found) == slipped
