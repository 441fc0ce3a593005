"""Which joints of a robot are fingers: the arm ends where the hand begins.

A hand is known by its shape, a body that branches into several short chains at the end of a long
one, or by the names of its joints. Mimic joints in a hand follow other joints of the hand; a rod
that follows a joint of the arm belongs to a linkage, and what carries a flange is a wrist.
"""

from __future__ import annotations

import re
from collections.abc import Collection

import numpy as np

from sk120stiff.robot.urdf.document import JointSpec, UrdfDocument

FINGER = re.compile(r"finger|thumb|knuckle|\bjaw|_jaw|claw|pinch|suction", re.IGNORECASE)
_HAND = re.compile(r"hand(?!l)", re.IGNORECASE)
_GRIPPER = re.compile(r"gripper|grasp", re.IGNORECASE)
_WRIST = re.compile(r"roll|pitch|yaw|wrist|rot|turn", re.IGNORECASE)
_FLANGE = re.compile(r"(?:^|_)(?:tool_?0|tcp|flange|eef?|end_?effector)(?:$|_)", re.IGNORECASE)

SHORT = 0.3  # of the way from the root to the palm
_FEWEST_BEFORE = 3  # motors between root and palm: a base with legs is no palm
_MOST_IN_FINGER = 5  # motors of one finger, where no name speaks of a hand


def finger_joints(document: UrdfDocument, arm: Collection[str] = ()) -> tuple[str, ...]:
    """Moving joints that belong to hands, in the order of the file.

    Empty for a robot that is a hand and nothing else: then its fingers are the arm.

    Args:
        document: The robot.
        arm: Joints that are known to belong to the arm, such as those of its closed linkages.
    """
    named = {joint.name for joint in document.moving_joints if _is_named_finger(joint)}
    first = named | _sliding_pairs(document) | _branches_of_palms(document)
    found: set[str] = set()
    for joint in document.joints:
        if joint.name in first and joint.name not in found:
            found.update(_behind(joint, document))
    found -= set(arm)
    if not any(j.mimic is None and j.name not in found for j in document.moving_joints):
        return ()
    return tuple(joint.name for joint in document.moving_joints if joint.name in found)


def _is_named_finger(joint: JointSpec) -> bool:
    """By its name; by its child's name only if it slides, since a wrist may carry a gripper."""
    names = f"{joint.name} {joint.child}" if joint.type == "prismatic" else joint.name
    if FINGER.search(names):
        return True
    return bool(_GRIPPER.search(names)) and not _WRIST.search(joint.name)


def _sliding_pairs(document: UrdfDocument) -> set[str]:
    """Joints that slide side by side on one link and carry nothing that moves: jaws."""
    jaws: set[str] = set()
    for joints in document.below.values():
        ends = [j.name for j in joints if j.type == "prismatic" and len(_behind(j, document)) == 1]
        if len(ends) > 1 and len(document.moving_joints) > len(ends):
            jaws.update(ends)
    return jaws


def _branches_of_palms(document: UrdfDocument) -> set[str]:
    """First joints of the chains into which a palm branches."""
    found: set[str] = set()
    bodies = [(document.root, 0.0, 0)]  # first link of a rigid body, way to it [m], motors before
    while bodies:
        start, way, motors = bodies.pop()
        branches: list[tuple[JointSpec, float]] = []
        links = [(start, way)]
        while links:
            link, here = links.pop()
            for joint in document.below.get(link, ()):
                there = here + _length(joint)
                if joint.moves:
                    branches.append((joint, there))
                else:
                    links.append((joint.child, there))
        if motors >= _FEWEST_BEFORE and _is_palm(branches, document):
            found.update(joint.name for joint, _ in branches)
            continue
        for joint, there in branches:
            bodies.append((joint.child, there, motors + int(joint.mimic is None)))
    return found


def _is_palm(branches: list[tuple[JointSpec, float]], document: UrdfDocument) -> bool:
    if len(branches) < 2:
        return False
    below = {name for joint, _ in branches for name in _behind(joint, document)}
    named = any(FINGER.search(name) or _HAND.search(name) for name in below)
    most = 2 * _MOST_IN_FINGER if named else _MOST_IN_FINGER
    return all(_is_finger(joint, SHORT * way, most, below, document) for joint, way in branches)


def _is_finger(
    first: JointSpec, longest: float, most: int, hand: set[str], document: UrdfDocument
) -> bool:
    """A chain no longer [m] and of no more motors, that drives a hand and carries no flange."""
    stack = [(first, 0.0, 0)]
    while stack:
        joint, length, motors = stack.pop()
        if joint.moves:
            motors += int(joint.mimic is None)
            if joint.mimic is not None and joint.mimic.joint not in hand:
                return False
        if length > longest or motors > most or _FLANGE.search(joint.child):
            return False
        stack += [(j, length + _length(j), motors) for j in document.below.get(joint.child, ())]
    return True


def _behind(joint: JointSpec, document: UrdfDocument) -> list[str]:
    """Moving joints from this one outwards, itself included."""
    found, stack = [], [joint]
    while stack:
        here = stack.pop()
        if here.moves:
            found.append(here.name)
        stack.extend(document.below.get(here.child, ()))
    return found


def _length(joint: JointSpec) -> float:
    return float(np.linalg.norm(joint.origin[:3, 3]))
