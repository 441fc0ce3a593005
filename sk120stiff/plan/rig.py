"""Which loads a rig can bring: a weight hangs, a cable pulls, a jack pushes, each in its steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import nnls

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError

TOLERANCE = np.deg2rad(5.0)  # by which a direction may be missed
SAME_SIZE = 0.01  # share by which a load may differ from a step of the rig
ROUND = 1e-3  # of a direction's length: what is left of it once others are taken away


@dataclass(frozen=True, eq=False)
class Rig:
    """Directions and sizes of the forces that can be brought; in base axes.

    Without `directions`, `cone` and `anchors` any direction can be.

    Attributes:
        words: What it is, in words.
        directions: (k, 3) unit vectors; these alone, or with `between` all that lie between them.
        between: Forces may be put together from several of the directions.
        axis, angle: (3,) unit vector and half opening [rad] of a cone of directions.
        anchors: (k, 3) points towards which a cable pulls [m].
        steps: Sizes that it has [N], ascending; empty: any up to the one that is asked for.
    """

    words: str = "any direction"
    directions: Array | None = None
    between: bool = False
    axis: Array | None = None
    angle: float = np.pi
    anchors: Array | None = None
    steps: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for name in ("directions", "anchors"):
            rows = getattr(self, name)
            if rows is not None and (np.ndim(rows) != 2 or np.shape(rows)[1] != 3 or not len(rows)):
                raise InputError(f"{name} of a rig have three numbers each", where="rig")
        if self.directions is not None:
            object.__setattr__(self, "directions", unit(self.directions))

    def allows(self, at: Array, force: Array) -> Mask:
        """(N,) directions of forces (N, 3) at points (N, 3) [m] that the rig can bring."""
        u = unit(force)
        still = ~np.asarray(force).any(axis=1)
        if self.directions is not None and self.between:
            left = np.array([nnls(self.directions.T, row)[1] for row in u])
            return np.asarray(still | (left < np.sin(TOLERANCE)))
        if self.directions is not None:
            nearest = (u @ self.directions.T).max(axis=1)
        elif self.anchors is not None:
            along = unit(self.anchors - np.asarray(at)[:, None])
            nearest = np.einsum("nkj,nj->nk", along, u).max(axis=1)
        elif self.axis is not None:
            limit = np.cos(min(self.angle + 1e-6, np.pi))
            return np.asarray(still | (u @ self.axis >= limit))
        else:
            return np.ones(len(u), dtype=bool)
        return np.asarray(still | (nearest >= np.cos(TOLERANCE)))

    def draw(self, at: Array, count: int, rng: np.random.Generator) -> Array:
        """(N, c, 3) unit directions, at most `count`, for points (N, 3) [m]."""
        N = len(at)
        if self.anchors is not None:
            return unit(self.anchors - at[:, None])[:, :count]
        if self.directions is not None:
            k = len(self.directions)
            if not self.between:
                picks = np.array([rng.permutation(k)[:count] for _ in range(N)], dtype=np.intp)
                return np.asarray(self.directions[picks])
            weights = rng.exponential(size=(N, count, k)) ** 3  # a few of them carry most
            return unit(weights @ self.directions)
        drawn = unit(rng.normal(size=(N, count, 3)))
        if self.axis is None:
            return drawn
        # evenly over the cap: cos of the angle to the axis is uniform
        cosine = rng.uniform(np.cos(self.angle), 1.0, (N, count, 1))
        across = unit(drawn - (drawn @ self.axis)[..., None] * self.axis)
        return np.asarray(cosine * self.axis + np.sqrt(1.0 - cosine**2) * across)

    def sizes(self, force: float, count: int) -> Array:
        """(k,) sizes [N] up to `force` for one direction, at most `count`, largest first.

        Its steps; halves where it has any size. `force` alone where every step is larger.
        """
        if self.steps:
            return np.array([s for s in self.steps[::-1] if s <= force + 1e-9][:count] or [force])
        return np.asarray(force / 2.0 ** np.arange(count))

    def has(self, size: Array) -> Mask:
        """(N,) sizes [N] that are among the steps."""
        if not self.steps:
            return np.ones(len(size), dtype=bool)
        steps = np.array([0.0, *self.steps])
        off = np.abs(np.asarray(size)[:, None] - steps) <= SAME_SIZE * steps + 1e-9
        return np.asarray(off.any(axis=1))

    def step_below(self, size: Array) -> Array:
        """(N,) the largest step not above each size [N]; zero where there is none."""
        if not self.steps:
            return np.asarray(size, dtype=float)
        steps = np.array([0.0, *self.steps])
        return np.asarray(steps[np.searchsorted(steps, np.asarray(size) + 1e-9, side="right") - 1])


HANGING = Rig("what hangs on the tool")  # nothing pulls it aside


def like(forces: Array) -> Rig:
    """The rig that brought some forces (N, 3): all directions between those that were measured."""
    found: list[Array] = []
    for row in unit(forces[np.asarray(forces).any(axis=1)]):
        if all(row @ other < np.cos(TOLERANCE) for other in found):
            found.append(row)
    if not found:
        return Rig()
    directions = np.array(found)
    axes = np.concatenate([np.eye(3), -np.eye(3), unit(-directions)])
    if len(found) > 3 and all(nnls(directions.T, row)[1] < ROUND for row in axes):
        return Rig("any direction, as was measured")
    words = "the directions that were measured, and what lies between them"
    return Rig(words, directions, between=True)


def unit(vectors: ArrayLike) -> Array:
    """Vectors (..., 3) at unit length; zero stays zero."""
    rows = np.asarray(vectors, dtype=float)
    length = np.linalg.norm(rows, axis=-1, keepdims=True)
    return np.asarray(rows / np.where(length > 0.0, length, 1.0))
