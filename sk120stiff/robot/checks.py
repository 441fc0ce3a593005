"""`check`: does a robot load, what moves, what is suspicious."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass

import numpy as np

from sk120stiff.errors import ToolkitError, ToolkitWarning
from sk120stiff.robot.loading import assemble, find_robot, told_joints
from sk120stiff.robot.robot import Robot
from sk120stiff.robot.urdf import (
    Finding,
    FrameChoice,
    default_frames,
    fingers_on_way,
    locked_on_way,
    read_urdf,
    suspicions,
)

_SINGULAR = 1e-6  # smallest singular value of J over the largest, lengths scaled by the reach


@dataclass(frozen=True)
class CheckReport:
    """What `check` says about a robot.

    Attributes:
        name: Name of the robot.
        actuated: Joints that motors drive between base and tool; empty when nothing moves there.
        coupled: Joints that follow another one, as rules ``follower = multiplier · driver +
            offset``, and joints that a closed loop determines.
        loops: Closed loops that `robot.yaml` declares.
        frames: All frames (URDF links).
        base_frame, tool_frame, chosen_because: Frames between which the arm is described, and why,
            in sentences.
        choice: What would be taken if nobody named frames: other ends of the robot, fingers.
        moving: All joints with a degree of freedom, coupled ones included.
        total_mass_kg: Sum of all link masses, the root's included [kg].
        warnings: Repairs made while reading, then whatever else is odd.
    """

    name: str
    actuated: tuple[str, ...]
    coupled: tuple[str, ...]
    loops: tuple[str, ...]
    frames: tuple[str, ...]
    base_frame: str
    tool_frame: str
    chosen_because: tuple[str, ...]
    choice: FrameChoice
    moving: tuple[str, ...]
    total_mass_kg: float
    warnings: tuple[Finding, ...]


def check_robot(
    source: str | os.PathLike[str], *, base: str | None = None, tool: str | None = None
) -> CheckReport:
    """Load a robot and look at everything that could be wrong with it.

    Args:
        source: Bundled name, ``.urdf``, ``.xacro``, folder, or URDF text.
        base, tool: Frames between which the arm is described; defaults as in `load_robot`.

    Raises:
        InputError: The robot is refused. A robot in which nothing moves is no refusal here but a
            warning.
    """
    found = find_robot(source)
    document = read_urdf(found.urdf, xacro_arguments=found.xacro)
    findings = [*document.warnings, *suspicions(document)]
    arm = (*(found.description.actuated or ()), *told_joints(document, found.description))
    guessed = default_frames(document, arm)
    base_frame = base or found.description.base_frame or guessed.base
    tool_frame = tool or found.description.tool_frame or guessed.tool
    reasons = list(guessed.sentences)
    if base or found.description.base_frame:
        reasons[0] = f"base frame {base_frame!r}: as told"
    if tool or found.description.tool_frame:
        reasons[1:] = [f"tool frame {tool_frame!r}: as told"]
    findings.extend(locked_on_way(document, base_frame, tool_frame))
    if not found.description.actuated:
        findings.extend(fingers_on_way(document, guessed, base_frame, tool_frame))
    robot: Robot | None = None
    if document.moving_joints:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore", ToolkitWarning)  # they stand in the report
            robot = assemble(found, document, named=os.fspath(source), base=base, tool=tool)
            findings.extend(_kinematics(robot))
    else:
        findings.append(Finding("nothing_moves", document.place, "no joint of this robot moves"))
    return CheckReport(
        name=robot.name if robot is not None else document.name,
        actuated=robot.actuated if robot is not None else (),
        coupled=_rules(robot),
        loops=()
        if robot is None
        else tuple(
            f"{closure.name}: {' meets '.join(closure.frames)}" for closure in robot.closures
        ),
        frames=tuple(link.name for link in document.links),
        base_frame=base_frame,
        tool_frame=tool_frame,
        chosen_because=tuple(reasons),
        choice=guessed,
        moving=tuple(joint.name for joint in document.moving_joints),
        total_mass_kg=document.total_mass,
        warnings=tuple(findings),
    )


def _rules(robot: Robot | None) -> tuple[str, ...]:
    if robot is None:
        return ()
    rules = [
        f"{name} = {rule.multiplier:g} · {rule.driver} + {rule.offset:g}"
        for name, rule in robot.followers.items()
    ]
    return (*rules, *(f"{name} by a closed loop" for name in robot.dependent))


def _kinematics(robot: Robot) -> list[Finding]:
    """What the arm itself shows: a singular zero pose, joints that do not move the tool."""
    findings = []
    where = f"{robot.base_frame} → {robot.tool_frame}"
    try:
        J = robot.jacobian(np.zeros(robot.n))  # (6, n)
    except ToolkitError as error:
        message = f"the loops cannot be closed with all joints at zero: {error.what}"
        return [Finding("open_at_zero", where, message)]
    if not np.isfinite(J).all():
        return [Finding("not_finite", where, "the Jacobian overflows: look at lengths and axes")]
    reach = float(np.max(np.linalg.norm(J[:3], axis=0), initial=0.0)) or 1.0
    scaled = np.vstack([J[:3] / reach, J[3:]])
    idle = [name for name, column in zip(robot.actuated, scaled.T, strict=True) if not column.any()]
    if idle:
        names = ", ".join(idle)
        findings.append(Finding("idle_joint", where, f"does not move the tool: {names}"))
    values = np.linalg.svd(scaled, compute_uv=False)
    rank = int(np.sum(values > _SINGULAR * values[0])) if values[0] > 0.0 else 0
    if rank < min(6, robot.n):
        findings.append(
            Finding(
                "singular_at_zero",
                where,
                f"the pose with all joints at zero is singular (rank {rank} of {min(6, robot.n)})",
            )
        )
    return findings
