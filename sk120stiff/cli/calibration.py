"""What `identify` answers where readings say where markers stand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.identify_rows import parameter_rows
from sk120stiff.cli.opening import provenance
from sk120stiff.cli.tables import table
from sk120stiff.errors import InputError, listed
from sk120stiff.identify.absolute.calibrate import Calibration, calibrate, with_model_form
from sk120stiff.identify.absolute.remainder import remainder_entry, remainder_sentences
from sk120stiff.identify.absolute.weighing import pounds
from sk120stiff.identify.absolute.words import (
    angle_gap,
    findings,
    gap_sentence,
    known_calibration,
    unseen,
)
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, write_model


def refuse_unused(data: Path, given: Mapping[str, object]) -> None:
    """Refuse options that do nothing for positions, rather than pass them over.

    Raises:
        InputError: One of them was given.
    """
    unused = [name for name, value in given.items() if value]
    if unused:
        raise InputError(
            f"{listed(unused)} {'is' if len(unused) == 1 else 'are'} for displacements, and these "
            "readings are positions",
            where=str(data),
            remedy="Leave it out." if len(unused) == 1 else "Leave them out.",
        )


def calibration_answer(
    model: Model,
    readings: Measurements,
    data: Path,
    fix: Sequence[str],
    out: Path | None,
    *,
    waves: bool = True,
) -> Answer:
    """Geometry, springs and what cannot be told, as JSON and for people."""
    found = with_model_form(calibrate(model, readings, freedom=tuple(fix), waves=waves))
    found = replace(found, notes=(*found.notes, *pounds(found)))
    fit = found.fit
    if out is not None:
        write_model(replace(known_calibration(found), provenance=provenance(data, readings)), out)
    reasons, angles = unseen(found), angle_gap(found)
    stated = found.problem.stated_sigma if len(found.problem.lengths) else None
    document = {
        "robot": model.robot.name,
        "parameters": parameter_rows(fit, unseen=reasons),
        "rms_um": fit.rms * 1e6 if len(found.problem.lengths) else None,
        "rms_urad": float(np.sqrt(np.mean(angles**2)) * 1e6) if len(angles) else None,
        "mean_distance_um": _mean(found),
        "placed_rms_um": None if found.placed is None else found.placed.rms * 1e6,
        "sigma_um": None if stated is None else stated * 1e6,
        "sigma_stated": fit.sigma_known,
        "chi_square": fit.chi_square,
        "degrees_of_freedom": fit.degrees_of_freedom,
        "inflated": fit.noise_factor if fit.exceeds else None,
        "condition": fit.condition,
        "weak_directions": [item.sentence() for item in found.frozen],
        "frozen": [item.name for item in found.frozen],
        "still_joints": list(found.still),
        "set_aside": [
            {"pose": readings.pose[row], "line": int(readings.line[row])}
            for row in found.wild.nonzero()[0]
        ],
        "waves": list(found.waves),
        "remainder": remainder_entry(found),
        "noise": gap_sentence(found),
        "notes": list(found.notes),
        "iterations": fit.iterations,
        "model": out,
    }
    parts: list[object] = [_table(found), *findings(found, readings), *remainder_sentences(found)]
    if fit.exceeds:
        parts.append("What is missing is what 'sk120stiff explain' looks for.")
    if out is not None:
        parts.append(f"Written to {out}.")
    return Answer(document, parts)


def _mean(found: Calibration) -> float | None:
    distances = found.distances
    return float(distances.mean() * 1e6) if len(distances) else None


def _table(found: Calibration) -> object:
    fit = found.fit
    known = fit.identifiable
    rows: list[tuple[object, ...]] = []
    for k, (p, (low, high)) in enumerate(zip(fit.parameters, fit.intervals(), strict=True)):
        if not known[k]:
            rows.append((p.name, "not identifiable", "", "", "", p.spec.unit))
            continue
        std = "on its bound" if p.std is None else p.std
        rows.append((p.name, p.value, std, low, high, p.spec.unit))
    return table("Parameters", ["name", "value", "± std", "95 % from", "to", "unit"], rows)
