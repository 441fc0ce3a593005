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
from sk120stiff.stiffness import Deflection, deflection

#: The formulas of `Deflection`, from crude to exact.
FORMULAS = ("conventional", "enhanced", "second_order", "equilibrium")


@dataclass(frozen=True)
class Variant:
    """Another reading of where the load acted, and how far it is from the printed columns.

    Attributes
    ----------
    name
        Wrist and point.
    calculated_rms, measured_rms
        Root mean square over all rows and axes [m].
    """

    name: str
    calculated_rms: float
    measured_rms: float


@dataclass(frozen=True, eq=False)
class Table2:
    """Rows of Table II in the frame `base_link`.

    Attributes
    ----------
    printed
        The table as printed.
    measured
        The measured columns as measurements.
    calculated
        (N, 3) the calculated columns, signs converted [m].
    ours
        Our deflections by four formulas, with the paper's springs.
    variants
        Other readings of the load's point.
    """

    printed: PrintedLoads
    measured: Measurements
    calculated: Array
    ours: Deflection
    variants: tuple[Variant, ...]

    @property
    def poses(self) -> tuple[str, ...]:
        """Labels of the poses."""
        return self.printed.poses

    @cached_property
    def displacement(self) -> Array:
        """(N, 3) measured displacements [m]."""
        return _displacement(self.measured)

    @cached_property
    def negated(self) -> dict[str, tuple[str, ...]]:
        """Columns whose printed sign was changed, by pose."""
        found = {}
        for pose in self.poses:
            rows = self.printed.rows(pose)
            changed = [
                f"f{axis}"
                for k, axis in enumerate("xyz")
                if _negated(self.printed.force[rows, k], self.measured.wrench[rows, k])
            ]
            changed += [
                f"d{axis}"
                for k, axis in enumerate("xyz")
                if _negated(self.printed.columns[f"d{axis}"][rows], self.displacement[rows, k])
            ]
            found[pose] = tuple(changed)
        return found

    def per_pose(self, gap: Array) -> dict[str, float]:
        """Root mean square of (N, 3) over the rows and axes of each pose [m]."""
        return {pose: rms(gap[self.printed.rows(pose)]) for pose in self.poses}

    def calculated_rms(self, formula: str) -> dict[str, float]:
        """Ours minus the printed calculated column, by one of `FORMULAS`, per pose [m]."""
        return self.per_pose(getattr(self.ours, formula) - self.calculated)

    def measured_rms(self, formula: str = "equilibrium") -> dict[str, float]:
        """Measured minus predicted with the paper's springs, per pose [m]."""
        return self.per_pose(self.displacement - getattr(self.ours, formula))

    @cached_property
    def effect_of_K_C(self) -> dict[str, float]:
        """Difference that K_C makes to the paper's formula, per pose [m]."""
        return self.per_pose(self.ours.enhanced - self.ours.conventional)


def table2(setting: Setting) -> Table2:
    """Recompute Table II with the paper's springs."""
    printed = printed_loads(2)
    folder = data_folder()
    measured = read_measurements(folder / "table2_measured.csv", setting.robot.actuated)
    calculated = _displacement(
        read_measurements(folder / "table2_calculated.csv", setting.robot.actuated)
    )
    ours = deflection(
        setting.mechanism, measured.joints, measured.wrench, setting.springs, measured.point
    )
    return Table2(
        printed=printed,
        measured=measured,
        calculated=calculated,
        ours=ours,
        variants=_variants(setting, printed, measured, calculated),
    )


def _variants(
    setting: Setting, printed: PrintedLoads, measured: Measurements, calculated: Array
) -> tuple[Variant, ...]:
    """Straight or printed wrist, flange or reflector."""
    found = []
    displacement = _displacement(measured)
    for wrist, joints in (("straight", measured.joints), ("as printed", printed.joints)):
        for frame in ("tool0", "reflector"):
            mechanism = setting.robot.mechanism(frame)
            moved = deflection(mechanism, joints, measured.wrench, setting.springs).equilibrium
            point = "flange" if frame == "tool0" else "reflector on the fixture"
            found.append(
                Variant(
                    f"wrist {wrist}, load at the {point}",
                    calculated_rms=rms(moved - calculated),
                    measured_rms=rms(moved - displacement),
                )
            )
    return tuple(found)


def _displacement(measurements: Measurements) -> Array:
    if measurements.displacement is None:
        raise InputError(
            "there are no displacements", where=str(measurements.path), remedy="Reinstall the data."
        )
    return measurements.displacement


def _negated(printed: Array, converted: Array) -> bool:
    return bool(np.allclose(printed, -converted, rtol=1e-12, atol=0.0))
