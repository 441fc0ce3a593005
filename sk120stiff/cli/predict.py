"""`sk120stiff predict MODEL DATA`."""

from __future__ import annotations

import io

import numpy as np
import pandas as pd

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_data, start_model
from sk120stiff.cli.options import DataArgument, ModelArgument, OutOption
from sk120stiff.cli.tables import table
from sk120stiff.effects import situation_of
from sk120stiff.files import write_atomically
from sk120stiff.measurements import Measurements
from sk120stiff.robot.coupling import Array

AXES = "xyz"


def command(model: ModelArgument, data: DataArgument, out: OutOption = None) -> Answer:
    """Predicted displacement of every reading, and the gap to it.

    Example: sk120stiff predict model.yaml robots/motoman_sk120/data/table2_measured.csv
    """
    readings, robot = open_data(data)
    predicted = start_model(robot, model).predict(situation_of(robot, readings))
    frame = prediction_table(readings, predicted)
    if out is not None:
        text = io.StringIO()
        frame.to_csv(text, index=False)
        write_atomically(out, text.getvalue())
    measured = readings.displacement
    per_pose: list[dict[str, object]] = []
    rms: float | None = None
    if measured is not None:
        used = readings.use
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
    return Answer(document, _parts(frame, rms, per_pose, len(predicted)))


def prediction_table(readings: Measurements, predicted: Array) -> pd.DataFrame:
    """One row per reading: pose, prediction, and measurement and gap where there is one [mm, µm]."""
    columns: dict[str, object] = {"pose": readings.pose}
    for k, axis in enumerate(AXES):
        columns[f"predicted_d{axis}[mm]"] = predicted[:, k] * 1e3
    if readings.displacement is not None:
        for k, axis in enumerate(AXES):
            columns[f"d{axis}[mm]"] = readings.displacement[:, k] * 1e3
        for k, axis in enumerate(AXES):
            columns[f"gap_{axis}[um]"] = (readings.displacement - predicted)[:, k] * 1e6
    columns["use"] = readings.use.astype(int)
    return pd.DataFrame(columns)


def _rms(gap: Array) -> float:
    return float(np.sqrt(np.mean(gap**2)) * 1e6)


def _parts(
    frame: pd.DataFrame, rms: float | None, per_pose: list[dict[str, object]], count: int
) -> list[object]:
    if rms is None:
        shown = frame.head(40)
        parts: list[object] = [table("Predicted", list(shown.columns), shown.values.tolist())]
        if count > len(shown):
            parts.append(f"... {count - len(shown)} more rows; write them all with --out FILE.")
        return parts
    rows = [(item["pose"], item["rms_um"]) for item in per_pose]
    return [
        table("Gap per pose", ["pose", "µm rms per axis"], rows),
        f"Gap over {count} readings: {rms:.2f} µm rms per axis.",
    ]
