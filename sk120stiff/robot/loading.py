"""From whatever the user names, a bundled robot, a folder or a URDF, to a `Robot`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, warn
from sk120stiff.robot.bundled import bundled_robots
from sk120stiff.robot.description import RobotDescription, read_description, xacro_value
from sk120stiff.robot.kinematics.coupling import Coupling, Follower, linear_coupling
from sk120stiff.robot.kinematics.tree import Tree
from sk120stiff.robot.loops.building import closures_of, loop_coupling, loop_drivers
from sk120stiff.robot.naming import robot_name
from sk120stiff.robot.robot import Linkage, Robot
from sk120stiff.robot.urdf import (
    BALLS,
    HARMLESS,
    Finding,
    UrdfDocument,
    default_frames,
    fingers_on_way,
    locked_on_way,
    read_urdf,
    refuse_orphans,
    with_arm_only,
)

_MOST_WARNINGS = 20

Source = str | os.PathLike[str]


@dataclass(frozen=True)
class RobotSource:
    """Where a robot comes from: its URDF, and its `robot.yaml` where there is one.

    `xacro` holds the arguments of its xacro.
    """

    urdf: Source
    xacro: Mapping[str, str] = field(default_factory=dict)
    folder: Path | None = None
    description: RobotDescription = field(default_factory=RobotDescription)

    @property
    def model_file(self) -> Path | None:
        """The base model that lies beside `robot.yaml`, if any."""
        candidate = self.folder / "model.yaml" if self.folder else None
        return candidate if candidate and candidate.is_file() else None


def find_robot(source: Source, *, relative_to: Path | None = None) -> RobotSource:
    """Tell a bundled name, a folder with `robot.yaml`, a file and URDF text apart.

    Args:
        source: Bundled name, path or XML text; a name or a path may be followed by ``NAME:=VALUE``.
        relative_to: Folder against which a relative path is tried first.

    Raises:
        InputError: Nothing of that name; the bundled robots are listed.
    """
    text, arguments = robot_name(os.fspath(source))
    if text.lstrip("\ufeff \t\r\n").startswith("<"):
        return RobotSource(urdf=text)
    bundled = bundled_robots()
    candidates = [relative_to / text] if relative_to else []
    candidates.append(Path(text))
    path = next((p for p in candidates if text.strip() and _exists(p)), None)
    if path is None and text in bundled:
        path = bundled[text]
    if path is None:
        raise InputError(
            "there is no such robot",
            where=text[:200] or "(no name)",
            remedy="Give a .urdf, a .xacro, a DH table (.csv), a folder with robot.yaml, or a "
            "bundled name: " + ", ".join(sorted(bundled)) + ".",
        )
    if path.name == "robot.yaml" and path.is_file():
        path = path.parent
    if path.is_dir() and (path / "robot.yaml").is_file():
        description = read_description(path / "robot.yaml")
        told = {name: xacro_value(value) for name, value in description.xacro.items()}
        return RobotSource(path / description.urdf, {**told, **arguments}, path, description)
    return RobotSource(path, arguments)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # names that are too long or hold zero bytes
        return False


def load_robot(
    source: Source,
    *,
    base: str | None = None,
    tool: str | None = None,
    actuated: Sequence[str] | None = None,
    lock: Mapping[str, float] | None = None,
    xacro: Mapping[str, str] | None = None,
    relative_to: Path | None = None,
) -> Robot:
    """Load the rigid kinematics of any robot arm.

    Args:
        source: Bundled name (``"motoman_sk120"``), ``.urdf`` or ``.xacro`` file, DH table
            (``.csv``), folder with ``robot.yaml``, or URDF text.
        base, tool: Frames (URDF links) between which the arm is described. Default: what
            ``robot.yaml`` says, else the root and the end of the longest arm (`Robot.choice`).
        actuated: Joints that motors drive, in the wanted order. Default: what ``robot.yaml`` says,
            else all moving joints between base and tool that mimic no other.
        lock: Values [rad or m] at which joints that are not actuated are held; zero else.
        xacro: Values of the arguments of a xacro, on top of those of ``robot.yaml``.
        relative_to: Folder against which a relative path is tried first.

    Raises:
        InputError: The file cannot be read or describes no arm; the message names place and remedy.

    Examples:
        >>> import sk120stiff as sk
        >>> robot = sk.load_robot("motoman_sk120")
        >>> robot.n, robot.tool_frame
        (6, 'tool0')
    """
    name = robot_name(os.fspath(source)).with_arguments(xacro or {})
    named = str(name if relative_to is None else name.found_from(relative_to))
    found = find_robot(named)
    document = read_urdf(found.urdf, xacro_arguments=found.xacro)
    return assemble(
        found, document, named=named, base=base, tool=tool, actuated=actuated, lock=lock
    )


def assemble(
    found: RobotSource,
    document: UrdfDocument,
    *,
    named: str,
    base: str | None = None,
    tool: str | None = None,
    actuated: Sequence[str] | None = None,
    lock: Mapping[str, float] | None = None,
) -> Robot:
    """The second half of `load_robot`, for a document that was read already.

    `named` finds the robot again from the working folder; files name it as seen from theirs.
    """
    description = found.description
    rest = {**description.lock, **(lock or {})}
    closures = closures_of(description)
    given = tuple(actuated or description.actuated or ())
    wanted = [*given, *told_joints(document, description)]
    guessed = default_frames(document, wanted)
    base_frame = base or description.base_frame or guessed.base
    tool_frame = tool or description.tool_frame or guessed.tool
    document = with_arm_only(document, base_frame, tool_frame, wanted, rest)
    tree = Tree(document.xml)
    followers = _followers(document, description)
    drivers = _drivers(tree, base_frame, tool_frame, followers)
    if closures and not given:
        drivers = loop_drivers(tree, closures, drivers, followers, rest)
    chosen = given or drivers
    _refuse_balls(document, base_frame, tool_frame, rest)
    settled = {*rest, *followers, *given}
    refuse_orphans(document, base_frame, tool_frame, settled)
    _check_actuated(chosen, tree, followers, document)
    for name in rest:
        if name not in document.locked:
            tree.joint_index(name)
    odd = [] if given else fingers_on_way(document, guessed, base_frame, tool_frame)
    _tell(document, [*odd, *locked_on_way(document, base_frame, tool_frame)])
    coupling: Coupling = linear_coupling(tree.joint_names, chosen, followers, rest)
    dependent: tuple[str, ...] = ()
    if closures:
        loops = loop_coupling(tree, closures, chosen, followers, rest, _start(description))
        coupling, dependent = loops, loops.dependent
    lower, upper = _limits(document, chosen)
    return Robot(
        name=description.name or document.name,
        base_frame=base_frame,
        tool_frame=tool_frame,
        actuated=chosen,
        lower=lower,
        upper=upper,
        tree=tree,
        coupling=coupling,
        document=document,
        choice=guessed,
        source=named,
        followers=followers,
        locked={
            name: rest.get(name, 0.0)
            for name in tree.joint_names
            if name not in chosen and name not in followers and name not in dependent
        },
        linkages=tuple(
            Linkage(rule.rod, rule.drivers, rule.corners) for rule in description.linkages
        ),
        foundation=_foundation(description, tree, base_frame),
        controller=description.controller,
        notes=description.notes.strip(),
    )


def told_joints(document: UrdfDocument, description: RobotDescription) -> tuple[str, ...]:
    """Joints of which `robot.yaml` says that they belong to the arm: coupled ones, and loops."""
    couplings = [*description.couplings, *(rule.driver for rule in description.couplings.values())]
    ends = [frame for rule in description.closures for frame in rule.frames]
    looped = [joint.name for frame in ends for joint in document.way("", frame)]
    return (*couplings, *looped)


def _start(description: RobotDescription) -> dict[str, float]:
    """Values of joints near which the loops are closed [rad or m]."""
    return {name: value for rule in description.closures for name, value in rule.start.items()}


def _followers(document: UrdfDocument, description: RobotDescription) -> dict[str, Follower]:
    """Mimic rules of the URDF, extended and overruled by those of `robot.yaml`."""
    rules = {
        joint.name: Follower(*joint.mimic) for joint in document.joints if joint.mimic is not None
    }
    for name, rule in description.couplings.items():
        rules[name] = Follower(rule.driver, rule.multiplier, rule.offset)
    return rules


def _drivers(
    tree: Tree, base: str, tool: str, followers: Mapping[str, Follower]
) -> tuple[str, ...]:
    """Joints on the way to the tool that follow no other, and the drivers of those that do."""
    found: list[str] = []
    for k in tree.path(base, tool):
        name = tree.joint_names[k]
        seen = {name}
        while name in followers:
            name = followers[name].driver
            if name in seen or name not in tree.joint_names:
                break  # linear_coupling refuses this with the full story
            seen.add(name)
        if name not in found and name in tree.joint_names:
            found.append(name)
    return tuple(found)


def _refuse_balls(document: UrdfDocument, base: str, tool: str, rest: Mapping[str, float]) -> None:
    """A ball joint on the way to the tool must be locked by the user's own word."""
    for joint in document.way(base, tool):
        if joint.source_type in BALLS and joint.name not in rest:
            raise InputError(
                f"this joint lies between {base!r} and {tool!r}, but cannot be driven: "
                f"{document.locked[joint.name]}",
                where=f"{document.place}, line {joint.line}, joint {joint.name!r}",
                remedy="Model it as three revolute joints, choose other frames, or hold it still: "
                f"lock: {{{joint.name}: 0.0}} in robot.yaml.",
            )
        if rest.get(joint.name, 0.0) != 0.0 and joint.name in document.locked:
            raise InputError(
                f"this joint can be held at zero only, because {document.locked[joint.name]}",
                where=f"joint {joint.name!r}",
                remedy="Put the wanted pose into the <origin> of the joint.",
            )


def _tell(document: UrdfDocument, on_way: Sequence[Finding]) -> None:
    """Warn of every repair that touches kinematics or masses, once of each kind.

    `check` tells the rest, and where each is.
    """
    told: dict[tuple[str, str], list[Finding]] = {}
    for finding in (*document.warnings, *on_way):
        if finding.code not in HARMLESS:
            told.setdefault((finding.code, finding.message), []).append(finding)
    groups = list(told.values())
    for first, *others in groups[:_MOST_WARNINGS]:
        more = f" ({len(others)} more of this kind; see check)" if others else ""
        warn(f"{document.place}: {first}{more}", stacklevel=4)
    if len(groups) > _MOST_WARNINGS:
        count = sum(map(len, groups[_MOST_WARNINGS:]))
        warn(f"{document.place}: {count} more findings; see check", stacklevel=4)


def _check_actuated(
    chosen: tuple[str, ...],
    tree: Tree,
    followers: Mapping[str, Follower],
    document: UrdfDocument,
) -> None:
    if not chosen:
        held = list(document.locked)
        still = f"; held still: {', '.join(held[:5])}" if held else ""
        raise InputError(
            f"no joint moves between the base frame and the tool frame{still}",
            where=document.place,
            remedy="Choose other frames with --base and --tool.",
        )
    for name in chosen:
        if name in document.locked:
            raise InputError(
                f"this joint cannot be actuated because {document.locked[name]}",
                where=f"joint {name!r}",
                remedy="Model it as single joints that turn or slide, or leave it locked.",
            )
        tree.joint_index(name)
        if name in followers:
            raise InputError(
                f"this joint follows {followers[name].driver!r} and cannot be actuated",
                where=f"joint {name!r}",
                remedy="Leave it out of the actuated joints, or remove its mimic rule.",
            )
    if len(set(chosen)) < len(chosen):
        raise InputError(
            "an actuated joint is named twice",
            where=document.name,
            remedy="Name each actuated joint once.",
        )


def _limits(document: UrdfDocument, chosen: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Limits the URDF states for the actuated joints; infinite where it states none."""
    lower = np.full(len(chosen), -np.inf)
    upper = np.full(len(chosen), np.inf)
    for k, name in enumerate(chosen):
        joint = document.by_name[name]
        if joint.type == "continuous" or joint.lower is None or joint.upper is None:
            continue
        if joint.lower < joint.upper:
            lower[k], upper[k] = joint.lower, joint.upper
    return lower, upper


def _foundation(description: RobotDescription, tree: Tree, base: str) -> Array:
    """(3,) rocking point in the base frame [m]; its origin where `robot.yaml` names none."""
    given = description.foundation
    if given is None:
        return np.zeros(3)
    point = np.array(given.xyz) * {"m": 1.0, "mm": 1e-3}[given.unit]
    body, T_body_base = tree.body(base)
    fixed_to, T_body_frame = tree.body(given.frame or base)
    if fixed_to != body:
        raise InputError(
            f"the frame {given.frame!r} moves against the base frame {base!r}",
            where="robot.yaml, foundation.frame",
            remedy="Name a frame that is fixed to the base.",
        )
    T_base_frame = np.linalg.inv(T_body_base) @ T_body_frame
    return np.asarray(T_base_frame[:3, :3] @ point + T_base_frame[:3, 3])
