"""Table II: deflections calculated by the paper, and measured, against ours.

The printed signs are not one coherent frame; the bundled measurement files hold the same digits in
`base_link`, and which signs they changed is found here by comparing the two. Why these signs and a
straight wrist: SOURCES.md of the robot.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements, read_measurements
from sk120stiff.paper.printed import PrintedLoads, data_folder, printed_loads
from sk120stiff.paper.setting import Setting, rms

#: The formulas of `UnderLoad`, from crude to exact.
FORMULAS = ("conventional", "enhanced", "second_order", "equilibrium")


@dataclass(frozen=True)
class Variant:
    """Another reading of where the load acted, and its rms over all rows and axes [µm]."""

    name: str
    calculated_rms_um: float
    measured_rms_um: float


@dataclass(frozen=True, eq=False)
class Table2:
    """N rows of Table II in the frame `base_link`.

    `calculated` and `displacement` are the paper's two columns with their signs converted, (N, 3)
    [m]; `ours` are our deflections with the paper's springs by four formulas.
    """

    printed: PrintedLoads
    measured: Measurements
    calculated: Array
    displacement: Array
    ours: dict[str, Array]
    variants: tuple[Variant, ...]

    @cached_property
    def gap(self) -> Array:
        """(N, 3) measured minus predicted at exact equilibrium [m]."""
        return np.asarray(self.displacement - self.ours["equilibrium"])

    @cached_property
    def negated(self) -> dict[str, tuple[str, ...]]:
        """Columns whose printed sign was changed, by pose."""
        pairs = {
            **{f"f{x}": (self.printed.force[:, k], self.measured.wrench[:, k]) for k, x in _AXES},
            **{f"d{x}": (self.printed.columns[f"d{x}"], self.displacement[:, k]) for k, x in _AXES},
        }
        return {
            pose: tuple(
                name
                for name, (theirs, ours) in pairs.items()
                if np.allclose(theirs[rows], -ours[rows], rtol=1e-12, atol=0.0)
            )
            for pose in self.printed.poses
            for rows in [self.printed.rows(pose)]
        }

    def per_pose(self, gap: Array) -> dict[str, float]:
        """Root mean square of (N, 3) over the rows and axes of each pose [m]."""
        return {pose: rms(gap[self.printed.rows(pose)]) for pose in self.printed.poses}

    def calculated_rms(self, formula: str) -> dict[str, float]:
        """Ours minus the printed calculated column, by one of `FORMULAS`, per pose [m]."""
        return self.per_pose(self.ours[formula] - self.calculated)

    def measured_rms(self, formula: str = "equilibrium") -> dict[str, float]:
        """Measured minus predicted with the paper's springs, per pose [m]."""
        return self.per_pose(self.displacement - self.ours[formula])

    @cached_property
    def effect_of_K_C(self) -> dict[str, float]:
        """Difference that K_C makes to the paper's formula, per pose [m]."""
        return self.per_pose(self.ours["enhanced"] - self.ours["conventional"])


_AXES = tuple(enumerate("xyz"))


def table2(setting: Setting) -> Table2:
    """Recompute Table II with the paper's springs."""
    printed = printed_loads(2)
    measured, calculated = (
        read_measurements(data_folder() / f"table2_{column}.csv", setting.robot.actuated)
        for column in ("measured", "calculated")
    )
    if measured.displacement is None or calculated.displacement is None:
        raise InputError("Table II lacks displacements", remedy="Reinstall the package.")
    force, theirs = measured.wrench[:, :3], (calculated.displacement, measured.displacement)
    variants = tuple(
        Variant(f"wrist {wrist}, load at the {point}", *(1e6 * rms(moved - d) for d in theirs))
        for wrist, joints in (("straight", measured.joints), ("as printed", printed.joints))
        for frame, point in (("tool0", "flange"), ("reflector", "reflector on the fixture"))
        for moved in [setting.deflection(joints, force, frame=frame)]
    )
    quantity = {name: f"deflection_{name}" for name in FORMULAS}
    found = setting.under_load(measured.joints, force, *quantity.values(), point=measured.point)
    ours = {name: found.of(wanted) for name, wanted in quantity.items()}
    return Table2(printed, measured, *theirs, ours, variants)
