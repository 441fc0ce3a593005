"""All bodies to draw for a robot: visuals where they can be read, capsules where not."""

from __future__ import annotations

import numpy as np

from sk120stiff.robot import Robot
from sk120stiff.robot.visuals import Visual, visuals
from sk120stiff.show.scene.links import LinkTree
from sk120stiff.show.scene.shapes import PLAIN, Body, Mesh, capsules, reach_of, simplified, welded

TRIANGLES = 60_000  # for a whole robot; a report stays below 3 MB and its scene turns smoothly


def bodies_of(robot: Robot, tree: LinkTree) -> list[Body]:
    """Every visual that can be drawn; capsules for a robot, or a link, that lost all of its own.

    Links that state no visual on purpose stay empty as long as others have some. Meshes with more
    triangles than a page can carry are made coarser.
    """
    index = {name: k for k, name in enumerate(tree.names)}
    shapes = list(visuals(robot))
    total = sum(len(shape.faces) for shape in shapes if shape.faces is not None)
    share = min(1.0, TRIANGLES / total) if total else 1.0
    bodies = [_body(shape, index[shape.link], share) for shape in shapes]
    reach = reach_of(robot)
    if not bodies:
        return capsules(tree, reach)
    stated = {index[visual.link] for visual in robot.document.visuals}
    lost = sorted(stated - {body.link for body in bodies})
    return bodies + (capsules(tree, reach, lost) if lost else [])


def _body(shape: Visual, link: int, share: float) -> Body:
    colour = shape.rgba or PLAIN
    if shape.vertices is None or shape.faces is None:
        return Body(link, shape.T_link_visual, shape.kind, shape.size, colour)
    mesh = welded(Mesh(shape.vertices.astype(np.float32), shape.faces.astype(np.uint32)))
    if share < 1.0:
        mesh = simplified(mesh, max(400, int(share * len(mesh.faces))))
    return Body(link, shape.T_link_visual, "mesh", (1.0, 1.0, 1.0), colour, mesh)
