"""Clocks as people and instruments write them become seconds since the first reading."""

from __future__ import annotations

import datetime as dt
import re
from collections.abc import Iterator, Sequence
from decimal import Decimal, InvalidOperation
from itertools import pairwise, product
from typing import Literal

DateOrder = Literal["dmy", "mdy"]

DATES = (
    "%d.%m.%Y", "%d.%m.%y", "%Y-%m-%d", "%Y/%m/%d", "%d/%m/%Y", "%m/%d/%Y", "%d/%m/%y", "%m/%d/%y",
    "%d-%m-%Y", "%m-%d-%Y", "%d %b %Y", "%d-%b-%Y",
)  # fmt: skip
TIMES = (
    "%H:%M:%S", "%H:%M:%S.%f", "%H:%M:%S,%f", "%H:%M", "%I:%M:%S %p", "%I:%M:%S.%f %p", "%I:%M %p",
)  # fmt: skip
DAY = dt.timedelta(days=1)

_UNIX = (Decimal(10) ** 9, Decimal(42) * 10**8)  # seconds since 1970 in 2001 and in 2103
_COUNTED = {0: "seconds", 3: "milliseconds", 6: "microseconds", 9: "nanoseconds"}  # 10^-k s
PARTS_OF_SECONDS = {  # powers of ten of a second
    "s": 0, "sec": 0, "secs": 0, "ms": -3, "us": -6, "µs": -6, "ns": -9,
}  # fmt: skip
EXAMPLES = "2026-11-22 10:15:00, 22.11.2026 10:15:00, 10:15:00"
EITHER_WAY = "day and month can be read either way; write dates as 2026-11-22"
_OTHER_ORDER = {"dmy": re.compile("%m[/-]%d"), "mdy": re.compile("%d[/-]%m")}
_CLOCK = re.compile(
    r"(?:\d{1,4}[./-]\d{1,2}[./-]\d{2,4}[T ]?)?"
    r"(?:\d{1,2}:\d{2}(?::\d{2}(?:[.,]\d+)?)?(?: ?[AP]M|Z)?)?",
    re.IGNORECASE,
)
_HALF_DAY = re.compile(r"(?<=\d)\s*([ap])\.?\s?m\.?$", re.IGNORECASE)
_MIDNIGHT = re.compile(r"[T ](?:0?0:00(?::00(?:[.,]0+)?)?|12:00(?::00)? AM)$")
_NO_DAY = re.compile(r"^(?:1899-12-30|30\.12\.1899|12/30/1899)[T ]")  # of a sheet's time alone


def since_first(*columns: Sequence[str], order: DateOrder | None = None) -> tuple[str, ...] | str:
    """Seconds since the first reading, or why they cannot be told, in words.

    Args:
        columns: The cells of one clock column; of two, one of dates and one of times of the day, or
            one that has both.
        order: Does the day come first in dates like 10/09/2026, or the month? None: what all cells
            together can be read as, and what rises, tells.
    """
    counted = since_1970(columns[0]) if len(columns) == 1 else None
    if counted is not None:
        return counted[1]
    columns = tuple([_plain(cell) for cell in cells] for cells in columns)
    ways: tuple[tuple[Sequence[str], ...], ...] = (columns,)
    if len(columns) > 1:
        alone = [cells for cells in columns if all(":" in cell for cell in cells)]
        columns = tuple(_part(cells) for cells in columns)
        ways = (columns, columns[::-1], *((cells,) for cells in alone))
    found: list[list[float]] = []
    for cells in (tuple(map(" ".join, zip(*way, strict=True))) for way in ways):
        for times in _readings_of(cells, order):
            seconds = [(time - times[0]).total_seconds() for time in times]
            if seconds not in found:
                found.append(seconds)
        if found:
            break
    rising = [each for each in found if all(a <= b for a, b in pairwise(each))]
    if len(rising) == 1 or len(found) == 1:
        return tuple(map(repr, (rising or found)[0]))
    return EITHER_WAY if found else f"no time in seconds, and none like {EXAMPLES}"


def is_clock(cell: str) -> bool:
    """Is this a date, a time of the day, or both, as instruments write them?"""
    return bool(cell) and _CLOCK.fullmatch(cell) is not None


def since_1970(cells: Sequence[str]) -> tuple[str, tuple[str, ...]] | None:
    """Clocks of computers: what they count since 1970, and seconds since the first reading.

    None where the numbers are no such count of this century.
    """
    try:
        counts = [Decimal(cell) for cell in cells]
    except InvalidOperation:
        return None
    for power, unit in _COUNTED.items():
        times = [count.scaleb(-power) for count in counts]
        if all(time.is_finite() and _UNIX[0] <= time <= _UNIX[1] for time in times):
            return unit, tuple(f"{time - times[0]:f}" for time in times)
    return None


def _plain(cell: str) -> str:
    """A cell in one dress: no comma after the date, no Uhr, AM for a.m., no nanoseconds."""
    text = re.sub(r",?\s+", " ", cell.strip()).removesuffix(" Uhr")
    return re.sub(r"([.,]\d{6})\d+", r"\1", _HALF_DAY.sub(lambda m: f" {m[1].upper()}M", text))


def _part(cells: Sequence[str]) -> Sequence[str]:
    """Dates without the midnight, and times without the day, that workbooks put beside them."""
    for surplus in (_MIDNIGHT, _NO_DAY):
        if all(surplus.search(cell) for cell in cells):
            return [surplus.sub("", cell) for cell in cells]
    return cells


def _readings_of(cells: Sequence[str], order: DateOrder | None) -> Iterator[list[dt.datetime]]:
    """What all cells say together, by every way of writing that all of them follow."""
    try:
        times = [dt.datetime.fromisoformat(cell) for cell in cells]
        if len({time.tzinfo is None for time in times}) == 1:
            yield times
        return
    except ValueError:
        pass
    for form in (*map(" ".join, product(DATES, TIMES)), *TIMES):
        if order is not None and _OTHER_ORDER[order].match(form):
            continue
        try:
            times = [dt.datetime.strptime(cell, form) for cell in cells]
        except ValueError:
            continue
        yield times if form not in TIMES else _past_midnight(times)


def _past_midnight(times: Sequence[dt.datetime]) -> list[dt.datetime]:
    """Times of the day with a day more wherever they begin anew."""
    out: list[dt.datetime] = []
    for time in times:
        while out and time < out[-1]:
            time += DAY
        out.append(time)
    return out


def in_seconds(cells: Sequence[str], unit: str | None) -> tuple[tuple[str, ...], str | None]:
    """Cells of a clock and their unit, milliseconds and the like as seconds, digit by digit.

    Counts since 1970 stay what they are, without a unit: `since_1970` knows them.
    """
    power = PARTS_OF_SECONDS.get(unit or "")
    if power is None:
        return tuple(cells), unit
    if since_1970(cells) is not None:
        return tuple(cells), None
    try:
        return tuple(f"{Decimal(cell).scaleb(power):f}" if cell else "" for cell in cells), "s"
    except InvalidOperation:
        return tuple(cells), unit
