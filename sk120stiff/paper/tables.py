"""Ours beside theirs: tables for the terminal, the report and CSV files, and the JSON document.

The document is made of plain containers; SI, but for µm where a name says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.files import csv_text
from sk120stiff.identify import Fit
from sk120stiff.model.predicted import rows_of
from sk120stiff.paper.identified import springs_of
from sk120stiff.paper.printed import CLAIMED_CRITICAL_FORCE
from sk120stiff.paper.recomputed import FORMULAS
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
    def shown_unit(self) -> str:
        """The unit as people write it."""
        return self.unit.replace("*", "·").replace("um", "µm").replace("uJ", "µJ")

    @property
    def parts(self) -> dict[str, list[Any]]:
        """Header with axis and unit → its cells."""
        unit = f"[{self.unit}]" if self.unit else ""
        axes = (" x", " y", " z") if np.ndim(self.values) == 2 else ("",)
        cells = np.atleast_2d(np.transpose(self.values)).tolist()
        return {f"{self.name}{axis}{unit}": part for axis, part in zip(axes, cells, strict=True)}

    def written(self, cells: Sequence[Any], *, more: int = 0) -> list[str]:
        """Cells as text, with `more` decimals than people need."""
        form = "" if self.decimals is None else f"z.{self.decimals + more}f"
        return [format(cell, form) for cell in cells]

    @cached_property
    def texts(self) -> list[str]:
        """A text per row; three numbers side by side, each as wide as the widest of its kind."""
        parts = [self.written(cells) for cells in self.parts.values()]
        wide = ([cell.rjust(max(map(len, of))) for cell in of] for of in parts)
        return [" ".join(row) for row in zip(*wide, strict=True)] if len(parts) > 1 else parts[0]


@dataclass(frozen=True, eq=False)
class SideBySide:
    """A table of the paper beside ours; `name` is that of its file, without ending."""

    name: str
    title: str
    columns: tuple[Column, ...]
    note: str = ""

    @property
    def brief(self) -> tuple[Column, ...]:
        """The columns that are shown where room is short."""
        return tuple(column for column in self.columns if column.brief)

    def csv(self) -> str:
        """The table as CSV text, three decimals more than shown elsewhere."""
        return csv_text(
            (header, column.written(cells, more=3))
            for column in self.columns
            for header, cells in column.parts.items()
        )

    def rows(self) -> list[dict[str, object]]:
        """The rows by the headers of the CSV file, all digits."""
        parts = [column.parts for column in self.columns]
        return rows_of({header: cells for part in parts for header, cells in part.items()})


def side_by_side(found: Reproduction) -> tuple[SideBySide, ...]:
    """Every table, in the order of the paper."""
    names = ("where", "claim", "verdict", "evidence")
    claims = (Column(n, [str(getattr(claim, n)) for claim in found.claims]) for n in names)
    return (
        *_deflections(found),
        *_springs_and_works(found),
        _classes(found),
        *_forces(found),
        SideBySide("claims", "Claims", tuple(claims)),
    )


def _deflections(found: Reproduction) -> tuple[SideBySide, SideBySide]:
    table, gap = found.table2, found.identified.fit.gap
    signs = [" ".join(names) for names in table.negated.values()]
    told = "; ".join(f"pose {p} {names}" for p, names in zip(table.negated, signs, strict=True))

    def rms(name: str, values: dict[str, float], decimals: int = 2) -> Column:
        return Column(name, 1e6 * np.array([*values.values()]), "um", decimals)

    def moved(name: str, values: Array, *, brief: bool = True) -> Column:
        return Column(name, 1e6 * values, "um", 1, brief)

    gaps = (
        Column("pose", table.printed.poses),
        Column("negated in print", signs, brief=False),
        rms("calc., eq. (8)", table.calculated_rms("conventional")),
        rms("calc., eq. (11)", table.calculated_rms("enhanced")),
        rms("calc., exact", table.calculated_rms("equilibrium")),
        rms("K_C on/off", table.effect_of_K_C),
        rms("meas., paper's springs", table.measured_rms(), 1),
        rms("meas., identified", table.per_pose(gap), 1),
    )
    rows = (
        Column("pose", table.printed.pose),
        Column("force", table.measured.wrench[:, :3], "N", 1, brief=False),
        moved("calculated, theirs", table.calculated),
        moved("ours, eq. (11)", table.ours["enhanced"], brief=False),
        moved("ours, exact", table.ours["equilibrium"]),
        moved("measured", table.displacement),
        moved("gap", table.gap, brief=False),
        moved("gap, identified", gap, brief=False),
    )
    return (
        SideBySide(
            "table2_gaps", "Table II, root-mean-square gaps per pose", gaps,
            "Ours against the printed calculated column by three formulas, and the measured column "
            "against the paper's springs and against springs identified from these rows. Printed "
            f"with the opposite sign: {told}.",
        ),
        SideBySide(
            "table2", "Table II, deflections in base_link", rows,
            "Printed signs converted to one frame; load at the flange, wrist straight. A gap is "
            "measured minus predicted at exact equilibrium.",
        ),
    )  # fmt: skip


def _springs_and_works(found: Reproduction) -> tuple[SideBySide, SideBySide]:
    fitted, table = found.identified, found.table3
    theirs, ours = table.differences

    def spring(name: str, values: Array, *, brief: bool = True) -> Column:
        return Column(name, 1e-6 * values, "MN*m/rad", 4, brief)

    def work(name: str, values: Array, *, brief: bool = True) -> Column:
        return Column(name, 1e3 * values, "mJ", 3, brief)  # 1 N·mm is 1 mJ

    springs = (
        Column("joint", [p.effect.where for p in fitted.fit.parameters]),
        spring("paper", found.setting.arm_springs),
        spring("identified", fitted.springs),
        spring("std. error", fitted.errors),
        spring("equal weights", springs_of(fitted.equal_weights)),
        *(spring(f"pose {p} alone", k, brief=False) for p, (k, _) in fitted.by_pose.items()),
    )
    works = (
        Column("pose", table.printed.pose),
        Column("force", table.printed.force, "N", 1, brief=False),
        work("Cartesian, theirs", table.printed_cartesian),
        work("eq. (14), ours", table.works.cartesian),
        work("eq. (15) with K_C, ours", table.works.joint_enhanced),
        Column("without - with, theirs", 1e6 * theirs, "uJ", 1),
        Column("without - with, ours", 1e6 * ours, "uJ", 1),
        work("work along the path", table.work),
        work("energy in the springs", table.energy, brief=False),
    )
    return (
        SideBySide(
            "identified", "Springs identified from Table II", springs,
            f"Three of the paper's twenty poses. {len(fitted.runs)} runs of both algorithms from "
            f"far starts agree to {fitted.spread:.0e}. Equal weights is the paper's eq. (12).",
        ),
        SideBySide(
            "table3", "Table III, works", works,
            "Theirs printed as joule, read as N·mm; the deflections behind them are not printed, "
            "ours are those predicted. Eq. (14) counts three times the work along the path.",
        ),
    )  # fmt: skip


def _classes(found: Reproduction) -> SideBySide:
    table = found.table4
    theirs = {"PD": 0, "ND": 2, "ID": 4}  # classes that the paper found, by their place
    counted = zip(("det > 0", "ND", "rest"), table.determinant_counts.T, strict=True)
    true = zip(CLASSES, table.counts.T, strict=True)
    columns = (
        Column("case", np.arange(1, len(table.signs) + 1)),
        Column("force", ["".join("+" if x > 0 else "-" for x in row) for row in table.signs]),
        *(Column(f"paper {name}", table.printed[:, k]) for name, k in theirs.items()),
        *(Column(name, column, brief=name != "ND") for name, column in counted),
        *(Column(f"true {c.short}", column, brief=bool(column.any())) for c, column in true),
        Column("K_theta - K_C PD", table.difference_positive, brief=False),
    )
    return SideBySide(
        "table4", f"Table IV, classes of K_C over {table.configurations} configurations", columns,
        "Theirs beside signs of the determinant, beside the classes by definition. PD(F) = ND(−F) "
        "must hold for cases 1/2, 3/6, 4/7 and 5/8. K_θ − K_C is positive definite at "
        f"{table.difference_positive.min()} of {table.configurations} configurations in every "
        "case.",
    )  # fmt: skip


def _forces(found: Reproduction) -> tuple[SideBySide, ...]:
    forces, errors, parts = found.critical, found.appendix, found.parts
    sizes = {
        "the paper, about": CLAIMED_CRITICAL_FORCE,
        "smallest, all poses and directions": forces.smallest,
        "upper arm as a column, K2 / L2": forces.column,
        **{f"quantile {q:g}": value for q, value in forces.quantiles.items() if q > 0},
        **{f"C{k}{k} reaches K{k}": v for k, v in enumerate(forces.by_diagonal, start=1)},
    }
    size = Column("size", 1e-3 * np.array([*sizes.values()]), "kN", 1)
    elements = [f"J{i}{k}" for i in (1, 2, 3) for k in (1, 2, 3)]
    wrong = [slip.element for slip in errors.slips if slip.length == "D4"]
    jacobian = (
        Column("element", elements),
        Column("as printed", [f"{x:.1e}" for x in errors.printed_error.ravel()], "m/rad"),
        Column("mended", [f"{x:.1e}" for x in errors.mended_error.ravel()], "m/rad"),
        Column("misprint", ["sign of D4" if e in wrong else "" for e in elements]),
    )
    ranges = (
        Column("element", [s.element for s in parts.surfaces]),
        Column("lowest, force along", parts.lowest, "N*m/rad/N", 3),
        Column("highest, force along", parts.highest, "N*m/rad/N", 3),
    )
    return (
        SideBySide(
            "critical",
            "Forces at which K_θ − K_C loses definiteness",
            (Column("force", list(sizes)), size),
            f"For {100 * forces.without:.0f} % of poses and directions no force is critical.",
        ),
        SideBySide(
            "appendix",
            "Appendix I against our Jacobian at the reflector",
            jacobian,
            "Largest difference over random poses of all six joints.",
        ),
        SideBySide(
            "diagonal_parts", "Figs. 7 to 9, range of each part over the motion range", ranges
        ),
    )


def as_document(found: Reproduction) -> dict[str, object]:
    """The keys that docs/FILES.md names; rows have the headers of the table's CSV file."""
    rows = {table.name: table.rows() for table in side_by_side(found)}
    second, fitted, third, fourth = found.table2, found.identified, found.table3, found.table4
    return {
        "robot": found.setting.robot.name,
        "paper_springs": found.setting.arm_springs,
        "table2": {
            "negated_in_print": second.negated,
            "calculated_rms_um": {
                name: _micrometres(second.calculated_rms(name)) for name in FORMULAS
            },
            "K_C_effect_rms_um": _micrometres(second.effect_of_K_C),
            "measured_rms_um": {
                "paper_springs": _micrometres(second.measured_rms()),
                "identified": _micrometres(second.per_pose(fitted.fit.gap)),
            },
            "variants": second.variants,
            "rows": rows["table2"],
        },
        "identified": {
            **_fit(fitted.fit),
            "equal_weights": _fit(fitted.equal_weights),
            "runs": fitted.runs,
            "relative_spread_of_runs": fitted.spread,
            "by_pose": {pose: {"springs": k, "std": e} for pose, (k, e) in fitted.by_pose.items()},
            "common_springs": {"F": fitted.F, "probability": fitted.probability},
        },
        "table3": {
            "unit_printed": "joule",
            "unit_found": "N*mm",
            "repeated_rows": [[i + 1, k + 1] for i, k in third.repeated],
            "identity_error": third.identity_error,
            "balance_error": third.balance_error,
            "rows": rows["table3"],
        },
        "table4": {
            "configurations": fourth.configurations,
            "cases_reproduced_by_determinant": fourth.reproduced,
            "cases": rows["table4"],
        },
        "critical": vars(found.critical),
        "appendix": vars(found.appendix),
        "formulation": vars(found.formulation),
        "posture": vars(found.posture),
        "parts": {"lowest": found.parts.lowest, "highest": found.parts.highest},
        "claims": found.claims,
    }


def _fit(fitted: Fit) -> dict[str, object]:
    return {
        "parameters": [
            {"name": p.name, "value": p.value, "std": p.std, "unit": p.spec.unit}
            for p in fitted.parameters
        ],
        "rms_um": 1e6 * fitted.rms,
        "condition": fitted.condition,
    }


def _micrometres(values: dict[str, float]) -> dict[str, float]:
    return {name: 1e6 * value for name, value in values.items()}
