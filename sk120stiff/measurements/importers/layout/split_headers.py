"""Headers of several words in a file whose cells are separated by blanks.

``Name Nominal X Nominal Y Measured X`` are four headers above rows of four cells: which words
belong together their meanings tell, and how many cells the rows have.
"""

from __future__ import annotations

import dataclasses
from collections import Counter

from sk120stiff.measurements.importers.columns.words import as_measured, meaning_of, unit_of_header
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.importers.layout.headerless import numeric

LONGEST = 3  # words of a header
FEWEST = 3  # headers that have to be understood
SEARCHED = 80  # rows that may stand above the numbers
Row = tuple[str, ...]


def with_whole_headers(source: Source) -> Source:
    """The source with such words joined; as it is where every row has as many cells."""
    grid = source.unnamed_grid
    if grid is None:
        return source
    first = next((k for k, row in enumerate(grid.rows[:SEARCHED]) if numeric(row)), 0)
    if not first:
        return source
    width = Counter(len(row) for row in grid.rows[first:]).most_common(1)[0][0]
    words = grid.rows[first - 1]
    if not width < len(words) <= LONGEST * width or any(not w or is_number(w) for w in words):
        return source
    headers = _joined(words, width, source.actuated)
    if headers is None:
        return source
    rows = (*grid.rows[: first - 1], headers, *grid.rows[first:])
    said = f"{len(words)} words of line {grid.lines[first - 1]} as the headers of {width} columns"
    return dataclasses.replace(
        source, given=dataclasses.replace(grid, rows=rows, how=f"{grid.how}, {said}")
    )


def _joined(words: Row, width: int, actuated: Row) -> Row | None:
    """As many headers, of which most are understood and none twice; None where they are few.

    Where two ways are understood alike, that of more even lengths is taken.
    """
    nothing: tuple[tuple[int, int], Row] = ((0, 0), ())
    best = {(0, 0): nothing}  # words and headers used: understood, minus squared lengths; headers
    for begin in range(len(words)):
        for count in range(width):
            if (begin, count) not in best:
                continue
            (known, even), headers = best[begin, count]
            for end in range(begin + 1, min(begin + LONGEST, len(words)) + 1):
                header = words[begin:end]
                score = known + _is_known(header, actuated), even - len(header) ** 2
                place = end, count + 1
                if place not in best or score > best[place][0]:
                    best[place] = score, (*headers, " ".join(header))
    _, found = best.get((len(words), width), nothing)
    meanings = as_measured([meaning_of(unit_of_header(each)[0], actuated) for each in found])
    told = Counter(each[0] for each in meanings if each)
    return found if len(told) >= FEWEST and max(told.values()) == 1 else None


def _is_known(header: Row, actuated: Row) -> bool:
    """Is it understood, or a word for a place before one that is, as ``Nominal Rx``?

    Such a word alone is no header here: ``Measured`` belongs to the X behind it.
    """
    if len(header) == 1 and meaning_of(f"{header[0]} x") is not None:
        return False
    if meaning_of(unit_of_header(" ".join(header))[0], actuated) is not None:
        return True
    rest = " ".join(header[1:])
    return bool(rest) and meaning_of(f"{header[0]} x") is not None and _is_known((rest,), actuated)
