"""Meshcat's own geometries: bodies of links, arrows, and the transforms that shape them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.show.scene.shapes import Body, Colour, along

# three.js has its cylinders along y.
_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def ellipsoid(centre: Array, directions: Array, halves: Array) -> Array:
    """(4, 4) that makes the unit sphere an ellipsoid; rows of `directions` are its axes."""
    T = np.eye(4)
    T[:3, :3] = directions.T * np.maximum(halves, 1e-3 * halves.max())
    if np.linalg.det(T[:3, :3]) < 0.0:
        T[:3, 2] *= -1.0
    T[:3, 3] = centre
    return T


def pointing(start: Array, vector: Array, thin: float) -> Array | None:
    """(4, 4) that makes an arrow of length 1 along z this vector; None where nothing is to see.

    An arrow that is short beside its shaft's radius `thin` is thinner too.
    """
    length = float(np.linalg.norm(vector))
    if length < 0.05 * thin:
        return None
    T = along(vector)
    T[:3, :2] *= min(1.0, length / (20.0 * thin))
    T[:3, 2] *= length
    T[:3, 3] = start
    return T


def solids(body: Body) -> Iterator[tuple[Any, Array]]:
    """Meshcat's geometries of a body, each with its (4, 4) placement on the link."""
    from meshcat import geometry as g

    T = body.placement
    if body.mesh is not None:
        yield g.TriangularMeshGeometry(body.mesh.vertices, body.mesh.faces), T
    elif body.kind == "box":
        yield g.Box(list(body.size)), T
    elif body.kind == "sphere":
        yield g.Sphere(body.size[0]), T
    else:
        radius, length = body.size
        yield g.Cylinder(length, radius), T @ _UP
        for end in (-0.5, 0.5) if body.kind == "capsule" else ():
            shifted = T.copy()
            shifted[:3, 3] += end * length * T[:3, 2]
            yield g.Sphere(radius), shifted


def arrow(thin: float) -> dict[str, tuple[Any, Array]]:
    """Shaft and head of an arrow from the origin to z = 1."""
    from meshcat import geometry as g

    parts = {}
    for name, low, high, bottom, top in (
        ("shaft", 0.0, 0.85, thin, thin),
        ("head", 0.85, 1.0, 3.2 * thin, 0.0),
    ):
        T = _UP.copy()
        T[2, 3] = 0.5 * (low + high)
        parts[name] = (g.Cylinder(high - low, radiusTop=top, radiusBottom=bottom), T)
    return parts


def unit_sphere() -> Any:
    """What an ellipsoid is made from."""
    from meshcat.geometry import Sphere

    return Sphere(1.0)


def material(colour: Colour, *, over: bool = False) -> Any:
    """A surface of this colour and opacity; `over` what stands before it, as marks are drawn."""
    from meshcat.geometry import MeshBasicMaterial, MeshPhongMaterial

    red, green, blue = (round(255 * part) for part in colour[:3])
    opacity = float(colour[3])
    tint = (red << 16) + (green << 8) + blue
    if over:  # transparent things are drawn last
        return MeshBasicMaterial(color=tint, transparent=True, depthTest=False, depthWrite=False)
    return MeshPhongMaterial(
        color=tint, opacity=opacity, transparent=opacity < 1.0, depthWrite=opacity == 1.0
    )
