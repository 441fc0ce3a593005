"""Clocks as labs write them, in one column or two."""

import pytest

from sk120stiff.measurements.importers.clock import since_first


@pytest.mark.parametrize(
    "cells",
    [
        ["2026-10-14 08:00:22", "2026-10-14T08:01:22", "2026-10-14 09:00:22"],
        ["14.10.2026 08:00:22", "14.10.2026 08:01:22", "14.10.2026 09:00:22"],
        ["10/14/2026 08:00:22 AM", "10/14/2026 08:01:22 AM", "10/14/2026 09:00:22 AM"],
        ["14/10/2026 08:00", "14/10/2026 08:01", "14/10/2026 09:00"],
        ["08:00:22", "08:01:22", "09:00:22"],
        ["08:00:22.0", "08:01:22.0", "09:00:22.0"],
    ],
)
def test_one_column(cells: list[str]) -> None:
    assert [float(second) for second in since_first(cells)] == [0.0, 60.0, 3600.0]


def test_a_date_and_a_time_of_the_day_in_columns_of_their_own() -> None:
    date, time = ["14.10.2026", "14.10.2026", "15.10.2026"], ["23:59:00", "23:59:30", "00:00:00"]
    for columns in ((date, time), (time, date)):
        assert [float(second) for second in since_first(*columns)] == [0.0, 30.0, 60.0]


def test_times_of_the_day_go_on_past_midnight() -> None:
    assert [float(s) for s in since_first(["23:59", "00:01", "00:02"])] == [0.0, 120.0, 180.0]


def test_the_order_of_the_readings_tells_day_from_month() -> None:
    """From 9 to 10 October, or from 10 September to 10 October: both rise, and nobody can tell."""
    told = since_first(["09/10/2026 08:00:00", "10/10/2026 08:00:00"])
    assert isinstance(told, str) and "either way" in told
    falling = ["01/02/2026 08:00:00", "02/01/2026 08:00:00"]  # the second is earlier as day/month
    assert [float(second) for second in since_first(falling)] == [0.0, 30 * 86400.0]


def test_what_is_no_clock_is_told() -> None:
    assert "2026-11-22" in since_first(["early", "late"])
