"""The paper's Table II from its own numbers: planar geometry, three springs, nothing else.

Reads the printed table and applies the sign rules of robots/motoman_sk120/SOURCES.md here again,
so that the conversion script is checked too.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROBOT = Path(__file__).resolve().parents[2] / "robots" / "motoman_sk120"
SPRINGS = np.array([1.4098e9, 4.0076e8, 9.3528e8])  # [N·mm/rad], as printed

# Signs that make force and displacement columns one frame: (fx fy fz), (dx dy dz) per pose.
SIGNS = {
    "1": (np.array([1, 1, 1]), np.array([-1, 1, 1])),
    "2": (np.array([1, 1, 1]), np.array([-1, 1, 1])),
    "3": (np.array([1, -1, -1]), np.array([1, -1, 1])),
}


def reach(t2: float, t3: float, ahead: float = 230.0) -> tuple[float, float]:
    """In-plane reach and height above the shoulder [mm] of a point ahead of the wrist centre."""
    r = 215 + 1100 * np.sin(t2) + (1300 + ahead) * np.cos(t3) - 250 * np.sin(t3)
    z = 1100 * np.cos(t2) + (1300 + ahead) * np.sin(t3) + 250 * np.cos(t3)
    return float(r), float(z)


def jacobian(angles: Array, ahead: float = 230.0) -> Array:
    """(3, 3) d(x, y, z)/d(theta_1, theta_2, theta_3) [mm/rad], by hand from `reach`."""
    t1, t2, t3 = angles
    r, _ = reach(t2, t3, ahead)
    out, side = np.array([np.cos(t1), np.sin(t1)]), np.array([-np.sin(t1), np.cos(t1)])
    dr2, dz2 = 1100 * np.cos(t2), -1100 * np.sin(t2)
    dr3 = -(1300 + ahead) * np.sin(t3) - 250 * np.cos(t3)
    dz3 = (1300 + ahead) * np.cos(t3) - 250 * np.sin(t3)
    columns = [np.append(r * side, 0.0), np.append(dr2 * out, dz2), np.append(dr3 * out, dz3)]
    return np.array(columns).T


def printed_rows() -> list[dict[str, str]]:
    path = ROBOT / "data" / "printed" / "table2.csv"
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def columns(row: dict[str, str], names: list[str]) -> Array:
    return np.array([float(row[name]) for name in names])


def residuals_um(measured: bool = False, convert_signs: bool = True) -> dict[str, Array]:
    """Predicted minus printed displacement [µm], (5, 3) per pose, without K_C."""
    gaps: dict[str, list[Array]] = {}
    for row in printed_rows():
        angles = np.radians(columns(row, ["joint_1_s[deg]", "joint_2_l[deg]", "joint_3_u[deg]"]))
        force = columns(row, ["fx[N]", "fy[N]", "fz[N]"])
        prefix = "" if measured else "calc_"
        printed = columns(row, [f"{prefix}d{axis}[mm]" for axis in "xyz"])
        if convert_signs:
            force_sign, displacement_sign = SIGNS[row["pose"]]
            force, printed = force * force_sign, printed * displacement_sign
        J = jacobian(angles)
        predicted = J @ (J.T @ force / SPRINGS)
        gaps.setdefault(row["pose"], []).append((predicted - printed) * 1e3)
    return {pose: np.array(rows) for pose, rows in gaps.items()}


def rms(gap: Array) -> float:
    """Root mean square over all readings and axes."""
    return float(np.sqrt(np.mean(gap**2)))
