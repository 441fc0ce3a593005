"""Which frames to take as base and tool when the user names none."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import listed
from sk120stiff.robot.urdf.document import Finding, JointSpec, UrdfDocument
from sk120stiff.robot.urdf.findings import at
from sk120stiff.robot.urdf.hands import FINGER, finger_joints

# Frames that only help: sensors, shapes for collision checks, pictures.
_HELPER = re.compile(
    r"camera|optical|sensor|imu|lidar|laser|depth|marker|aruco|inertial|collision|visual|mesh"
    r"|(?:^|_)(?:sc|com|cog|dummy|ft)(?:$|_link$)",
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
        r"(?:^|_)(?:ee|eef|(?:end_?)?effector)(?:_link|_frame|_tip)?$",
        r"(?:^|_)hand(?:_link)?$|attachment|mounting|(?:^|_)tip$",
    )
)
_LEG = re.compile(
    r"foot|feet|sole|toe|ankle|ankel|knee|hip(?![a-z])|thigh|calf|shank|wheel|caster|rotor"
    r"|(?:^|_)legs?(?:_|\d|$)|(?:_|^)(?:haa|hfe|kfe)(?:_|$)",
    re.IGNORECASE,
)
_FEWEST_OF_AN_ARM = 3  # motors, where an arm is preferred to a longer leg
_MOST_NAMED = 6


@dataclass(frozen=True)
class FrameChoice:
    """Base and tool frame of a robot whose user named none, and what else there was.

    Attributes:
        base, tool: The frames taken.
        why_base, why_tool: The reasons, in a few words.
        motors: Joints before the tool frame that follow no other.
        others: The best frame at the end of every other arm, leg or head, and the motors before it;
            the longest first.
        beside: Other frames on the same body as the tool frame, without helpers.
        fingers: Moving joints that belong to hands; they are held still.
    """

    base: str
    tool: str
    why_base: str
    why_tool: str
    motors: int
    others: tuple[tuple[str, int], ...] = ()
    beside: tuple[str, ...] = ()
    fingers: tuple[str, ...] = ()

    @property
    def about_tool(self) -> str:
        """Why the tool frame was chosen, and its alternatives, in one line."""
        text = f"({self.why_tool})"
        if self.others:
            ends = [f"{name} ({motors})" for name, motors in self.others]
            text += f"; the robot ends also at {listed(ends, most=_MOST_NAMED)}"
        if self.beside:
            text += f"; also on this body: {listed(self.beside, most=_MOST_NAMED)}"
        return text

    @property
    def sentences(self) -> tuple[str, ...]:
        """Everything a user should know about the choice."""
        told = [f"base frame {self.base!r}: {self.why_base}"]
        told.append(f"tool frame {self.tool!r} {self.about_tool}")
        if self.fingers:
            told.append(f"held still as fingers: {listed(self.fingers, most=_MOST_NAMED)}")
        return tuple(told)


def fingers_on_way(
    document: UrdfDocument, choice: FrameChoice, base: str, tool: str
) -> tuple[Finding, ...]:
    """What to say where a tool frame beyond the hand's beginning puts fingers into the arm."""
    on_way = [joint for joint in document.way(base, tool) if joint.name in choice.fingers]
    if not on_way:
        return ()
    names = listed([joint.name for joint in on_way], most=_MOST_NAMED)
    return (
        Finding(
            "fingers_on_way",
            at(on_way[0].line, "joint", on_way[0].name),
            f"finger joints lie between {base!r} and {tool!r} and count as joints of the arm: "
            f"{names}; to hold them still, name the others under actuated in robot.yaml, or choose "
            f"the tool frame {choice.tool!r}",
        ),
    )


@dataclass(frozen=True, eq=False)
class _End:
    """Where the motors end: the last one, all of them, and the links it moves."""

    joint: JointSpec | None
    motors: tuple[str, ...]
    links: tuple[str, ...]

    @property
    def is_leg(self) -> bool:
        return any(_LEG.search(name) for name in self.motors)


def default_frames(document: UrdfDocument, arm: Collection[str] = ()) -> FrameChoice:
    """Base frame, tool frame, why, and what else could have been meant.

    The base is the root. The arm is the way with the most motors; hands do not count (see
    `finger_joints`), nor do mimic joints, and legs only where there is no arm. Among the links
    that its last motor moves, a usual name decides (`tool0`, `tcp`, `tool`, `flange`, `ee_link`,
    ...), else the one farthest out that is no helper: no sensor, no shape for collision checks.
    Between arms of equal length the better name decides, then the order of the file.

    Args:
        document: The robot.
        arm: Joints that are known to belong to the arm, such as those of its closed linkages.
    """
    fingers = finger_joints(document, arm)
    ends = _ends(document, set(fingers))
    arms = [end for end in ends if not end.is_leg and len(end.motors) >= _FEWEST_OF_AN_ARM]
    longest = max(len(end.motors) for end in arms or ends)
    tied = [end for end in arms or ends if len(end.motors) == longest]
    tools = {id(end): _tool_of(end, document) for end in ends}
    order = {link.name: k for k, link in enumerate(document.links)}
    chosen = min(tied, key=lambda end: (_rank(tools[id(end)]), order[tools[id(end)]]))
    tool = tools[id(chosen)]
    others = sorted((end for end in ends if end is not chosen), key=lambda end: -len(end.motors))
    reach = _places(chosen, document)
    return FrameChoice(
        base=document.root,
        tool=tool,
        why_base="the root of the URDF",
        why_tool=_why(tool, chosen),
        motors=len(chosen.motors),
        others=tuple((tools[id(end)], len(end.motors)) for end in others),
        beside=tuple(link for link in reach if link != tool and not _HELPER.search(link)),
        fingers=fingers,
    )


def _why(tool: str, end: _End) -> str:
    if end.joint is None:
        return "no joint moves"
    named = "its name says so" if _rank(tool) < len(_TOOL_NAMES) else "the frame farthest out"
    return f"{named}, behind {len(end.motors)} joint" + "s" * (len(end.motors) > 1)


def _rank(link: str) -> int:
    """How usual a name for a tool frame: 0 is best; the number of patterns if it is none."""
    if _HELPER.search(link):
        return len(_TOOL_NAMES)
    fits = (k for k, pattern in enumerate(_TOOL_NAMES) if pattern.search(link))
    return next(fits, len(_TOOL_NAMES))


def _ends(document: UrdfDocument, fingers: set[str]) -> list[_End]:
    """Every way from the root outwards that ends with a motor, in the order of the file.

    A motor is a moving joint that follows no other and is no finger. Links behind mimic joints
    belong to the motor before them.
    """
    motors: dict[str, tuple[str, ...]] = {document.root: ()}
    last: dict[str, JointSpec | None] = {document.root: None}
    stack = [document.root]
    while stack:
        link = stack.pop()
        for joint in document.below.get(link, ()):
            if joint.name in fingers:
                continue
            drives = joint.moves and joint.mimic is None
            motors[joint.child] = (*motors[link], joint.name) if drives else motors[link]
            last[joint.child] = joint if drives else last[link]
            stack.append(joint.child)
    inner = {name for way in motors.values() for name in way[:-1]}
    groups: dict[str | None, list[str]] = {}
    for spec in document.links:
        if spec.name in last:
            motor = last[spec.name]
            groups.setdefault(motor.name if motor else None, []).append(spec.name)
    if len(groups) > 1:  # what no motor moves is no end
        groups.pop(None, None)
    return [
        _End(last[links[0]], motors[links[0]], tuple(links))
        for name, links in groups.items()
        if name not in inner
    ]


def _places(end: _End, document: UrdfDocument) -> dict[str, Array]:
    """Position of each link that the last motor carries rigidly, in that motor's frame [m]."""
    start = end.joint.child if end.joint is not None else document.root
    found = {start: np.eye(4)}
    stack = [start]
    while stack:
        link = stack.pop()
        for joint in document.below.get(link, ()):
            if not joint.moves:
                found[joint.child] = found[link] @ joint.origin
                stack.append(joint.child)
    return {link: T[:3, 3] for link, T in found.items()}


def _tool_of(end: _End, document: UrdfDocument) -> str:
    """The best named link of an end, else the farthest one that is no helper."""
    best = min(end.links, key=_rank)
    if _rank(best) < len(_TOOL_NAMES):
        return best
    places = _places(end, document)
    helpful = [link for link in places if not _HELPER.search(link)]
    sensible = [link for link in helpful if not FINGER.search(link)] or helpful or list(places)[:1]
    # Of frames at one point, within 1 µm, the one nearest to the motor is the real link.
    return max(sensible, key=lambda link: round(float(np.linalg.norm(places[link])), 6))
