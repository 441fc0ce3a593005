"""Clocks as labs write them, in one column or two."""

from pathlib import Path

import pytest

from sk120stiff.measurements.importers.clock import since_1970, since_first
from tests.measurements.importers.reading import draft_of, written


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


@pytest.mark.parametrize(
    ("unit", "cells"),
    [
        ("seconds", ["1732700000.020", "1732700000.145", "1732700060"]),
        ("milliseconds", ["1732700000020", "1732700000145", "1732700060000"]),
        ("microseconds", ["1732700000020000", "1732700000145000", "1732700060000000"]),
        ("nanoseconds", ["1732700000020000000", "1732700000145000000", "1732700060000000000"]),
    ],
)
def test_what_computers_count_since_1970(unit: str, cells: list[str]) -> None:
    found = since_1970(cells)
    assert found is not None and found[0] == unit
    assert [float(second) for second in found[1]] == [0.0, 0.125, 59.98]
    assert since_first(cells) == found[1]


@pytest.mark.parametrize(
    "cells",
    [
        ["0.0", "0.5"], ["1732700000", "12"], ["1732700000", "1732700000000"], ["1732700000", ""],
        ["20261122101500", "20261122101501"], ["nan", "1732700000"],
    ],
)  # fmt: skip
def test_other_numbers_are_no_time(cells: list[str]) -> None:
    assert since_1970(cells) is None
    assert "no time in seconds" in since_first(cells)


def test_a_column_of_such_counts_is_the_time_and_that_is_said(tmp_path: Path) -> None:
    rows = [f"{k},2,3,1,2,3,4,5,6,{1732700000 + 10 * k}.25" for k in range(3)]
    text = "\n".join(["x,y,z,q1,q2,q3,q4,q5,q6,timestamp", *rows]) + "\n"
    found = draft_of(tmp_path, text, length="mm", angle="deg")
    assert written(found)["time[s]"] == ("0.00", "10.00", "20.00")
    assert "timestamp counts seconds since 1970." in found.said
    iso = text.replace("17327000", "2026-11-22T10:15:")  # 2026-11-22T10:15:00.25 and so on
    assert written(draft_of(tmp_path, iso, length="mm", angle="deg"))["time[s]"][1:] == (
        "10.0", "20.0",
    )  # fmt: skip
