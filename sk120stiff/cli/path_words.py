"""What `compensate` says: of the branch, of what remains, and of how sure it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array, largest, rms
from sk120stiff.cli.tables import table
from sk120stiff.cli.uncertainty import NO_REMAINDER, sentences
from sk120stiff.effects import Viewpoint
from sk120stiff.errors import InputError, two_digits, warn
from sk120stiff.model import Model, marker_off
from sk120stiff.model.predicted import blame_reason
from sk120stiff.plan import Cell, feasible
from sk120stiff.robot import Robot
from sk120stiff.show.wording import um_or_less
from sk120stiff.units import parse_values
from sk120stiff.workspace import (
    Branch,
    Compensation,
    LoadedPath,
    Standing,
    StandingUncertainty,
    lowest_floor,
)

ASKED = 2000  # points of a path that are asked whether the arm can take them up
FAR_OFF = 1e-3  # m from the stated place of the measured point: worth a word
LISTED = 10  # points that people are shown


def infeasible(
    robot: Robot, cell: Cell, a: Array, given: LoadedPath, wrench: Array | None
) -> list[dict[str, object]]:
    """Points of the path that the arm cannot take up or hold, with their lines; warns of them.

    Of a long path `ASKED` points are asked, evenly spread.
    """
    rows = np.unique(np.linspace(0, len(a) - 1, min(len(a), ASKED)).astype(int))
    rows = rows[np.isfinite(a[rows]).all(axis=1)]
    if not len(rows):
        return []
    verdict = feasible(robot, cell, a[rows], None if wrench is None else wrench[rows])
    wrong: list[dict[str, object]] = [
        {"line": given.table.lines[k], "faults": list(faults)}
        for k, faults in zip(rows, verdict.faults, strict=True)
        if faults
    ]
    if wrong:
        first = verdict.faults[int(np.argmin(verdict.ok))][0]
        warn(
            f"at {len(wrong)} of {len(rows)} points asked the arm cannot stand so or hold the "
            f"load, first in line {wrong[0]['line']}: {first}"
        )
    return wrong


def standing_notes(uncertainty: StandingUncertainty | None) -> dict[str, list[str]]:
    """Columns of the file; blank where nothing is known."""
    if uncertainty is None:
        return {}
    columns = {"after_std_parameters[um]": uncertainty.std_parameters}
    if uncertainty.std_remainder is not None:
        columns["after_std_remainder[um]"] = uncertainty.std_remainder
    return {
        name: [f"{x * 1e6:.4f}" if np.isfinite(x) else "" for x in std]
        for name, std in columns.items()
    }


def standing_keys(uncertainty: StandingUncertainty | None) -> dict[str, object]:
    """The key `uncertainty`, what it adds to that of other commands."""
    if uncertainty is None:
        return {}
    own, left = uncertainty.rms
    return {
        "after_std_parameters_um": own * 1e6,
        "after_std_remainder_um": None if left is None else left * 1e6,
        "unknown_because": blame_reason(uncertainty.blame) or None,
    }


def standing_words(model: Model, uncertainty: StandingUncertainty | None) -> list[str]:
    """How far off the corrected tool may stand in truth."""
    if uncertainty is None:
        return sentences(model, None, None)
    if uncertainty.blame:
        return [f"How far off it stands in truth is unknown: it {blame_reason(uncertainty.blame)}."]
    own, left = uncertainty.rms
    words = f"{two_digits(own * 1e6)} µm from the parameters"
    if left is None:
        words += f"; {NO_REMAINDER}"
    else:
        words += f", {two_digits(left * 1e6)} µm from what the model leaves unexplained"
    return [
        f"After ± {two_digits(1e6 * np.hypot(own, left or 0.0))} µm: one standard distance, "
        f"{words}."
    ]


def point_words(model: Model) -> tuple[str, ...]:
    """That the point of the path is the stated one, where the marker was found elsewhere."""
    said: tuple[str, ...] = ()
    if any(isinstance(effect, Viewpoint) for effect in model.effects):
        said = (
            "The base is where the fit put it in the tracker's frame, with what no reading tells "
            "apart from its place counted there: how far that is from the base of the robot's "
            "controller is in no ±; register the base of the cell anew, or measure and correct it.",
        )
    off = marker_off(model)
    if off < FAR_OFF:
        return said
    return (
        *said,
        f"The marker sat {1e3 * off:.4g} mm off its stated place (tool_offset): "
        "that is a matter of the measurement. What is brought onto the path is the stated point.",
    )


def floor_of(robot: Robot, text: str | None, path: LoadedPath) -> float:
    """The height that --floor names [m], else that of the base or of the path."""
    if text is None:
        heights = None if path.position is None else path.position[:, 2]
        return lowest_floor(robot, path.joints, heights)
    return float(parse_values(text, "length", where="--floor", like="-0.3 m")[0])


def warn_of_branch(branch: Branch, path: LoadedPath) -> None:
    """Warn of joints below the floor, and of jumps between points."""
    lines = path.table.lines
    if branch.below:
        warn(
            f"at {branch.below} of {path.count} points a joint of the arm lies below the floor "
            f"({1e3 * branch.floor:.0f} mm): {branch.lowest_joint} at "
            f"{1e3 * branch.lowest:.0f} mm, line {lines[branch.lowest_point]}. Choose another "
            "branch with --start, or say where the floor is with --floor"
        )
    for k in branch.jumps[:1]:
        more = f" (and {len(branch.jumps) - 1} more pairs)" if len(branch.jumps) > 1 else ""
        warn(
            f"between lines {lines[k]} and {lines[k + 1]}{more} a joint moves by more "
            "than 30 deg (or 0.5 m): the arm changes its posture there, or the way between is long "
            "and wants points of its own, as the correction in its middle does"
        )


def branch_keys(branch: Branch, path: LoadedPath, robot: Robot) -> dict[str, object]:
    """The key `branch`."""
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


def branch_words(branch: Branch, robot: Robot) -> str:
    """The posture in one sentence or two."""
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


def movable_joints(model: Model, text: str) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(n,) joints that --only names."""
    names = [name.strip() for name in text.split(",") if name.strip()]
    unknown = [name for name in names if name not in model.robot.actuated]
    if unknown or not names:
        raise InputError(
            f"{unknown[0]!r} is no actuated joint" if unknown else "no joint is named",
            where="--only",
            remedy=f"Joints are: {', '.join(model.robot.actuated)}.",
        )
    return np.array([joint in names for joint in model.robot.actuated])


def notes(found: Compensation, uncertainty: dict[str, list[str]]) -> dict[str, list[str]]:
    """Columns of the CSV file: what was off, what is, and why."""

    def micrometres(where: Standing) -> list[str]:
        return ["" if np.isnan(d) else f"{d * 1e6:.4f}" for d in where.distance]

    return {
        "before[um]": micrometres(found.before),
        "after[um]": micrometres(found.after),
        **uncertainty,
        "remark": list(found.reasons),
    }


def parts(document: dict[str, object], path: LoadedPath, found: Compensation) -> list[object]:
    """The answer for people: figures, file, and points that are not fully corrected."""
    after = found.after.distance
    told: list[object] = [
        f"{document['rows']} points. Off its place before: {document['before_um']:.1f} µm rms, "
        f"{document['before_max_um']:.1f} at most; after: {um_or_less(rms(after))} µm "
        f"rms, {um_or_less(largest(after))} at most (judged by "
        f"{Path(str(document['judged_by'])).name}).",
        f"Written: {document['out']}" + (f" and {document['sheet']}" if document["sheet"] else ""),
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
        told.append(table(title, ("line", "before [µm]", "after [µm]", "why"), rows))
    return told
