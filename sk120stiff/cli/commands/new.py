"""`sk120stiff new ROBOT --out DIR`."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
import yaml

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_robot
from sk120stiff.cli.options import BaseOption, RobotArgument, ToolOption
from sk120stiff.cli.tables import table
from sk120stiff.effects import load_case
from sk120stiff.errors import InputError
from sk120stiff.files import together, will_write, write_atomically
from sk120stiff.identify import why_unseen
from sk120stiff.model import Model, typical_model, write_model
from sk120stiff.model.typical import RULE
from sk120stiff.robot import Robot, find_robot
from sk120stiff.robot.anatomy import sample_poses
from sk120stiff.robot.naming import robot_name

ROBOT, MODEL, READINGS, SETTINGS = "robot.yaml", "model.yaml", "readings.csv", "readings.yaml"
FILES = (ROBOT, MODEL, READINGS, SETTINGS)
COUNT = 15  # readings of the plan that is proposed
PROBE = np.array([100.0, 70.0, -50.0, 0.0, 0.0, 0.0])  # N; a load that passes through no axis


def command(
    robot: RobotArgument,
    out: Annotated[Path, typer.Option("--out")],
    base: BaseOption = None,
    tool: ToolOption = None,
) -> Answer:
    """A folder to start from: robot, model, empty measurements.

    Writes robot.yaml, a model.yaml with joint springs typical of an arm of this size (from its
    reach and the efforts that its URDF states; not measured), and readings.csv and readings.yaml
    with the joints' names and units, to be filled in. Replaces no file.

    Example: sk120stiff new my_robot.urdf --out my_robot

    Args:
        out (DIR): Folder to make.
    """
    for name in FILES:
        if (out / name).exists():
            raise InputError(
                f"{name} is there already, and nothing is replaced",
                where=f"--out {out}",
                remedy="Name another folder, or move the file.",
            )
        will_write(out / name)
    arm = open_robot(robot, base, tool)
    model = typical_model(replace(arm, source=str(out)))
    with together(last=out / ROBOT):
        write_atomically(out / ROBOT, _description(robot, arm, out))
        write_model(model, out / MODEL)
        write_atomically(out / READINGS, _header(arm) + "\n")
        write_atomically(out / SETTINGS, _settings(arm))
    plan = out / "plan.csv"
    following = f"sk120stiff plan --model {_quoted(out / MODEL)} --count {COUNT} --out " + _quoted(
        plan
    )
    unseen = _unseen(model)
    springs = [
        {"joint": p.effect.where, "stiffness": p.value, "unit": p.spec.unit}
        for p in model.parameters
    ]
    document = {
        "robot": arm.name,
        "files": [out / name for name in FILES],
        "springs": springs,
        "rule": RULE,
        "cannot_be_seen": unseen,
        "next": following,
    }
    rows = [tuple(spring.values()) for spring in springs]
    parts: list[object] = [
        f"Written to {out}: {', '.join(FILES)}.",
        table("Springs typical of an arm of this size, not measured", ["joint", "", ""], rows),
        RULE,
        *(f"The spring of {joint} cannot be seen so: {why}." for joint, why in unseen.items()),
        f"Next: {following}",
    ]
    return Answer(document, parts)


def _description(named: str, arm: Robot, out: Path) -> str:
    """`robot.yaml`: what the robot's own said, if it had one, with the frames written down."""
    found = find_robot(named)
    if str(found.urdf).lstrip().startswith("<"):
        raise InputError("give a file, not text", where="ROBOT")
    urdf = Path(found.urdf)
    told = Path(robot_name(named).place)
    nearby = not told.is_absolute() and told.exists()
    place = Path(os.path.relpath(urdf, out)).as_posix() if nearby else str(urdf.resolve())
    kept = found.description.model_dump(mode="json", exclude_defaults=True)
    described: dict[str, object] = {
        "name": arm.name,
        **kept,
        "urdf": place,
        **({"xacro": dict(found.xacro)} if found.xacro else {}),
        "base_frame": arm.base_frame,
        "tool_frame": arm.tool_frame,
        "actuated": list(arm.actuated),
    }
    return _yaml(described)


def _header(arm: Robot) -> str:
    """The measurements' first line: every column that the arm needs, with its unit."""
    joints = [
        f"{name}[{'mm' if slides else 'deg'}]"
        for name, slides in zip(arm.actuated, arm.prismatic, strict=True)
    ]
    loads, moved = (f"f{axis}[N]" for axis in "xyz"), (f"d{axis}[mm]" for axis in "xyz")
    return ",".join(["pose", *joints, *loads, *moved])


def _settings(arm: Robot) -> str:
    """The measurements' YAML file, with a word on what to fill in."""
    frames = {"robot": ".", "base_frame": arm.base_frame, "tool_frame": arm.tool_frame}
    return _yaml(frames) + (
        "# Where the reflector sits in the tool frame: off the last axis, or its spring cannot be\n"
        "# seen.\n"
        "point: {xyz: [0.0, 0.0, 0.0], unit: mm}\n"
        "force: {frame: base}            # or tool\n"
        "# zero: shared where the rows of a pose subtract one zero reading, separate where each\n"
        "# has its own.\n"
        "displacement: {frame: base, zero: unknown}\n"
        "# noise: {sigma: 10, unit: um}  # of one reading per axis, if you know it\n"
        "source: ''                      # where the numbers come from\n"
    )


def _unseen(model: Model) -> dict[str, str]:
    """Joint → reason why its spring cannot show at the tool frame's origin."""
    arm = model.robot
    poses = sample_poses(arm, 5)
    load_cases = load_case(arm, poses, np.tile(PROBE, (len(poses), 1)))
    found = ((p.effect.where, why_unseen(load_cases, p)) for p in model.parameters)
    return {joint: why for joint, why in found if why is not None}


def _yaml(content: Mapping[str, object]) -> str:
    return str(yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=100))


def _quoted(path: Path) -> str:
    return shlex.quote(str(path))
