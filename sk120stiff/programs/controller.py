"""The frame in which a robot's controller states places, where the URDF knows it.

ROS describes an arm from its link `base_link`, x forward. The maker's own base or world frame is a
further link, `base` (draft REP 199, "Coordinate Frames for Serial Industrial Manipulators"): with
Universal Robots it is turned by half a turn about z, with FANUC and Yaskawa it lies at the height
of the second axis. What goes to a controller is stated there.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.programs.language import Language
from sk120stiff.programs.placing import place_text
from sk120stiff.programs.program import Program, Targets
from sk120stiff.robot import Mechanism, Robot

LINK, ROOT = "base", "base_link"
SAME = 1e-9  # m and rad: frames that are no farther apart are one


def controller_frame(robot: Robot) -> str:
    """The link whose axes the controller states places in; the robot's base frame by default.

    `controller: frame:` of `robot.yaml`, else the link `base` beside the arm's `base_link`, with
    the same prefix.

    Raises:
        InputError: `robot.yaml` names a link that moves against the base frame, or none.
    """
    body = robot.tree.body(robot.base_frame)[0]
    named = robot.controller.frame
    if named is not None:
        if robot.tree.body(named)[0] != body:
            raise InputError(
                f"the frame {named!r} moves against the base frame {robot.base_frame!r}",
                where="robot.yaml, controller.frame",
                remedy="Name a link that is fixed to the base.",
            )
        return named
    found = _prefix(robot) + LINK
    if found in robot.frames and robot.tree.body(found)[0] == body:
        return found
    return robot.base_frame


def _prefix(robot: Robot) -> str:
    """What stands before ``base_link`` in the name of the last such link below the arm's joints."""
    prefix = ""
    for joint in robot.document.way("", robot.tool_frame):
        for link in (joint.parent, joint.child):
            if link.endswith(ROOT) and not (link == joint.child and joint.moves):
                prefix = link.removesuffix(ROOT)
        if joint.moves:
            break
    return prefix


def T_base_controller(robot: Robot) -> Array:
    """(4, 4) the controller's frame in the robot's base frame [m]."""
    frame = controller_frame(robot)
    if frame == robot.base_frame:
        return np.eye(4)
    T_body_base, T_body_frame = (robot.tree.body(name)[1] for name in (robot.base_frame, frame))
    return np.asarray(np.linalg.inv(T_body_base) @ T_body_frame)


def is_elsewhere(robot: Robot) -> bool:
    """Does the controller's frame lie elsewhere than the robot's base frame, or turned?"""
    return not np.allclose(T_base_controller(robot), np.eye(4), rtol=0.0, atol=SAME)


def places(robot: Robot, a: Array, frame: str | None, part: Array | None = None) -> Array:
    """(N, 4, 4) of `frame` at joints (N, n) in the controller's frame, or in the part's.

    Args:
        part: (4, 4) part in the robot's base frame [m].
    """
    root = T_base_controller(robot) if part is None else part
    return np.asarray(np.linalg.inv(root) @ robot.placement(a, frame))


def frame_words(robot: Robot, part: Array | None = None, *, stated: bool = True) -> tuple[str, ...]:
    """Where the controller's frame lies, and the part in it; nothing where it is the base frame.

    Args:
        part: (4, 4) part in the robot's base frame [m].
        stated: Places are stated in the controller's frame, not in the part's.
    """
    if not is_elsewhere(robot):
        return ()
    frame, T = controller_frame(robot), T_base_controller(robot)
    why = "named in robot.yaml" if robot.controller.frame else "what ROS calls it, REP 199"
    said = (
        f"The controller's own base is the frame {frame} ({why}), which lies in "
        f"{robot.base_frame} at {place_text(T)}."
        + (" The program's places are stated there." if stated else "")
    )
    if part is None:
        return (said,)
    return (said, f"Part's frame in {frame}: {place_text(np.linalg.inv(T) @ part)}.")


def checked_text(
    language: Language,
    program: Program,
    robot: Robot,
    a: Array,
    frame: str | None = None,
    part: Array | None = None,
) -> str:
    """The program's text, read again; its places are those of its joints in their frame.

    The arm is followed from the controller's frame outwards, by a chain of its own.

    Args:
        a: (N, n) the joints of its targets [rad or m].
        frame: Whose places are written; the tool frame by default.
        part: (4, 4) part in the robot's base frame, if places are stated in the part's [m].

    Raises:
        InputError: The language cannot say it.
        RuntimeError: A place is another than its joints lead to.
    """
    text = language.text(program)
    root = controller_frame(robot) if part is None else robot.base_frame
    chain = robot.tree.chain(root, frame or robot.tool_frame)
    there = Mechanism(chain, robot.coupling).screws(robot.coordinates(a), None)
    found = language.read(text)
    if part is not None:
        R, t = part[:3, :3], part[:3, 3]
        turned = None if found.rotation is None else R @ found.rotation
        found = Targets(found.position @ R.T + t, turned, found.joints, found.speed)
    language.hold(found, there.position, there.rotation)
    return text
