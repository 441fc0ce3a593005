"""An explanation as files: verdict, model, gaps and the poses to measure next."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.effects import load_cases_of
from sk120stiff.errors import ToolkitWarning
from sk120stiff.explain.answer.verdict import BEST_GUESS, NEXT_POSES, VERDICT, Verdict
from sk120stiff.files import csv_text, together, write_atomically
from sk120stiff.files.json_text import as_json_text
from sk120stiff.identify import known_model
from sk120stiff.measurements import Measurements, write_measurements
from sk120stiff.measurements.directions import in_the_frame
from sk120stiff.measurements.poses import labels_to_come
from sk120stiff.model import Model, write_model
from sk120stiff.model.predicted import predict_what_holds, prediction_table

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation

RESULTS = (
    VERDICT,
    "model.yaml",
    BEST_GUESS,
    "gaps.csv",
    NEXT_POSES,
    "next_poses.yaml",
    "report.html",
    "scene.html",
)


def save(
    answer: Explanation,
    folder: str | os.PathLike[str],
    *,
    provenance: Mapping[str, str] | None = None,
) -> dict[str, object]:
    """Write what was found, all in one moment; see `Explanation.save`.

    The model's file tells in any case which readings it is of: offsets of their zeros are theirs.
    """
    out, digest = Path(folder), answer.readings.data_hash
    own = {"data_hash": f"sha256:{digest}"} if digest else {}
    verdict = answer.document()
    fitted = replace(
        known_model(answer.final, answer.remainder.left), provenance=own | dict(provenance or {})
    )
    gaps = _gaps(fitted, answer.readings)
    with replacing_results(out):
        write_model(fitted, out / "model.yaml")
        if gaps is not None:
            write_atomically(out / "gaps.csv", gaps)
        if answer.guess is not None:
            guess = replace(known_model(answer.guess), provenance=fitted.provenance)
            write_model(guess, out / BEST_GUESS)
        if answer.next_poses is not None:
            write_measurements(plan_of(answer, answer.readings), out / NEXT_POSES)
        return write_verdict(verdict, out)


def write_verdict(verdict: Verdict, out: Path) -> dict[str, object]:
    """Write `verdict.json`; its content."""
    keys = verdict.as_keys()
    write_atomically(out / VERDICT, as_json_text(keys) + "\n")
    return keys


def replacing_results(out: Path) -> AbstractContextManager[None]:
    """Let what is written inside replace the results of an earlier run, all in one moment.

    An old verdict never stands beside new files, nor old proposals and pages beside a new one; and
    until all is written, the earlier results stay.
    """
    return together(stale=[out / name for name in RESULTS], last=out / VERDICT)


def _gaps(fitted: Model, readings: Measurements) -> str | None:
    """Prediction and gap of every row; None, with a warning, where there is none."""
    try:
        load_cases = load_cases_of(fitted.robot, in_the_frame(readings))
        predicted = predict_what_holds(fitted, load_cases)
        return csv_text(prediction_table(readings, predicted).items())
    except Exception as error:  # noqa: BLE001  (an answer is never lost to its table)
        warnings.warn(
            f"The page gaps.csv could not be made ({type(error).__name__}: {error}). Everything "
            "else is as it should be.",
            ToolkitWarning,
            stacklevel=3,
        )
        return None


def plan_of(answer: Explanation, readings: Measurements) -> Measurements:
    """The poses and loads to measure next, as measurements without displacements."""
    if answer.next_poses is None:
        raise ValueError("there is nothing to measure next")
    a, wrench = answer.next_poses
    return Measurements(
        pose=labels_to_come(readings.pose, len(a)),
        joint_names=readings.joint_names,
        joint_kinds=readings.joint_kinds,
        joints=np.asarray(a),
        wrench=np.asarray(wrench),
        displacement=None,
        robot=readings.robot,
        base_frame=readings.base_frame,
        tool_frame=readings.tool_frame,
        point=readings.point,
        force_point=readings.force_point,
        zero=readings.zero,
        noise=readings.noise,
        source=" ".join(
            [
                "Poses and loads that tell the named alternatives apart.",
                *answer.details.get("next_remarks", ()),
            ]
        ),
    )
