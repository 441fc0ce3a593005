"""Files that belong together: each reading with its row of another file."""

from __future__ import annotations

from dataclasses import dataclass, replace

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.campaign.by_label import by_label, label_of
from sk120stiff.measurements.importers.campaign.by_time import ByTime, by_time, clock_of
from sk120stiff.measurements.importers.campaign.in_turn import in_turn
from sk120stiff.measurements.importers.clock import DateOrder
from sk120stiff.measurements.importers.contract import FILE, Column, Sheet, Unpaired

NAME, TIME, ORDER = "name", "time", "order"


@dataclass(frozen=True)
class _Pairs:
    """Rows of the points, those of the other file, how they were found, what has no partner, and
    the labels of both where these told."""

    rows: list[int]
    others: list[int]
    how: str
    unpaired: list[Unpaired]
    labels: tuple[Column, Column] | None = None


def paired(
    points: Sheet,
    other: Sheet,
    what: str,
    *,
    by_clock: bool = False,
    alone: bool = True,
    dates: DateOrder | None = None,
) -> Sheet:
    """Each reading with its row of another file: by name, else by time, else by order.

    Args:
        points, other: The readings, and what belongs to them.
        what: What the other file holds, as its option names it: joints or loads.
        by_clock: May times of both decide?
        alone: Is this the only file of points? Of several the order of their rows tells nothing.
        dates: The order of day and month, where somebody told.

    Raises:
        InputError: A few names agree, or none and the files are not equally long.
    """
    found: _Pairs | str | None = _by_name(points, other, what)
    untold = ""
    if found is None and by_clock:
        found = _by_time(points, other, dates)
        if isinstance(found, str):
            untold = f" Both files have times, which were not used: {found}."
    if not isinstance(found, _Pairs):
        if not alone:
            raise InputError(
                f"neither names nor times tell which rows of {what} belong to which of several "
                f"files.{untold}".removesuffix("."),
                where=f"{points.path} and {other.path}",
                remedy="Give all files a column of names, those of the points, or the file of "
                f"{what} a column pose with the numbers in the names of the others. If they are "
                "the same poses without and with a load, give the file without as --before FILE, "
                "and the other alone; if each holds one marker at the same poses, row by row, put "
                "them side by side in one file, x1 y1 z1 x2 y2 z2. Else import them one by one, "
                "each with a file of its own.",
            )
        turned = in_turn(points, other.total)
        points = turned or points
        times = 1 if turned is None else points.total // other.total
        found = _by_order(points, other, what, untold, times)
    rows, others = found.rows, found.others
    if found.labels and any(found.labels[0] is c for c in points.spare):
        points = _named_by(points, found.labels[0])
    lost = list(points.skipped)
    if found.how.startswith(ORDER):
        lost += [(line, f"{reason} ({other.path.name})") for line, reason in other.skipped]
    if not rows:
        raise InputError(f"no point has its {what}", where=f"{points.path} and {other.path}")
    taken = {c.meaning for c in points.columns} | {"name"}
    more = [replace(c, file=other.path) for c in other.columns if c.meaning not in taken]
    told = taken - {"name"}
    clock = clock_of(other) if found.how.startswith(TIME) else ()
    used = (*(found.labels or ()), *clock)
    twice = [c for c in other.columns if c.meaning in told and not any(c is u for u in used)]
    spare = [replace(c, file=other.path) for c in other.spare if not any(c is u for u in used)]
    kept = points.rows(rows)
    of = "" if alone else f" of {points.path.name}"
    return replace(
        kept,
        columns=(*kept.columns, *(column.rows(others) for column in more)),
        spare=(*kept.spare, *(column.rows(others) for column in spare)),
        skipped=tuple(lost),
        unpaired=(*points.unpaired, *found.unpaired),
        by_order=(*points.by_order, *([other.path] if found.how.startswith(ORDER) else [])),
        unused=(
            *points.unused,
            *(f"{item} of {other.path.name}" for item in other.unused),
            *(f"column {c.header} of {other.path.name}" for c in twice),
        ),
        notes=(
            *points.notes,
            f"The {what}{of} are those of {other.path.name}, matched by {found.how}: {len(rows)} "
            f"readings.{untold} Recognised as {other.title}: {other.why}.",
            *(f"{other.path.name}: {n[0].lower()}{n[1:]}" for n in other.notes),
        ),
    )


def _named_by(points: Sheet, label: Column) -> Sheet:
    """The points with a column of unknown header as their names; those so far count rows, say."""
    others = points.those(NAME)
    made = points.exchanged([label, *others], replace(label, meaning=NAME))
    return replace(made, spare=(*made.spare, *(replace(c, meaning="") for c in others)))


def _by_name(points: Sheet, other: Sheet, what: str) -> _Pairs | None:
    """By the labels of both, where these agree; None where none does.

    Raises:
        InputError: A few do.
    """
    found = by_label(points, other)
    if found is None:
        return None
    place = {key: k for k, key in enumerate(found.other_keys)}
    if not found.enough:
        raise InputError(
            f"only {len(found.shared)} of {len(place)} names agree ({min(found.shared)} among "
            f"them): the {what} belong to other points",
            where=f"{points.path} and {other.path}",
            remedy="Give both files the same names, or take the names out of one of them: "
            "rows then belong together by order.",
        )
    rows = [k for k, key in enumerate(found.keys) if key in place]
    left = [
        Unpaired(points.path, points.lines[k], found.mine.cells[k], f"not in {other.path.name}")
        for k, key in enumerate(found.keys)
        if key not in place
    ]
    left += [
        Unpaired(other.path, other.lines[k], found.theirs.cells[k], "no point", beside=True)
        for key, k in place.items()
        if key not in found.shared
    ]
    of_file = found.mine.header == FILE
    headers = f"{found.mine.stated if of_file else found.mine.header}, {found.theirs.header}"
    first = found.mine.cells[rows[0]], found.theirs.cells[place[found.keys[rows[0]]]]
    example = f", as {first[0]} and {first[1]}" if first[0] != first[1] and not of_file else ""
    how = f"{NAME} ({headers}{f'; {found.how}{example}' if found.how else ''})"
    return _Pairs(rows, [place[found.keys[k]] for k in rows], how, left, (found.mine, found.theirs))


def _by_time(points: Sheet, other: Sheet, dates: DateOrder | None) -> _Pairs | str | None:
    """By the times of both; why these do not tell, in words; None where they have none."""
    found = by_time(points, other, dates)
    if not isinstance(found, ByTime):
        return found
    rows, others = found.rows.tolist(), found.others.tolist()
    left = [
        Unpaired(points.path, points.lines[k], "", f"no row of {other.path.name} at its time")
        for k in sorted(set(range(len(points.lines))) - set(rows))
    ]
    if not found.dense:
        left += [
            Unpaired(other.path, other.lines[k], "", "no point at its time", beside=True)
            for k in sorted(set(range(len(other.lines))) - set(others))
        ]
    return _Pairs(rows, others, f"{TIME} ({found.say()})", left)


def _by_order(points: Sheet, other: Sheet, what: str, untold: str, times: int = 1) -> _Pairs:
    """Row by row, each row of the other file `times` times.

    Raises:
        InputError: The files are not equally long.
    """
    if points.total != times * other.total:
        raise InputError(
            f"{points.total} points, but {other.total} rows of {what}, and their names do not "
            f"agree.{untold}".removesuffix("."),
            where=f"{points.path} and {other.path}",
            remedy="Give both files the same names, or times of one clock (a column time), or "
            "delete the rows that have no partner. Which these are the robot tells: delete as many "
            "at the end, and the message says from where on the rows are apart.",
        )
    place_of = {rank: k for k, rank in enumerate(other.rank)}
    rows = [k for k, rank in enumerate(points.rank) if rank // times in place_of]
    mine, theirs = label_of(points), label_of(other)
    said = f" ({mine.header} and {theirs.header} do not agree)" if mine and theirs else ""
    return _Pairs(rows, [place_of[points.rank[k] // times] for k in rows], ORDER + said, [])
