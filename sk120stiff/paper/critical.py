"""The forces at which K_θ − K_C stops being positive definite; the paper says about 10 kN."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.parts import parts_at
from sk120stiff.paper.printed import CLAIMED_CRITICAL_FORCE, DIMENSIONS
from sk120stiff.paper.setting import Setting, motion_axes, motion_grid, wrench_of
from sk120stiff.robot import Screws
from sk120stiff.stiffness import (
    complementary_stiffness,
    critical_load,
    deflection,
)

QUANTILES = (0.0, 0.01, 0.05, 0.25, 0.5)


@dataclass(frozen=True, eq=False)
class Critical:
    """Critical forces over the motion range, for K_C taken at the unloaded pose as the paper does.

    Attributes
    ----------
    smallest
        The smallest critical force of all poses and directions [N].
    everywhere
        The largest, over the poses, of the smallest over the directions [N]: where it equals
        `smallest`, every pose has its direction that is as bad as the worst.
    column
        Spring of joint 2 over the length of the upper arm: a column that is pressed along itself
        [N].
    pose, direction
        (3,) joint readings [rad] and unit force where `smallest` was found.
    quantiles
        Quantile over poses and directions, spread evenly → critical force [N].
    without
        Share of poses and directions at which no force is critical.
    by_diagonal
        (3,) smallest force at which a diagonal element of K_C reaches that of K_θ: the criterion
        of section VI [N].
    share
        Largest share of the joint stiffness that K_C takes up at the claimed force.
    deflection
        Largest exact deflection under the claimed force among the sampled poses [m].
    """

    smallest: float
    everywhere: float
    column: float
    pose: Array
    direction: Array
    quantiles: dict[float, float]
    without: float
    by_diagonal: Array
    share: float
    deflection: float


def critical(setting: Setting, *, directions: int = 200) -> Critical:
    """Critical forces over the grid of section VI.

    The arm turns about a vertical axis as a whole: joint 1 changes directions only, so it is held.
    """
    _, second, third = motion_axes()
    poses = np.stack(np.meshgrid([0.0], second, third, indexing="ij"), axis=-1).reshape(-1, 3)
    screws = setting.arm(poses)
    units = even_directions(directions)
    forces = np.stack(
        [critical_load(screws, setting.arm_springs, wrench_of(unit)) for unit in units], axis=1
    )  # (poses, directions)
    worst, direction = _worst(setting, screws, units[np.argmin(forces, axis=1)])
    k = int(np.argmin(worst))
    loads = CLAIMED_CRITICAL_FORCE * direction
    straight = np.concatenate([poses, np.zeros_like(poses)], axis=1)
    moved = deflection(setting.mechanism, straight, wrench_of(loads), setting.springs).equilibrium
    size = np.linalg.norm(parts_at(setting, motion_grid()), axis=-1)  # (G, 3) |∂C_ii/∂F|
    return Critical(
        smallest=float(worst[k]),
        everywhere=float(np.max(worst)),
        column=float(setting.arm_springs[1]) / DIMENSIONS["L2"],
        pose=poses[k],
        direction=direction[k],
        quantiles={q: float(np.quantile(forces, q, method="inverted_cdf")) for q in QUANTILES},
        without=float(np.mean(np.isinf(forces))),
        by_diagonal=np.min(setting.arm_springs / size, axis=0),
        share=CLAIMED_CRITICAL_FORCE / float(worst[k]),
        deflection=float(np.max(np.linalg.norm(moved, axis=1))),
    )


def even_directions(count: int) -> Array:
    """(count, 3) unit vectors spread evenly over the sphere, on a spiral."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    angle = np.pi * (1.0 + 5.0**0.5) * k
    across = np.sqrt(1.0 - z**2)
    return np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)


def _worst(setting: Setting, screws: Screws, start: Array) -> tuple[Array, Array]:
    """Smallest critical force of each pose over all directions (P,), and its direction (P, 3).

    For a joint motion x the best direction is known, and for a direction the best motion: taken in
    turns they climb to a maximum of xᵀ K_C(u) x over unit u and xᵀ K_θ x = 1.
    """
    root = 1.0 / np.sqrt(setting.arm_springs)
    scaled = np.stack(
        [root[:, None] * complementary_stiffness(screws, unit) * root for unit in np.eye(6)[:3]],
        axis=1,
    )  # (P, 3 components, 3, 3) [1/N]
    u = start
    for _ in range(200):
        motion = np.linalg.eigh(np.einsum("pk,pkij->pij", u, scaled))[1][..., -1]
        gradient = np.einsum("pi,pkij,pj->pk", motion, scaled, motion)
        size = np.linalg.norm(gradient, axis=1)
        new = gradient / size[:, None]
        done = float(np.max(np.abs(new - u))) < 1e-12
        u = new
        if done:
            break
    return 1.0 / size, u
