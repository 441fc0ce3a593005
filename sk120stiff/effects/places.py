"""Where an effect can act on a robot, by what its `place` names."""

from __future__ import annotations

from collections.abc import Callable

from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_links

USUAL_PLACES: dict[str, Callable[[Robot], tuple[str, ...]]] = {
    "a joint": lambda robot: robot.actuated,
    "a joint that turns": lambda robot: tuple(
        joint for joint, slides in zip(robot.actuated, robot.prismatic, strict=True) if not slides
    ),
    "a link": lambda robot: tuple(joint.link for joint in arm_links(robot)),
    "the base frame": lambda robot: (robot.base_frame,),
    "the tool frame": lambda robot: (robot.tool_frame,),
    "sensor": lambda _: ("sensor",),
    "tracker": lambda _: ("tracker",),
}
