"""`sk120stiff predict MODEL DATA`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array, Mask, rms
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import model_for, open_data
from sk120stiff.cli.options import DataArgument, ModelArgument, OutOption
from sk120stiff.cli.path_words import FAR_OFF
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.cli.uncertainty import plus_minus, sentences, uncertainty_keys
from sk120stiff.data_checks import look
from sk120stiff.errors import listed, warn
from sk120stiff.files import csv_text, will_write, write_atomically
from sk120stiff.identify.positions.checks.reregistration import placed_anew
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, Predicted, marker_off, predict, warn_of_far_bend
from sk120stiff.model.predicted import (
    predict_what_holds,
    prediction_table,
    rows_of,
    seen_by,
    unknown_reasons,
)

SINGLE = (  # columns of single numbers, what read them, and in what unit
    ("gap_d[um]", "gauges", "um"),
    ("gap_l[um]", "wires", "um"),
    ("gap_inc[urad]", "levels", "urad"),
)
LISTED = 40  # rows that people are shown
TOLD = 6  # rows far off all others that are told one by one
FAR = 10.0  # times the median distance off, beyond which a row is told apart


def command(model: ModelArgument, data: DataArgument, out: OutOption = None) -> Answer:
    """Predicted displacement of every reading ± error, and the gap.

    The uncertainty is that of the deflection, from a model that 'identify' or 'explain' wrote: of
    its parameters, and of what it leaves unexplained. The noise of a reading comes on top.

    Example: sk120stiff predict model.yaml robots/motoman_sk120/data/table2_measured.csv
    """
    will_write(out)
    readings, robot = open_data(data)
    believed = model_for(robot, model)
    if readings.absolute is not None:
        return _positions(believed, readings, out)
    for said in look(believed, readings).sentences:
        warn(said)
    with progress_bar("predict"):
        predicted = predict_what_holds(believed, seen_by(believed, readings))
    columns = prediction_table(readings, predicted)
    if out is not None:
        write_atomically(out, csv_text(columns.items()))
    gap = predicted.gap(readings)
    per_pose: list[dict[str, object]] = []
    left: float | None = None
    told: Mask = np.isfinite(gap) & readings.use[:, None]
    used: Mask = np.asarray(told.any(axis=1))
    if used.any():
        left = 1e6 * rms(gap[told])
        for label in readings.poses:
            rows = readings.rows_of(label)
            if used[rows].any():
                per_pose.append({"pose": label, "rms_um": 1e6 * rms(gap[rows][told[rows]])})
    document = {
        "rows": rows_of(columns),
        "rms_um": left,
        "per_pose": per_pose,
        "uncertainty": uncertainty_keys(believed),
        "out": out,
    }
    parts = _parts(predicted, readings, left, per_pose, int(used.sum()))
    parts += sentences(believed, predicted.std_parameters, predicted.std_remainder)
    off = marker_off(believed)
    if off >= FAR_OFF:
        parts.append(
            f"The point is taken {1e3 * off:.4g} mm off its stated place, where the marker of the "
            "calibration sat (tool_offset); of another point, take that effect out of the model."
        )
    warn_of_far_bend(believed, predicted.displacement)
    lost = [reason for reason in unknown_reasons(predicted) if reason]
    if lost:
        count = f"{len(lost)} of {readings.n_readings} rows"
        parts.append(f"{count} have no known uncertainty: {lost[0]}.")
    return Answer(document, parts)


def _positions(model: Model, readings: Measurements, out: Path | None) -> Answer:
    """Where a model has the marker at every reading, and how far the readings are off."""
    if readings.absolute is not None and readings.absolute.channels.displacement is not None:
        for said in look(model, readings).sentences:
            warn(said)
    moved = placed_anew(model, readings)
    model, readings = (model, readings) if moved is None else (moved.model, moved.readings)
    predicted = predict(model, readings)
    columns = prediction_table(readings, predicted)
    if out is not None:
        write_atomically(out, csv_text(columns.items()))
    document: dict[str, object] = {
        "rows": rows_of(columns),
        "uncertainty": uncertainty_keys(model),
        "placed_anew": None if moved is None else moved.sentence(),
        "out": out,
    }
    parts: list[object] = [] if moved is None else [moved.sentence()]
    sizes: dict[str, list[Array]] = {"um": [], "urad": []}
    for column, what, unit in SINGLE:
        read = np.array(columns.get(column, []), dtype=float)
        read = read[readings.use & np.isfinite(read)] if read.size else read
        if read.size:
            sizes[unit].append(read)
            shown = unit.replace("u", "µ", 1)
            parts.append(f"Gap over {len(read)} readings of {what}: {rms(read):.4g} {shown} rms.")
    gap = 1e6 * predicted.gap(readings)
    rows = np.flatnonzero(readings.use & np.isfinite(gap).all(axis=1))
    gap = gap[rows]
    if len(gap):
        left, far = rms(gap), float(np.linalg.norm(gap, axis=1).mean())
        sizes["um"].append(gap.ravel())
        document["mean_distance_um"] = far
        of = "positions" if predicted.position is not None else "displacements"
        parts.append(
            f"Gap over {len(gap)} {of}: {left:.4g} µm rms per axis, {far:.4g} µm mean distance."
        )
        lengths = np.linalg.norm(gap, axis=1)
        off = lengths > FAR * np.median(lengths)
        document["far_off"] = [
            {"pose": readings.pose[k], "line": int(readings.line[k])} for k in rows[off]
        ]
        if off.any():
            document["rms_without_um"] = rms(gap[~off])
            lines = [f"line {readings.line[k]} (pose {readings.pose[k]})" for k in rows[off]]
            parts.append(
                f"More than {FAR:g} times the median distance off: {listed(lines, most=TOLD)}. "
                f"Without that {rms(gap[~off]):.4g} µm rms per axis."
            )
    of = "r" if "gap_rx[urad]" in columns else "dr"
    turns = np.array([columns.get(f"gap_{of}{axis}[urad]", []) for axis in "xyz"], dtype=float).T
    turns = turns[readings.use & np.isfinite(turns).all(axis=1)] if turns.size else turns
    if turns.size:
        sizes["urad"].append(turns.ravel())
        parts.append(f"Gap over {len(turns)} rotations: {rms(turns):.4g} µrad rms per axis.")
    document |= {f"rms_{unit}": rms(np.concatenate(own)) for unit, own in sizes.items() if own}
    ways = predicted.std_parameters, predicted.std_remainder
    what = "a position" if predicted.position is not None else "a displacement"
    parts += sentences(model, *ways, what=what)
    if out is not None:
        parts.append(f"Written to {out}.")
    return Answer(document, parts)


def _parts(
    predicted: Predicted,
    readings: Measurements,
    left: float | None,
    per_pose: Sequence[dict[str, object]],
    used: int,
) -> list[object]:
    if left is None:
        shown = [
            (readings.pose[k], *cells)
            for k, cells in enumerate(_cells(predicted, min(LISTED, readings.n_readings)))
        ]
        parts: list[object] = [table("Predicted [µm]", ["pose", "dx", "dy", "dz"], shown)]
        if readings.n_readings > len(shown):
            more = readings.n_readings - len(shown)
            parts.append(f"... {more} more rows; write them with --out FILE.")
        return parts
    rows = [(item["pose"], item["rms_um"]) for item in per_pose]
    return [
        table("Gap per pose", ["pose", "µm rms per axis"], rows),
        f"Gap over {used} readings: {left:.2f} µm rms per axis.",
    ]


def _cells(predicted: Predicted, count: int) -> list[list[str]]:
    """Values ± standard deviations [µm] of the first readings."""
    values, std = predicted.displacement * 1e6, predicted.std
    if std is None:
        return [[f"{x + 0.0:.5g}" for x in row] for row in values[:count]]
    return [
        [plus_minus(x, s) for x, s in zip(row, own, strict=True)]
        for row, own in zip(values[:count], std[:count] * 1e6, strict=True)
    ]
