"""Ours beside theirs as tables: the same rows for the terminal, the report and CSV files."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.paper.identified import springs_of
from sk120stiff.paper.printed import CLAIMED_CRITICAL_FORCE
from sk120stiff.paper.reproduction import Reproduction
from sk120stiff.stiffness import CLASSES


@dataclass(frozen=True, eq=False)
class Column:
    """One column, or three that belong together: N words, or (N,) or (N, 3) numbers.

    `decimals` None writes counts and words as they are; a column that is not `brief` stands in the
    CSV file alone.
    """

    name: str
    values: Sequence[str] | Array | Index
    unit: str = ""
    decimals: int | None = None
    brief: bool = True

    @property
    def width(self) -> int:
        """How many numbers stand in a row."""
        return int(np.shape(self.values)[1]) if np.ndim(self.values) == 2 else 1

    @property
    def is_number(self) -> bool:
        """Numbers rather than words?"""
        return isinstance(self.values, np.ndarray)

    @property
    def shown_unit(self) -> str:
        """The unit as people write it."""
        return self.unit.replace("*", "·").replace("um", "µm").replace("uJ", "µJ")

    @property
    def names(self) -> list[str]:
        """One name per number, with the axis where there are three."""
        return [self.name] if self.width == 1 else [f"{self.name} {axis}" for axis in "xyz"]

    def cells(self, row: int, *, more: int = 0) -> list[str]:
        """The numbers of a row as text, with `more` decimals than people need."""
        given = [self.values[row]] if self.width == 1 else list(self.values[row])
        if self.decimals is None:
            return [str(value) for value in given]
        return [f"{float(value):z.{self.decimals + more}f}" for value in given]

    def text(self, row: int) -> str:
        """The numbers of a row side by side, each as wide as the widest of its kind."""
        pairs = zip(self.cells(row), self._widths, strict=True)
        return " ".join(cell.rjust(width) for cell, width in pairs)

    @cached_property
    def _widths(self) -> list[int]:
        if self.width == 1:
            return [0]
        rows = [self.cells(row) for row in range(len(self.values))]
        return [max(map(len, cells)) for cells in zip(*rows, strict=True)]


@dataclass(frozen=True, eq=False)
class SideBySide:
    """A table of the paper beside ours; `name` is that of its file, without ending."""

    name: str
    title: str
    columns: tuple[Column, ...]
    note: str = ""

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.columns[0].values)

    @property
    def brief(self) -> tuple[Column, ...]:
        """The columns that are shown where room is short."""
        return tuple(column for column in self.columns if column.brief)

    @property
    def header(self) -> list[str]:
        """Names of single columns with their units."""
        units = {column.name: f"[{column.unit}]" if column.unit else "" for column in self.columns}
        return [name + units[column.name] for column in self.columns for name in column.names]

    def rows(self, *, more: int = 0) -> list[list[str]]:
        """Single cells as text, numbers with `more` decimals than people need."""
        return [
            [cell for column in self.columns for cell in column.cells(k, more=more)]
            for k in range(self.count)
        ]

    def csv(self) -> str:
        """The table as CSV text, three decimals more than shown elsewhere."""
        stream = io.StringIO()
        csv.writer(stream, lineterminator="\n").writerows([self.header, *self.rows(more=3)])
        return stream.getvalue()


def side_by_side(found: Reproduction) -> tuple[SideBySide, ...]:
    """Every table, in the order of the paper."""
    made = (_gaps, _table2, _springs, _table3, _table4, _critical, _appendix, _parts, _claims)
    return tuple(table(found) for table in made)


def _gaps(found: Reproduction) -> SideBySide:
    table = found.table2
    poses = table.printed.poses
    signs = [" ".join(table.negated[p]) for p in poses]
    told = "; ".join(f"pose {p} {names}" for p, names in zip(poses, signs, strict=True))

    def column(name: str, values: Mapping[str, float], decimals: int = 2) -> Column:
        return Column(name, 1e6 * np.array([values[p] for p in poses]), "um", decimals)

    return SideBySide(
        "table2_gaps",
        "Table II, root-mean-square gaps per pose",
        (
            Column("pose", poses),
            Column("negated in print", signs, brief=False),
            column("calc., eq. (8)", table.calculated_rms("conventional")),
            column("calc., eq. (11)", table.calculated_rms("enhanced")),
            column("calc., exact", table.calculated_rms("equilibrium")),
            column("K_C on/off", table.effect_of_K_C),
            column("meas., paper's springs", table.measured_rms(), 1),
            column("meas., identified", table.per_pose(found.identified.fit.gap), 1),
        ),
        "Ours against the printed calculated column by three formulas, and the measured column "
        "against the paper's springs and against springs identified from these rows. Printed with "
        f"the opposite sign: {told}.",
    )


def _table2(found: Reproduction) -> SideBySide:
    table = found.table2

    def column(name: str, values: Array, *, brief: bool = True) -> Column:
        return Column(name, 1e6 * values, "um", 1, brief)

    return SideBySide(
        "table2",
        "Table II, deflections in base_link",
        (
            Column("pose", table.printed.pose),
            Column("force", table.measured.wrench[:, :3], "N", 1, brief=False),
            column("calculated, theirs", table.calculated),
            column("ours, eq. (11)", table.ours["enhanced"], brief=False),
            column("ours, exact", table.ours["equilibrium"]),
            column("measured", table.displacement),
            column("gap", table.gap, brief=False),
            column("gap, identified", found.identified.fit.gap, brief=False),
        ),
        "Printed signs converted to one frame; load at the flange, wrist straight. A gap is "
        "measured minus predicted at exact equilibrium.",
    )


def _springs(found: Reproduction) -> SideBySide:
    fitted = found.identified

    def column(name: str, values: Array, *, brief: bool = True) -> Column:
        return Column(name, 1e-6 * values, "MN*m/rad", 4, brief)

    return SideBySide(
        "identified",
        "Springs identified from Table II",
        (
            Column("joint", [p.effect.where for p in fitted.fit.parameters]),
            column("paper", found.setting.arm_springs),
            column("identified", fitted.springs),
            column("std. error", fitted.errors),
            column("equal weights", springs_of(fitted.equal_weights)),
            *(column(f"pose {p} alone", k, brief=False) for p, (k, _) in fitted.by_pose.items()),
        ),
        f"Three of the paper's twenty poses. {len(fitted.runs)} runs of both algorithms from "
        f"far starts agree to {fitted.spread:.0e}. Equal weights is the paper's eq. (12).",
    )


def _table3(found: Reproduction) -> SideBySide:
    table = found.table3
    theirs, ours = table.differences

    def column(name: str, values: Array, *, brief: bool = True) -> Column:
        return Column(name, 1e3 * values, "mJ", 3, brief)  # 1 N·mm is 1 mJ

    return SideBySide(
        "table3",
        "Table III, works",
        (
            Column("pose", table.printed.pose),
            Column("force", table.printed.force, "N", 1, brief=False),
            column("Cartesian, theirs", table.printed_cartesian),
            column("eq. (14), ours", table.works.cartesian),
            column("eq. (15) with K_C, ours", table.works.joint_enhanced),
            Column("without - with, theirs", 1e6 * theirs, "uJ", 1),
            Column("without - with, ours", 1e6 * ours, "uJ", 1),
            column("work along the path", table.work),
            column("energy in the springs", table.energy, brief=False),
        ),
        "Theirs printed as joule, read as N·mm; the deflections behind them are not printed, ours "
        "are those predicted. Eq. (14) counts three times the work along the path.",
    )


def _table4(found: Reproduction) -> SideBySide:
    table = found.table4
    signs = ["".join("+" if x > 0 else "-" for x in row) for row in table.signs]
    theirs = [Column(f"paper {name}", table.printed[:, k]) for name, k in _COUNTED.items()]
    counted = [
        Column(name, column, brief=name != "ND")
        for name, column in zip(("det > 0", "ND", "rest"), table.determinant_counts.T, strict=True)
    ]
    true = [
        Column(f"true {c.short}", column, brief=bool(column.any()))
        for c, column in zip(CLASSES, table.counts.T, strict=True)
    ]
    return SideBySide(
        "table4",
        f"Table IV, classes of K_C over {table.configurations} configurations",
        (
            Column("case", [str(k + 1) for k in range(len(signs))]),
            Column("force", signs),
            *theirs,
            *counted,
            *true,
            Column("K_theta - K_C PD", table.difference_positive, brief=False),
        ),
        "Theirs beside signs of the determinant, beside the classes by definition. PD(F) = ND(−F) "
        "must hold for cases 1/2, 3/6, 4/7 and 5/8. K_θ − K_C is positive definite at "
        f"{table.difference_positive.min()} of {table.configurations} configurations in every "
        "case.",
    )


_COUNTED = {"PD": 0, "ND": 2, "ID": 4}  # classes that the paper found, by their place


def _critical(found: Reproduction) -> SideBySide:
    forces = found.critical
    rows = {
        "the paper, about": CLAIMED_CRITICAL_FORCE,
        "smallest, all poses and directions": forces.smallest,
        "upper arm as a column, K2 / L2": forces.column,
        **{f"quantile {q:g}": value for q, value in forces.quantiles.items() if q > 0},
        **{f"C{k}{k} reaches K{k}": v for k, v in enumerate(forces.by_diagonal, start=1)},
    }
    return SideBySide(
        "critical",
        "Forces at which K_θ − K_C loses definiteness",
        (
            Column("force", list(rows)),
            Column("size", 1e-3 * np.array([*rows.values()]), "kN", 1),
        ),
        f"For {100 * forces.without:.0f} % of poses and directions no force is critical.",
    )


def _appendix(found: Reproduction) -> SideBySide:
    errors = found.appendix
    elements = [f"J{i}{k}" for i in (1, 2, 3) for k in (1, 2, 3)]
    slips = {slip.element: slip.length for slip in errors.slips if slip.length == "D4"}
    return SideBySide(
        "appendix",
        "Appendix I against our Jacobian at the reflector",
        (
            Column("element", elements),
            Column("as printed", [f"{x:.1e}" for x in errors.printed_error.ravel()], "m/rad"),
            Column("mended", [f"{x:.1e}" for x in errors.mended_error.ravel()], "m/rad"),
            Column("misprint", [f"sign of {slips[e]}" if e in slips else "" for e in elements]),
        ),
        "Largest difference over random poses of all six joints.",
    )


def _parts(found: Reproduction) -> SideBySide:
    return SideBySide(
        "diagonal_parts",
        "Figs. 7 to 9, range of each part over the motion range",
        (
            Column("element", [s.element for s in found.parts.surfaces]),
            Column("lowest, force along", found.parts.lowest, "N*m/rad/N", 3),
            Column("highest, force along", found.parts.highest, "N*m/rad/N", 3),
        ),
    )


def _claims(found: Reproduction) -> SideBySide:
    names = ("where", "claim", "verdict", "evidence")
    columns = (Column(n, [str(getattr(claim, n)) for claim in found.claims]) for n in names)
    return SideBySide("claims", "Claims", tuple(columns))
