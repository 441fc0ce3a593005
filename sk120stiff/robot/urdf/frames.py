"""Which frames to take as base and tool when the user names none."""

from __future__ import annotations

import re

from sk120stiff.robot.urdf.document import JointSpec, UrdfDocument

_FINGER = re.compile(
    r"finger|gripper|grasp|jaw|thumb|knuckle|claw|pinch|suction"
    r"|(?:^|_)(?:index|middle|ring|pinky|little|mrl)(?:_|\d|$)",
    re.IGNORECASE,
)
_SENSOR = re.compile(
    r"camera|optical|sensor|imu|lidar|laser|depth|marker|aruco|inertial|collision|visual",
    re.IGNORECASE,
)
# What robot makers call the frame to work with, best first.
_TOOL_NAMES = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        r"(?:^|_)tool_?0$",
        r"(?:^|_)tcp$|tool_?center_?point|(?:^|_)tool_tip$",
        r"(?:^|_)tool(?:_frame|_link)?$",
        r"(?:^|_)flange(?:_link|_frame)?$",
        r"(?:^|_)(?:ee|eef|end_?effector)(?:_link|_frame|_tip)?$",
        r"(?:^|_)hand(?:_link)?$|attachment|mounting|(?:^|_)tip$",
    )
)


def default_frames(document: UrdfDocument) -> tuple[str, str, tuple[str, ...]]:
    """Base frame, tool frame, and why, in sentences.

    The base is the root. The tool lies behind the most moving joints; fingers and grippers (known
    by name, or as jaws that slide side by side) do not count, nor do mimic joints. Among the links
    that those joints carry rigidly, a usual name decides (`tool0`, `tcp`, `tool`, `flange`,
    `ee_link`, ...), else the outermost link that is no sensor; between branches of equal length
    the first one of the file.
    """
    children: dict[str, list[JointSpec]] = {}
    for joint in document.joints:
        children.setdefault(joint.parent, []).append(joint)
    fingers = {joint.name for joint in document.moving_joints if _is_finger(joint)}
    fingers |= _sliding_pairs(document, children)
    if not any(j.mimic is None and j.name not in fingers for j in document.moving_joints):
        fingers = set()  # the robot is a gripper: then its fingers are the arm
    moving, level, order = _walk(document, children, fingers)
    longest = max(moving.values())
    carried = [link for link in order if moving[link] == longest]
    reasons = [f"base frame {document.root!r}: the root of the URDF"]
    tool, why = _by_name(carried)
    if tool is None:
        branch = _branch(carried, {joint.child: joint for joint in document.joints})
        leaves = [link for link in branch if not _inner(link, children, fingers)] or branch
        leaves = [link for link in leaves if not _SENSOR.search(link)] or branch
        tool = max(leaves, key=lambda link: level[link])
        why = "the outermost link" if longest else "the root, because no joint moves"
        others = sorted(set(carried) - set(branch))
        if others:
            why += f", first of several branches with {longest} joints (another: {others[0]!r})"
    reasons.append(f"tool frame {tool!r}: {why}, behind {longest} moving joints")
    if fingers:
        reasons.append(f"ignored as fingers: {', '.join(sorted(fingers)[:8])}")
    return document.root, tool, tuple(reasons)


def _is_finger(joint: JointSpec) -> bool:
    """By its name; by its child's name only if it slides, since a wrist may carry a gripper."""
    return bool(
        _FINGER.search(joint.name) or (joint.type == "prismatic" and _FINGER.search(joint.child))
    )


def _sliding_pairs(document: UrdfDocument, children: dict[str, list[JointSpec]]) -> set[str]:
    """Joints that slide side by side on one link and carry nothing that moves: jaws."""
    jaws: set[str] = set()
    for joints in children.values():
        ends = [
            joint.name
            for joint in joints
            if joint.type == "prismatic" and not children.get(joint.child)
        ]
        if len(ends) > 1 and len(document.moving_joints) > len(ends):
            jaws.update(ends)
    return jaws


def _walk(
    document: UrdfDocument, children: dict[str, list[JointSpec]], fingers: set[str]
) -> tuple[dict[str, int], dict[str, int], list[str]]:
    """Moving joints and levels above each link that is not behind a finger; links in file order."""
    moving, level = {document.root: 0}, {document.root: 0}
    stack = [document.root]
    while stack:
        link = stack.pop()
        for joint in children.get(link, ()):
            if joint.name in fingers:
                continue
            counts = joint.moves and joint.mimic is None
            moving[joint.child] = moving[link] + int(counts)
            level[joint.child] = level[link] + 1
            stack.append(joint.child)
    return moving, level, [link.name for link in document.links if link.name in moving]


def _by_name(links: list[str]) -> tuple[str | None, str]:
    for pattern in _TOOL_NAMES:
        for link in links:
            if pattern.search(link):
                return link, "its name says so"
    return None, ""


def _branch(carried: list[str], above: dict[str, JointSpec]) -> list[str]:
    """Of the carried links, those on the same rigid body as the first one."""

    def body(link: str) -> str:
        while link in above and not above[link].moves:
            link = above[link].parent
        return link

    first = body(carried[0])
    return [link for link in carried if body(link) == first]


def _inner(link: str, children: dict[str, list[JointSpec]], fingers: set[str]) -> bool:
    return any(joint.name not in fingers for joint in children.get(link, ()))
