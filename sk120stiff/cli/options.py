"""Arguments and options that several commands share, declared once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def _robots(incomplete: str) -> list[str]:
    from sk120stiff.robot.bundled import bundled_robots

    return [name for name in bundled_robots() if name.startswith(incomplete)]


RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A .urdf, a .xacro, a DH table (.csv), a folder with robot.yaml, or a bundled name "
        "(motoman_sk120).",
        autocompletion=_robots,
        show_default=False,
    ),
]
RobotOrModelArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT|MODEL",
        help="A robot (a .urdf, a .xacro, a folder with robot.yaml, a bundled name), or a model "
        "file (YAML), which knows its robot.",
        autocompletion=_robots,
        show_default=False,
    ),
]
DataArgument = Annotated[
    Path,
    typer.Argument(
        metavar="DATA",
        help="Measurements: a CSV with units in its header, and a YAML file of the same stem.",
        show_default=False,
    ),
]
ModelArgument = Annotated[
    str,
    typer.Argument(
        metavar="MODEL|ROBOT",
        help="A model file (YAML), or a robot: then the model beside its robot.yaml, else springs "
        "typical of its size.",
        autocompletion=_robots,
        show_default=False,
    ),
]
PoseOption = Annotated[
    str | None,
    typer.Option(
        "--pose",
        metavar="VALUES",
        help="Joint values with their unit, all of them ('10,20,-30,0,0,0 deg') or some "
        "('joint_2_l=20 deg'), the rest at zero.",
        show_default="all joints at zero",
    ),
]
WrenchOption = Annotated[
    str | None,
    typer.Option(
        "--wrench",
        metavar="VALUES",
        help="Force, or force and moment, on the robot in axes of the base frame, with units: "
        "'100,0,-200 N' or '100,0,-200,0,5,0 N, N*m'.",
        show_default="no load",
    ),
]
BaseOption = Annotated[
    str | None,
    typer.Option(
        "--base",
        metavar="FRAME",
        help="Frame (URDF link) that the arm stands on.",
        show_default="the robot's own, else the root",
    ),
]
ToolOption = Annotated[
    str | None,
    typer.Option(
        "--tool",
        metavar="FRAME",
        help="Frame (URDF link) at the end of the arm.",
        show_default="the robot's own, else the end of its longest arm",
    ),
]
ModelOption = Annotated[
    Path | None,
    typer.Option(
        "--model",
        metavar="MODEL",
        help="Model file (YAML) with the effects and their values; or a robot that has one.",
        show_default="the one beside robot.yaml",
    ),
]
AtOption = Annotated[
    str | None,
    typer.Option(
        "--at",
        metavar="FRAME",
        help="Frame at whose origin the load acts and the stiffness is asked for.",
        show_default="the tool frame",
    ),
]
OutOption = Annotated[
    Path | None,
    typer.Option("--out", metavar="FILE", help="Where to write the result.", show_default=False),
]
OutFolderOption = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Folder that the results are written to.", show_default=False
    ),
]
SeedOption = Annotated[
    int, typer.Option("--seed", min=0, metavar="N", help="Seed of the random numbers.")
]
