"""`sk120stiff import CSV --robot ROBOT --out FILE.csv`."""
# ruff: noqa: N999 - the file is named as its command, and is imported by that name alone

from __future__ import annotations

import warnings
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.arrays import Array, Index
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import declare_readings, open_robot, wrench_of
from sk120stiff.cli.options import BaseOption, ToolOption
from sk120stiff.errors import Refusal, ToolkitWarning
from sk120stiff.measurements import Measurements, read_figaroh, write_measurements
from sk120stiff.measurements.registration import Registration, register, registration_doubts
from sk120stiff.robot.anatomy import arm_length
from sk120stiff.robot.naming import RobotName, robot_name
from sk120stiff.units import parse_values

# Of the stretched arm. Zeros that are one degree off in every joint leave about 2 %, arms as they
# are delivered 0.1 to 0.3 %.
NO_SUCH_ROBOT, MISCALIBRATED = 0.03, 0.01


class Length(StrEnum):
    """Unit of marker coordinates."""

    m = "m"
    mm = "mm"


class Angle(StrEnum):
    """Unit of joint values."""

    rad = "rad"
    deg = "deg"


class Load(StrEnum):
    """Unit of forces, or of a payload."""

    N = "N"
    kN = "kN"
    kg = "kg"


def command(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="CSV",
            help="Columns x1,y1,z1 and the joints (their names, or q1,q2,...); for the load "
            "fx,fy,fz or payload or load; pose and use where there are any.",
            show_default=False,
        ),
    ],
    robot: Annotated[
        str,
        typer.Option(
            "--robot",
            metavar="ROBOT",
            help="A .urdf, a .xacro, a folder with robot.yaml, or a bundled name (motoman_sk120).",
            show_default=False,
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            metavar="FILE",
            help="The CSV file to write; a YAML file goes beside it.",
            show_default=False,
        ),
    ],
    length: Annotated[
        Length | None, typer.Option(help="Unit of positions, where headers carry none.")
    ] = None,
    angle: Annotated[
        Angle | None, typer.Option(help="Unit of joint angles, where headers carry none.")
    ] = None,
    load: Annotated[
        Load | None, typer.Option(help="Unit of fx,fy,fz or payload (kg: payload alone).")
    ] = None,
    wrench: Annotated[
        str | None,
        typer.Option(
            metavar="VALUES",
            help="What the column load counts, on the robot in base axes: '0,0,-490 N'.",
            show_default=False,
        ),
    ] = None,
    marker: Annotated[
        int | None,
        typer.Option(metavar="N", help="Which marker, where there are several."),
    ] = None,
    point: Annotated[
        str | None,
        typer.Option(
            metavar="VALUES",
            help="Where the marker sits in the tool frame: '0,0,150 mm'.",
            show_default="its origin",
        ),
    ] = None,
    joints: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Columns of the actuated joints, in the joints' order: 'a,b,c'.",
            show_default="named as the joints, or q1,q2,...",
        ),
    ] = None,
    base: BaseOption = None,
    tool: ToolOption = None,
) -> Answer:
    """A calibration file of marker positions as measurements.

    For files as FIGAROH takes them. Says what was assumed, how well the positions fit the robot,
    and what can be identified: without two loads at one pose, nothing about stiffness.

    Example: sk120stiff import marks.csv --robot motoman_sk120 --length m --angle rad --out own.csv
    """
    declare_readings(out)
    arm = open_robot(robot, base, tool)
    found = read_figaroh(
        source,
        arm.actuated,
        prismatic=[n for n, slides in zip(arm.actuated, arm.prismatic, strict=True) if slides],
        length=length,
        angle=angle,
        load=load,
        wrench=None if wrench is None else wrench_of(wrench),
        joints=None if joints is None else [name.strip() for name in joints.split(",")],
        marker=marker,
        point=None
        if point is None
        else parse_values(point, "length", where="--point", like="0,0,150 mm"),
    )
    readings = replace(
        found.measurements,
        robot=_lasting(arm.source),
        base_frame=arm.base_frame,
        tool_frame=arm.tool_frame,
    )
    first, measured = _positions(readings)
    reached = arm.placement(readings.joints[first], point=readings.point)
    doubts = registration_doubts(measured, reached[..., :3, 3])
    flange = arm.placement(readings.joints[first])
    fitted = register(measured, flange[..., :3, 3], reached[..., :3, :3], readings.point)
    labels = [readings.pose[k] for k in first]
    said, doubted = _judged(fitted, arm_length(arm), arm.name, labels, doubts)
    doubts += doubted
    for sentence in doubts:
        warnings.warn(sentence, ToolkitWarning, stacklevel=2)
    write_measurements(readings, out, as_positions=True)
    document = {
        "rows": readings.n_readings,
        "poses": len(readings.poses),
        "useful_poses": found.useful_poses,
        "rows_with_load_difference": found.differences,
        "stiffness_identifiable": found.differences > 0,
        "identifiable": found.identifiable,
        "assumed": list(found.assumed),
        "doubts": doubts,
        "registration": None
        if fitted is None
        else {
            "rms_mm": fitted.rms * 1e3,
            "largest_mm": fitted.largest * 1e3,
            "worst_pose": labels[fitted.worst],
            "poses": fitted.poses,
            "marker_m": fitted.marker,
            "marker_fitted": fitted.marker_fitted,
        },
        "largest_load_N": float(np.linalg.norm(readings.wrench[:, :3], axis=1).max()),
        "out": out,
    }
    parts: list[object] = [
        f"{readings.n_readings} rows at {len(readings.poses)} poses.",
        "Assumed:",
        *(f"- {sentence}" for sentence in found.assumed),
        said,
        "What can be identified:",
        found.identifiable,
        f"Written to {out} and {out.with_suffix('.yaml')}.",
    ]
    return Answer(document, parts)


def _positions(readings: Measurements) -> tuple[Index, Array]:
    """First row in use of each pose (P,), and the positions measured there (P, 3) [m]."""
    used = np.flatnonzero(readings.use)
    first = used[np.sort(np.unique(readings.pose_index[used], return_index=True)[1])]
    if readings.displacement is None:
        return first[:0], np.zeros((0, 3))
    return first, readings.displacement[first]


def _judged(
    fitted: Registration | None, length: float, name: str, labels: list[str], doubts: list[str]
) -> tuple[str, list[str]]:
    """What is said of the fit, and what is doubted.

    Raises:
        Refusal: The positions are not those of this robot.
    """
    if fitted is None:
        return "Fewer than three poses: whether they are this robot's was not checked.", []
    share = fitted.rms / length
    freed = "the tracker's frame" + (" and the marker's place" if fitted.marker_fitted else "")
    said = (
        f"Against {name} the positions are {fitted.rms * 1e3:.3g} mm off (rms of {fitted.poses} "
        f"poses, {freed} fitted), {fitted.largest * 1e3:.3g} mm at pose {labels[fitted.worst]}: "
        f"{100 * share:.2g} % of the arm's {length:.3g} m."
    )
    if share > NO_SUCH_ROBOT:
        raise Refusal(
            f"{said[:-1]}. These are not this robot's positions",
            where="--robot",
            remedy=" ".join([*doubts, "Check the robot, and the order, signs, zeros and units of "
            "its joints (--joints, --angle, --length)."]),
        )  # fmt: skip
    if share > MISCALIBRATED:
        return said, [f"{said} A robot of this make is nearer: check signs and zeros of joints."]
    return said, []


def _lasting(source: str) -> str:
    """The robot's name as it holds in any folder."""
    name = robot_name(source)
    path = Path(name.place)
    return str(RobotName(str(path.resolve()), name.arguments)) if path.exists() else source
