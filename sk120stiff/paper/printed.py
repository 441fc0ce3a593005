"""What the paper prints: its tables as data, and the numbers of its text.

G. Alici, B. Shirinzadeh, "Enhanced Stiffness Modeling, Identification and Characterization for
Robot Manipulators", IEEE Transactions on Robotics, 2005. Values are the printed ones in SI; signs
are untouched.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.measurements.table.table import Table, read_table
from sk120stiff.robot.bundled import bundled_robots

#: Section VI: ranges of the first three joints, and the step through them [rad].
LOWER: Array = np.radians([-180.0, -70.0, -115.0])
UPPER: Array = np.radians([180.0, 70.0, 35.0])
STEP = 0.2
#: Section VI: size of each force component of Table IV; "forces as large as 10 kN are needed" [N].
COMPONENT = 100.0
CLAIMED_CRITICAL_FORCE = 10e3
#: Section IV-B: "with a residual norm of 2.2106", unit not given (mm² by eq. (12)).
RESIDUAL_NORM = 2.2106
#: Section IV-B: configurations, load levels, and deadweights [kg].
CONFIGURATIONS, LOADINGS = 20, 5
DEADWEIGHTS = np.array([0.0, 10.0, 20.0, 30.0, 40.0, 50.0])
#: Section I: resolution of the laser tracker [m].
RESOLUTION = 1.26e-6
#: Configurations of Figs. 4 to 6, six joint readings each [rad].
FIGURE_POSES = {
    "4": np.radians([-89.3803, -62.9809, 21.2489, 0.0, -111.2492, -90.0]),
    "5": np.radians([98.1065, 23.2088, -20.7957, 0.0, -69.2041, 90.0]),
    "6": np.radians([-13.6727, -10.9660, -37.4489, 0.0, -52.5514, -90.0]),
}
#: Table I and section II [m]; lengths that Table I gives as zero are left out.
DIMENSIONS = {"L1": 0.215, "L2": 1.100, "L3": 0.250, "D4": 1.300, "D6": 0.230}
#: Section II, the fixture: ahead of the flange, and off its axis [m].
FIXTURE = (0.11265, 0.20532)

_KINDS = {"joint": "angle", "f": "force", "d": "length", "calc": "length"}


@dataclass(frozen=True, eq=False)
class PrintedLoads:
    """N rows of Table II or III: labels, (N, 6) joints [rad], (N, 3) force [N], and all columns.

    `columns` holds (N,) values by the printed name, in SI where they have a unit.
    """

    pose: tuple[str, ...]
    joints: Array
    force: Array
    columns: dict[str, Array]

    @property
    def poses(self) -> tuple[str, ...]:
        """Labels in the order of first appearance."""
        return tuple(dict.fromkeys(self.pose))

    def rows(self, pose: str) -> Index:
        """Indices of the rows of a pose."""
        return np.flatnonzero([label == pose for label in self.pose])


def data_folder() -> Path:
    """The bundled data of the SK120."""
    return bundled_robots()["motoman_sk120"] / "data"


def printed_loads(table: int) -> PrintedLoads:
    """Table II or III as printed."""
    read = _read(table)
    values: dict[str, Array] = {}
    for name in list(read.cells)[1:]:
        kind = _KINDS.get(name.split("_")[0].rstrip("xyz"))
        values[name] = read.quantity(name, kind) if kind else read.numbers(name)
    first = list(values.values())  # six joints and three forces stand before the others
    joints, force = np.stack(first[:6], axis=1), np.stack(first[6:9], axis=1)
    return PrintedLoads(read.cells["pose"], joints, force, values)


def printed_counts() -> tuple[Array, Index]:
    """Table IV: signs of the force components (8, 3), and counts (8, 5) PD, PSD, ND, NSD, ID."""
    read = _read(4)
    signs = [
        [1.0 if sign == "+" else -1.0 for sign in row] for row in read.cells["force_signs_xyz"]
    ]
    counts = np.stack([read.numbers(name) for name in ("PD", "PSD", "ND", "NSD", "ID")], axis=1)
    return np.array(signs), counts.astype(np.intp)


def _read(table: int) -> Table:
    return read_table(data_folder() / "printed" / f"table{table}.csv")
