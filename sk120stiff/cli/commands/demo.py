"""`sk120stiff demo`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from sk120stiff.cli.explain_output import Task, check_folder, findings, said, write_answer
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.identify_rows import parameter_rows
from sk120stiff.cli.opening import open_data, provenance
from sk120stiff.cli.outputs import write_pages
from sk120stiff.cli.tables import progress_bar, shown
from sk120stiff.effects import all_effects, load_cases_of
from sk120stiff.explain.answer.saving import replacing_results, write_verdict
from sk120stiff.explain.answer.verdict import NEXT_POSES
from sk120stiff.explain.candidates.absorbed import absorbed
from sk120stiff.explain.run import explain_displacements
from sk120stiff.identify import fit
from sk120stiff.measurements import write_measurements
from sk120stiff.model import base_model, write_model
from sk120stiff.robot.bundled import bundled_robots

if TYPE_CHECKING:
    from sk120stiff.measurements import Measurements
    from sk120stiff.robot import Robot
    from sk120stiff.show.stories.demo_facts import Demo
    from sk120stiff.show.stories.hidden_cause import HiddenCause

ROBOT = "motoman_sk120"
HIDDEN = "hidden_cause"  # the campaign's files, and the folder of its answer
Told = Callable[[int, int], None]


def command(out: Path = Path("sk120stiff-demo")) -> Answer:
    """The main job on measured data, and on a hidden cause.

    Puts the paper's springs to its measured deflections, identifies springs, asks what is missing,
    and says what three poses can tell. Then it explains a simulated campaign in which a cause was
    hidden, and opens the truth. Writes report.html, scene.html, model.yaml, verdict.json, and the
    campaign's own into the folder hidden_cause.

    Example: sk120stiff demo --out sk120stiff-demo

    Args:
        out (DIR): Folder for the results.
    """
    check_folder(out)
    check_folder(out / HIDDEN)
    data = bundled_robots()[ROBOT] / "data" / "table2_measured.csv"
    readings, robot = open_data(data)
    with progress_bar("demo") as tell:
        made = demo_of(readings, robot, tell)
        cause, of_cause = _hidden_cause(data.with_name(f"{HIDDEN}.csv"), out / HIDDEN, tell)
        written = _write(made, cause, readings, data, out, tell)
    document = {**_document(made), HIDDEN: {**_of_hidden(cause), **of_cause}, **written}
    return Answer(document, parts=[*_parts(made), *_told(cause), *_files(written)])


def _hidden_cause(data: Path, out: Path, tell: Told) -> tuple[HiddenCause, dict[str, object]]:
    """Explain the campaign, write its answer, then open the truth."""
    from sk120stiff.show.stories.hidden_cause import opened

    holdout = data.with_name(f"{data.stem}_holdout.csv")
    readings, robot = open_data(data)
    others, _ = open_data(holdout)
    answer = explain_displacements(
        base_model(robot),
        readings,
        holdout=others,
        progress=lambda _, share: tell(40 + round(40 * share), 100),
    )
    task = Task(readings, data, [data, data.with_suffix(".yaml"), holdout], holdout)
    written = write_answer(answer, task, out, report=True)
    cause = opened(answer, data.with_name(f"{data.stem}_truth.json"))
    return cause, {key: written[key] for key in ("model", "report", "scene") if key in written}


def _of_hidden(cause: HiddenCause) -> dict[str, object]:
    first, last = cause.answer.steps[0], cause.answer.steps[-1]
    return {
        "verdict": cause.answer.verdict,
        "effects": list(cause.found),
        "truth": list(cause.hidden),
        "heldout_um": {"before": 1e6 * first.heldout_rms, "after": 1e6 * last.heldout_rms},
        "parameters": [
            {"name": p.name, "value": p.value, "std": p.std, "truth": cause.values[p.name],
             "unit": p.spec.unit}
            for p in cause.parameters
        ],
    }  # fmt: skip


def _told(cause: HiddenCause) -> list[object]:
    from sk120stiff.show.stories.gap_section import steps_table

    answer = cause.answer
    poses = len(answer.base.problem.load_cases.poses)
    return [
        f"A campaign of {poses} poses, simulated by other code, with a hidden cause:",
        said(answer),
        *findings(answer),
        shown(steps_table(answer)),
        cause.opened(),
        shown(cause.table()),
    ]


def demo_of(readings: Measurements, robot: Robot, tell: Told) -> Demo:
    """Everything the demo computes."""
    from sk120stiff.show.stories.demo_facts import Demo

    paper = base_model(robot)
    found = fit(paper, readings, method="trf")
    other = fit(paper, readings, method="lm")
    tell(10, 100)
    answer = explain_displacements(
        paper, readings, progress=lambda _, share: tell(10 + round(25 * share), 100)
    )
    load_cases = load_cases_of(robot, readings.masked())
    present = {effect.id for effect in found.model.effects}
    absent = [
        effect
        for effect in all_effects(robot, poses=readings.poses, timed=readings.time is not None)
        if effect.id not in present and effect.applies_to(load_cases)
    ]
    return Demo(paper, found, other, answer, absorbed(found, absent))


def _write(
    made: Demo,
    cause: HiddenCause,
    readings: Measurements,
    data: Path,
    out: Path,
    tell: Told,
) -> dict[str, object]:
    """Verdict and model first; a page that cannot be made is a warning."""
    from sk120stiff.show import reproducibility
    from sk120stiff.show.stories import demo_report, identify_scene
    from sk120stiff.show.stories.demo_facts import OURS, PAPER

    where = provenance(data, readings)
    following = made.answer.next_readings()
    with replacing_results(out):
        write_model(replace(made.model, provenance=where), out / "model.yaml")
        if following is not None:
            write_measurements(following, out / NEXT_POSES)
        write_verdict(made.answer.document(), out)
    tell(85, 100)
    inputs = [data, data.with_suffix(".yaml"), data.parent.parent / "sk120.urdf"]
    pages = write_pages(
        out,
        lambda: identify_scene(
            made.found,
            made.paper,
            names=(PAPER, OURS),
            subtitle="Table II of the 2005 paper, measured",
            model_file="model.yaml",
        ),
        lambda scene: demo_report(
            made,
            cause,
            cause_link=f"{HIDDEN}/report.html" if (out / HIDDEN / "report.html").exists() else "",
            next_poses="" if following is None else NEXT_POSES,
            scene=scene,
            scene_link="scene.html" if scene else "",
            reproducibility=reproducibility(where["command"], inputs),
        ),
    )
    tell(100, 100)
    return {"model": out / "model.yaml", **pages}


def _document(made: Demo) -> dict[str, object]:
    return {
        "verdict": made.answer.verdict,
        "effects": [
            {"name": found.effect.id, "alternatives": list(found.alternatives)}
            for found in made.answer.findings
        ],
        "gap_um": {
            "paper": 1e6 * made.rms(made.paper),
            "identified": 1e6 * made.rms(made.found.model),
            "noise_floor": None if made.noise is None else 1e6 * made.noise,
            "heldout": 1e6 * made.answer.steps[0].heldout_rms,
        },
        "per_pose": [
            {"pose": pose, "paper_um": before, "identified_um": after}
            for pose, before, after in made.per_pose
        ],
        "one_force_gain": [
            {"gain": gain, "rms_um": 1e6 * left, "three_springs_um": 1e6 * springs}
            for gain, left, springs in made.gains
        ],
        "parameters": parameter_rows(made.found),
    }


def _files(written: Mapping[str, object]) -> list[object]:
    titles = {"report": "Report:", "scene": "Scene: "}
    return [f"{title} {written[page]}" for page, title in titles.items() if page in written]


def _parts(made: Demo) -> list[object]:
    from sk120stiff.show.stories.demo_report import demo_lead, per_pose_table, springs_table

    answer = made.answer
    able = sum(s.visible >= 5.0 for s in made.hidden)
    return [
        demo_lead(made),
        shown(per_pose_table(made)),
        shown(springs_table(made)),
        made.of_the_gain(),
        said(answer),
        *findings(answer),
        *answer.where[:2],
        f"Poses left out in turn are predicted to {1e6 * answer.steps[0].heldout_rms:.1f} µm.",
        f"At their usual size {able} of {len(made.hidden)} other effects would leave enough beyond "
        "the springs to be named on these three poses.",
    ]
