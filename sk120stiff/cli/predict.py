"""`sk120stiff predict MODEL DATA`."""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence

import numpy as np
import pandas as pd

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import model_for, open_data
from sk120stiff.cli.options import DataArgument, ModelArgument, OutOption
from sk120stiff.cli.tables import table
from sk120stiff.cli.uncertainty import blame_reason, plus_minus, sentences, uncertainty_keys
from sk120stiff.effects import Situation, situation_of
from sk120stiff.errors import Refusal, ToolkitWarning
from sk120stiff.files import guarded_cell, will_write, write_atomically
from sk120stiff.measurements import Measurements
from sk120stiff.model import (
    Model,
    Predicted,
    held_loads,
    predict_with_uncertainty,
    warn_of_far_bend,
)
from sk120stiff.robot.coupling import Array
from sk120stiff.slips import look

AXES = "xyz"
UNHELD = "no static equilibrium: the springs cannot hold this load"
LISTED = 40  # rows that people are shown


def command(model: ModelArgument, data: DataArgument, out: OutOption = None) -> Answer:
    """Predicted displacement of every reading ± error, and the gap.

    The uncertainty is that of the deflection, from a model that 'identify' or 'explain' wrote: of
    its parameters, and of what it leaves unexplained. The noise of a reading comes on top.

    Example: sk120stiff predict model.yaml robots/motoman_sk120/data/table2_measured.csv
    """
    will_write(out)
    readings, robot = open_data(data)
    believed = model_for(robot, model)
    for said in look(believed, readings).sentences:
        warnings.warn(said, ToolkitWarning, stacklevel=2)
    predicted = predict_what_holds(believed, situation_of(robot, readings))
    frame = prediction_table(readings, predicted)
    if out is not None:
        write_atomically(out, csv_text(frame))
    measured = readings.displacement
    per_pose: list[dict[str, object]] = []
    rms: float | None = None
    used = readings.use & np.isfinite(predicted.displacement).all(axis=1)
    if measured is not None and used.any():
        gap = measured - predicted.displacement
        rms = _rms(gap[used])
        for label in readings.poses:
            rows = np.intersect1d(readings.rows_of(label), np.flatnonzero(used))
            if len(rows):
                per_pose.append({"pose": label, "rms_um": _rms(gap[rows])})
    document = {
        "rows": frame.to_dict(orient="records"),
        "rms_um": rms,
        "per_pose": per_pose,
        "uncertainty": uncertainty_keys(believed),
        "out": out,
    }
    parts = _parts(predicted, readings, rms, per_pose, int(used.sum()))
    parts += sentences(believed, predicted.std_parameters, predicted.std_remainder)
    warn_of_far_bend(believed, predicted.displacement)
    lost = [reason for reason in _reasons(predicted) if reason]
    if lost:
        parts.append(f"{len(lost)} of {len(frame)} rows have no known uncertainty: {lost[0]}.")
    return Answer(document, parts)


def predict_what_holds(model: Model, situation: Situation) -> Predicted:
    """Predictions ± uncertainty; NaN, with a warning, where no equilibrium exists.

    Raises
    ------
    Refusal
        None of the loads can be held.
    """
    try:
        return predict_with_uncertainty(model, situation)
    except Refusal:
        held = held_loads(model, situation)
        if not held.any():
            raise
    warnings.warn(
        f"{int((~held).sum())} of {len(held)} loads are beyond what the springs can hold; their "
        "rows are left empty and say so.",
        ToolkitWarning,
        stacklevel=2,
    )
    return predict_with_uncertainty(model, situation.rows(held)).among(held)


def prediction_table(readings: Measurements, predicted: Predicted) -> pd.DataFrame:
    """One row per reading: pose, prediction ± its uncertainty, measurement and gap if any [mm, µm].

    A column `reason` says why a prediction is missing, `std_reason` why an uncertainty is unknown,
    if any is.
    """
    columns: dict[str, object] = {"pose": readings.pose}
    for k, axis in enumerate(AXES):
        columns[f"predicted_d{axis}[mm]"] = predicted.displacement[:, k] * 1e3
    for name, std in (
        ("parameters", predicted.std_parameters),
        ("remainder", predicted.std_remainder),
    ):
        if std is not None:
            told = np.where(np.isfinite(std), std, np.nan) * 1e6
            columns |= {f"std_{name}_{axis}[um]": told[:, k] for k, axis in enumerate(AXES)}
    if readings.displacement is not None:
        gap = readings.displacement - predicted.displacement
        for k, axis in enumerate(AXES):
            columns[f"d{axis}[mm]"] = readings.displacement[:, k] * 1e3
        for k, axis in enumerate(AXES):
            columns[f"gap_{axis}[um]"] = gap[:, k] * 1e6
    columns["use"] = readings.use.astype(int)
    missing = ~np.isfinite(predicted.displacement).all(axis=1)
    if missing.any():
        columns["reason"] = np.where(missing, UNHELD, "")
    reasons = _reasons(predicted)
    if any(reasons):
        columns["std_reason"] = reasons
    return pd.DataFrame(columns)


def _reasons(predicted: Predicted) -> list[str]:
    return [blame_reason(names) for names in predicted.blame]


def csv_text(frame: pd.DataFrame) -> str:
    """The table as CSV; labels that a spreadsheet would take for formulas are written as text."""
    text = io.StringIO()
    frame.assign(pose=[guarded_cell(label) for label in frame["pose"]]).to_csv(text, index=False)
    return text.getvalue()


def _rms(gap: Array) -> float:
    return float(np.sqrt(np.mean(gap**2)) * 1e6)


def _parts(
    predicted: Predicted,
    readings: Measurements,
    rms: float | None,
    per_pose: Sequence[dict[str, object]],
    used: int,
) -> list[object]:
    if rms is None:
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
        f"Gap over {used} readings: {rms:.2f} µm rms per axis.",
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
