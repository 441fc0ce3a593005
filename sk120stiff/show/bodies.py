"""All bodies to draw for a robot: visuals where they can be read, capsules where not."""

from __future__ import annotations

from sk120stiff.robot import Robot
from sk120stiff.show.links import LinkTree
from sk120stiff.show.shapes import PLAIN, Body, capsules, reach_of


def bodies_of(robot: Robot, tree: LinkTree) -> list[Body]:
    """Every visual that can be drawn; capsules for a robot, or a link, that lost all of its own.

    Links that state no visual on purpose stay empty as long as others have some.
    """
    index = {name: k for k, name in enumerate(tree.names)}
    bodies: list[Body] = []
    stated: set[int] = set()
    for visual in robot.document.visuals:
        link = index[visual.link]
        stated.add(link)
        if visual.geometry.kind == "mesh":
            continue
        bodies.append(
            Body(
                link,
                visual.origin,
                visual.geometry.kind,
                visual.geometry.size,
                visual.rgba or PLAIN,
            )
        )
    reach = reach_of(robot)
    if not bodies:
        return capsules(tree, reach)
    lost = sorted(stated - {body.link for body in bodies})
    return bodies + (capsules(tree, reach, lost) if lost else [])
