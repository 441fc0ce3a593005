"""How visible a cause is in given measurements, and which other causes look like it.

Everything is whitened by the true noise covariance; what springs of the base model can imitate is
projected out. Numbers come from differences of the generator's own solutions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from .noise import Noise
from .rotations import Array
from .rows import Rows
from .usual import unusual
from .world import Cause, World


@dataclass(frozen=True)
class View:
    """A world seen through its noise: whitener and an orthonormal basis of the base springs."""

    world: World
    rows: Rows
    plain: Array  # (N, 3) displacement of the world
    white: Array  # (3N, 3N)
    base: Array  # (3N, b)

    def whiten(self, displacement: Array) -> Array:
        return self.white @ displacement.reshape(-1)

    def beyond_base(self, vector: Array) -> Array:
        return vector - self.base @ (self.base.T @ vector)


def view(world: World, rows: Rows, noise: Noise) -> View:
    """`world` carries no hidden cause, or those that are already known."""
    plain, position, _ = world.observe(rows)
    white = noise.whitener(rows, plain, position)
    columns = []
    for name, compliance in world.springs.items():
        step = 1e-4 * compliance
        moved = world.with_spring(name, compliance + step).displacement(rows)
        columns.append(white @ ((moved - plain) / 1e-4).reshape(-1))
    return View(world, rows, plain, white, orthonormal(np.array(columns).T))


def orthonormal(columns: Array) -> Array:
    """Basis of the column space; columns that vanish or repeat are dropped."""
    size = np.linalg.norm(columns, axis=0)
    columns = columns[:, size > 1e-12]
    if columns.shape[1] == 0:
        return columns
    left, values, _ = np.linalg.svd(columns / np.linalg.norm(columns, axis=0), full_matrices=False)
    return left[:, values > 1e-9 * values[0]]


def signature(seen: View, cause: Cause) -> Array:
    """Whitened change (3N,) that the cause brings, base springs projected out."""
    world = seen.world
    changed = world.with_causes(*world.causes, cause).displacement(seen.rows)
    return seen.beyond_base(seen.whiten(changed - seen.plain))


def tuned(
    seen: View, cause: Cause, target: float, *, widest: float = 4.0, narrowest: float = 1 / 40
) -> Cause | None:
    """The cause scaled to ||u|| = target, or None if that needs an unusual size."""
    factor = 1.0
    for _ in range(4):
        norm = float(np.linalg.norm(signature(seen, cause.scaled(factor))))
        if not norm > 1e-9:
            return None
        factor *= target / norm
        if not narrowest / 2 <= factor <= widest * 2:
            return None
        if abs(norm / target - 1.0) < 1e-3:
            break
    if not narrowest <= factor <= widest or unusual(cause.scaled(factor), seen.world.arm):
        return None
    return cause.scaled(factor)


@dataclass(frozen=True)
class Blocks:
    """First-order signatures of all candidates: one matrix (3N, parameters) each."""

    names: list[tuple[str, str]]
    columns: list[Array]


def blocks(seen: View, candidates: Sequence[Cause]) -> Blocks:
    """Columns of every candidate at the world's own springs, base projected out."""
    world = seen.world
    start = world.displacement(seen.rows, iterations=1)
    names, columns = [], []
    for cause in candidates:
        own = []
        for part in cause.parts():
            changed = world.with_causes(*world.causes, part)
            moved = changed.displacement(seen.rows, iterations=1)
            own.append(seen.beyond_base(seen.whiten(moved - start)))
        names.append((cause.name, cause.where))
        columns.append(np.array(own).T)
    return Blocks(names, columns)


def beyond(vector: Array, columns: Array) -> float:
    """Length of what is left of a signature beyond other columns (3N, k)."""
    basis = orthonormal(columns)
    return float(np.linalg.norm(vector - basis @ (basis.T @ vector)))


# a compliance is never negative: such rivals only add. Play and friction keep both signs: they are
# declared aliases while loads only ascend.
ONE_SIGNED = {
    "joint_springs", "joint_tilt", "link_bending", "link_torsion", "base_rocking", "base_sliding",
    "tool_compliance", "closure_rod", "gravity_compensator",
}  # fmt: skip


def short_of(vector: Array, columns: Array, name: str) -> float:
    """Length of what a candidate of this name cannot imitate of a signature."""
    if name not in ONE_SIGNED:
        return beyond(vector, columns)
    size = np.linalg.norm(columns, axis=0)
    columns = columns[:, size > 1e-12] / size[size > 1e-12]
    if columns.shape[1] == 0:
        return float(np.linalg.norm(vector))
    return float(nnls(columns, vector)[1])


@dataclass(frozen=True)
class Rival:
    """Another cause, what it leaves of the true signature, and the angle between the two."""

    name: str
    where: str
    separation: float  # sqrt(lambda) of EVIDENCE: below 3.3 the data cannot tell
    angle: float  # [deg]


def rivals(
    vector: Array, own: tuple[str, str], table: Blocks, known: Array | None = None
) -> list[Rival]:
    """All other candidates, the most similar first. `known`: further columns to project out."""
    basis = orthonormal(known) if known is not None else np.zeros((len(vector), 0))
    vector = vector - basis @ (basis.T @ vector)
    norm = float(np.linalg.norm(vector))
    out = []
    for (name, where), columns in zip(table.names, table.columns, strict=True):
        if (name, where) == own:
            continue
        left = short_of(vector, columns - basis @ (basis.T @ columns), name)
        angle = float(np.degrees(np.arcsin(min(1.0, left / norm)))) if norm > 0 else 0.0
        out.append(Rival(name, where, left, angle))
    return sorted(out, key=lambda rival: rival.separation)
