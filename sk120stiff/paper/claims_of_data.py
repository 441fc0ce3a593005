"""Claims that rest on measured data: Tables II and III, identification, Figs. 4 to 6."""

from __future__ import annotations

import numpy as np

from sk120stiff.paper.findings import Findings
from sk120stiff.paper.printed import CONFIGURATIONS, LOADINGS, RESIDUAL_NORM, RESOLUTION
from sk120stiff.paper.setting import rms
from sk120stiff.paper.verdict import Claim, Verdict, reproduced_if

ROUNDING = 1e-9
CALCULATED_LIMIT = 0.3e-6  # m rms per pose: the columns are printed to 0.1 µm


def claims_of_data(found: Findings) -> list[Claim]:
    """Claims that rest on measured data, or on numbers said to be computed from them."""
    return [*_identification(found), *_table2(found), *_table3(found), *_curves(found)]


def _identification(found: Findings) -> list[Claim]:
    fitted, paper = found.identified, found.setting.arm_springs
    off = fitted.springs / paper - 1.0
    gap = found.table2.gap
    squares = float(np.sum((1e3 * gap) ** 2))  # mm²
    per_axis = (RESIDUAL_NORM / (CONFIGURATIONS * LOADINGS * 3)) ** 0.5 * 1e3  # µm
    return [
        Claim(
            "IV, B",
            "K_θ = diag(1.4098, 0.40076, 0.93528)·10⁹ N·mm/rad.",
            Verdict.NOT_REPRODUCIBLE,
            f"{CONFIGURATIONS} configurations were measured, {len(found.table2.printed.poses)} are "
            "printed. From these come "
            + ", ".join(
                f"{value / 1e6:.3f} ± {error / 1e6:.3f}"
                for value, error in zip(fitted.springs, fitted.errors, strict=True)
            )
            + " ·10⁶ N·m/rad, "
            + ", ".join(f"{100 * value:+.1f} %" for value in off)
            + " from the paper's.",
        ),
        Claim(
            "IV, A",
            "Interior-reflective Newton and Levenberg–Marquardt reach the same values; so do "
            "different starts.",
            reproduced_if(fitted.spread < 1e-5),
            f"{len(fitted.attempts)} runs of both, from "
            f"{min(a.start for a in fitted.attempts) * 1e3:.0e} to "
            f"{max(a.start for a in fitted.attempts) * 1e3:.0e} N·mm/rad, agree to "
            f"{fitted.spread:.0e}.",
        ),
        Claim(
            "IV, B",
            "The joint stiffness is constant and does not change with the configuration.",
            reproduced_if(fitted.probability > 0.01, Verdict.NOT_REPRODUCIBLE),
            "The printed poses do not show it. Fitted to one pose at a time, the spring of joint 1 "
            "comes out as "
            + ", ".join(
                f"{springs[0] / 1e6:.2f} ± {errors[0] / 1e6:.2f}"
                for springs, errors in fitted.by_pose.values()
            )
            + " ·10⁶ N·m/rad. If they were the same everywhere, poses would differ so much with a "
            f"probability of {fitted.probability:.1g} (F = {fitted.F:.1f}): something the three "
            "springs do not describe depends on the pose.",
        ),
        Claim(
            "IV, B",
            f"Residual norm {RESIDUAL_NORM} by eq. (12).",
            Verdict.NOT_REPRODUCIBLE,
            f"Its data are not printed, nor its unit. In mm² over all readings it would mean "
            f"{per_axis:.0f} µm rms per axis; the three printed poses have {squares:.4f} mm², "
            f"{1e6 * rms(gap):.0f} µm rms.",
        ),
    ]


def _table2(found: Findings) -> list[Claim]:
    table = found.table2
    enhanced, exact = table.calculated_rms("enhanced"), table.calculated_rms("equilibrium")
    signs = "; ".join(f"pose {p}: {' '.join(names)}" for p, names in table.negated.items())
    others = [v for v in table.variants if v != table.variants[0]]
    gap = table.gap
    share = rms(gap) / rms(table.displacement)
    without = rms(table.displacement - table.ours["conventional"])
    with_K_C = rms(table.displacement - table.ours["enhanced"])
    best = min(enhanced.values()), max(enhanced.values()), max(exact.values())
    return [
        Claim(
            "IV, Table II",
            "Deflections calculated from the identified springs.",
            reproduced_if(max(best[1:]) <= CALCULATED_LIMIT),
            f"To {_um(enhanced)} µm rms by eq. (11) and {_um(exact)} at exact equilibrium, poses 1 "
            "to 3. Two things had to be found out: columns printed with the opposite sign "
            f"({signs}) and the load at the flange with the wrist straight, no fixture.",
        ),
        Claim(
            "IV, Table II",
            "The load acts on the fixture at the printed wrist angles.",
            reproduced_if(
                others[-1].calculated_rms_um <= 1e6 * CALCULATED_LIMIT, Verdict.NOT_REPRODUCIBLE
            ),
            "The calculated column does not come from the printed configuration: "
            + "; ".join(
                f"{v.name}: {v.calculated_rms_um:.0f} µm off calculated, "
                f"{v.measured_rms_um:.0f} off measured"
                for v in others
            )
            + f". Straight and at the flange: {table.variants[0].calculated_rms_um:.2f} and "
            f"{table.variants[0].measured_rms_um:.0f} µm.",
        ),
        Claim(
            "IV, Table II",
            "The difference of calculated and measured deflections is negligibly small.",
            reproduced_if(rms(gap) < 3 * RESOLUTION),
            f"It is {_um(table.measured_rms(), 1)} µm rms in poses 1 to 3, {100 * share:.0f} % of "
            f"the deflections and {rms(gap) / RESOLUTION:.0f} times the tracker's resolution. "
            f"Springs identified from these rows leave {1e6 * found.identified.fit.rms:.1f} µm: "
            "the rest is not joint springs.",
        ),
        Claim(
            "IV, Table II",
            "To tell the two formulations apart by deflections takes a far better tracker.",
            reproduced_if(max(table.effect_of_K_C.values()) < RESOLUTION),
            f"K_C changes the calculated column by {_um(table.effect_of_K_C)} µm rms, below the "
            f"resolution of {1e6 * RESOLUTION:.2f} µm; the measured one is missed by "
            f"{1e6 * without:.2f} µm without and {1e6 * with_K_C:.2f} µm with it.",
        ),
        Claim(
            "Abstract",
            "New experimental results prove that the conventional formulation is incomplete.",
            Verdict.WRONG,
            "It is incomplete, but no measurement here shows it: in Table II K_C makes less than "
            "the tracker can resolve, and Table III compares two formulas with each other, "
            "whatever was measured.",
        ),
    ]


def _table3(found: Findings) -> list[Claim]:
    table, form = found.table3, found.formulation
    gap_theirs, gap_ours = table.differences
    same_sign = int((np.sign(gap_theirs) == np.sign(gap_ours)).sum())
    beyond = int((table.printed_cartesian > table.largest).sum())
    count = len(table.work)
    typical = float(np.exp(np.mean(np.log(table.ratio))))
    row, after = table.repeated[0] if table.repeated else (0, 0)
    rows = table.printed.rows(table.printed.pose[row])
    usual = table.work_per_force_squared[rows[rows != row]]
    return [
        Claim(
            "IV, Table III",
            "With K_C the works in Cartesian and joint space are precisely equal.",
            reproduced_if(table.identity_error < ROUNDING),
            f"To {table.identity_error:.0e}. But that is algebra, not evidence: J turns one "
            "formula into the other for any displacement at all; random ones fit as well as "
            "measured ones.",
        ),
        Claim(
            "IV, C",
            "The conventional formulation violates the conservation of energy.",
            reproduced_if(form.conventional_cycle > 1e-3 and form.enhanced_cycle < 1e-6),
            f"When a force of {form.load / 1e3:.0f} kN goes round a full circle and the arm "
            f"follows by increments, eq. (8) leaves over up to {100 * form.conventional_cycle:.1f} "
            f"% of the stored energy, eq. (10) {form.enhanced_cycle:.0e} of it.",
        ),
        Claim(
            "IV, Table III",
            "The unequal works of Table III show that violation.",
            Verdict.WRONG,
            "The table sets the enhanced K_X against the conventional joint stiffness. Their works "
            "differ by ½ Δθᵀ K_C Δθ by construction, whatever was displaced "
            f"({1e6 * np.min(np.abs(gap_ours)):.1f} to {1e6 * np.max(np.abs(gap_ours)):.0f} µJ for "
            "predicted displacements); each formulation agrees with itself, as the paper notes. "
            "The true balance, ∫ F·dX along the loading path = energy in the springs, holds to "
            f"{table.balance_error:.0e} for these springs, and no K_X enters it.",
        ),
        Claim(
            "IV, eqs. (14), (15)",
            "The work of a load is Fᵀ ΔX + ½ ΔXᵀ K_X ΔX.",
            Verdict.WRONG,
            "That is the energy of a further displacement under a load that is already there. A "
            "load that grows from zero does half of F·ΔX: eq. (14) gives "
            f"{table.overcount.min():.3f} to {table.overcount.max():.3f} times the work done. In "
            "eq. (15) ΔX is misprinted for Δθ.",
        ),
        Claim(
            "IV, Table III",
            "The printed works.",
            Verdict.NOT_REPRODUCIBLE,
            "The deflections behind them are not printed. With predicted ones the printed values "
            f"are {table.ratio.min():.1f} to {table.ratio.max():.1f} times ours, {typical:.1f} "
            f"times in the geometric mean; {beyond} of {count} exceed what a force of that size "
            "can do in any direction. The difference of the two columns has our sign in "
            f"{same_sign} of {count} rows.",
        ),
        Claim(
            "IV, Table III",
            "The works are in joule.",
            Verdict.WRONG,
            f"They are N·mm: read as joule they would be {1e3 * typical:.0f} times ours.",
        ),
        Claim(
            "IV, Table III",
            f"Pose {table.printed.pose[row]}, row {row % LOADINGS + 1}: "
            f"Fy = {table.printed.force[row, 1]:g} N, Fz = {table.printed.force[row, 2]:g} N.",
            reproduced_if(not table.repeated),
            f"Repeated from row {after % LOADINGS + 1}. Its work over the square of the force is "
            f"{1e6 * table.work_per_force_squared[row]:.1f} µJ/N², in the other rows of the pose "
            f"{1e6 * usual.min():.1f} to {1e6 * usual.max():.1f}.",
        ),
    ]


def _curves(found: Findings) -> list[Claim]:
    soft = found.posture.softest
    figures = found.posture.softest_of_figures
    low, high = found.posture.force_share
    return [
        Claim(
            "IV, Figs. 4–6",
            "Force-deflection curves at three configurations.",
            Verdict.NOT_REPRODUCIBLE,
            "Points and forces are drawn, not printed. The models' lines are drawn here for 0 to "
            "50 kg along each axis, with the paper's springs and those identified from Table II.",
        ),
        Claim(
            "IV, Figs. 4–6",
            "The Cartesian stiffness changes significantly between configurations.",
            reproduced_if(float(soft[-1] / soft[0]) > 1.5),
            "The softest direction has "
            + ", ".join(f"{value / 1e6:.2f}" for value in figures.values())
            + f" N/µm in Figs. 4 to 6, and {soft[0] / 1e6:.2f} to {soft[-1] / 1e6:.2f} N/µm over "
            "the motion range.",
        ),
        Claim(
            "IV, B",
            "Deadweights of 10 to 50 kg in steps of 10 kg.",
            Verdict.NOT_REPRODUCIBLE,
            f"The printed forces of Tables II and III are {low:.2f} to {high:.2f} times those "
            "weights; pulley friction and the sensor's own zero are not given.",
        ),
    ]


def _um(values: dict[str, float], digits: int = 2) -> str:
    return " / ".join(f"{1e6 * value:.{digits}f}" for value in values.values())
