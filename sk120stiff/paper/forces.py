"""What forces do over the motion range, and at the printed configurations.

To K_C and K_θ − K_C: Figs. 7 to 9, and critical forces. At the printed configurations: tool
direction, size of the loads, stiffness, pulls of Figs. 4 to 6. The paper's points of these are
drawn, not printed, and so are their forces. The curves here are the models', for deadweights of 0
to 50 kg hung along each base axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import (
    CLAIMED_CRITICAL_FORCE,
    DEADWEIGHTS,
    DIMENSIONS,
    FIGURE_POSES,
    LOADINGS,
    LOWER,
    UPPER,
    PrintedLoads,
)
from sk120stiff.paper.setting import Setting, even_directions, motion_axes, motion_grid
from sk120stiff.robot import STANDARD_GRAVITY, Screws
from sk120stiff.stiffness import complementary_stiffness

QUANTILES = (0.0, 0.01, 0.05, 0.25, 0.5)


@dataclass(frozen=True, eq=False)
class Surface:
    """One of Figs. 7 to 9 as maps over two joints.

    Attributes:
        figure, element: ``"7"`` and ``"C11"``, and so on.
        x, y: (nx,), (ny,) values of the two joints [rad].
        joints, held: Their numbers, from 1; number and value of the third joint [rad].
        parts: (3, ny, nx) contribution of a unit force along x, y, z [N·m/rad per N].
    """

    figure: str
    element: str
    x: Array
    y: Array
    joints: tuple[int, int]
    held: tuple[int, float]
    parts: Array


@dataclass(frozen=True, eq=False)
class DiagonalParts:
    """Parts of C11, C22, C33 for unit forces: three figures, and their range over the grid.

    `lowest` and `highest` are (3, 3), element by force component [N·m/rad per N].
    """

    surfaces: tuple[Surface, ...]
    lowest: Array
    highest: Array


def unit_parts(screws: Screws) -> Array:
    """(..., 3, n, n) K_C of a unit force along x, y and z [N·m/rad per N]."""
    return np.stack([complementary_stiffness(screws, unit) for unit in np.eye(6)[:3]], axis=-3)


def parts_at(setting: Setting, joints: Array) -> Array:
    """(..., 3, 3) parts of C_ii by force component k, at joint readings (..., 3) [rad]."""
    diagonal = np.diagonal(unit_parts(setting.arm(joints)), axis1=-2, axis2=-1)
    return np.swapaxes(diagonal, -1, -2)


def diagonal_parts(setting: Setting, *, count: int = 61) -> DiagonalParts:
    """The parts over the grid, and as maps over the two joints that matter to each most."""
    on_grid = parts_at(setting, motion_grid())
    middle = float(0.5 * (LOWER[2] + UPPER[2]))
    shown = (((1, 2), (3, middle)), ((1, 2), (3, middle)), ((1, 3), (2, 0.0)))
    surfaces = []
    for k, (joints, held) in enumerate(shown):
        x, y = (np.linspace(float(LOWER[j - 1]), float(UPPER[j - 1]), count) for j in joints)
        poses = np.full((count, count, 3), held[1])
        poses[..., joints[0] - 1], poses[..., joints[1] - 1] = np.meshgrid(x, y)
        parts = np.moveaxis(parts_at(setting, poses)[..., k, :], -1, 0)
        surfaces.append(Surface(str(7 + k), f"C{k + 1}{k + 1}", x, y, joints, held, parts))
    return DiagonalParts(tuple(surfaces), on_grid.min(axis=0), on_grid.max(axis=0))


@dataclass(frozen=True, eq=False)
class Critical:
    """Forces at which K_θ − K_C loses definiteness, K_C taken at the unloaded pose as in the paper.

    Attributes:
        smallest: The smallest critical force of all poses and directions [N].
        everywhere: The largest, over the poses, of the smallest over the directions [N]: where it
            equals `smallest`, every pose has its direction that is as bad as the worst.
        column: Spring of joint 2 over the length of the upper arm: a column that is pressed along
            itself [N].
        pose, direction: (3,) joint readings [rad] and unit force where `smallest` was found.
        quantiles, without: Quantile over poses and directions, spread evenly → critical force [N];
            share of them at which no force is critical.
        by_diagonal: (3,) smallest force at which a diagonal element of K_C reaches that of K_θ: the
            criterion of section VI [N].
        share, deflection: Under the claimed force: largest share of the joint stiffness that K_C
            takes up, and largest exact deflection among the sampled poses [m].
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
    poses = np.array(list(product([0.0], *motion_axes()[1:])))
    units = even_directions(directions)
    forces = setting.under_load(poses, units[:, None], "critical").of("critical")
    worst, direction = _worst(setting, poses, units[np.argmin(forces, axis=0)])
    k = int(np.argmin(worst))
    moved = setting.deflection(poses, CLAIMED_CRITICAL_FORCE * direction)
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


def _worst(setting: Setting, poses: Array, start: Array) -> tuple[Array, Array]:
    """Smallest critical force of each pose over all directions (P,), and its direction (P, 3).

    For a joint motion x the best direction is known, and for a direction the best motion: taken in
    turns they climb to a maximum of xᵀ K_C(u) x over unit u and xᵀ K_θ x = 1.
    """
    root = 1.0 / np.sqrt(setting.arm_springs)
    scaled = root[:, None] * unit_parts(setting.arm(poses)) * root  # (P, 3 components, 3, 3) [1/N]
    u = start
    for _ in range(200):
        motion = np.linalg.eigh(np.einsum("pk,pkij->pij", u, scaled))[1][..., -1]
        gradient = np.einsum("pi,pkij,pj->pk", motion, scaled, motion)
        size = np.linalg.norm(gradient, axis=1)
        u, before = gradient / size[:, None], u
        if np.max(np.abs(u - before)) < 1e-12:
            break
    return 1.0 / size, u


@dataclass(frozen=True, eq=False)
class Posture:
    """Findings about the printed configurations and loads.

    Attributes:
        tool_error: Largest deviation of the tool from straight down over all printed configurations
            [rad].
        force_share: (2,) smallest and largest printed force over the weight of its deadweight, k ·
            10 kg for the k-th load of a pose.
        softest: (5,) smallest principal stiffness over the motion range: quantiles 0, 0.25, 0.5,
            0.75, 1 [N/m].
        softest_of_figures: Figure → smallest principal stiffness at its configuration [N/m].
    """

    tool_error: float
    force_share: Array
    softest: Array
    softest_of_figures: dict[str, float]


def posture(setting: Setting, tables: tuple[PrintedLoads, ...]) -> Posture:
    """Look at every printed configuration and load."""
    figures = np.array([*FIGURE_POSES.values()])
    joints = np.concatenate([*(table.joints for table in tables), figures])
    down = -setting.robot.placement(joints)[:, 2, 2]
    size = np.concatenate([np.linalg.norm(table.force, axis=1) for table in tables])
    share = size.reshape(-1, LOADINGS) / (STANDARD_GRAVITY * DEADWEIGHTS[1:])
    softest = dict(zip(FIGURE_POSES, _softest(setting, figures[:, :3]).tolist(), strict=True))
    return Posture(
        tool_error=float(np.max(np.arccos(np.clip(down, -1.0, 1.0)))),
        force_share=np.array([np.min(share), np.max(share)]),
        softest=np.quantile(_softest(setting, motion_grid()), [0.0, 0.25, 0.5, 0.75, 1.0]),
        softest_of_figures=softest,
    )


def _softest(setting: Setting, joints: Array) -> Array:
    return setting.under_load(joints, np.zeros(3), "values").of("values")[..., 0]


@dataclass(frozen=True, eq=False)
class Pull:
    """A force that grows along one base axis at the configuration of Fig. 4, 5 or 6.

    `force` is (k,) its size [N], `displacement` model name → (k, 3) of the flange, exact [m].
    """

    figure: str
    axis: str
    force: Array
    displacement: dict[str, Array]


def pulls(setting: Setting, springs: dict[str, Array]) -> tuple[Pull, ...]:
    """Curves of each printed configuration and axis, for each model's (3,) springs [N·m/rad]."""
    force = STANDARD_GRAVITY * DEADWEIGHTS

    def moved(joints: Array, along: Array) -> dict[str, Array]:
        loads = np.outer(force, along)
        return {
            name: setting.deflection(joints[:3], loads, springs=values)
            for name, values in springs.items()
        }

    return tuple(
        Pull(figure, axis, force, moved(joints, along))
        for figure, joints in FIGURE_POSES.items()
        for axis, along in zip("xyz", np.eye(3), strict=True)
    )
