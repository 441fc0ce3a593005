"""What a robot looks like: its visuals where they can be read, clean capsules where not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import frame_about, homogeneous
from sk120stiff.robot.visuals import Visual, visuals
from sk120stiff.show.scene.links import FIXED, LinkTree

Colour = tuple[float, float, float, float]

PLAIN: Colour = (0.80, 0.83, 0.86, 1.0)  # visuals that state no colour
LIMB: Colour = (0.87, 0.89, 0.91, 1.0)
HINGE: Colour = (0.16, 0.36, 0.52, 1.0)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles: (v, 3) vertices [m] and (f, 3) indices."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]


@dataclass(frozen=True, eq=False)
class Body:
    """A shape fixed to a link.

    Attributes:
        link: Index of the link in the `LinkTree`.
        placement: (4, 4) T_link_body [m].
        kind: ``box``, ``cylinder``, ``sphere``, ``capsule`` (both along z) or ``mesh``.
        size: box: x, y, z; cylinder, capsule: radius, length; sphere: radius; mesh: scale x, y, z.
        colour: Red, green, blue, opacity in 0..1.
        mesh: Triangles of a mesh.
        still: It is no part of the arm, and has no deflected twin.
    """

    link: int
    placement: Array
    kind: str
    size: tuple[float, ...]
    colour: Colour
    mesh: Mesh | None = None
    still: bool = False


def reach_of(robot: Robot, frame: str | None = None) -> float:
    """Length of the arm: the sum of the offsets between its joints [m], never zero."""
    chain = robot.mechanism(frame).chain
    lengths = np.linalg.norm(chain.placements[:, :3, 3], axis=1)
    slides = [
        float(np.max(np.abs([lo, up]), initial=0.0, where=np.isfinite([lo, up])))
        for lo, up, slide in zip(robot.lower, robot.upper, robot.prismatic, strict=True)
        if slide
    ]
    return max(float(lengths.sum()) + sum(slides), 1e-3)


def capsules(tree: LinkTree, reach: float, links: Sequence[int] | None = None) -> list[Body]:
    """Limbs from joint to joint and a hinge at every joint, thinner towards the end.

    Args:
        links: Links to draw; all of them by default.
    """
    depth = np.zeros(len(tree.names), dtype=int)
    for k, parent in enumerate(tree.parents):
        if parent >= 0:
            depth[k] = depth[parent] + (tree.kinds[k] != FIXED)
    deepest = max(1, int(depth.max()))
    chosen = set(range(len(tree.names)) if links is None else links)
    bodies: list[Body] = []
    for k, parent in enumerate(tree.parents):
        radius = reach * (0.042 - 0.024 * depth[k] / deepest)
        if parent >= 0 and parent in chosen:
            end = tree.origins[k, :3, 3]
            length = float(np.linalg.norm(end))
            thick = reach * (0.042 - 0.024 * depth[parent] / deepest)
            if length > 0.25 * thick:
                placement = along(end)
                placement[:3, 3] = 0.5 * end
                bodies.append(Body(int(parent), placement, "capsule", (0.82 * thick, length), LIMB))
        if k in chosen and tree.kinds[k] != FIXED:
            placement = along(tree.axes[k])
            bodies.append(Body(k, placement, "cylinder", (1.12 * radius, 2.3 * radius), HINGE))
    return bodies


def welded(mesh: Mesh) -> Mesh:
    """The mesh with corners at one place made one; many files repeat them for every triangle."""
    size = float(np.ptp(mesh.vertices, axis=0).max()) or 1.0
    return _clustered(mesh, mesh.vertices.min(axis=0), 1e-6 * size)


def simplified(mesh: Mesh, triangles: int) -> Mesh:
    """A mesh with about that many triangles at most, by merging the corners of a grid's cells."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    cells = max(8.0, np.sqrt(triangles))  # a surface meets about cells² of the cells³
    found = mesh
    for _ in range(12):
        if len(found.faces) <= triangles:
            break
        size = float(np.max(high - low)) / cells
        found = _clustered(mesh, low, size)
        cells *= 0.8
    return found


def _clustered(mesh: Mesh, low: NDArray[np.float32], size: float) -> Mesh:
    cell = np.floor((mesh.vertices - low) / size).astype(np.int64)
    _, inverse = np.unique(cell, axis=0, return_inverse=True)
    inverse = inverse.reshape(-1)
    count = np.bincount(inverse)
    vertices = np.stack(
        [np.bincount(inverse, weights=mesh.vertices[:, k]) / count for k in range(3)], axis=1
    )
    faces = inverse[mesh.faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return Mesh(vertices.astype(np.float32), faces[np.sort(first)].astype(np.uint32))


def along(direction: Array) -> Array:
    """(4, 4) rotation that turns z into a direction."""
    return homogeneous(np.zeros(3), frame_about(direction / np.linalg.norm(direction)))


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
