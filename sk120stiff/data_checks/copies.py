"""Rows that were pasted twice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.measurements import Measurements


def repeated_rows(measurements: Measurements) -> Index:
    """(k,) rows that repeat an earlier one to the last digit, load and all three axes.

    A row with an axis that is zero, or was not read, says too little to be told for one.
    Such rows are copies, not repeats: the noise that they claim to show is zero. Rows that the file
    itself tells apart, by order, time, branch or repeat, are readings of their own.
    """
    if measurements.displacement is None:
        return np.zeros(0, dtype=np.intp)
    whole = np.column_stack([measurements.joints, measurements.wrench, measurements.displacement])
    first: dict[tuple[bytes, tuple[object, ...]], int] = {}
    copies = []
    for row in np.flatnonzero(measurements.use):
        if not (np.abs(measurements.displacement[row]) > 0.0).all():
            continue
        told_apart = tuple(
            None if column is None else column[row]
            for column in (
                measurements.order,
                measurements.time,
                measurements.branch,
                measurements.repeat,
            )
        )
        key = ((whole[row] + 0.0).tobytes(), told_apart)
        if first.setdefault(key, int(row)) != row:
            copies.append(row)
    return np.array(copies, dtype=np.intp)


def without_copies(measurements: Measurements) -> tuple[Measurements, str | None]:
    """The readings with copied rows masked, and the sentence that says so."""
    copies = repeated_rows(measurements)
    if not len(copies):
        return measurements, None
    use = measurements.use.copy()
    use[copies] = False
    lines = [str(measurements.line[row]) for row in copies[:5]]
    more = " …" if len(copies) > 5 else ""
    said = (
        f"{len(copies)} rows repeat earlier ones to the last digit "
        f"(lines {', '.join(lines)}{more}). Copies show no noise, so they are masked here."
        if len(copies) > 1
        else f"One row repeats an earlier one to the last digit (line {lines[0]}). A copy shows no "
        "noise, so it is masked here."
    )
    return replace(measurements, use=use), said
