"""`sk120stiff export MODEL --out FILE`."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum
from pathlib import Path

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import frame_at, open_model, pose_of
from sk120stiff.cli.options import AtOption, ModelArgument, PoseOption
from sk120stiff.cli.tables import table
from sk120stiff.errors import InputError
from sk120stiff.exports import Request, Told, exported, format_of, write_exported
from sk120stiff.files import will_write


class Kind(StrEnum):
    """What other programs read."""

    urdf = "urdf"
    kinematics_params = "kinematics_params"
    dh = "dh"
    mjcf = "mjcf"
    sdf = "sdf"


def command(
    model: ModelArgument,
    out: Path | None = None,
    pose: PoseOption = None,
    at: AtOption = None,
    to: Kind | None = None,
) -> Answer:
    """A calibrated URDF, DH tables, or an arm for a simulator.

    A URDF, UR's kinematics_params and DH tables hold the rigid geometry as the model has it. Models
    for MuJoCo and SDF move: position actuators at the joints, the springs behind them, the robot's
    own shapes and masses. At rest under a load they stand where the model does. What a format
    cannot hold is told by name.

    Example: sk120stiff export model.yaml --pose '0,20,-30,0,-60,0 deg' --out sk120.xml

    Args:
        out (FILE): Where to write it: .urdf, .yaml (kinematics_params of UR's driver), .csv (DH
            tables), .xml (MuJoCo) or .sdf. [default: only say what would be carried; give --to]
        to: The format. [default: by the ending of FILE]
    """
    will_write(out)
    chosen = format_of(out, None if to is None else to.value)
    if not chosen.moves and (pose is not None or at is not None):
        raise InputError(
            f"{chosen.title} holds no pose and no load",
            where="--pose" if pose is not None else "--at",
            remedy="Leave it out, or export to .xml or .sdf.",
        )
    believed = open_model(model)
    robot = believed.robot
    target = out or Path(f"{robot.name}{chosen.endings[0]}")
    a = pose_of(robot, pose) if chosen.moves else None
    frame = frame_at(robot, at) if chosen.moves else None
    made = exported(believed, Request(target, a, frame), chosen)
    if out is not None:
        write_exported(made, out)
    document = {
        "robot": robot.name,
        "format": chosen.name,
        "out": None if out is None else str(out),
        "files": [str(target.parent / name) for name in made.files],
        "carried": made.carried,
        "left_out": made.left_out,
        "notes": made.notes,
        **made.details,
    }
    parts: list[object] = [
        f"{chosen.title} written: {out}"
        if out is not None
        else f"{chosen.title}; nothing is written without --out.",
    ]
    if made.rows:
        parts.append(table(made.title, made.header, made.rows))
    parts += [*_by_reason("Carried", made.carried), *_by_reason("Left out", made.left_out)]
    return Answer(document, [*parts, *made.notes])


def _by_reason(title: str, told: Iterable[Told]) -> list[str]:
    """One line for each reason, with the effects that share it."""
    reasons: dict[str, list[str]] = {}
    for each in told:
        reasons.setdefault(each.how, []).append(each.effect)
    return [f"{title} ({how}): {', '.join(effects)}." for how, effects in reasons.items()]
