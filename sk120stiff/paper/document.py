"""The reproduction as one document of plain containers: SI, but for µm where a name says so."""

from __future__ import annotations

from sk120stiff.arrays import Index
from sk120stiff.identify import Fit
from sk120stiff.model.prediction_table import rows_of
from sk120stiff.paper.reproduction import Reproduction
from sk120stiff.paper.table2 import FORMULAS
from sk120stiff.paper.table3 import Table3
from sk120stiff.paper.table4 import Table4
from sk120stiff.stiffness import CLASSES


def as_document(found: Reproduction) -> dict[str, object]:
    """Keys ``table2 table3 table4 identified critical appendix formulation parts claims``."""
    fitted = found.identified
    return {
        "robot": found.setting.robot.name,
        "paper_springs": found.setting.arm_springs,
        "table2": _table2(found),
        "identified": {
            **_fit(fitted.fit),
            "equal_weights": _fit(fitted.equal_weights),
            "runs": fitted.runs,
            "relative_spread_of_runs": fitted.spread,
            "by_pose": {pose: {"springs": k, "std": e} for pose, (k, e) in fitted.by_pose.items()},
            "common_springs": {"F": fitted.F, "probability": fitted.probability},
        },
        "table3": _table3(found.table3),
        "table4": _table4(found.table4),
        "critical": vars(found.critical),
        "appendix": vars(found.appendix),
        "formulation": vars(found.formulation),
        "posture": vars(found.posture),
        "parts": {"lowest": found.parts.lowest, "highest": found.parts.highest},
        "claims": found.claims,
    }


def _table2(found: Reproduction) -> dict[str, object]:
    table = found.table2
    return {
        "negated_in_print": table.negated,
        "calculated_rms_um": {name: _micrometres(table.calculated_rms(name)) for name in FORMULAS},
        "K_C_effect_rms_um": _micrometres(table.effect_of_K_C),
        "variants": table.variants,
        "rows": rows_of(
            {
                "pose": table.printed.pose,
                "joints": table.measured.joints,
                "force": table.measured.wrench[:, :3],
                "calculated_theirs": table.calculated,
                **{f"calculated_{name}": table.ours[name] for name in FORMULAS},
                "measured": table.displacement,
            }
        ),
        "measured_rms_um": {
            "paper_springs": _micrometres(table.measured_rms()),
            "identified": _micrometres(table.per_pose(found.identified.fit.gap)),
        },
    }


def _fit(fitted: Fit) -> dict[str, object]:
    return {
        "parameters": [
            {"name": p.name, "value": p.value, "std": p.std, "unit": p.spec.unit}
            for p in fitted.parameters
        ],
        "rms_um": 1e6 * fitted.rms,
        "sigma_um": 1e6 * fitted.problem.noise.sigma * fitted.noise_factor,
        "condition": fitted.condition,
        "iterations": fitted.iterations,
    }


def _table3(table: Table3) -> dict[str, object]:
    return {
        "unit_printed": "joule",
        "unit_found": "N*mm",
        "repeated_rows": [[i + 1, k + 1] for i, k in table.repeated],
        "identity_error": table.identity_error,
        "balance_error": table.balance_error,
        "overcount": [table.overcount.min(), table.overcount.max()],
        "rows": rows_of(
            {
                "pose": table.printed.pose,
                "force": table.printed.force,
                "cartesian_theirs": table.printed_cartesian,
                "joint_conventional_theirs": table.printed_conventional,
                **vars(table.works),
                "work_along_path": table.work,
                "energy": table.energy,
                "largest_in_any_direction": table.largest,
            }
        ),
    }


def _table4(table: Table4) -> dict[str, object]:
    def mirrored(counts: Index) -> dict[str, bool]:
        return {f"{i}/{k}": holds for (i, k), holds in table.mirrored(counts).items()}

    classes = [c.short for c in CLASSES]
    return {
        "configurations": table.configurations,
        "cases_reproduced_by_determinant": table.reproduced,
        "pd_columns_reproduced_by_determinant": table.reproduced_determinant,
        "printed_opposites_mirror": mirrored(table.printed),
        "opposites_mirror": mirrored(table.counts),
        "cases": rows_of(
            {
                "case": range(1, len(table.signs) + 1),
                "signs": table.signs,
                "theirs": rows_of(dict(zip(classes, table.printed.T, strict=True))),
                "counts": rows_of(dict(zip(classes, table.counts.T, strict=True))),
                "determinant": rows_of(
                    dict(zip(("positive", "ND", "rest"), table.determinant_counts.T, strict=True))
                ),
                "K_theta_minus_K_C_PD": table.difference_positive,
            }
        ),
    }


def _micrometres(values: dict[str, float]) -> dict[str, float]:
    return {name: 1e6 * value for name, value in values.items()}
