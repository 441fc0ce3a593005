"""`sk120stiff predict MODEL DATA`."""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence

import numpy as np
import pandas as pd

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_data, start_model
from sk120stiff.cli.options import DataArgument, ModelArgument, OutOption
from sk120stiff.cli.tables import table
from sk120stiff.effects import Situation, situation_of
from sk120stiff.errors import Refusal, ToolkitWarning
from sk120stiff.files import write_atomically
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, held_loads
from sk120stiff.robot.coupling import Array

AXES = "xyz"
UNHELD = "no static equilibrium: the springs cannot hold this load"


def command(model: ModelArgument, data: DataArgument, out: OutOption = None) -> Answer:
    """Predicted displacement of every reading, and the gap to it.

    Example: sk120stiff predict model.yaml robots/motoman_sk120/data/table2_measured.csv
    """
    readings, robot = open_data(data)
    predicted = predict_what_holds(start_model(robot, model), situation_of(robot, readings))
    frame = prediction_table(readings, predicted)
    if out is not None:
        text = io.StringIO()
        frame.to_csv(text, index=False)
        write_atomically(out, text.getvalue())
    measured = readings.displacement
    per_pose: list[dict[str, object]] = []
    rms: float | None = None
    used = readings.use & np.isfinite(predicted).all(axis=1)
    if measured is not None and used.any():
        gap = measured - predicted
        rms = _rms(gap[used])
        for label in readings.poses:
            rows = np.intersect1d(readings.rows_of(label), np.flatnonzero(used))
            if len(rows):
                per_pose.append({"pose": label, "rms_um": _rms(gap[rows])})
    document = {
        "rows": frame.to_dict(orient="records"),
        "rms_um": rms,
        "per_pose": per_pose,
        "out": out,
    }
    return Answer(document, _parts(frame, rms, per_pose, int(used.sum())))


def predict_what_holds(model: Model, situation: Situation) -> Array:
    """(N, 3) predicted displacements [m]; NaN, with a warning, where no equilibrium exists.

    Raises
    ------
    Refusal
        None of the loads can be held.
    """
    try:
        return model.predict(situation)
    except Refusal:
        held = held_loads(model, situation)
        if not held.any():
            raise
    predicted = np.full((situation.count, 3), np.nan)
    predicted[held] = model.predict(situation.rows(held))
    warnings.warn(
        f"{int((~held).sum())} of {len(held)} loads are beyond what the springs can hold; their "
        "rows are left empty and say so.",
        ToolkitWarning,
        stacklevel=2,
    )
    return predicted


def prediction_table(readings: Measurements, predicted: Array) -> pd.DataFrame:
    """One row per reading: pose, prediction, and measurement and gap where there is one [mm, µm].

    A column `reason` says why a prediction is missing, if any is.
    """
    columns: dict[str, object] = {"pose": readings.pose}
    for k, axis in enumerate(AXES):
        columns[f"predicted_d{axis}[mm]"] = predicted[:, k] * 1e3
    if readings.displacement is not None:
        for k, axis in enumerate(AXES):
            columns[f"d{axis}[mm]"] = readings.displacement[:, k] * 1e3
        for k, axis in enumerate(AXES):
            columns[f"gap_{axis}[um]"] = (readings.displacement - predicted)[:, k] * 1e6
    columns["use"] = readings.use.astype(int)
    missing = ~np.isfinite(predicted).all(axis=1)
    if missing.any():
        columns["reason"] = np.where(missing, UNHELD, "")
    return pd.DataFrame(columns)


def _rms(gap: Array) -> float:
    return float(np.sqrt(np.mean(gap**2)) * 1e6)


def _parts(
    frame: pd.DataFrame, rms: float | None, per_pose: Sequence[dict[str, object]], used: int
) -> list[object]:
    if rms is None:
        shown = frame.head(40)
        parts: list[object] = [table("Predicted", list(shown.columns), shown.values.tolist())]
        if len(frame) > len(shown):
            parts.append(f"... {len(frame) - len(shown)} more rows; write them with --out FILE.")
        return parts
    rows = [(item["pose"], item["rms_um"]) for item in per_pose]
    return [
        table("Gap per pose", ["pose", "µm rms per axis"], rows),
        f"Gap over {used} readings: {rms:.2f} µm rms per axis.",
    ]
