"""`sk120stiff identify DATA`."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from typing import Annotated

import numpy as np
import typer

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_data, provenance, start_model
from sk120stiff.cli.options import DataArgument, ModelOption, OutOption
from sk120stiff.cli.tables import table
from sk120stiff.identify import Fit, fit, weak_directions
from sk120stiff.model import write_model


class Method(StrEnum):
    """The two least-squares algorithms."""

    trf = "trf"
    lm = "lm"


def command(
    data: DataArgument,
    model: ModelOption = None,
    method: Annotated[
        Method, typer.Option(help="Trust-region-reflective, or Levenberg-Marquardt.")
    ] = Method.trf,
    out: OutOption = None,
) -> Answer:
    """Spring values and their uncertainty from measured deflections.

    Example: sk120stiff identify robots/motoman_sk120/data/table2_measured.csv --out model.yaml
    """
    readings, robot = open_data(data)
    found = fit(start_model(robot, model), readings, method=method.value)
    if out is not None:
        write_model(replace(found.model, provenance=provenance(data, readings)), out)
    weak = weak_directions(found)
    document = {
        "robot": robot.name,
        "parameters": parameter_rows(found),
        "rms_um": found.rms * 1e6,
        "sigma_um": found.sigma * 1e6,
        "sigma_stated": found.sigma_stated,
        "chi_square": found.chi_square,
        "degrees_of_freedom": found.degrees_of_freedom,
        "lack_of_fit_probability": found.lack_of_fit,
        "condition": found.condition,
        "correlation": found.correlation,
        "weak_directions": list(weak),
        "noise": found.problem.noise.describe(),
        "iterations": found.iterations,
        "method": method.value,
        "model": out,
    }
    return Answer(document, _parts(found, weak))


def parameter_rows(found: Fit) -> list[dict[str, object]]:
    """The estimated parameters as the JSON of several commands states them."""
    return [
        {
            "name": p.name,
            "value": p.public_value,
            "std": p.public_std,
            "unit": p.spec.unit,
            "at_bound": bool(held),
        }
        for p, held in zip(found.parameters, found.at_bound, strict=True)
    ]


def _parts(found: Fit, weak: tuple[str, ...]) -> list[object]:
    rows = []
    for p, start in zip(found.parameters, found.problem.start * found.problem.scale, strict=True):
        std = p.public_std
        share = "" if std is None or not np.isfinite(std) else f"{100 * std / p.public_value:.1f} %"
        error = "on its bound" if std is None else f"{std:.3g}"
        rows.append((p.name, p.public_value, error, share, p.spec.unit, p.spec.public(start)))
    size = "stated" if found.sigma_stated else "estimated"
    lines = [
        f"Gap {found.rms * 1e6:.1f} µm rms per axis over {len(found.gap)} readings; noise of one "
        f"reading {found.sigma * 1e6:.1f} µm ({size}); condition {found.condition:.3g}.",
        found.problem.noise.describe(),
    ]
    if found.lack_of_fit is not None:
        verdict = "agree within the noise" if found.lack_of_fit > 0.01 else "do not agree"
        lines.append(
            f"Model and data {verdict}: χ² = {found.chi_square:.1f} on "
            f"{found.degrees_of_freedom} degrees of freedom, p = {found.lack_of_fit:.2g}."
        )
    columns = ["parameter", "value", "std. error", "", "unit", "start"]
    return [table("Identified", columns, rows), *lines, *weak]
