"""Holding joints beside the arm still, so that a swarm of them does not fill the memory.

Pinocchio's workspace grows with the cube of the number of moving joints: 70 MB for 100, 1.7 GB for
300. An arm needs the joints on its own way and those they are coupled to; the others may stand.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from sk120stiff.errors import InputError
from sk120stiff.robot.urdf.clean import clean_xml
from sk120stiff.robot.urdf.document import Finding, UrdfDocument
from sk120stiff.robot.urdf.findings import Notebook
from sk120stiff.robot.urdf.mimics import drivers_first

MOST_FREE = 150  # above it, joints beside the arm are held still
MOST_MOVING = 250  # above it, the robot is refused; about 1 GB


def with_arm_only(
    document: UrdfDocument,
    base: str,
    tool: str,
    needed: Iterable[str],
    rest: Mapping[str, float],
) -> UrdfDocument:
    """The document itself, or, beyond `MOST_FREE` moving joints, one in which only the arm moves.

    Args:
        base, tool: Frames between which the arm lies.
        needed: Further joints that must stay free.
        rest: Values at which joints are held [rad or m]; zero where not named.

    Raises:
        InputError: The arm alone has more than `MOST_MOVING` joints.
    """
    moving = document.moving_joints
    if len(moving) <= MOST_FREE:
        return document
    free: set[str] = set()
    names = [*(joint.name for joint in document.way(base, tool)), *needed]
    while names:
        joint = document.by_name.get(names.pop())
        if joint is None or not joint.moves or joint.name in free:
            continue
        free.add(joint.name)
        if joint.mimic is not None:
            names.append(joint.mimic.joint)
    if len(free) > MOST_MOVING:
        raise InputError(
            f"{len(free)} joints move between base and tool; at most {MOST_MOVING} can be handled",
            where=document.place,
            remedy="Choose frames that are nearer to each other, or make joints fixed.",
        )
    held = {joint.name for joint in moving if joint.name not in free}
    locked = dict(document.locked)
    values = _standing(document, rest)
    changed = []
    for joint in document.joints:
        if joint.name in held:
            origin = joint.standing(values[joint.name])
            joint = replace(joint, type="fixed", origin=origin, mimic=None)
            locked[joint.name] = "it lies beside the arm"
        changed.append(joint)
    joints = tuple(changed)
    note = Finding(
        "joints_aside",
        document.place,
        f"{len(held)} of {len(moving)} moving joints lie beside the arm and are held still",
    )
    return replace(
        document,
        joints=joints,
        xml=clean_xml(document.name, document.links, joints),
        locked=locked,
        warnings=(*document.warnings, note),
    )


def _standing(document: UrdfDocument, rest: Mapping[str, float]) -> dict[str, float]:
    """Where every joint stands while the drivers are at rest, by name."""
    values: dict[str, float] = {}
    for name in drivers_first(document.joints, document.by_name, Notebook(document.place)):
        rule = document.by_name[name].mimic
        values[name] = (
            rest.get(name, 0.0)
            if rule is None
            else rule.multiplier * values[rule.joint] + rule.offset
        )
    return values
