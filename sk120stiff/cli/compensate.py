"""`sk120stiff compensate MODEL PATH --out CSV`."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.arrays import Array
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import model_for, open_model, pose_of
from sk120stiff.cli.options import AtOption, ModelArgument
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.cli.uncertainty import NO_REMAINDER, sentences, uncertainty_keys
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.files import will_write
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.model.prediction_table import blame_reason
from sk120stiff.robot import Robot
from sk120stiff.units import parse_values
from sk120stiff.workspace import (
    Branch,
    Compensation,
    LoadedPath,
    Standing,
    StandingUncertainty,
    branch_of,
    compensate,
    elastic_arm,
    joints_along,
    lowest_floor,
    read_path,
    standing,
    standing_uncertainty,
    stays_above,
    write_joints,
)

LISTED = 10  # points that people are shown


def command(
    model: ModelArgument,
    path: Annotated[
        Path,
        typer.Argument(
            metavar="PATH",
            help="A CSV file of points: joints (joint_1_s[deg], …) or the tool's placement (x[mm], "
            "y, z, roll[deg], pitch, yaw), and the wrench on the robot (fx[N], fy, fz, mx[N*m], "
            "my, mz), base axes.",
            show_default=False,
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", metavar="CSV", help="Where to write the corrected path.")
    ],
    at: AtOption = None,
    orientation: Annotated[
        bool, typer.Option("--orientation", help="Restore the tool's orientation too.")
    ] = False,
    only: Annotated[
        str | None,
        typer.Option(
            metavar="JOINTS",
            help="Joints that may be corrected, separated by commas.",
            show_default="all",
        ),
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL",
            help="Judge the corrected path by this model instead: what a wrong model costs.",
            show_default="the model that corrects",
        ),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="POSE",
            help="For positions: the pose near which the arm begins, as in --pose elsewhere; it "
            "stays in that branch.",
            show_default="a branch above the floor, near the zero pose",
        ),
    ] = None,
    floor: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Height in the base frame below which no joint should go: '-0.3 m'.",
            show_default="the base plane, or the path where that is lower",
        ),
    ] = None,
) -> Answer:
    """Joint commands that cancel the deflection along a loaded path.

    The loaded tool then stands, at exact equilibrium, where the unloaded nominal robot would have
    stood. Weight and wrong geometry that the model knows are corrected too. Says what remains and
    why, and in which branch the arm runs. With a model that 'identify' or 'explain' wrote, ± what
    the model does not know.

    Example: sk120stiff compensate model.yaml path.csv --start '0,20,-30,0,-60,0 deg' --out new.csv
    """
    will_write(out)
    believed = open_model(model)
    robot = believed.robot
    movable = None if only is None else _movable(believed, only)
    given = read_path(path, robot)
    wanted = None if start is None else pose_of(robot, start, option="--start")
    ground = _floor(robot, floor, given)
    with progress_bar("Finding the joints") as report:
        nominal = joints_along(
            given,
            elastic_arm(joint_spring_model(robot), frame=at),
            wanted,
            stays_above=lambda a: stays_above(robot, a, ground),
            progress=report,
        )
    branch = branch_of(robot, nominal, ground)
    _warn_of_branch(branch, given)
    with progress_bar("Compensating") as report:
        found = compensate(
            believed,
            nominal,
            given.wrench,
            frame=at,
            orientation=orientation,
            movable=movable,
            progress=report,
        )
    after, judge = found.after, believed
    if against is not None:
        truth = judge = model_for(robot, against)
        after = standing(truth, found.a, nominal, given.wrench, frame=at)
        before = standing(truth, nominal, nominal, given.wrench, frame=at)
        found = Compensation(found.a, before, after, found.reasons)
    doubt = standing_uncertainty(judge, found.a, given.wrench, frame=at)
    write_joints(out, given, robot, found.a, _notes(found, _doubt_notes(doubt)))
    document = {
        "robot": robot.name,
        "rows": given.count,
        "before_um": _rms(found.before) * 1e6,
        "after_um": _rms(after) * 1e6,
        "before_max_um": _largest(found.before.distance) * 1e6,
        "after_max_um": _largest(after.distance) * 1e6,
        "before_max_urad": _largest(np.linalg.norm(found.before.turned, axis=1)) * 1e6,
        "after_max_urad": _largest(np.linalg.norm(after.turned, axis=1)) * 1e6,
        "largest_correction": np.abs(found.a - nominal).max(axis=0, initial=0.0),
        "joints": robot.actuated,
        "remaining": [
            {"line": given.table.lines[k], "reason": reason, "after_um": after.distance[k] * 1e6}
            for k, reason in enumerate(found.reasons)
            if reason
        ],
        "branch": _branch_keys(branch, given, robot),
        "judged_by": str(against or model),
        "uncertainty": uncertainty_keys(judge) | _doubt_keys(doubt),
        "out": str(out),
    }
    held = bool(found.before.exists.any())
    parts = [
        _branch_words(branch, robot),
        *_parts(document, given, found),
        *_doubt_words(judge, doubt),
    ]
    return Answer(document, parts=parts, exit_code=0 if held else 1)


def _doubt_notes(doubt: StandingUncertainty | None) -> dict[str, list[str]]:
    """Columns of the file; blank where nothing is known."""
    if doubt is None:
        return {}
    columns = {"after_std_parameters[um]": doubt.std_parameters}
    if doubt.std_remainder is not None:
        columns["after_std_remainder[um]"] = doubt.std_remainder
    return {
        name: [f"{x * 1e6:.4f}" if np.isfinite(x) else "" for x in std]
        for name, std in columns.items()
    }


def _doubt_keys(doubt: StandingUncertainty | None) -> dict[str, object]:
    if doubt is None:
        return {}
    left = doubt.std_remainder
    return {
        "after_std_parameters_um": _root_mean_square(doubt.std_parameters) * 1e6,
        "after_std_remainder_um": None if left is None else _root_mean_square(left) * 1e6,
        "unknown_because": blame_reason(doubt.blame) or None,
    }


def _doubt_words(model: Model, doubt: StandingUncertainty | None) -> list[str]:
    if doubt is None:
        return sentences(model, None, None)
    if doubt.blame:
        return [f"How far off it stands in truth is unknown: it {blame_reason(doubt.blame)}."]
    own, left = _root_mean_square(doubt.std_parameters), 0.0
    words = f"{own * 1e6:.2g} µm from the parameters"
    if doubt.std_remainder is None:
        words += f"; {NO_REMAINDER}"
    else:
        left = _root_mean_square(doubt.std_remainder)
        words += f", {left * 1e6:.2g} µm from what the model leaves unexplained"
    return [f"After ± {np.hypot(own, left) * 1e6:.2g} µm: one standard distance, {words}."]


def _root_mean_square(std: Array) -> float:
    """Over the points that have an equilibrium; infinite if one of them is unknown."""
    there = std[~np.isnan(std)]
    return float(np.sqrt(np.mean(there**2))) if len(there) else float("nan")


def _floor(robot: Robot, text: str | None, path: LoadedPath) -> float:
    if text is None:
        heights = None if path.position is None else path.position[:, 2]
        return lowest_floor(robot, path.joints, heights)
    return float(parse_values(text, "length", where="--floor", like="-0.3 m")[0])


def _warn_of_branch(branch: Branch, path: LoadedPath) -> None:
    lines = path.table.lines
    if branch.below:
        warnings.warn(
            f"at {branch.below} of {path.count} points a joint of the arm lies below the floor "
            f"({1e3 * branch.floor:.0f} mm): {branch.lowest_joint} at "
            f"{1e3 * branch.lowest:.0f} mm, line {lines[branch.lowest_point]}. Choose another "
            "branch with --start, or say where the floor is with --floor",
            ToolkitWarning,
            stacklevel=2,
        )
    for k in branch.jumps[:1]:
        warnings.warn(
            f"between lines {lines[k]} and {lines[k + 1]} (and {len(branch.jumps) - 1} more pairs) "
            "a joint moves by more than 30 deg (or 0.5 m): the arm changes its posture there",
            ToolkitWarning,
            stacklevel=2,
        )


def _branch_keys(branch: Branch, path: LoadedPath, robot: Robot) -> dict[str, object]:
    return {
        "first": dict(zip(robot.actuated, branch.first.tolist(), strict=True)),
        "elbow": branch.elbow,
        "elbow_up": branch.elbow_up if branch.elbow else None,
        "elbow_height_m": branch.elbow_height,
        "lowest_m": branch.lowest,
        "lowest_joint": branch.lowest_joint,
        "lowest_line": path.table.lines[branch.lowest_point],
        "floor_m": branch.floor,
        "points_below_floor": branch.below,
        "jumps_after_lines": [path.table.lines[k] for k in branch.jumps],
    }


def _branch_words(branch: Branch, robot: Robot) -> str:
    values = ", ".join(
        f"{name} {1e3 * x:.0f} mm" if slides else f"{name} {np.degrees(x):.1f}°"
        for name, x, slides in zip(robot.actuated, branch.first, robot.prismatic, strict=True)
    )
    elbow = "stretched"
    if branch.elbow:
        side = "up" if branch.elbow_up else "down"
        elbow = f"elbow {side} ({branch.elbow} {1e3 * branch.elbow_height:.0f} mm high)"
    return (
        f"Branch at the first point: {elbow}; {values}. Lowest joint along the path: "
        f"{branch.lowest_joint}, {1e3 * branch.lowest:.0f} mm."
    )


def _movable(model: Model, text: str) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    unknown = [name for name in names if name not in model.robot.actuated]
    if unknown or not names:
        raise InputError(
            f"{unknown[0]!r} is no actuated joint" if unknown else "no joint is named",
            where="--only",
            remedy=f"Joints are: {', '.join(model.robot.actuated)}.",
        )
    return np.array([joint in names for joint in model.robot.actuated])


def _rms(where: Standing) -> float:
    """Over the points that have an equilibrium [m]; NaN if none has."""
    distances = where.distance[where.exists]
    return float(np.sqrt(np.mean(distances**2))) if len(distances) else float("nan")


def _largest(values: Array) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else float("nan")


def _notes(found: Compensation, doubt: dict[str, list[str]]) -> dict[str, list[str]]:
    def micrometres(where: Standing) -> list[str]:
        return ["" if np.isnan(d) else f"{d * 1e6:.4f}" for d in where.distance]

    return {
        "before[um]": micrometres(found.before),
        "after[um]": micrometres(found.after),
        **doubt,
        "remark": list(found.reasons),
    }


def _parts(document: dict[str, object], path: LoadedPath, found: Compensation) -> list[object]:
    parts: list[object] = [
        f"{document['rows']} points. Off its place before: {document['before_um']:.1f} µm rms, "
        f"{document['before_max_um']:.1f} at most; after: {document['after_um']:.3g} µm rms, "
        f"{document['after_max_um']:.3g} at most (judged by {document['judged_by']}).",
        f"Written: {document['out']}",
    ]
    left = [k for k, reason in enumerate(found.reasons) if reason]
    if left:
        rows = [
            (
                str(path.table.lines[k]),
                found.before.distance[k] * 1e6,
                found.after.distance[k] * 1e6,
                found.reasons[k],
            )
            for k in left[:LISTED]
        ]
        title = f"Not fully corrected: {len(left)} of {path.count} points"
        parts.append(table(title, ("line", "before [µm]", "after [µm]", "why"), rows))
    return parts
