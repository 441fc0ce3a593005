"""`sk120stiff explain DATA --out DIR`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sk120stiff.cli.cell import CellOption, opened_cell
from sk120stiff.cli.commands.explain.task_budget import opened_task, with_task
from sk120stiff.cli.explain_output import (
    Task,
    check_folder,
    parts,
    warn_of_known_poses,
    write_answer,
)
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_data, start_model
from sk120stiff.cli.options import DataArgument, ModelOption, SeedOption
from sk120stiff.cli.positions import positions_answer
from sk120stiff.cli.tables import progress_bar
from sk120stiff.explain import Explained, Explanation, Options, explain
from sk120stiff.explain.options import MOST_EFFECTS
from sk120stiff.explain.priors import priors_from
from sk120stiff.identify import as_moved, refuse_for_positions
from sk120stiff.model import Model, base_model
from sk120stiff.plan import Cell


def command(
    data: DataArgument,
    out: Annotated[Path, typer.Option("--out")],
    model: ModelOption = None,
    holdout: Path | None = None,
    exclude: list[str] | None = None,
    only: list[str] | None = None,
    assume: list[str] | None = None,
    max_effects: Annotated[int, typer.Option(min=0, max=20)] = MOST_EFFECTS,
    alpha: Annotated[float, typer.Option(min=1e-06, max=0.5)] = Options.alpha,
    prior: list[str] | None = None,
    task: Path | None = None,
    cell: CellOption = None,
    seed: SeedOption = 0,
    no_report: bool = False,
) -> Answer:
    """What is missing when simulation and measurement disagree.

    Finds where the gap lives, names the missing effect, adds it to the model and shows the gap
    shrink. Writes report.html, scene.html, model.yaml, gaps.csv, verdict.json and, where two names
    cannot be told apart, next_poses.csv, which keeps to the cell. Slips of the pen in the readings
    are looked for first and stop it, with what mends them.

    Example: sk120stiff explain readings.csv --holdout others.csv --task path.csv --out explained

    Args:
        out (DIR): Folder for the results.
        holdout (CSV): Readings of other poses, kept out of every fit.
        exclude (EFFECT): Leave out this effect, 'name' or 'name:where'.
        only (EFFECT): Consider this effect only (may be repeated).
        assume (EFFECT): Put this effect into the model from the start.
        max_effects: Name no more than this; told where it binds.
        alpha: Largest chance of a name where nothing is missing.
        prior (EFFECT=P): How probable an effect is before measuring, e.g. base_rocking=0.5 (the
            usual is 0.1; may be repeated).
        task (CSV): A loaded path that has to be driven, as 'compensate' takes it: its error budget
            stands beside that of the readings.
        no_report: Write no report.html and no scene.html.
    """
    check_folder(out)
    readings, robot = open_data(data)
    others = None if holdout is None else open_data(holdout).data
    if others is not None:
        warn_of_known_poses(readings, others)
    options = Options(
        only=tuple(only or ()),
        exclude=tuple(exclude or ()),
        assume=tuple(assume or ()),
        max_effects=max_effects,
        alpha=alpha,
        prior=priors_from(prior or ()),
        seed=seed,
        cell=opened_cell(robot, cell, data, model),
    )
    given = None if model is None else start_model(robot, model)
    springs = base_model(robot) if given is None else given
    positions = as_moved(springs, readings).absolute is not None
    if positions:
        refuse_for_positions(readings, **{
            "--assume": assume, "--max-effects": max_effects != MOST_EFFECTS,
            "--alpha": alpha != Options.alpha, "--prior": prior, "--task": task,
        })  # fmt: skip
    by_load = readings.absolute is not None and readings.absolute.channels.displacement is not None
    plain = positions and not by_load and model is None  # of displacements springs are no news
    start = Model(robot) if plain else (given or start_model(robot, None))
    inputs = [data, data.with_suffix(".yaml"), *(each for each in (holdout, model, task) if each)]
    driven = None if task is None else opened_task(task, robot, options.cell or Cell())
    with progress_bar("explain") as report:
        answer = explain(
            start,
            readings,
            holdout=others,
            options=options,
            progress=lambda _, share: report(round(85 * share), 100),
        )
        if isinstance(answer, Explanation) and task is not None and driven is not None:
            answer = with_task(answer, task, *driven)
        asked = Task(readings, data, inputs, holdout, seed)
        document = write_answer(answer, asked, out, report=not no_report, progress=report)
    if isinstance(answer, Explained):
        return positions_answer(answer, document, out)
    return Answer(document, parts(answer, out, report=document.get("report")))
