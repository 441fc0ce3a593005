"""`sk120stiff compensate MODEL PATH --out FILE`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.arrays import Array, largest, rms
from sk120stiff.cli.cell import CellOption, assumed_at_work, at_work, opened_cell
from sk120stiff.cli.commands.compensate.files import (
    budget_keys,
    budget_parts,
    check_sheet,
    measured_keys,
    measured_words,
    origin,
    placement_columns,
    settings_of,
    write_program,
    write_sheet,
)
from sk120stiff.cli.commands.compensate.path import (
    CHORD,
    STEP,
    LoadAxes,
    OpenedPath,
    PathOptions,
    open_path,
    with_joints,
)
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import frame_at, model_for, open_model, pose_of
from sk120stiff.cli.options import AtOption, ModelArgument
from sk120stiff.cli.path_words import (
    branch_keys,
    branch_words,
    floor_of,
    infeasible,
    movable_joints,
    notes,
    parts,
    point_words,
    standing_keys,
    standing_notes,
    standing_words,
    warn_of_branch,
)
from sk120stiff.cli.tables import progress_bar
from sk120stiff.cli.uncertainty import uncertainty_keys
from sk120stiff.errors import InputError
from sk120stiff.files import will_write
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.plan import feasible
from sk120stiff.programs import Language, language_of
from sk120stiff.programs.building import convention
from sk120stiff.programs.controller import frame_words
from sk120stiff.programs.placing import TOOL_DOWN
from sk120stiff.robot import Robot
from sk120stiff.units import parse_size
from sk120stiff.workspace import (
    Compensation,
    Judged,
    LoadedPath,
    branch_of,
    compensate,
    elastic_arm,
    joints_along,
    standing,
    standing_uncertainty,
    stays_above,
    write_joints,
)

FEED, RAPID = "600 mm/min", "6000 mm/min"


def command(
    model: ModelArgument,
    path: Path,
    out: Annotated[Path, typer.Option("--out")],
    at: AtOption = None,
    orientation: bool = False,
    only: str | None = None,
    against: Path | None = None,
    start: str | None = None,
    floor: str | None = None,
    frame: str | None = None,
    wrench: str | None = None,
    load_axes: LoadAxes = LoadAxes.base,
    tool_rpy: Annotated[
        str | None,
        typer.Option(
            show_default=f"{TOOL_DOWN} (z axis down), turned about its axis where limits need it"
        ),
    ] = None,
    chord: Annotated[str | None, typer.Option(show_default=CHORD)] = None,
    step: Annotated[str | None, typer.Option(show_default=STEP)] = None,
    to: str | None = None,
    settings: Annotated[list[str] | None, typer.Option("--set")] = None,
    by_joints: bool = False,
    sheet: Path | None = None,
    measured: Path | None = None,
    cell: CellOption = None,
    feed: str = FEED,
    rapid: str = RAPID,
) -> Answer:
    """Joint commands that cancel the deflection along a loaded path.

    The loaded tool then stands, at exact equilibrium, where the unloaded nominal robot would have
    stood. Weight and wrong geometry that the model knows are corrected too. Says what remains and
    why, and in which branch the arm runs. With a model that 'identify' or 'explain' wrote, ± what
    the model does not know. A robot program is read again and checked before it is written.

    Example: sk120stiff compensate model.yaml part.nc --frame 'x=1500 mm; z=-300 mm'
    --wrench '0,0,-490 N' --out part.jbi

    Args:
        path (PATH): G-code (.nc, .ngc, .tap, …), APT or CLS (.apt, .cls, .cl), or a CSV file of
            points: joints (joint_1_s[deg], …) or the tool's placement (x[mm], y, z, roll[deg],
            pitch, yaw), the wrench on the robot (fx[N], fy, fz, mx[N*m], my, mz), feed[mm/min].
        out (FILE): Where to write the corrected path: .csv, .nc, .src (KUKA), .mod (ABB), .ls
            (FANUC), .jbi (Motoman), .script (UR).
        orientation: Restore the tool's orientation too.
        only (JOINTS): Joints that may be corrected, separated by commas. [default: all]
        against (MODEL): Judge the corrected path by this model instead: what a wrong model costs.
            [default: the model that corrects]
        start (POSE): For positions: the pose near which the arm begins, as in --pose elsewhere; it
            stays in that branch. [default: a branch above the floor that touches nothing, near the
            zero pose]
        floor (LENGTH): Height in the base frame below which no joint should go: '-0.3 m'. [default:
            the base plane, or the path where that is lower]
        frame (PLACE): Where the path's own axes lie in the base: 'x=1200 mm; z=-300 mm; yaw=90
            deg'. [default: in the base]
        wrench (VALUES): The load at every point of a path that holds none: '0,0,-490 N', or six
            numbers '0,0,-490,0,5,0 N, N*m'. [default: the load of the file]
        load_axes: Axes that loads are stated in, of --wrench and of the file.
        tool_rpy (ANGLES): The tool in the path's axes, roll, pitch, yaw, for G-code and APT; an
            axis that the file states turns it. 'free': any orientation.
        chord (LENGTH): How far a chord of an arc may be off it.
        step (LENGTH): Longest straight feed move: longer ones are divided, and each part is
            corrected.
        to (LANGUAGE): csv, gcode, krl, rapid, ls, jbi or urscript. [default: by the ending of
            --out]
        settings (KEY=VALUE): What the language needs besides, such as tool=1 or pulses=…; the
            program's header lists all with their values. May be repeated.
        by_joints: Move by joint values instead of in straight lines.
        sheet (HTML): Write a sheet: error before and after with its ±, the share of each effect,
            where it is worst. A browser prints it as PDF. [default: none]
        measured (CSV): Points as measured, to stand beside the prediction: point, run (before,
            after), x[mm], y, z in the path's axes, or dx[mm], dy, dz from the target. [default:
            none]
        feed (SPEED): Feed where the path states none.
        rapid (SPEED): Speed of rapid moves.
    """
    will_write(out)
    check_sheet(sheet)
    chosen = settings_of(settings or [])
    language = _language_for(language_of(out, to), chosen, by_joints=by_joints)
    speed = {
        "feed": parse_size(feed, "m/s", where="--feed", like=FEED),
        "rapid": parse_size(rapid, "m/s", where="--rapid", like=RAPID),
    }
    believed = open_model(model)
    robot = believed.robot
    at = frame_at(robot, at)
    movable = None if only is None else movable_joints(believed, only)
    options = PathOptions(frame, wrench, load_axes, tool_rpy, chord, step)
    opened = open_path(path, robot, options)
    wanted = None if start is None else pose_of(robot, start, option="--start")
    ground = floor_of(robot, floor, opened.path)
    arm = elastic_arm(joint_spring_model(robot), frame=at)
    around = at_work(opened_cell(robot, cell, path))
    if floor is not None and not np.isfinite(around.floor):
        around = replace(around, floor=ground)
    with progress_bar("Finding the joints") as report:
        opened, nominal = with_joints(
            opened,
            robot,
            lambda way: joints_along(
                way,
                arm,
                wanted,
                stays_above=lambda a: stays_above(robot, a, ground),
                stands=lambda a: feasible(robot, around, a).ok,
                progress=report,
            ),
        )
    given, part = opened.path, opened.part
    if load_axes == LoadAxes.tool:
        given = given.turned_to_base(robot, nominal, at)
    facts = [*opened.facts, *_facts(believed, opened, at, language, chosen)]
    assumed = assumed_at_work(robot, around)
    held_at = given.wrench if at == robot.tool_frame else None
    wrong = infeasible(robot, around, nominal, given, held_at)
    branch = branch_of(robot, nominal, ground)
    warn_of_branch(branch, given)
    with progress_bar("Compensating") as report:
        own = compensate(
            believed,
            nominal,
            given.wrench,
            frame=at,
            orientation=orientation,
            movable=movable,
            progress=report,
        )
    found, judge = own, believed
    if against is not None:
        judge = model_for(robot, against)
        found = replace(
            own,
            before=standing(judge, nominal, nominal, given.wrench, frame=at),
            after=standing(judge, own.a, nominal, given.wrench, frame=at),
        )
    uncertainty = standing_uncertainty(judge, found.a, given.wrench, frame=at)
    said = branch_words(branch, robot)
    judged = Judged(
        given, judge, nominal, at, part, found.before, found.after, uncertainty, measured
    )
    came_back = measured_keys(judged)
    about = standing_words(judge, uncertainty)
    used = None
    if language is None:
        placed = placement_columns(robot, given, found.a, at)
        write_joints(out, given, robot, found.a, placed | notes(found, standing_notes(uncertainty)))
    else:
        used = write_program(
            language, out, given, robot, own, frame=at, part=part, by_joints=by_joints,
            settings=chosen, facts=[*origin(model, believed, path), *facts, said], **speed,
        )  # fmt: skip
    if sheet is not None:
        told = [*origin(str(against or model), judge, path)[1:], *facts, said]
        write_sheet(judged, sheet, str(against or model), path, told, about)
    document = {
        **_corrected(robot, given, nominal, found),
        "branch": branch_keys(branch, given, robot),
        "cell": around.source or None,
        "infeasible": wrong,
        "judged_by": str(against or model),
        "uncertainty": uncertainty_keys(judge) | standing_keys(uncertainty),
        "assumed": (*facts, *assumed),
        "language": "csv" if language is None else language.name,
        "settings": used,
        "measured": came_back or None,
        "out": str(out),
        "sheet": sheet,
        "budget": budget_keys(judged),
    }
    held = bool(found.before.exists.any())
    shown = [
        said, *parts(document, given, found), *about, *budget_parts(judged),
        *measured_words(came_back), *facts, *assumed,
    ]  # fmt: skip
    return Answer(document, parts=shown, exit_code=0 if held else 1)


def _language_for(
    language: Language | None, chosen: Mapping[str, str], *, by_joints: bool
) -> Language | None:
    """The language, once it is sure that it takes these settings and moves; None: a CSV file."""
    if language is not None:
        language.with_defaults(chosen)
        if by_joints and not language.joint_moves:
            raise InputError(
                f"{language.title} has no moves by joint values",
                where="--by-joints",
                remedy="Leave the option out, or name another language in --out or --to.",
            )
    elif chosen or by_joints:
        raise InputError(
            "a CSV file needs no settings of a language",
            where="--set" if chosen else "--by-joints",
            remedy="Name a robot program in --out, or its language in --to.",
        )
    return language


def _facts(
    model: Model,
    opened: OpenedPath,
    at: str,
    language: Language | None,
    chosen: Mapping[str, str],
) -> Iterator[str]:
    """What is said of the path with its joints and of the program, in sentences."""
    robot, path = model.robot, opened.path
    if path.joints is not None and path.position is not None:
        yield "Its joints are driven; the positions beside them agree."
    if at == robot.tool_frame:
        yield from point_words(model)
    if language is not None:
        if not robot.controller.axes:
            yield f"In the program {convention(robot)}."
        stated = not language.in_part_frame(language.with_defaults(chosen))
        yield from frame_words(robot, opened.part, stated=stated)


def _corrected(
    robot: Robot, path: LoadedPath, nominal: Array, found: Compensation
) -> dict[str, object]:
    """The keys of errors before and after, and of what remains."""
    before, after = found.before, found.after
    return {
        "robot": robot.name,
        "rows": path.count,
        "before_um": rms(before.distance) * 1e6,
        "after_um": rms(after.distance) * 1e6,
        "before_max_um": largest(before.distance) * 1e6,
        "after_max_um": largest(after.distance) * 1e6,
        "before_max_urad": largest(np.linalg.norm(before.turned, axis=1)) * 1e6,
        "after_max_urad": largest(np.linalg.norm(after.turned, axis=1)) * 1e6,
        "largest_correction": np.abs(found.a - nominal).max(axis=0, initial=0.0),
        "joints": robot.actuated,
        "remaining": [
            {"line": path.table.lines[k], "reason": reason, "after_um": after.distance[k] * 1e6}
            for k, reason in enumerate(found.reasons)
            if reason
        ],
    }
