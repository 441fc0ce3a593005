"""What `identify` answers where readings say where markers stand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.identify_rows import parameter_rows
from sk120stiff.cli.opening import provenance
from sk120stiff.cli.tables import table
from sk120stiff.errors import to_one_place
from sk120stiff.identify import Calibration, known_model
from sk120stiff.identify.positions.residuals.remainder import remainder_entry, remainder_sentences
from sk120stiff.identify.positions.words import (
    angle_gap,
    findings,
    gap_sentence,
    missing_sentences,
    unseen,
)
from sk120stiff.identify.uncertainty.parts import mostly_parts
from sk120stiff.measurements import Measurements
from sk120stiff.model import write_model


def calibration_answer(
    found: Calibration, readings: Measurements, data: Path, out: Path | None
) -> Answer:
    """Geometry, springs and what cannot be told, as JSON and for people."""
    if out is not None:
        write_model(replace(known_model(found), provenance=provenance(data, readings)), out)
    reasons, angles = unseen(found), angle_gap(found)
    stated = found.problem.stated_sigma if len(found.problem.lengths) else None
    document = {
        "robot": found.model.robot.name,
        "parameters": parameter_rows(found, unseen=reasons),
        "rms_um": found.rms * 1e6 if len(found.problem.lengths) else None,
        "rms_urad": rms(angles) * 1e6 if len(angles) else None,
        "mean_distance_um": _mean(found),
        "placed_rms_um": None if found.placed is None else found.placed.rms * 1e6,
        "sigma_um": None if stated is None else stated * 1e6,
        "sigma_stated": found.sigma_known,
        "chi_square": found.chi_square,
        "degrees_of_freedom": found.degrees_of_freedom,
        "inflated": found.noise_factor if found.exceeds else None,
        "condition": found.condition,
        "weak_directions": [item.sentence() for item in found.frozen],
        "frozen": [item.name for item in found.frozen],
        "still_joints": list(found.still),
        "set_aside": [
            {"pose": readings.pose[row], "line": int(readings.line[row])}
            for row in found.wild.nonzero()[0]
        ],
        "waves": list(found.waves),
        "lacks": list(found.lacks),
        "remainder": remainder_entry(found),
        "noise": gap_sentence(found),
        "notes": [*found.notes, *mostly_parts(found)],
        "iterations": found.iterations,
        "model": out,
    }
    parts: list[object] = [_table(found), *findings(found, readings), *remainder_sentences(found)]
    parts += missing_sentences(found)
    if out is not None:
        parts.append(f"Written to {out}.")
    return Answer(document, parts)


def _mean(found: Calibration) -> float | None:
    distances = found.distances
    return float(distances.mean() * 1e6) if len(distances) else None


def _table(found: Calibration) -> object:
    known = found.identifiable
    rows: list[tuple[object, ...]] = []
    for k, (p, (low, high)) in enumerate(zip(found.parameters, found.intervals(), strict=True)):
        if not known[k]:
            rows.append((p.name, "not identifiable", "", "", "", p.spec.unit))
            continue
        value, *ends, error = to_one_place(p.std or np.nan, p.value, low, high)
        rows.append((p.name, value, "on its bound" if p.std is None else error, *ends, p.spec.unit))
    return table("Parameters", ["name", "value", "± std", "95 % from", "to", "unit"], rows)
