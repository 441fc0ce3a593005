"""`sk120stiff export MODEL --pose ... --out FILE`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_model, pose_of
from sk120stiff.cli.options import AtOption, ModelArgument, PoseOption
from sk120stiff.cli.tables import table
from sk120stiff.errors import InputError
from sk120stiff.files import will_write, write_atomically
from sk120stiff.workspace import FORMATS, spring_arm

_BY_ENDING = {".xml": "mjcf", ".mjcf": "mjcf", ".sdf": "sdf"}


class Format(StrEnum):
    """What simulators read."""

    mjcf = "mjcf"
    sdf = "sdf"


def command(
    model: ModelArgument,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="Where to write it: .xml or .sdf.")
    ],
    pose: PoseOption = None,
    at: AtOption = None,
    to: Annotated[
        Format | None,
        typer.Option("--to", help="The format.", show_default="by the ending of FILE"),
    ] = None,
) -> Answer:
    """The modelled arm as a file for MuJoCo or SDF simulators.

    Bodies, joints and springs, commanded to a pose. Joints that no spring reaches are built in at
    the pose; joints that follow others still do. The exported arm deflects as the model does, to
    well below a micrometre.

    Example: sk120stiff export model.yaml --pose '0,20,-30,0,-60,0 deg' --out sk120.xml
    """
    will_write(out)
    believed = open_model(model)
    robot = believed.robot
    chosen = to.value if to is not None else _BY_ENDING.get(out.suffix.lower())
    if chosen is None:
        raise InputError(
            f"the ending {out.suffix!r} names no format",
            where=str(out),
            remedy="Name the file .xml (MuJoCo) or .sdf, or give --to.",
        )
    arm = spring_arm(believed, pose_of(robot, pose), frame=at)
    writer, title = FORMATS[chosen]
    write_atomically(out, writer(arm))
    springs = [
        {
            "joint": body.name,
            "stiffness": body.stiffness,
            "unit": "N/m" if body.slides else "N*m/rad",
            "reference": body.reference,
        }
        for body in arm.bodies
        if body.stiffness
    ]
    document = {
        "robot": robot.name,
        "format": chosen,
        "out": str(out),
        "frame": arm.frame,
        "springs": springs,
        "coupled": [{"weights": one.weights, "stiffness": one.stiffness} for one in arm.springs],
        "followers": [
            {"joint": one.joint, "drivers": one.drivers, "offset": one.offset}
            for one in arm.followers
        ],
        "held": arm.held,
    }
    rows = [(spring["joint"], spring["stiffness"], spring["unit"]) for spring in springs]
    held = ", ".join(arm.held) or "none"
    parts: list[object] = [
        f"{title} written: {out}",
        table("Springs", ("joint", "stiffness", ""), rows),
        f"Held where the pose puts them: {held}.",
    ]
    if arm.springs:
        parts.append(f"{len(arm.springs)} springs tie joints together.")
    return Answer(document, parts)
