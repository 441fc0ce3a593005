"""Rows that were pasted twice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.measurements import Measurements

COARSE = 1e-5  # m; positions told in steps as wide may be alike by chance


def repeated_rows(measurements: Measurements) -> Index:
    """(k,) rows that repeat an earlier one to the last digit, load and all three axes.

    Of positions every other reading and label of the row is the same as well, but for that of the
    pose.

    A row with an axis that is zero, or was not read, says too little to be told for one.
    Such rows are copies, not repeats: the noise that they claim to show is zero. Rows that the file
    itself tells apart, by order, time, branch or repeat, are readings of their own.
    """
    seen, beside = _readings(measurements)
    if seen is None:
        return np.zeros(0, dtype=np.intp)
    whole = np.column_stack([measurements.joints, measurements.wrench, seen])
    first: dict[tuple[bytes, tuple[object, ...]], int] = {}
    copies = []
    for row in np.flatnonzero(measurements.use):
        if not (np.abs(seen[row, :3]) > 0.0).all():
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
        labels = tuple(each[row] for each in beside)
        key = ((whole[row] + 0.0).tobytes(), (*told_apart, *labels))
        if first.setdefault(key, int(row)) != row:
            copies.append(row)
    return np.array(copies, dtype=np.intp)


def _readings(measurements: Measurements) -> tuple[Array | None, list[tuple[str, ...]]]:
    """(N, k) what was read, the three axes first, and labels of each row; None: nothing tells."""
    said = measurements.absolute
    if said is None:
        return measurements.displacement, []
    x = said.channels.position
    if x is None:
        return None, []
    steps = x[np.isfinite(x)] / COARSE
    if (np.abs(steps - np.round(steps)) < 1e-4).all():
        return None, []
    kinds = (kind for kind in said.channels.present if kind != "position")
    others = [getattr(said.channels, kind).reshape(len(x), -1) for kind in kinds]
    labels = [each for each in (said.markers, said.series, said.stations) if each is not None]
    return np.column_stack([x, said.payload, *others]), labels


def without_copies(measurements: Measurements) -> tuple[Measurements, str | None]:
    """The readings with copied rows masked, and the sentence that says so."""
    copies = repeated_rows(measurements)
    if not len(copies):
        return measurements, None
    use = measurements.use.copy()
    use[copies] = False
    every = list(dict.fromkeys(str(measurements.line[row]) for row in copies))
    lines, more = every[:5], " …" if len(every) > 5 else ""
    said = (
        f"{len(copies)} rows repeat earlier ones to the last digit "
        f"(lines {', '.join(lines)}{more}). Copies show no noise, so they are masked here."
        if len(copies) > 1
        else f"One row repeats an earlier one to the last digit (line {lines[0]}). A copy shows no "
        "noise, so it is masked here."
    )
    return replace(measurements, use=use), said
