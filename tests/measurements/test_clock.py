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
        ["14.10.2026, 08:00:22 Uhr", "14.10.2026, 08:01:22 Uhr", "14.10.2026, 09:00:22 Uhr"],
        ["14.10.26 08:00", "14.10.26 08:01", "14.10.26 09:00"],
        ["10/14/26 8:00:22 a.m.", "10/14/26 8:01:22 a.m.", "10/14/26 9:00:22 a.m."],
        ["10/14/2026 11:59:22.5 PM", "10/15/2026 12:00:22.5 AM", "10/15/2026 12:59:22.5 AM"],
        ["2026-10-14 11:30:00 AM", "2026-10-14 11:31:00 AM", "2026-10-14 12:30:00 PM"],
        ["14-Oct-2026 08:00:22", "14-Oct-2026 08:01:22", "14-Oct-2026 09:00:22"],
        [f"2026-10-14T{clock}.123456789" for clock in ("08:00:22", "08:01:22", "09:00:22")],
    ],
)
def test_one_column(cells: list[str]) -> None:
    assert [float(second) for second in since_first(cells)] == [0.0, 60.0, 3600.0]


def test_a_date_and_a_time_of_the_day_in_columns_of_their_own() -> None:
    date, time = ["14.10.2026", "14.10.2026", "15.10.2026"], ["23:59:00", "23:59:30", "00:00:00"]
    for columns in ((date, time), (time, date)):
        assert [float(second) for second in since_first(*columns)] == [0.0, 30.0, 60.0]


@pytest.mark.parametrize(
    ("date", "times"),
    [
        ("2026-10-14T00:00:00", ("08:00:22", "08:01:22")),
        ("14.10.2026 00:00:00", ("30.12.1899 08:00:22", "30.12.1899 08:01:22")),
        ("10/14/2026 12:00:00 AM", ("8:00:22 PM", "8:01:22 PM")),
    ],
)
def test_a_workbook_writes_midnight_beside_its_dates(date: str, times: tuple[str, str]) -> None:
    """Taken for the time itself, every row would have been read at once."""
    assert [float(second) for second in since_first([date] * 2, times)] == [0.0, 60.0]


def test_a_date_beside_what_is_no_clock_is_none() -> None:
    assert "no time" in since_first(["2026-10-14", "2026-10-14"], ["early", "late"])


def test_what_the_file_leaves_open_can_be_told() -> None:
    cells = ["10/09/2026 08:00 AM", "10/10/2026 08:00 AM"]
    assert "either way" in since_first(cells)
    for order, days in (("dmy", 30), ("mdy", 1)):
        assert [float(second) for second in since_first(cells, order=order)] == [0.0, days * 86400]


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
