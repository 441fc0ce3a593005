"""Clocks as people and instruments write them become seconds since the first reading."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator, Sequence
from itertools import pairwise, product

DATES = ("%d.%m.%Y", "%d.%m.%y", "%Y/%m/%d", "%d/%m/%Y", "%m/%d/%Y", "%d-%m-%Y", "%d %b %Y")
TIMES = ("%H:%M:%S", "%H:%M:%S.%f", "%H:%M:%S,%f", "%H:%M", "%I:%M:%S %p", "%I:%M %p")
DAY = dt.timedelta(days=1)

EXAMPLES = "2026-11-22 10:15:00, 22.11.2026 10:15:00, 10:15:00"


def since_first(*columns: Sequence[str]) -> tuple[str, ...] | str:
    """Seconds since the first reading, or why they cannot be told, in words.

    Args:
        columns: The cells of one clock column; of two, one of dates and one of times of the day, or
            one that has both.
    """
    found: list[list[float]] = []
    orders = (columns, columns[::-1], columns[:1], columns[1:]) if len(columns) > 1 else (columns,)
    for cells in (tuple(map(" ".join, zip(*order, strict=True))) for order in orders):
        for times in _readings_of(cells):
            seconds = [(time - times[0]).total_seconds() for time in times]
            if seconds not in found:
                found.append(seconds)
        if found:
            break
    rising = [each for each in found if all(a <= b for a, b in pairwise(each))]
    if len(rising) == 1 or len(found) == 1:
        return tuple(map(repr, (rising or found)[0]))
    if found:
        return "day and month can be read either way; write dates as 2026-11-22"
    return f"no time in seconds, and none like {EXAMPLES}"


def _readings_of(cells: Sequence[str]) -> Iterator[list[dt.datetime]]:
    """What all cells say together, by every way of writing that all of them follow."""
    try:
        times = [dt.datetime.fromisoformat(cell.strip()) for cell in cells]
        if len({time.tzinfo is None for time in times}) == 1:
            yield times
        return
    except ValueError:
        pass
    for form in (*map(" ".join, product(DATES, TIMES)), *TIMES):
        try:
            times = [dt.datetime.strptime(cell.strip(), form) for cell in cells]
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
