"""`sk120stiff explain DATA --out DIR`."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.cli.document import as_json_text
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_data, provenance, start_model
from sk120stiff.cli.options import DataArgument, ModelOption, SeedOption
from sk120stiff.cli.predict import prediction_table
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.effects import situation_of
from sk120stiff.explain import Explanation, Options, explain, verdict_document
from sk120stiff.files import write_atomically
from sk120stiff.measurements import Measurements, write_measurements
from sk120stiff.model import write_model



def command(
    data: DataArgument,
    out: Annotated[
        Path,
        typer.Option("--out", metavar="DIR", help="Folder for the results.", show_default=False),
    ],
    model: ModelOption = None,
    holdout: Annotated[
        Path | None,
        typer.Option(metavar="CSV", help="Readings of other poses, kept out of every fit."),
    ] = None,
    exclude: Annotated[
        list[str] | None,
        typer.Option(metavar="EFFECT", help="Leave out this effect, 'name' or 'name:where'."),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="EFFECT", help="Consider this effect only (may be repeated)."),
    ] = None,
    assume: Annotated[
        list[str] | None,
        typer.Option(metavar="EFFECT", help="Put this effect into the model from the start."),
    ] = None,
    max_effects: Annotated[int, typer.Option(min=0, max=8, help="Name no more than this.")] = 4,
    seed: SeedOption = 0,
) -> Answer:
    """What is missing when simulation and measurement disagree.

    Finds where the gap lives, names the missing effect, adds it to the model and shows the gap
    shrink. Writes model.yaml, verdict.json, gaps.csv and, where two names cannot be told apart,
    next_poses.csv.

    Example: sk120stiff explain readings.csv --holdout others.csv --out explained
    """
    readings, robot = open_data(data)
    others = None if holdout is None else open_data(holdout).data
    options = Options(
        only=tuple(only or ()),
        exclude=tuple(exclude or ()),
        assume=tuple(assume or ()),
        max_effects=max_effects,
        seed=seed,
    )
    with progress_bar("explain") as report:
        answer = explain(
            start_model(robot, model),
            readings,
            holdout=others,
            options=options,
            progress=lambda phrase, share: report(round(100 * share), 100),
        )
    document = write_answer(answer, readings, data, out)
    return Answer(document, parts(answer, out))


def write_answer(
    answer: Explanation, readings: Measurements, data: Path, out: Path
) -> dict[str, object]:
    """Write model, verdict, gaps and next poses; the verdict last, so that it marks completion."""
    fitted = replace(answer.final.model, provenance=provenance(data, readings))
    write_model(fitted, out / "model.yaml")
    predicted = fitted.predict(situation_of(fitted.robot, readings))
    text = io.StringIO()
    prediction_table(readings, predicted).to_csv(text, index=False)
    write_atomically(out / "gaps.csv", text.getvalue())
    name = None
    if answer.next_poses is not None:
        name = "next_poses.csv"
        write_measurements(_plan(answer, readings), out / name)
    document = verdict_document(answer, name)
    write_atomically(out / "verdict.json", as_json_text(document) + "\n")
    return {**document, "out": out}


def _plan(answer: Explanation, readings: Measurements) -> Measurements:
    if answer.next_poses is None:
        raise ValueError("there is nothing to measure next")
    a, wrench = answer.next_poses
    return Measurements(
        pose=tuple(f"next_{k + 1}" for k in range(len(a))),
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
        source="poses and loads that tell the named alternatives apart",
    )


def parts(answer: Explanation, out: Path) -> list[object]:
    """The answer for people."""
    said = {
        "none": "Model and data agree within the noise: nothing is missing.",
        "named": "Something was missing, and it has a name.",
        "ambiguous": "Something is missing; these readings cannot tell which of several names.",
        "outside": "Something is missing that no effect of the catalogue explains.",
    }
    shown: list[object] = [said[answer.verdict]]
    for finding in answer.findings:
        shown.append(f"{finding.effect.sentence()} [{finding.effect.id}]")
        for other in finding.alternatives:
            kind = "always the same" if other in finding.exact else "not told apart here"
            shown.append(f"  or {other} ({kind})")
    rows = [(s.label, s.fit_rms * 1e6, s.heldout_rms * 1e6) for s in answer.steps]
    shown.append(table("Gap [µm rms per axis]", ["model", "fitted", "held out"], rows))
    if answer.suspects:
        shown.append(f"Nearest, but not it: {', '.join(answer.suspects)}.")
    shown.extend(answer.noise_reasons)
    if answer.next_poses is not None:
        shown.append(f"Measure next what stands in {out / 'next_poses.csv'}.")
    shown.append(f"Results are in {out}.")
    return shown
