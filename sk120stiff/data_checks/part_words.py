"""What a part of the rows was written as, in words: a unit under the header of another, or a sign.

Loads of a part that are too small by a factor, and readings of it that are too large, are one to an
arm; and so is the opposite in all other rows. What headers allow decides: of several, the one that
concerns fewer rows comes first.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Index, Integers
from sk120stiff.data_checks.correction import Correction
from sk120stiff.data_checks.part_rows import INCH, KGF, LBF, THOUSAND, Part
from sk120stiff.data_checks.sheet import Sheet
from sk120stiff.errors import InputError
from sk120stiff.measurements.table.table import read_table

FORCES = {"N": 1.0, "kN": THOUSAND, "kgf": KGF, "lbf": LBF}  # N
LENGTHS = {"mm": 1.0, "um": 1.0 / THOUSAND, "m": THOUSAND, "inch": INCH}  # mm
SPELT = {"kp": "kgf", "µm": "um", "in": "inch", "micron": "um"}
SAME = 1e-6  # of a factor
LISTED = 12  # stretches of lines that are told


def headers_of(path: Path | None) -> tuple[str, str, bool]:
    """Units of force and of what was read, and whether that is displacements; else N, mm, yes."""
    try:
        table = None if path is None else read_table(path)
    except InputError:
        table = None
    if table is None:
        return "N", "mm", True
    written = table.column_units
    moved = "dx" in written
    force, length = written.get("fx") or "N", written.get("dx" if moved else "x") or "mm"
    return SPELT.get(force, force), SPELT.get(length, length), moved


def correction_of(
    part: Part, sheet: Sheet, lines: Integers, headers: tuple[str, str, bool]
) -> Correction | None:
    """What looks wrong and what mends it; None where the headers leave no such slip.

    Args:
        part: What was found.
        sheet: The readings that it was found in.
        lines: (N,) lines of the file.
        headers: See `headers_of`.
    """
    force, length, moved = headers
    if part.way.times in (1.0, -1.0):
        said, remedy = _sign(part, moved)
        where = places(part.rows, np.flatnonzero(sheet.kept), lines)
        return Correction(f"{where}: {said}", remedy, part.mend)
    used = np.flatnonzero(sheet.kept)
    others = np.setdiff1d(used, part.rows)
    ways = [
        (len(rows), places(rows, used, lines), *slip)
        for rows, times in ((part.rows, part.way.times), (others, 1.0 / part.way.times))
        for slip in _slips(times, force, length, moved)
    ]
    if not ways:
        return None
    ways.sort(key=lambda way: way[0])
    _, where, said, remedy = ways[0]
    rest = [f" Or {there}: {what}. {how}" for _, there, what, how in ways[1:]]
    return Correction(f"{where}: {said}", remedy + "".join(rest), part.mend)


def _sign(part: Part, moved: bool) -> tuple[str, str]:
    name = part.way.negated
    if name:
        return f"{name} has the other sign than in the other rows", f"Negate {name} there."
    if not moved:
        return (
            "forces have the other sign than in the other rows",
            "Negate fx, fy, fz there: the force is the one on the arm.",
        )
    return (
        "forces have the other sign than in the other rows, or displacements have",
        "Negate fx, fy, fz there, or dx, dy, dz: the force is the one on the arm, and a "
        "displacement is loaded minus unloaded.",
    )


def _slips(times: float, force: str, length: str, moved: bool) -> Iterator[tuple[str, str]]:
    """Said and remedy of each unit in which rows yield as if their loads were `times` as large."""
    read, columns = ("displacements", "dx, dy, dz") if moved else ("positions", "x, y, z")
    for unit, by in _units(FORCES, force):
        if abs(by / times - 1.0) < SAME:
            yield (
                f"forces look like {unit}, not {force}",
                f"Write fx, fy, fz there times {by:.6g}.",
            )
    for unit, by in _units(LENGTHS, length):
        if abs(by * times - 1.0) < SAME:
            yield (
                f"{read} look like {unit}, not {length}",
                f"Write {columns} there times {by:.6g}.",
            )


def _units(sizes: dict[str, float], own: str) -> Iterator[tuple[str, float]]:
    """Each other unit, and what brings its numbers into the header's own."""
    if own in sizes:
        yield from ((unit, size / sizes[own]) for unit, size in sizes.items() if unit != own)


def places(rows: Index, used: Index, lines: Integers) -> str:
    """The lines of some rows of those in use; what follows one another as `a to b`."""
    at = np.searchsorted(used, rows)
    numbers = lines if lines.any() else np.arange(1, len(lines) + 1)
    runs = np.split(rows, np.flatnonzero(np.diff(at) > 1) + 1)
    each = [
        f"{numbers[run[0]]} to {numbers[run[-1]]}" if len(run) > 2
        else ", ".join(str(numbers[row]) for row in run)
        for run in runs
    ]  # fmt: skip
    more = f" … ({len(rows)} rows)" if len(each) > LISTED else ""
    return f"{'lines' if lines.any() else 'rows'} {', '.join(each[:LISTED])}{more}"
