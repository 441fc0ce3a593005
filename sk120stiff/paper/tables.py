"""Ours beside theirs as tables: the same rows for the terminal, the report and CSV files."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.paper.printed import CLAIMED_CRITICAL_FORCE
from sk120stiff.stiffness import CLASSES

if TYPE_CHECKING:
    from sk120stiff.paper.reproduction import Reproduction

_AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Column:
    """One column, or three that belong together.

    Attributes
    ----------
    name
        What it holds, and whose it is.
    values
        N words, or (N,) or (N, 3) numbers.
    unit
        Empty for words and counts.
    decimals
        Places after the point; None writes counts and words as they are.
    brief
        Shown where room is short.
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

    def text(self, row: int) -> str:
        """The numbers of a row side by side, each as wide as the widest of its kind."""
        return " ".join(
            cell.rjust(width) for cell, width in zip(self.cells(row), self._widths, strict=True)
        )

    @cached_property
    def _widths(self) -> list[int]:
        if self.width == 1:
            return [0]
        cells = [self.cells(row) for row in range(len(self.values))]
        return [max(len(row[k]) for row in cells) for k in range(self.width)]

    def names(self) -> list[str]:
        """One name per number, with the axis where there are three."""
        return [self.name] if self.width == 1 else [f"{self.name} {axis}" for axis in _AXES]

    def cells(self, row: int, *, more: int = 0) -> list[str]:
        """The numbers of a row as text, with `more` decimals than people need."""
        value = self.values[row]
        given = [value] if self.width == 1 else list(value)
        places = None if self.decimals is None else self.decimals + more
        return [_cell(x, places) for x in given]


@dataclass(frozen=True, eq=False)
class SideBySide:
    """A table of the paper beside ours.

    Attributes
    ----------
    name
        Name of its file, without ending.
    title
        Heading.
    columns
        All of one length.
    note
        What it shows, in a sentence or two.
    """

    name: str
    title: str
    columns: tuple[Column, ...]
    note: str = ""

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.columns[0].values)

    def header(self) -> list[str]:
        """Names of single columns."""
        return [name for column in self.columns for name in column.names()]

    def units(self) -> list[str]:
        """Units of single columns."""
        return [column.unit for column in self.columns for _ in column.names()]

    def rows(self, *, more: int = 0) -> list[list[str]]:
        """Single cells as text, numbers with `more` decimals than people need."""
        return [
            [cell for column in self.columns for cell in column.cells(k, more=more)]
            for k in range(self.count)
        ]

    def csv(self) -> str:
        """The table as CSV text, units in the header, three decimals more than shown elsewhere."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        heads = zip(self.header(), self.units(), strict=True)
        writer.writerow([f"{name}[{unit}]" if unit else name for name, unit in heads])
        writer.writerows(self.rows(more=3))
        return stream.getvalue()


def side_by_side(found: Reproduction) -> tuple[SideBySide, ...]:
    """Every table, in the order of the paper."""
    return (
        _table2_gaps(found),
        _table2(found),
        _springs(found),
        _table3(found),
        _table4(found),
        _critical(found),
        _appendix(found),
        _parts(found),
        _claims(found),
    )


def _table2_gaps(found: Reproduction) -> SideBySide:
    table = found.table2
    poses = table.poses
    identified = table.per_pose(found.identified.fit.gap)
    signs = [" ".join(table.negated[p]) for p in poses]
    told = "; ".join(f"pose {p} {names}" for p, names in zip(poses, signs, strict=True))

    def column(name: str, values: dict[str, float], decimals: int = 2) -> Column:
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
            column("meas., identified", identified, 1),
        ),
        "Ours against the printed calculated column by three formulas, and the measured column "
        "against the paper's springs and against springs identified from these rows. Printed with "
        f"the opposite sign: {told}.",
    )


def _table2(found: Reproduction) -> SideBySide:
    table = found.table2
    gap = table.displacement - table.ours.equilibrium
    return SideBySide(
        "table2",
        "Table II, deflections in base_link",
        (
            Column("pose", table.printed.pose),
            Column("force", table.measured.wrench[:, :3], "N", 1, brief=False),
            Column("calculated, theirs", 1e6 * table.calculated, "um", 1),
            Column("ours, eq. (11)", 1e6 * table.ours.enhanced, "um", 1, brief=False),
            Column("ours, exact", 1e6 * table.ours.equilibrium, "um", 1),
            Column("measured", 1e6 * table.displacement, "um", 1),
            Column("gap", 1e6 * gap, "um", 1, brief=False),
            Column("gap, identified", 1e6 * found.identified.fit.gap, "um", 1, brief=False),
        ),
        "Printed signs converted to one frame; load at the flange, wrist straight. A gap is "
        "measured minus predicted at exact equilibrium.",
    )


def _springs(found: Reproduction) -> SideBySide:
    fitted = found.identified
    columns = [
        Column("joint", [p.effect.where for p in fitted.fit.parameters]),
        Column("paper", 1e-6 * found.setting.arm_springs, "MN*m/rad", 4),
        Column("identified", 1e-6 * fitted.springs, "MN*m/rad", 4),
        Column("std. error", 1e-6 * fitted.errors, "MN*m/rad", 4),
        Column(
            "equal weights",
            1e-6 * np.array([p.value for p in fitted.equal_weights.parameters]),
            "MN*m/rad",
            4,
        ),
    ]
    columns += [
        Column(f"pose {pose} alone", 1e-6 * springs, "MN*m/rad", 4, brief=False)
        for pose, (springs, _) in fitted.by_pose.items()
    ]
    return SideBySide(
        "identified",
        "Springs identified from Table II",
        tuple(columns),
        f"Three of the paper's twenty poses. {len(fitted.attempts)} runs of both algorithms from "
        f"far starts agree to {fitted.spread:.0e}. Equal weights is the paper's eq. (12).",
    )


def _table3(found: Reproduction) -> SideBySide:
    table = found.table3
    mJ = 1e3  # 1 N·mm is 1 mJ
    theirs = table.printed_conventional - table.printed_cartesian
    ours = table.works.joint_conventional - table.works.cartesian
    return SideBySide(
        "table3",
        "Table III, works",
        (
            Column("pose", table.printed.pose),
            Column("force", table.printed.force, "N", 1, brief=False),
            Column("Cartesian, theirs", mJ * table.printed_cartesian, "mJ", 3),
            Column("eq. (14), ours", mJ * table.works.cartesian, "mJ", 3),
            Column("eq. (15) with K_C, ours", mJ * table.works.joint_enhanced, "mJ", 3),
            Column("without - with, theirs", 1e6 * theirs, "uJ", 1),
            Column("without - with, ours", 1e6 * ours, "uJ", 1),
            Column("work along the path", mJ * table.work, "mJ", 3),
            Column("energy in the springs", mJ * table.energy, "mJ", 3, brief=False),
        ),
        "Theirs printed as joule, read as N·mm; the deflections behind them are not printed, ours "
        "are those predicted. Eq. (14) counts three times the work along the path.",
    )


def _table4(found: Reproduction) -> SideBySide:
    table = found.table4
    theirs = {"PD": 0, "ND": 2, "ID": 4}
    signs = ["".join("+" if x > 0 else "-" for x in row) for row in table.signs]
    counted = table.determinant_counts
    return SideBySide(
        "table4",
        f"Table IV, classes of K_C over {table.configurations} configurations",
        (
            Column("case", [str(k + 1) for k in range(len(signs))]),
            Column("force", signs),
            *(Column(f"paper {name}", table.printed[:, k]) for name, k in theirs.items()),
            Column("det > 0", counted[:, 0]),
            Column("ND", counted[:, 1], brief=False),
            Column("rest", counted[:, 2]),
            *(
                Column(f"true {c.short}", table.counts[:, k], brief=bool(table.counts[:, k].any()))
                for k, c in enumerate(CLASSES)
            ),
            Column("K_theta - K_C PD", table.difference_positive, brief=False),
        ),
        "Theirs beside signs of the determinant, beside the classes by definition. PD(F) = ND(−F) "
        "must hold for cases 1/2, 3/6, 4/7 and 5/8. K_θ − K_C is positive definite at "
        f"{table.difference_positive.min()} of {table.configurations} configurations in every "
        "case.",
    )


def _critical(found: Reproduction) -> SideBySide:
    forces = found.critical
    rows = {
        "the paper, about": CLAIMED_CRITICAL_FORCE,
        "smallest, all poses and directions": forces.smallest,
    }
    rows["upper arm as a column, K2 / L2"] = forces.column
    rows |= {f"quantile {q:g}": value for q, value in forces.quantiles.items() if q > 0}
    rows |= {f"C{k + 1}{k + 1} reaches K{k + 1}": v for k, v in enumerate(forces.by_diagonal)}
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
    low, high = found.parts.lowest, found.parts.highest
    return SideBySide(
        "diagonal_parts",
        "Figs. 7 to 9, range of each part over the motion range",
        (
            Column("element", [s.element for s in found.parts.surfaces]),
            Column("lowest, force along", low, "N*m/rad/N", 3),
            Column("highest, force along", high, "N*m/rad/N", 3),
        ),
    )


def _claims(found: Reproduction) -> SideBySide:
    every = found.claims
    return SideBySide(
        "claims",
        "Claims",
        (
            Column("where", [claim.where for claim in every]),
            Column("claim", [claim.claim for claim in every]),
            Column("verdict", [claim.verdict.value for claim in every]),
            Column("evidence", [claim.evidence for claim in every]),
        ),
    )


def _cell(value: object, decimals: int | None) -> str:
    if decimals is None:
        return str(value)
    text = f"{float(value):.{decimals}f}"  # type: ignore[arg-type]
    return text.lstrip("-") if float(text) == 0.0 else text
