"""The user's meshes as binary STL files beside a model: every simulator reads those."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence

import numpy as np

from sk120stiff.robot.visuals import Visual

MOST = 150_000  # triangles of one file: MuJoCo takes 200 000
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def mesh_files(
    shapes: Sequence[Visual], folder: str
) -> tuple[dict[str, bytes], list[tuple[str, ...]]]:
    """Files (path → bytes) of all meshes, and the paths of each shape; none for a primitive."""
    files: dict[str, bytes] = {}
    named: dict[str, str] = {}
    paths: list[tuple[str, ...]] = []
    for shape in shapes:
        own = []
        for data in _parts(shape):
            digest = hashlib.sha256(data).hexdigest()
            if digest not in named:
                stem = re.sub(r"[^\w.-]", "_", shape.link) or "link"
                name = f"{folder}/{stem}.stl"
                while name in files:
                    name = f"{folder}/{stem}_{len(files)}.stl"
                named[digest], files[name] = name, data
            own.append(named[digest])
        paths.append(tuple(own))
    return files, paths


def _parts(shape: Visual) -> list[bytes]:
    if shape.vertices is None or shape.faces is None or len(shape.faces) < 2:
        return []
    corners = shape.vertices[shape.faces]
    return [_stl(corners[k : k + MOST]) for k in range(0, len(corners), MOST)]


def _stl(corners: np.ndarray) -> bytes:
    """Triangles (F, 3, 3) [m]."""
    records = np.zeros(len(corners), dtype=_RECORD)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    records["normal"] = normal / np.where(length > 0.0, length, 1.0)
    records["corners"] = corners
    return b"\0" * 80 + len(corners).to_bytes(4, "little") + records.tobytes()
