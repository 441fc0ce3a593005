"""What a robot looks like: shapes of its links as triangles or primitives, for the picture layer.

Meshes are read by trimesh, one by one: a mesh that is missing or broken costs its own shape and
becomes a finding; the rest of the picture and all kinematics stay.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff.arrays import Array, Integers
from sk120stiff.errors import require
from sk120stiff.files import note_read
from sk120stiff.robot.robot import Robot
from sk120stiff.robot.urdf import Finding, UrdfDocument, VisualSpec, resolve

MAX_MESH_BYTES = 200 * 1024 * 1024
_READABLE = {"stl": "stl", "obj": "obj", "dae": "dae", "ply": "ply", "off": "off", "glb": "glb"}
_ENTITIES = re.compile(rb"<!\s*(?:ENTITY|DOCTYPE)", re.IGNORECASE)
_UNIT = re.compile(rb"<unit\b[^>]{0,200}?meter\s*=\s*[\"']\s*([0-9.eE+-]{1,40})\s*[\"']")
_MATERIALS = re.compile(rb"<bind_material\b.*?</bind_material>", re.DOTALL)

Colour = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Visual:
    """One shape of a link.

    Attributes:
        link, name: The link that carries it, and the shape's own name (may be empty).
        T_link_visual: (4, 4) placement in the link frame [m].
        kind: ``box``, ``cylinder``, ``sphere``, ``capsule`` or ``mesh``.
        size: box: x, y, z; cylinder and capsule (along z, centred): radius, length; sphere: radius
            [m]; empty for a mesh.
        vertices, faces: (V, 3) [m], scale applied, and (F, 3) indices; None but for a mesh.
        rgba: Colour, each 0..1; None where the file gives none.
    """

    link: str
    name: str
    T_link_visual: Array
    kind: str
    size: tuple[float, ...]
    vertices: Array | None
    faces: Integers | None
    rgba: Colour | None


@dataclass(frozen=True, eq=False)
class Appearance:
    """All shapes that could be read, and a finding for each that could not."""

    shapes: tuple[Visual, ...]
    findings: tuple[Finding, ...]

    def __iter__(self) -> Iterator[Visual]:
        return iter(self.shapes)

    def __len__(self) -> int:
        return len(self.shapes)


@dataclass(frozen=True, eq=False)
class _Mesh:
    vertices: Array
    faces: Integers
    rgba: Colour | None


def visuals(robot: Robot | UrdfDocument) -> Appearance:
    """Shapes of a robot's links, in the order of the file; never raises for a bad mesh.

    Args:
        robot: A loaded robot, or its document.
    """
    document = robot.document if isinstance(robot, Robot) else robot
    return shapes_of(document, document.visuals)


def shapes_of(document: UrdfDocument, specs: Iterable[VisualSpec]) -> Appearance:
    """The same of some of its shapes, such as those for collision checks."""
    shapes: list[Visual] = []
    findings: list[Finding] = []
    meshes: dict[str, _Mesh | str] = {}
    for spec in specs:
        address = spec.geometry.filename
        if address is None:
            shapes.append(_visual(spec, None))
            continue
        if address not in meshes:
            meshes[address] = _read(address, document)
        mesh = meshes[address]
        if isinstance(mesh, str):
            findings.append(Finding("mesh_missing", spec.place, f"mesh {address!r}: {mesh}"))
        else:
            shapes.append(_visual(spec, mesh))
    return Appearance(tuple(shapes), tuple(findings))


def _visual(spec: VisualSpec, mesh: _Mesh | None) -> Visual:
    if mesh is None:
        size, vertices, faces = spec.geometry.size, None, None
    else:
        size, vertices, faces = (), mesh.vertices * np.array(spec.geometry.size), mesh.faces
        if np.prod(np.sign(spec.geometry.size)) < 0.0:  # a mirrored mesh would be inside out
            faces = faces[:, ::-1]
    colour = spec.rgba if spec.rgba is not None or mesh is None else mesh.rgba
    return Visual(
        spec.link, spec.name, spec.origin, spec.geometry.kind, size, vertices, faces, colour
    )


def read_mesh(path: Path) -> Array | str:
    """(V, 3) corners of a mesh file, or why there are none."""
    mesh = _read_file(path)
    return mesh if isinstance(mesh, str) else mesh.vertices


def _read(address: str, document: UrdfDocument) -> _Mesh | str:
    """The mesh behind an address, or why there is none."""
    path, why = resolve(address, document.path, document.package_folders)
    return why if path is None else _read_file(path)


def _read_file(path: Path) -> _Mesh | str:
    note_read(path)
    kind = _READABLE.get(path.suffix.lower().lstrip("."))
    if kind is None:
        return f"meshes of kind {path.suffix!r} are not read; use STL, OBJ, DAE, PLY, OFF or GLB"
    try:
        if path.stat().st_size > MAX_MESH_BYTES:
            return f"it has more than {MAX_MESH_BYTES / 1e6:.0f} MB"
        data = path.read_bytes()
        if kind != "dae":
            return _load(data, kind, 1.0)
        if _ENTITIES.search(data):
            return "it defines entities, which are never expanded"
        mesh = _load(data, kind, _unit(data))
        if isinstance(mesh, str):  # one broken material hides its whole shape
            mesh = _load(_MATERIALS.sub(b"", data), kind, _unit(data))
        return mesh
    except Exception as error:  # noqa: BLE001 - readers of foreign files raise anything
        return f"it cannot be read ({type(error).__name__}: {str(error)[:200]})"


def _unit(collada: bytes) -> float:
    """Metres per unit of a COLLADA file; its up axis is ignored, as ROS viewers do."""
    match = _UNIT.search(collada[:20_000])
    value = float(match.group(1)) if match else 1.0
    return value if np.isfinite(value) and value > 0.0 else 1.0


def _load(data: bytes, kind: str, unit: float) -> _Mesh | str:
    require("trimesh", needed_for="reading meshes")
    import trimesh

    loaded: Any = trimesh.load_scene(io.BytesIO(data), file_type=kind)  # textures are not followed
    if not loaded.geometry:
        return "it holds no triangles"
    merged: Any = loaded.to_mesh()
    vertices = np.asarray(merged.vertices, dtype=float) * unit
    faces = np.asarray(merged.faces, dtype=np.int64)
    if not len(vertices) or not len(faces):
        return "it holds no triangles"
    if not np.isfinite(vertices).all() or faces.min() < 0 or faces.max() >= len(vertices):
        return "its triangles are not finite or refer to missing corners"
    return _Mesh(vertices, faces, _colour(merged))


def _colour(mesh: Any) -> Colour | None:
    """Mean colour of a mesh that brings one."""
    try:
        r, g, b, a = (float(v) / 255.0 for v in np.ravel(mesh.visual.main_color)[:4])
    except (AttributeError, ValueError, TypeError, IndexError):
        return None
    return (r, g, b, a)
