"""`sk120stiff map ROBOT --grid ... --out STORE.zarr`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.arrays import Array
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import direction_of, frame_at, open_model, pose_of, wrench_of
from sk120stiff.cli.options import (
    AtOption,
    BaseOption,
    ModelOption,
    PoseOption,
    RobotOrModelArgument,
    ToolOption,
)
from sk120stiff.cli.outputs import will_draw, will_show
from sk120stiff.cli.tables import progress_bars, table
from sk120stiff.cli.uncertainty import plus_minus, sentences, uncertainty_keys
from sk120stiff.errors import InputError, warn
from sk120stiff.files import will_fill
from sk120stiff.model import Model
from sk120stiff.robot.rotations import rotation_from_rpy
from sk120stiff.units import parse_values
from sk120stiff.workspace import (
    ElasticArm,
    Grid,
    JointGrid,
    LoadSummary,
    MapJob,
    MapPostures,
    MapReport,
    PositionGrid,
    damaged_map,
    elastic_arm,
    map_postures,
    open_map,
    parse_axes,
    summarise_map,
    verify_map,
    write_map,
)
from sk120stiff.workspace.grid import CARTESIAN


def command(
    robot: RobotOrModelArgument,
    out: Annotated[Path, typer.Option("--out")],
    grid: Annotated[list[str], typer.Option("--grid")],
    model: ModelOption = None,
    wrench: list[str] | None = None,
    pose: PoseOption = None,
    at: AtOption = None,
    axis: Annotated[str | None, typer.Option("--tool-axis")] = None,
    orientation: str | None = None,
    start: str | None = None,
    directions: bool = False,
    scheduler: str | None = None,
    page: Path | None = None,
    colour: str | None = None,
    figures: Path | None = None,
    overwrite: bool = False,
    base: BaseOption = None,
    tool: ToolOption = None,
) -> Answer:
    """Stiffness over the workspace: extremes, directions, stability.

    Under a load the deflection too, and its ± with a model that 'identify' or 'explain' wrote. The
    map is a Zarr store with units and labels. A run that was stopped in whatever way goes on where
    it was when the same command is given again. A finished map is checked, every file, against the
    checksums of when it was written; what is damaged is made again.

    Example: sk120stiff map motoman_sk120 --grid 'joint_2_l=::2; joint_3_u=::2 deg'
    --wrench '0,0,-490 N' --out sk120.zarr --figures sk120_slices

    Args:
        out (STORE.zarr): Folder to write the map to.
        grid (AXES): Axes as NAME=START:STOP:STEP with units, 'joint_2_l=-70:70:2; joint_3_u=::2
            deg' (an empty start or stop is the joint's limit), or positions of the point,
            'x=0:3:0.1; y=0; z=-1:2:0.1 m'. May be given several times.
        wrench (VALUES): A load as in 'stiffness'; give it several times for several loads.
            [default: no load]
        axis (X,Y,Z): For positions: direction of the tool's z axis in the base frame ('0,0,-1':
            down). Rotation about it is free. [default: any orientation]
        orientation (RPY): For positions: orientation of the tool, roll, pitch and yaw as in a URDF
            ('180,0,0 deg'). [default: any orientation]
        start (POSE): For positions: a pose as in --pose; the arm is led from it to every point
            along a straight line and stays in its branch. [default: at each point the stiffest
            branch that is found]
        directions: Store the softest and stiffest directions too.
        scheduler (ADDRESS): Dask scheduler (tcp://host:8786) whose workers share the folder of the
            map. [default: compute here]
        page (HTML): Write a page too: the map as coloured points around the robot. [default: none]
        colour (VARIABLE): What colours the points of --page: minimum_stiffness, deflection_length,
            deflection_std_parameters or another variable of the map. [default: minimum_stiffness]
        figures (DIR): Draw slices too, as SVG and PNG: least stiffness, definiteness, and under a
            load the deflection and its ±, over every pair of axes, through the softest point.
            [default: none]
        overwrite: Replace another map of that name, and nothing else.
    """
    will_fill(out)
    will_show(page)
    will_draw(page, figures)
    believed = open_model(robot, model, base=base, tool=tool)
    arm_robot = believed.robot
    arm = elastic_arm(believed, frame=frame_at(arm_robot, at))
    rest = pose_of(arm_robot, pose)
    loads = np.array([wrench_of(text) for text in wrench] if wrench else [np.zeros(6)])
    points = _points(arm, grid, rest, axis, orientation)
    if start is not None:
        if isinstance(points, JointGrid):
            raise InputError(
                "a start pose was given, but the grid is over joints",
                where="--start",
                remedy="Give x, y and z in --grid.",
            )
        points = replace(points, start=pose_of(arm_robot, start, option="--start"))
    if figures is not None and sum(size > 1 for size in points.grid.shape) < 2:
        raise InputError(
            "a slice needs two axes with more than one point each",
            where="--figures",
            remedy="Map over two axes or more.",
        )
    job = MapJob(arm, points, loads, with_directions=directions)
    shown = _shown(colour, page, job)
    with progress_bars("Checking what is there", "Mapping") as (found, mapped):
        written = write_map(
            job, out, scheduler=scheduler, overwrite=overwrite, progress=mapped, checking=found
        )
    with progress_bars("Checking", "Reading") as (checked, read):
        check = verify_map(out, progress=checked)
        if not check.intact:
            raise damaged_map(out, check)
        loads_found, status = summarise_map(out, progress=read)
    if page is not None:
        _write_page(page, out, believed, pose, shown)
    drawn = [] if figures is None else _draw(figures, out, loads_found)
    document = {
        "robot": arm.name,
        "store": str(out),
        "points": written.points,
        "written": written.computed,
        "seconds": written.seconds,
        "chunks": written.chunks,
        "files_verified": check.files,
        "mended": written.mended,
        "status": status,
        "page": page,
        "figures": drawn,
        "wrenches": loads,
        "loads": loads_found,
        "units": {
            "softest": "N/m",
            "stiffest": "N/m",
            "critical": "1",
            "softest_at": "rad or m",
            "stiffest_at": "rad or m",
            "deflection": "m; null: no load",
            "deflection_at": "rad or m",
            "deflection_std_parameters": "m; null: unknown, or not stored",
            "deflection_std_remainder": "m; null: not known",
        },
        "uncertainty": uncertainty_keys(believed),
    }
    parts = _parts(arm, written, check.files, status, loads, loads_found)
    if job.bends:
        parts += _bent(arm, believed, loads, loads_found)
    if points.cartesian:
        document["postures"], text = _postures(map_postures(arm_robot, out), led=start is not None)
        parts.append(text)
    if drawn:
        parts.append(f"Figures: {len(drawn)} files in {figures}")
    return Answer(document, parts)


def _shown(colour: str | None, page: Path | None, job: MapJob) -> str:
    """The variable that colours the page, before anything is computed."""
    from sk120stiff.show.scene.cloud import SHOWN

    there = [variable.name for variable in job.variables if variable.name in SHOWN]
    if colour is not None and page is None:
        raise InputError("there is no page to colour", where="--colour", remedy="Give --page HTML.")
    if colour is not None and colour not in there:
        raise InputError(
            f"this map holds no {colour!r} to colour points by",
            where="--colour",
            remedy=f"Choose from {', '.join(there)}. Deflections need a load, and their ± a model "
            "that 'identify' or 'explain' wrote.",
        )
    return colour or "minimum_stiffness"


def _write_page(page: Path, store: Path, model: Model, pose: str | None, colour: str) -> None:
    from sk120stiff.show import cloud_of_map, cloud_page, scene_of_model

    robot = model.robot
    what = "deflection" if colour.startswith("deflection") else "stiffness"
    title = f"{robot.name}: {what} over the workspace"
    scene = scene_of_model(model, title=title, a=pose_of(robot, pose))
    cloud_page(page, scene, cloud_of_map(open_map(store), robot, variable=colour))


def _draw(folder: Path, store: Path, loads: tuple[LoadSummary, ...]) -> list[Path]:
    from sk120stiff.show import figures_of_map, save_figure

    dataset = open_map(store)
    return [
        save_figure(each.figure, folder / f"{each.name}.{ending}")
        for load, summary in enumerate(loads)
        for each in figures_of_map(dataset, load=load, at=summary.softest_at or None)
        for ending in ("svg", "png")
    ]


def _points(
    arm: ElasticArm, texts: list[str], rest: Array, axis: str | None, orientation: str | None
) -> JointGrid | PositionGrid:
    limits = {
        joint: (float(low), float(high), "length" if slides else "angle")
        for joint, low, high, slides in zip(
            arm.joints, arm.lower, arm.upper, arm.slides, strict=True
        )
    }
    limits |= dict.fromkeys(CARTESIAN, (-np.inf, np.inf, "length"))
    grid = Grid(parse_axes(texts, limits))
    names = {each.name for each in grid.axes}
    if not names & set(CARTESIAN):
        if axis or orientation:
            raise InputError(
                "an orientation of the tool was given, but the grid is over joints",
                where="--tool-axis" if axis else "--orientation",
                remedy="Give x, y and z in --grid.",
            )
        _warn_beyond_limits(grid, limits)
        return JointGrid(grid, rest)
    if names != set(CARTESIAN):
        raise InputError(
            "a grid over positions has the axes x, y and z and no other",
            where="--grid",
            remedy="One number makes an axis of one point: 'y=0 m'.",
        )
    direction = None if axis is None else direction_of(axis, "--tool-axis")
    rotation = None
    if orientation is not None:
        angles = parse_values(orientation, "angle", where="--orientation", like="180,0,0 deg")
        rotation = rotation_from_rpy(angles)
    return PositionGrid(grid, rest, direction, rotation)


def _warn_beyond_limits(grid: Grid, limits: dict[str, tuple[float, float, str]]) -> None:
    for axis in grid.axes:
        low, high, _ = limits[axis.name]
        slack = 1e-9 * max(1.0, float(np.abs(axis.values).max()))
        if axis.values.min() < low - slack or axis.values.max() > high + slack:
            warn(
                f"the grid goes beyond the limits of {axis.name}, {low:.4g} to {high:.4g}; "
                "those points are computed as if the joint could go there"
            )


def _parts(
    arm: ElasticArm,
    written: MapReport,
    files: int,
    status: dict[str, int],
    loads: Array,
    found: tuple[LoadSummary, ...],
) -> list[object]:
    rate = f", {written.computed / written.seconds:,.0f} points/s" if written.computed else ""
    parts: list[object] = [
        f"{written.path}: {written.points:,} points, {written.computed:,} of them computed now in "
        f"{written.seconds:.1f} s{rate}; {files} files verified."
    ]
    if written.mended:
        parts.append(
            f"{len(written.mended)} files were not as an earlier run had written them and were "
            f"made again, the first is {written.mended[0]}."
        )
    if any(count for label, count in status.items() if label != "reached"):
        counts = [f"{count:,} {label}" for label, count in status.items() if count]
        parts.append("Points: " + "; ".join(counts) + ".")
    rows = [
        (
            _load(load),
            summary.softest * 1e-6,
            _place(arm, summary.softest_at),
            summary.stiffest * 1e-6,
            _place(arm, summary.stiffest_at),
            summary.critical,
            summary.unstable,
        )
        for load, summary in zip(loads, found, strict=True)
    ]
    head = ("load", "softest", "at", "stiffest", "at", "critical factor", "unstable points")
    if any(summary.softest_at for summary in found):
        parts.append(table("Minimum principal stiffness [N/µm] over the map", head, rows))
    return parts


def _bent(
    arm: ElasticArm, model: Model, loads: Array, found: tuple[LoadSummary, ...]
) -> list[object]:
    """The largest deflections ± for people."""
    rows = []
    for load, summary in zip(loads, found, strict=True):
        if summary.deflection is None or summary.deflection_at is None:
            continue
        size: object = summary.deflection * 1e6
        own, left = summary.deflection_std_parameters, summary.deflection_std_remainder
        if own is not None:
            size = plus_minus(summary.deflection * 1e6, float(np.hypot(own, left or 0.0)) * 1e6)
        rows.append((_load(load), size, _place(arm, summary.deflection_at)))
    parts: list[object] = [
        table("Largest deflection [µm] over the map", ("load", "length", "at"), rows)
    ]
    if model.uncertainty is None:
        parts += sentences(model, None, None)
    return parts


def _load(load: Array) -> str:
    return ", ".join(f"{component:g}" for component in (load if load[3:].any() else load[:3]))


def _place(arm: ElasticArm, coordinates: dict[str, float]) -> str:
    turns = {joint for joint, slides in zip(arm.joints, arm.slides, strict=True) if not slides}
    return ", ".join(
        f"{name} {np.degrees(value):.1f}°" if name in turns else f"{name} {value * 1e3:.0f} mm"
        for name, value in coordinates.items()
    )


def _postures(found: MapPostures | None, *, led: bool) -> tuple[dict[str, object], str]:
    """The key `postures`, and a sentence; was the arm led from a start pose?"""
    if found is None:
        return {"elbow_up": 0, "elbow_down": 0}, "No point was reached."
    lowest = f"{found.lowest_joint}, {1e3 * found.lowest:.0f} mm"
    if found.sunk:
        warn(
            f"at {found.sunk} points a joint lies below the base plane and below the point itself "
            f"({lowest.replace(',', ' down to', 1)}): choose the branch with --start"
        )
    how = "the branch of the start pose" if led else "at each point the stiffest branch found"
    text = (
        f"Postures, {how}: elbow up at {found.elbow_up} points, down at {found.elbow_down}; "
        f"lowest joint {lowest}."
    )
    return {
        "elbow_up": found.elbow_up,
        "elbow_down": found.elbow_down,
        "lowest_joint": found.lowest_joint,
        "lowest_m": found.lowest,
        "below_base_and_point": found.sunk,
    }, text
