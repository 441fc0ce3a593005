"""What `explain` answers where readings say where markers stand."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import provenance
from sk120stiff.cli.outputs import write_pages
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.effects import LinearElastic
from sk120stiff.errors import InputError
from sk120stiff.explain import Options
from sk120stiff.explain.absolute.accounts import heldout_on
from sk120stiff.explain.absolute.document import gaps_table, save_positions
from sk120stiff.explain.absolute.next_step import headline, next_step_of_positions
from sk120stiff.explain.absolute.run import Explained, explain_positions
from sk120stiff.explain.answer.document import BEST_GUESS
from sk120stiff.explain.findings import likely
from sk120stiff.files import csv_text, write_atomically
from sk120stiff.identify.absolute.words import findings
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, base_model
from sk120stiff.model.predicted import rows_of


def positions_answer(
    model: Model,
    readings: Measurements,
    others: Measurements | None,
    options: Options,
    data: Path,
    out: Path,
    *,
    report: bool,
) -> Answer:
    """Explain positions, write the folder, and say what was found."""
    if others is not None and others.absolute is None:
        raise InputError(
            "the held-out readings are no positions", remedy="Hold out readings of the same kind."
        )
    with progress_bar("explain") as tell:
        answer = explain_positions(
            model,
            readings,
            options=options,
            progress=lambda _, share: tell(round(85 * share), 100),
        )
        document = save_positions(answer, readings, out, provenance(data, readings))
        pages = _pages(answer, readings, data, out) if report else {}
        tell(100, 100)
    parts = _parts(answer, readings, out)
    held: dict[str, float | None] | None = None
    if others is not None:
        rms, distance = heldout_on(answer.final, others)
        unit = answer.final.problem.unit
        whole = np.isfinite(distance)
        held = {
            f"rms_{'um' if unit == 'µm' else 'urad'}": rms * 1e6,
            "mean_distance_um": distance * 1e6 if whole else None,
        }
        mean = f", {1e6 * distance:.3g} µm mean distance" if whole else ""
        parts.append(f"Held-out file: {1e6 * rms:.3g} {unit} rms per axis{mean}.")
    document = {**document, "holdout": held, "out": out, "model": out / "model.yaml", **pages}
    return Answer(document, parts)


def predicted_positions(model: Model, readings: Measurements, out: Path | None) -> Answer:
    """Where a model has the marker at every reading, and how far the readings are off."""
    if readings.absolute is None:
        raise InputError("there are no positions")
    if readings.absolute.frame == "unknown" and "tracker_frame:tracker" not in {
        effect.id for effect in model.effects
    }:
        raise InputError(
            "the model does not know where the tracker stands",
            remedy="Give a model that 'identify' or 'explain' wrote from readings of this tracker.",
        )
    model = model.under(readings.gravity)
    columns = gaps_table(model, readings)
    if out is not None:
        write_atomically(out, csv_text(columns.items()))
    document: dict[str, object] = {"rows": rows_of(columns), "out": out}
    parts: list[object] = []
    names = [f"gap_{axis}[um]" for axis in "xyz"]
    if names[0] in columns:
        gap = np.array([columns[name] for name in names], dtype=float).T[readings.use]
        gap = gap[np.isfinite(gap).all(axis=1)]
        document["rms_um"] = float(np.sqrt(np.mean(gap**2)))
        document["mean_distance_um"] = float(np.linalg.norm(gap, axis=1).mean())
        parts.append(
            f"Gap over {len(gap)} positions: {document['rms_um']:.4g} µm rms per axis, "
            f"{document['mean_distance_um']:.4g} µm mean distance."
        )
    if out is not None:
        parts.append(f"Written to {out}.")
    return Answer(document, parts)


def _pages(answer: Explained, readings: Measurements, data: Path, out: Path) -> dict[str, Path]:
    """Scene and report, each where it can be made."""
    from sk120stiff.show import reproducibility
    from sk120stiff.show.scene.building import scene_of_model
    from sk120stiff.show.stories import positions_report

    model, where = yielding(answer.final.fit.model), provenance(data, readings)
    facts = reproducibility(where["command"], [data, data.with_suffix(".yaml")])
    return write_pages(
        out,
        lambda: scene_of_model(model, title=model.robot.name),
        lambda _: positions_report(answer, readings, data=data.name, reproducibility=facts),
    )


def yielding(model: Model) -> Model:
    """The model, or plain springs where nothing in it yields: a scene needs something that does."""
    soft = any(isinstance(p.effect, LinearElastic) and p.internal > 0.0 for p in model.parameters)
    return model if soft else base_model(model.robot)


def _parts(answer: Explained, readings: Measurements, out: Path) -> list[object]:
    shown: list[object] = [headline(answer)]
    for item in answer.named:
        shown.append(
            f"{item.effect.sentence()} [{item.effect.id}] ({likely(item.probability)}, takes off "
            f"{100 * item.gain.share:.1f} %)"
        )
        shown += [f"  or {other} (not told apart here)" for other in item.alternatives]
    whole = np.isfinite(answer.steps[-1].heldout_distance)
    rows = [
        (s.label, s.fit_rms * 1e6, s.heldout_rms * 1e6, s.heldout_distance * 1e6)[: 3 + whole]
        for s in answer.steps
    ]
    columns = ["model", "fitted", "held out", "mean distance"][: 3 + whole]
    unit = answer.final.problem.unit
    title = f"Gap [{unit}], rms per axis" + (" and mean distance held out" if whole else "")
    shown.append(table(title, columns, rows))
    if answer.families:
        told = ", ".join(f"{name} {1e6 * share:.3g}" for name, share in answer.families.items())
        shown.append(f"What each takes off beside the others [{unit}]: {told}.")
    shown += answer.weight()
    shown += findings(answer.final, readings)
    shown += answer.dropped
    shown += answer.left_over()
    if answer.guess is not None:
        shown.append(f"The best guess stands in {out / BEST_GUESS}; it is not confirmed.")
    shown.append(f"What to do now: {next_step_of_positions(answer)}")
    shown.append(f"Results are in {out}.")
    return shown
