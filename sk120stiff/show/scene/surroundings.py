"""What stands around the arm and hangs on its tool, as the cell of a plan states it."""

from __future__ import annotations

import numpy as np

from sk120stiff.plan import Cell
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import homogeneous
from sk120stiff.robot.solids import Solid
from sk120stiff.show.scene.links import LinkTree
from sk120stiff.show.scene.shapes import Body, Colour, Mesh, reach_of

OBSTACLE: Colour = (0.78, 0.52, 0.30, 0.42)
CARRIED: Colour = (0.45, 0.50, 0.56, 0.60)
FLOOR: Colour = (0.78, 0.52, 0.30, 0.16)
TRACKER: Colour = (0.66, 0.16, 0.16, 1.0)
WIDE = 1.2  # of the arm's reach: half the side of what has no end
THIN = 0.002  # of the arm's reach: thickness of what has none
SEEN = 0.03  # of the arm's reach: radius of the tracker


def surroundings_of(cell: Cell, robot: Robot, tree: LinkTree) -> tuple[Body, ...]:
    """Obstacles, what the tool carries, the floor and the tracker, as far as the cell states them.

    Args:
        cell: The cell.
        robot: The arm in it.
        tree: Its links.
    """
    reach = reach_of(robot)
    index = {name: k for k, name in enumerate(tree.names)}
    base = index[robot.base_frame]
    bodies = [
        _body(solid, index[solid.frame], colour, reach)
        for solids, colour in ((cell.obstacles, OBSTACLE), (cell.tool or (), CARRIED))
        for solid in solids
    ]
    if np.isfinite(cell.floor):
        top = homogeneous((0.0, 0.0, cell.floor))
        bodies.append(_slab(top, base, FLOOR, reach))
    if cell.tracker is not None:
        at = homogeneous(cell.tracker.place)
        bodies.append(Body(base, at, "sphere", (SEEN * reach,), TRACKER, still=True))
    return tuple(bodies)


def _body(solid: Solid, link: int, colour: Colour, reach: float) -> Body:
    if solid.kind == "plane":
        return _slab(solid.T_frame_solid, link, colour, reach)
    if solid.points is None:
        return Body(link, solid.T_frame_solid, solid.kind, solid.size, colour, still=True)
    mesh = _hull(solid.points)
    return Body(link, solid.T_frame_solid, "mesh", (1.0, 1.0, 1.0), colour, mesh, still=True)


def _slab(top: np.ndarray, link: int, colour: Colour, reach: float) -> Body:
    """A part of the plane z = 0 of a placement (4, 4), what it fills below."""
    middle = top.copy()
    middle[:3, 3] -= 0.5 * THIN * reach * top[:3, 2]
    size = (2.0 * WIDE * reach, 2.0 * WIDE * reach, THIN * reach)
    return Body(link, middle, "box", size, colour, still=True)


def _hull(points: np.ndarray) -> Mesh:
    from scipy.spatial import ConvexHull  # slow to import

    hull = ConvexHull(points)
    return Mesh(points.astype(np.float32), hull.simplices.astype(np.uint32))
