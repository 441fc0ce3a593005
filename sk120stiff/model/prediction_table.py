"""What a model says of every row of measurements, as the table that is written to a file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from sk120stiff.effects import LoadCases
from sk120stiff.errors import Refusal, warn
from sk120stiff.measurements import Measurements
from sk120stiff.model.holding import held_loads
from sk120stiff.model.model import Model
from sk120stiff.model.predicted import Predicted, predict_with_uncertainty

AXES = "xyz"
UNHELD = "no static equilibrium: the springs cannot hold this load"


def predict_what_holds(model: Model, load_cases: LoadCases) -> Predicted:
    """Predictions ± uncertainty; NaN, with a warning, where no equilibrium exists.

    Raises:
        Refusal: None of the loads can be held.
    """
    try:
        return predict_with_uncertainty(model, load_cases)
    except Refusal:
        held = held_loads(model, load_cases)
        if not held.any():
            raise
    warn(
        f"{int((~held).sum())} of {len(held)} loads are beyond what the springs can hold; their "
        "rows are left empty and say so."
    )
    return predict_with_uncertainty(model, load_cases.rows(held)).among(held)


Columns = dict[str, list[object]]


def rows_of(columns: Mapping[str, Iterable[object]]) -> list[dict[str, object]]:
    """The rows of a table, each a mapping from header to cell."""
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def prediction_table(readings: Measurements, predicted: Predicted) -> Columns:
    """One row per reading: pose, prediction ± its uncertainty, measurement and gap if any [mm, µm].

    Header → cells.

    A column `reason` says why a prediction is missing, `std_reason` why an uncertainty is unknown,
    if any is.
    """
    columns: dict[str, object] = {"pose": list(readings.pose)}
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
    reasons = unknown_reasons(predicted)
    if any(reasons):
        columns["std_reason"] = reasons
    return {name: np.asarray(cells, dtype=object).tolist() for name, cells in columns.items()}


def unknown_reasons(predicted: Predicted) -> list[str]:
    """Why the uncertainty of each row is unknown; empty where it is known."""
    return [blame_reason(names) for names in predicted.blame]


def blame_reason(names: tuple[str, ...]) -> str:
    """Why a ± is unknown; empty if it is not."""
    if not names:
        return ""
    return f"depends on {', '.join(names)}, of which the readings of the fit do not show enough"
