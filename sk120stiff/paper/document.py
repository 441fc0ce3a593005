"""The reproduction as one document of plain containers: SI, but for µm where a name says so."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from sk120stiff.identify import Fit
from sk120stiff.paper.table2 import FORMULAS
from sk120stiff.stiffness import CLASSES

if TYPE_CHECKING:
    from sk120stiff.paper.reproduction import Reproduction


def as_document(found: Reproduction) -> dict[str, object]:
    """Keys ``table2 table3 table4 identified critical appendix formulation parts claims``."""
    return {
        "robot": found.setting.robot.name,
        "paper_springs": found.setting.arm_springs,
        "table2": _table2(found),
        "identified": _identified(found),
        "table3": _table3(found),
        "table4": _table4(found),
        "critical": asdict(found.critical),
        "appendix": asdict(found.appendix),
        "formulation": asdict(found.formulation),
        "posture": asdict(found.posture),
        "parts": {"lowest": found.parts.lowest, "highest": found.parts.highest},
        "claims": found.claims,
    }


def _table2(found: Reproduction) -> dict[str, object]:
    table = found.table2
    return {
        "negated_in_print": table.negated,
        "calculated_rms_um": {name: _micrometres(table.calculated_rms(name)) for name in FORMULAS},
        "K_C_effect_rms_um": _micrometres(table.effect_of_K_C),
        "measured_rms_um": {
            "paper_springs": _micrometres(table.measured_rms()),
            "identified": _micrometres(table.per_pose(found.identified.fit.gap)),
        },
        "variants": [
            {
                "name": variant.name,
                "calculated_rms_um": 1e6 * variant.calculated_rms,
                "measured_rms_um": 1e6 * variant.measured_rms,
            }
            for variant in table.variants
        ],
        "rows": [
            {
                "pose": pose,
                "joints": table.measured.joints[k],
                "force": table.measured.wrench[k, :3],
                "calculated_theirs": table.calculated[k],
                **{f"calculated_{name}": getattr(table.ours, name)[k] for name in FORMULAS},
                "measured": table.displacement[k],
            }
            for k, pose in enumerate(table.printed.pose)
        ],
    }


def _identified(found: Reproduction) -> dict[str, object]:
    fitted = found.identified
    return {
        **_fit(fitted.fit),
        "equal_weights": _fit(fitted.equal_weights),
        "attempts": fitted.attempts,
        "relative_spread_of_attempts": fitted.spread,
        "by_pose": {
            pose: {"springs": springs, "std": errors}
            for pose, (springs, errors) in fitted.by_pose.items()
        },
        "common_springs": {"F": fitted.F, "probability": fitted.probability},
    }


def _fit(fitted: Fit) -> dict[str, object]:
    return {
        "parameters": [
            {
                "name": p.name,
                "value": p.value,
                "std": p.std,
                "unit": p.spec.unit,
            }
            for p in fitted.parameters
        ],
        "rms_um": 1e6 * fitted.rms,
        "sigma_um": 1e6 * fitted.problem.noise.sigma * fitted.noise_factor,
        "condition": fitted.condition,
        "iterations": fitted.iterations,
    }


def _table3(found: Reproduction) -> dict[str, object]:
    table = found.table3
    return {
        "unit_printed": "joule",
        "unit_found": "N*mm",
        "repeated_rows": [[i + 1, k + 1] for i, k in table.repeated],
        "identity_error": table.identity_error,
        "balance_error": table.balance_error,
        "overcount": [float(table.overcount.min()), float(table.overcount.max())],
        "rows": [
            {
                "pose": pose,
                "force": table.printed.force[k],
                "cartesian_theirs": table.printed_cartesian[k],
                "joint_conventional_theirs": table.printed_conventional[k],
                "cartesian": table.works.cartesian[k],
                "joint_enhanced": table.works.joint_enhanced[k],
                "joint_conventional": table.works.joint_conventional[k],
                "work_along_path": table.work[k],
                "energy": table.energy[k],
                "largest_in_any_direction": table.largest[k],
            }
            for k, pose in enumerate(table.printed.pose)
        ],
    }


def _table4(found: Reproduction) -> dict[str, object]:
    table = found.table4
    names = [c.short for c in CLASSES]
    return {
        "configurations": table.configurations,
        "cases_reproduced_by_determinant": table.reproduced,
        "pd_columns_reproduced_by_determinant": table.reproduced_determinant,
        "printed_opposites_mirror": {
            f"{i}/{k}": holds for (i, k), holds in table.mirrored(table.printed).items()
        },
        "opposites_mirror": {
            f"{i}/{k}": holds for (i, k), holds in table.mirrored(table.counts).items()
        },
        "cases": [
            {
                "case": k + 1,
                "signs": table.signs[k],
                "theirs": dict(zip(names, table.printed[k].tolist(), strict=True)),
                "counts": dict(zip(names, table.counts[k].tolist(), strict=True)),
                "determinant": dict(
                    zip(
                        ("positive", "ND", "rest"),
                        table.determinant_counts[k].tolist(),
                        strict=True,
                    )
                ),
                "K_theta_minus_K_C_PD": table.difference_positive[k],
            }
            for k in range(len(table.signs))
        ],
    }


def _micrometres(values: dict[str, float]) -> dict[str, float]:
    return {name: 1e6 * value for name, value in values.items()}
