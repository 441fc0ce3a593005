"""What a robot must not run into and with: solids, convex each.

A link has the shapes of its `<collision>` elements; where it has none that can be read, those of
its `<visual>` elements; where it has neither, a capsule from its joint to the next one. Meshes
count as their convex hulls: a little too large, never too small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from weakref import WeakKeyDictionary

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from sk120stiff.arrays import Array
from sk120stiff.errors import listed
from sk120stiff.robot.anatomy import SHORTEST_LINK, arm_joints, arm_length
from sk120stiff.robot.robot import Robot
from sk120stiff.robot.rotations import frame_about, homogeneous
from sk120stiff.robot.urdf import Finding
from sk120stiff.robot.visuals import Visual, read_mesh, shapes_of

# Of the stretched arm. Half a link's thickness is 0.034 of it on a UR10, 0.046 on a Panda.
CAPSULE_RADIUS = 0.04
_KNOWN: WeakKeyDictionary[Robot, Body] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Solid:
    """One convex solid.

    Attributes:
        name: What to call it in a message.
        frame: The frame that carries it.
        T_frame_solid: (4, 4) placement [m].
        kind: ``box``, ``capsule``, ``cylinder``, ``hull``, ``sphere``; all that lies below its xy
            plane (``plane``).
        size: box: x, y, z; cylinder and capsule (along z, centred): radius, length between the
            ends or the centres of the caps; sphere: radius [m].
        points: (V, 3) corners of a ``hull`` [m].
        spares: So many joints' links, counted from the base, may touch it.
    """

    name: str
    frame: str
    T_frame_solid: Array
    kind: str
    size: tuple[float, ...] = ()
    points: Array | None = None
    spares: int = 0


@dataclass(frozen=True, eq=False)
class Body:
    """All solids of a robot, and in sentences where they come from."""

    solids: tuple[Solid, ...]
    remarks: tuple[str, ...] = field(default=())


def body_of(robot: Robot) -> Body:
    """The solids of a robot's links; worked out once for a robot."""
    known = _KNOWN.get(robot)
    if known is None:
        known = _KNOWN[robot] = _worked_out(robot)
    return known


def capsule_between(
    name: str, frame: str, start: Array, end: Array, radius: float, spares: int = 0
) -> Solid:
    """A capsule from one point of a frame to another [m]."""
    along = np.asarray(end, dtype=float) - start
    length = float(np.linalg.norm(along))
    turn = frame_about(along / length) if length > 0.0 else None
    T = homogeneous(0.5 * (np.asarray(start) + end), turn)
    return Solid(name, frame, T, "capsule", (radius, length), spares=spares)


def mesh_solid(name: str, frame: str, T: Array, path: Path, scale: float) -> Solid | str:
    """The hull of a mesh file, or why there is none."""
    vertices = read_mesh(path)
    return vertices if isinstance(vertices, str) else _hull(name, frame, T, scale * vertices)


def _worked_out(robot: Robot) -> Body:
    document = robot.document
    own = shapes_of(document, document.collisions)
    solids = [_solid(shape) for shape in own]
    done = {solid.frame for solid in solids}
    seen = shapes_of(document, (v for v in document.visuals if v.link not in done))
    solids += [_solid(shape) for shape in seen]
    drawn = sorted({shape.link for shape in seen})
    lines = _capsules(robot, solids)
    said = []
    if drawn:
        said.append(
            f"No shapes for collision checks at {listed(drawn)}: those that are shown count."
        )
    if lines:
        radius = lines[0].size[0]
        said.append(
            f"No shapes at all at {listed([s.frame for s in lines])}: a capsule of "
            f"{1e3 * radius:.0f} mm radius from joint to joint counts, and that is a guess."
        )
    lost = [*own.findings, *seen.findings]
    if lost:
        said.append(f"{len(lost)} shapes cannot be read, the first: {_told(lost)}.")
    return Body((*solids, *lines), tuple(said))


def _told(lost: Sequence[Finding]) -> str:
    return f"{lost[0].where}, {lost[0].message}".rstrip(".")


def _solid(shape: Visual) -> Solid:
    name = f"{shape.link}" if not shape.name else f"{shape.link} ({shape.name})"
    if shape.vertices is not None:
        return _hull(name, shape.link, shape.T_link_visual, shape.vertices)
    return Solid(name, shape.link, shape.T_link_visual, shape.kind, shape.size)


def _hull(name: str, frame: str, T: Array, vertices: Array) -> Solid:
    try:
        corners = vertices[ConvexHull(vertices).vertices]
    except QhullError:  # flat or thinner: the box around it
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        T = T.copy()
        T[:3, 3] += T[:3, :3] @ (0.5 * (low + high))
        size = np.maximum(high - low, 1e-3)
        return Solid(name, frame, T, "box", (float(size[0]), float(size[1]), float(size[2])))
    return Solid(name, frame, T, "hull", points=np.asarray(corners))


def _capsules(robot: Robot, solids: Sequence[Solid]) -> list[Solid]:
    """Capsules along the links of the arm that nothing else gives a shape."""
    bodies = {robot.tree.body(solid.frame)[0] for solid in solids}
    radius = CAPSULE_RADIUS * arm_length(robot)
    return [
        capsule_between(joint.link, joint.link, np.zeros(3), joint.along, radius)
        for joint in arm_joints(robot)
        if joint.length > SHORTEST_LINK and robot.tree.body(joint.link)[0] not in bodies
    ]
