"""The independent arm under a load on its tool: where marker and tool go, and files of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from tests.positions.arm import NAMES, Arm, Array, slopes, urdf

SPRINGS = np.array([1 / 9e5, 1 / 8e5, 1 / 5e5, 1 / 1e5, 1 / 8e4, 1 / 5e4])  # rad/(N·m)
ORIGIN = np.zeros(3)
PULLED = np.array([0.0, 0.0, 0.1])  # m, tool frame: where the load acts
MARKERS = {
    "A": np.array([0.15, 0.0, 0.1]), "B": np.array([-0.15, 0.12, 0.05]),
    "C": np.array([0.0, -0.2, 0.15]),
}  # fmt: skip


def rests(
    arm: Arm, a: Array, force: Array, rocking: float = 0.0, about: Array = ORIGIN
) -> tuple[Array, Array]:
    """Origin (N, 3) and axes (N, 3, 3) of the tool under forces (N, 3) [N], base axes.

    The foundation rocks by `rocking` about x and y of the base [rad/(N·m)] through a point.
    """
    own = Arm(**{**vars(arm), "marker": PULLED})
    q, tilt = a, Rotation.identity(len(a))
    for _ in range(12):
        pull = tilt.inv().apply(force)

        def energy(near: Array, pull: Array = pull) -> Array:
            x, _, weight = own.pose(near)
            return weight * own.weighs - (x * pull[:, None]).sum(axis=-1)

        torque = -slopes(energy, q)
        q = a + arm.compliance * torque
        moment = np.cross(tilt.apply(own.pose(q)[0] - about), force)
        tilt = Rotation.from_rotvec(rocking * moment * [1.0, 1.0, 0.0])
    x, R, _ = own.pose(q)
    origin = x - np.einsum("nij,j->ni", R, PULLED)
    return about + tilt.apply(origin - about), tilt.as_matrix() @ R


def moved(
    arm: Arm,
    a: Array,
    force: Array,
    marker: Array,
    rocking: float = 0.0,
    about: Array = ORIGIN,
) -> tuple[Array, Array]:
    """Displacement (N, 3) of a marker and rotation vector (N, 3) of the tool by the load, base."""
    (x, R), (x_0, R_0) = (rests(arm, a, f, rocking, about) for f in (force, 0.0 * force))
    turn = Rotation.from_matrix(R @ np.swapaxes(R_0, 1, 2)).as_rotvec()
    return x - x_0 + np.einsum("nij,j->ni", R - R_0, marker), turn


def write_moved(
    folder: Path,
    a: Array,
    force: Array,
    columns: Mapping[str, Array | list[str]],
    settings: str,
    *,
    weighs: bool = False,
) -> Path:
    """A file of displacements [mm] and turns [mrad] in columns by their headers, and the robot."""
    path = folder / "moved.csv"
    joints = {f"{name}[rad]": a[:, k] for k, name in enumerate(NAMES)}
    loads = {f"f{axis}[N]": force[:, k] for k, axis in enumerate("xyz")}
    whole = {"pose": _poses(a), **joints, **loads, **columns}
    rows = zip(*(map(_cell, cells) for cells in whole.values()), strict=True)
    path.write_text("\n".join([",".join(whole), *map(",".join, rows)]) + "\n")
    (folder / "six.urdf").write_text(urdf(weighs))
    path.with_suffix(".yaml").write_text(
        "robot: six.urdf\nbase_frame: base\ntool_frame: tool\n"
        "force: {frame: base, point: {xyz: [0, 0, 100], unit: mm}}\n" + settings
    )
    return path


def _poses(a: Array) -> list[str]:
    labels: dict[bytes, str] = {}
    return [labels.setdefault(row.tobytes(), f"p{len(labels)}") for row in a]


def _cell(value: object) -> str:
    if isinstance(value, str):
        return value
    number = float(str(value))
    return "" if np.isnan(number) else f"{number:.12g}"
