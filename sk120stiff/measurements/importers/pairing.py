"""Files that belong together: each reading with its row of another file."""

from __future__ import annotations

from dataclasses import replace

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Column, Sheet

SHARED = 0.5  # of the names of the shorter file, from which on names decide


def paired(points: Sheet, other: Sheet, what: str) -> Sheet:
    """Each reading with its row of another file: by name, else by order.

    Args:
        points, other: The readings, and what belongs to them.
        what: What the other file holds, as its option names it: joints or loads.

    Raises:
        InputError: A few names agree, or none and the files are not equally long.
    """
    mine, theirs = label_of(points), label_of(other)
    rows, others, how, lost = None, None, "order", list(points.skipped)
    if mine and theirs and len(set(theirs.cells)) == len(theirs.cells):
        place = {name: k for k, name in enumerate(theirs.cells)}
        shared = set(mine.cells) & place.keys()
        if len(shared) >= SHARED * min(len(set(mine.cells)), len(place)):
            how = f"name ({mine.header}, {theirs.header})"
            rows = [k for k, name in enumerate(mine.cells) if name in place]
            others = [place[mine.cells[k]] for k in rows]
            lost += [
                (points.lines[k], f"{name} is not in {other.path.name}")
                for k, name in enumerate(mine.cells)
                if name not in place
            ]
            lost += [
                (other.lines[k], f"{name} of {other.path.name} has no point")
                for name, k in place.items()
                if name not in mine.cells
            ]
        elif shared:
            raise InputError(
                f"only {len(shared)} of {len(place)} names agree ({min(shared)} among them): the "
                f"{what} belong to other points",
                where=f"{points.path} and {other.path}",
                remedy="Give both files the same names, or take the names out of one of them: "
                "rows then belong together by order.",
            )
    if rows is None or others is None:
        if points.total != other.total:
            raise InputError(
                f"{points.total} points, but {other.total} rows of {what}, and their names "
                "do not agree",
                where=f"{points.path} and {other.path}",
                remedy="Give both files the same names, or delete the rows that have no partner. "
                "Which these are the robot tells: delete as many at the end, and the message says "
                "from where on the rows are apart.",
            )
        place_of = {rank: k for k, rank in enumerate(other.rank)}
        rows = [k for k, rank in enumerate(points.rank) if rank in place_of]
        others = [place_of[points.rank[k]] for k in rows]
        lost += [(line, f"{reason} ({other.path.name})") for line, reason in other.skipped]
    if not rows:
        raise InputError(f"no point has its {what}", where=f"{points.path} and {other.path}")
    taken = {c.meaning for c in points.columns} | {"name"}
    more = [replace(c, file=other.path) for c in other.columns if c.meaning not in taken]
    told = taken - {"name"}
    twice = [c for c in other.columns if c.meaning in told and (c is not theirs or how == "order")]
    spare = [replace(c, file=other.path) for c in other.spare]
    kept = points.rows(rows)
    return replace(
        kept,
        columns=(*kept.columns, *(column.rows(others) for column in more)),
        spare=(*kept.spare, *(column.rows(others) for column in spare)),
        skipped=tuple(lost),
        unused=(
            *points.unused,
            *(f"{item} of {other.path.name}" for item in other.unused),
            *(f"column {c.header} of {other.path.name}" for c in twice),
        ),
        notes=(
            *points.notes,
            f"The {what} are those of {other.path.name}, matched by {how}: {len(rows)} readings. "
            f"Recognised as {other.title}: {other.why}.",
            *(f"{other.path.name}: {n[0].lower()}{n[1:]}" for n in other.notes),
        ),
    )


def label_of(sheet: Sheet) -> Column | None:
    """The column of names, else that of poses if every row has one."""
    pose = sheet.get("pose")
    return sheet.get("name") or (pose if pose is not None and all(pose.cells) else None)
