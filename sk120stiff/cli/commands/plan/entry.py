"""`sk120stiff plan --model M --count N`."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.cli.cell import CellOption, height_words, opened_cell
from sk120stiff.cli.commands.plan.asked import (
    hung_on,
    masses_understood,
    named_parameters,
    two_effects,
)
from sk120stiff.cli.commands.plan.check import checked, points_of
from sk120stiff.cli.commands.plan.told import told
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import declare_readings, direction_of, model_for, open_data, open_model
from sk120stiff.cli.options import SeedOption
from sk120stiff.cli.outputs import will_draw, will_show
from sk120stiff.cli.tables import progress_bar
from sk120stiff.errors import InputError
from sk120stiff.files import will_write, write_atomically
from sk120stiff.measurements import Measurements, write_measurements
from sk120stiff.model import Model
from sk120stiff.plan import Cell, Plan, Route, as_measured, lowest_points, plan, plan_positions
from sk120stiff.programs import Language
from sk120stiff.programs.controller import checked_text, frame_words
from sk120stiff.programs.driving import language_by_joints, route_program
from sk120stiff.robot import Robot
from sk120stiff.units import parse_size, parse_values
from sk120stiff.workspace import places_of

MOST_CANDIDATES = 1_000_000


def command(
    robot: Annotated[str | None, typer.Argument()] = None,
    model: Path | None = None,
    count: Annotated[int | None, typer.Option(min=1)] = None,
    loads: Annotated[int | None, typer.Option(min=1)] = None,
    check: Path | None = None,
    between: str | None = None,
    wanted: Annotated[list[str] | None, typer.Option("--for")] = None,
    data: Path | None = None,
    force: str | None = None,
    noise: str | None = None,
    point: str | None = None,
    positions: Annotated[bool, typer.Option("--positions")] = False,
    payload: list[str] | None = None,
    payload_point: str | None = None,
    lowest: Annotated[str | None, typer.Option("--floor", "--lowest")] = None,
    box: str | None = None,
    cell: CellOption = None,
    candidates: Annotated[int, typer.Option(min=10, max=MOST_CANDIDATES)] = 400,
    directions: Annotated[int, typer.Option(min=1, max=10_000)] = 12,
    out: Path | None = None,
    program: Path | None = None,
    places: Path | None = None,
    axis: Annotated[str | None, typer.Option("--tool-axis")] = None,
    page: Path | None = None,
    seed: SeedOption = 0,
) -> Answer:
    """The poses and loads to measure next.

    D-optimal for the parameters that count, or T-optimal between two effects; feasible as far as
    the URDF and cell.yaml tell: limits, efforts, collisions, floor, rig, tracker. `gain` is the
    precision (or evidence) over that of random poses.

    With --positions, or --data that hold positions: poses and payloads at which to read where the
    marker stands, for geometry and springs.

    Example: sk120stiff plan model.yaml --count 15 --floor '-0.8 m' --out plan.csv
    Example: sk120stiff plan model.yaml --positions --count 40 --payload '0 kg' --payload '5 kg'
    Example: sk120stiff plan --model model.yaml --places reach.csv --page plan.html
    Example: sk120stiff plan --check plan.csv --cell cell.yaml
    Example: sk120stiff plan --check best.csv --model model.yaml

    Args:
        robot (ROBOT): Robot or model file; --model does as well.
        model (MODEL): Model file (YAML), or a robot.
        count: Number of poses.
        loads: Number of loads at each pose, or of payloads. [default: 1; 2 of several payloads
            where the URDF states no masses]
        check (CSV): Plan nothing: say row by row what is wrong with this plan, these readings, or
            (of ROBOT) this path by joints, as 'posture' writes it.
        between (EFFECT,EFFECT): Tell these two apart: 'name' or 'name:where' each. [default: make
            the parameters well known]
        wanted (PARAM): Make this well known: a parameter, or an effect with all it has. [default:
            all free ones]
        data (CSV): Readings there are already; points and noise are theirs.
        force (FORCE): Size of the loads, less where the motors cannot hold it. [default: 400 N]
        noise (LENGTH): Standard uncertainty of one reading. [default: the data's, else 10 um]
        point (XYZ): Measured and loaded point in the tool frame, e.g. '0,50,120 mm'. [default: the
            data's, else the tool frame's origin]
        positions: Plan readings of where a marker stands (tracker, camera, arm), not of what a load
            does.
        payload (MASS): Mass that hangs on the tool, with --positions: '5 kg', '500 g', '10 lb';
            of several to choose from '0; 2.5 kg', or repeat it. Decimals have a point: '0,5 kg' is
            0 kg and 5 kg here. [default: those of --data, else none]
        payload_point (XYZ): Where it hangs in the tool frame, '0,0,80 mm'. [default: that of
            --data, else the tool frame's origin]
        lowest (LENGTH): Height in the base frame below which nothing may go: '-0.3 m'. [default: as
            low as --data went, else none]
        box (XYZXYZ): Box in the base frame for the measured point: '0.8,-1,0, 2.2,1,1.5 m'.
        candidates: Poses to choose from.
        directions: Load directions at each pose.
        out (CSV): Where to write them, for the measurement.
        program (FILE): Order the poses for least driving and write the way through them, free of
            collisions: .src (KUKA), .mod (ABB), .ls (FANUC), .jbi (Motoman), .script (UR).
        places (CSV): Poses that put the point at these places, one at each; with --count so many of
            them all. Columns point, x[mm], y[mm], z[mm] in the base, with roll[deg], pitch, yaw of
            the tool or not. [default: poses all over the joints' ranges]
        axis (X,Y,Z): Direction of the tool's z axis at the places, rotation about it free.
            [default: any, or that of the file]
        page (HTML): Write a page: the arm in 3-D at every pose of the plan, in order, with its
            loads. [default: none]
    """
    if check is not None:
        return checked(
            check, model or _file(robot), point, cell, lambda found: _stated(found, lowest, box)
        )
    _refuse_half_a_question(model or _file(robot), count, places, axis)
    declare_readings(out)
    will_write(program, "--program")
    will_show(page)
    will_draw(None, page)
    language = None if program is None else language_by_joints(program)
    known, start = _opened(robot, model, data)
    absolute = positions or (known is not None and known.absolute is not None)
    hung = hung_on(payload, payload_point, force, absolute)
    at = points_of(known, point)[0]
    within = _stated(opened_cell(start.robot, cell, data, model or _file(robot)), lowest, box)
    given = None
    if places is not None:
        around = within if known is None else as_measured(start.robot, within, known)
        towards = None if axis is None else direction_of(axis, "--tool-axis")
        with progress_bar("poses at the places"):
            given = places_of(places, start.robot, around, at, towards)
    larger, names = start, list[str]()
    for text in wanted or () if between is None else ():
        larger, found = named_parameters(larger, text)
        names += found
    with progress_bar("plan"):
        pull = parse_size(force or "400 N", "force", where="--force", like="400 N")
        kind = (
            partial(plan_positions, loads=loads, **hung)
            if absolute
            else partial(plan, loads=loads or 1, force=pull, directions=directions)
        )
        made: Plan = kind(
            larger,
            count,
            between=None if between is None else two_effects(start, between),
            parameters=names,
            point=None if point is None else at,
            sigma=None
            if noise is None
            else parse_size(noise, "length", where="--noise", like="10 um"),
            cell=within,
            known=known,
            places=given,
            candidates=candidates,
            drive=language is not None,
            seed=seed,
        )
        document, said = told(made)
    way: dict[str, object] | None = None
    if language is not None and program is not None and made.way is not None:
        way, driving = _driven(made, made.way, start.robot, program, language, count)
        said += driving
    floor = made.cell.floor
    heights = lowest_points(start.robot, made.joints, at, made.cell)
    remarks = [*made.remarks]
    if made.way is None and len(made.poses) > 1:
        remarks.append(
            "The straight ways from pose to pose were not checked for collisions: 'sk120stiff plan "
            f"--check {out or 'plan.csv'}' does, and --program FILE finds an order and ways that "
            "are free."
        )
    if "payloads" in hung:
        remarks.append(masses_understood(hung["payloads"]))
    document |= {
        "sigma_um": made.standard * 1e6,
        "seed": seed,
        "cell": within.source or None,
        "floor_m": floor if np.isfinite(floor) else None,
        "lowest_m": float(heights.min()),
        "remarks": remarks,
        "route": way,
        "program": program,
        "page": page,
        "out": out,
    }
    said += [*remarks, height_words(heights, made.pose, floor)]
    if page is not None:
        from sk120stiff.show import static_scene
        from sk120stiff.show.stories import plan_scene

        static_scene(page, plan_scene(start, made, made.cell, made.way))
        said.append(f"Shown in {page}.")
    if out is not None:
        write_measurements(made, out)
        said.append(f"Written to {out} and {out.with_suffix('.yaml')}.")
    return Answer(document, said)


def _refuse_half_a_question(
    arm: Path | None, count: int | None, places: Path | None, axis: str | None
) -> None:
    if arm is None:
        raise InputError(
            "nothing says for which arm to plan",
            remedy="Write plan model.yaml --count 12; --check plan.csv checks one there is.",
        )
    if count is None and places is None:
        raise InputError(
            "nothing says how many poses to plan", remedy="Write --count 12, or --places CSV."
        )
    if axis is not None and places is None:
        raise InputError("this says how the tool stands at --places", where="--tool-axis")


def _driven(
    made: Plan, way: Route, robot: Robot, program: Path, language: Language, count: int | None
) -> tuple[dict[str, object], list[str]]:
    """Write the program of the way; its keys and what is said of it."""
    driven = route_program(language, program.stem, robot, way, made.poses)
    write_atomically(program, checked_text(language, driven, robot, way.a))
    via, minutes = int((way.pose < 0).sum()), way.minutes(made.n_readings)
    said = [
        *frame_words(robot),
        f"Driven in this order: {way.seconds:.0f} s of way with {via} via points; about "
        f"{minutes:.0f} min with the readings. Written to {program}.",
    ]
    if made.left_out:
        said.append(
            "Poses to which no free way was found, others taken instead where there are any: "
            f"{made.left_out}."
        )
    if count is not None and (fewer := count - len(made.poses)) > 0:
        poses = "1 pose" if fewer == 1 else f"{fewer} poses"
        said.append(f"{poses} fewer than was asked for: ways to others are not free either.")
    keys = {
        "order": made.poses,
        "via_points": via,
        "driving_s": way.seconds,
        "minutes": minutes,
        "left_out": made.left_out,
    }
    return keys, said


def _opened(
    named: str | None, model: Path | None, data: Path | None
) -> tuple[Measurements | None, Model]:
    if data is None:
        return None, open_model(named or str(model), model if named else None)
    known, robot = open_data(data)
    return known, model_for(robot, model or str(named))


def _file(named: str | None) -> Path | None:
    return None if named is None else Path(named)


def _stated(cell: Cell, lowest: str | None, box: str | None) -> Cell:
    """The cell with what the command line says of floor and box."""
    if lowest is not None:
        cell = replace(
            cell, floor=float(parse_values(lowest, "length", where="--floor", like="-0.3 m")[0])
        )
    if box is not None:
        corners = parse_values(box, "length", where="--box", like="0.8,-1,0, 2.2,1,1.5 m")
        cell = replace(cell, low=corners[:3], high=corners[3:])
    return cell
