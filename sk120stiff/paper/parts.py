"""Figs. 7 to 9: what each force component adds to the diagonal of K_C, over the motion range."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import LOWER, UPPER
from sk120stiff.paper.setting import Setting, motion_grid
from sk120stiff.stiffness import complementary_stiffness


@dataclass(frozen=True, eq=False)
class Surface:
    """One of Figs. 7 to 9 as maps over two joints.

    Attributes
    ----------
    figure, element
        ``"7"`` and ``"C11"``, and so on.
    x, y
        (nx,), (ny,) values of the two joints [rad].
    joints
        Their numbers, from 1.
    held
        Number of the third joint, and its value [rad].
    parts
        (3, ny, nx) contribution of a unit force along x, y, z [N·m/rad per N].
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
    """Parts of C11, C22, C33 for unit forces.

    Attributes
    ----------
    surfaces
        The three figures.
    lowest, highest
        (3, 3) range of each part over the grid of section VI: element by force component
        [N·m/rad per N].
    """

    surfaces: tuple[Surface, ...]
    lowest: Array
    highest: Array


def parts_at(setting: Setting, joints: Array) -> Array:
    """(..., 3, 3) parts of C_ii by force component k, at joint readings (..., 3) [rad]."""
    screws = setting.arm(joints)
    columns = []
    for axis in range(3):
        unit = np.zeros(6)
        unit[axis] = 1.0
        K_C = complementary_stiffness(screws, unit)
        columns.append(np.diagonal(K_C, axis1=-2, axis2=-1))
    return np.stack(columns, axis=-1)


def diagonal_parts(setting: Setting, *, count: int = 61) -> DiagonalParts:
    """The parts over the grid, and as maps over the two joints that matter to each most."""
    on_grid = parts_at(setting, motion_grid())
    middle = float(0.5 * (LOWER[2] + UPPER[2]))
    surfaces = (
        _surface(setting, "7", 1, (1, 2), (3, middle), count),
        _surface(setting, "8", 2, (1, 2), (3, middle), count),
        _surface(setting, "9", 3, (1, 3), (2, 0.0), count),
    )
    return DiagonalParts(surfaces, on_grid.min(axis=0), on_grid.max(axis=0))


def _surface(
    setting: Setting,
    figure: str,
    element: int,
    joints: tuple[int, int],
    held: tuple[int, float],
    count: int,
) -> Surface:
    x, y = (
        np.linspace(float(LOWER[joint - 1]), float(UPPER[joint - 1]), count) for joint in joints
    )
    poses = np.empty((count, count, 3))
    poses[..., joints[0] - 1], poses[..., joints[1] - 1] = np.meshgrid(x, y)
    poses[..., held[0] - 1] = held[1]
    parts = parts_at(setting, poses)[..., element - 1, :]  # (ny, nx, 3)
    return Surface(figure, f"C{element}{element}", x, y, joints, held, np.moveaxis(parts, -1, 0))
