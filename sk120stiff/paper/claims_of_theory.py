"""Claims about kinematics, stiffness matrices and their definiteness."""

from __future__ import annotations

import numpy as np

from sk120stiff.paper.findings import Findings
from sk120stiff.paper.printed import CLAIMED_CRITICAL_FORCE, COMPONENT
from sk120stiff.paper.verdict import Claim, Verdict, reproduced_if, small

ROUNDING = 1e-9


def claims_of_theory(found: Findings) -> list[Claim]:
    """Claims that need no measured data."""
    return [
        *_kinematics(found),
        *_stiffness(found),
        *_definiteness(found),
        *_critical(found),
    ]


def _kinematics(found: Findings) -> list[Claim]:
    appendix, posture = found.appendix, found.posture
    printed, mended = float(appendix.printed_error.max()), float(appendix.mended_error.max())
    slips = [slip for slip in appendix.slips if slip.length == "D4"]
    harmless = sorted(slip.length for slip in appendix.slips if slip.length != "D4")
    return [
        Claim(
            "II",
            "The five-bar is a parallelogram: the crank turns with the forearm, the rod stays "
            "parallel to the upper arm.",
            reproduced_if(found.formulation.loop_error < ROUNDING),
            "The loop of crank, rod and forearm stays closed to "
            f"{small(found.formulation.loop_error)} m over the whole motion range.",
        ),
        Claim(
            "Appendix I",
            "The Jacobian, eq. (17), term by term.",
            reproduced_if(printed < ROUNDING),
            f"The sign of D4 in {' and '.join(s.element for s in slips)} is misprinted: it "
            "contradicts J11, J13 and J23, and puts the element off by up to "
            f"{printed:.2f} m/rad. With it mended all nine elements agree with ours to "
            f"{small(mended)} m/rad at random poses of all six joints. J11 and J21 also name "
            f"different lengths, {' and '.join(harmless)}; both are zero in Table I.",
        ),
        Claim(
            "IV, B",
            "At every configuration the tool was perpendicular to the ground.",
            reproduced_if(posture.tool_error < np.radians(0.01)),
            f"All printed configurations have it straight down to "
            f"{np.degrees(posture.tool_error):.4f}°.",
        ),
    ]


def _stiffness(found: Findings) -> list[Claim]:
    form = found.formulation
    return [
        Claim(
            "III, eq. (10)",
            "The stiffness of a loaded arm is J⁻ᵀ (K_θ − K_C) J⁻¹.",
            reproduced_if(form.enhanced_error < 1e-6),
            f"The slope of the exact deflection under {form.load / 1e3:.0f} kN agrees with it to "
            f"{small(form.enhanced_error)}, taken at the loaded pose.",
        ),
        Claim(
            "III, eq. (8)",
            "Without K_C the formula holds only for an unloaded arm or a constant Jacobian.",
            reproduced_if(form.conventional_error > 1e-3 and form.unloaded_difference == 0.0),
            f"Under {form.load / 1e3:.0f} kN it misses by "
            f"{100 * form.conventional_error:.1f} %, without a load by nothing. At the loads of "
            f"Table II K_C changes the deflection by "
            f"{1e6 * max(found.table2.effect_of_K_C.values()):.2f} µm rms or less.",
        ),
        Claim(
            "V",
            "K_C is symmetric and an exact differential: a conservative matrix.",
            reproduced_if(form.force_asymmetry < ROUNDING and form.third_derivatives < 1e-6),
            f"For forces: asymmetry {small(form.force_asymmetry)}, exact differential to "
            f"{small(form.third_derivatives)}. A moment about fixed axes, which the paper leaves "
            "out, has no potential: its K_C is not symmetric "
            f"(‖K_C − K_Cᵀ‖ up to {form.moment_asymmetry:.2f} ‖K_C‖).",
        ),
        Claim(
            "VI, eq. (16)",
            "C_ii is the sum over k of (∂J_k1/∂θ_k F_x + ...).",
            Verdict.WRONG,
            "The indices are misprinted: eq. (9) gives C_ii = Σ_k ∂J_ki/∂θ_i F_k, one part per "
            "force component. Figs. 7 to 9 are drawn here by that formula.",
        ),
        Claim(
            "VI, Figs. 7–9",
            "Parts of C11, C22 and C33 for unit forces over the motion range.",
            Verdict.NOT_REPRODUCIBLE,
            "Recomputed, and bounded by "
            + ", ".join(
                f"{part:.2f} (C{k}{k})"
                for k, part in enumerate(
                    np.maximum(found.parts.highest, -found.parts.lowest).max(axis=1), start=1
                )
            )
            + " N·m/rad per N. The paper draws its values and prints none, so they cannot be "
            "compared digit by digit.",
        ),
    ]


def _definiteness(found: Findings) -> list[Claim]:
    form, table = found.formulation, found.table4
    size = COMPONENT * 3**0.5
    positive = int(table.difference_positive.min())
    every = table.configurations
    indefinite = int(table.counts[:, 4].min())
    sums = table.printed_determinant_sums
    odd = [f"{i} and {k} ({total})" for (i, k), total in sums.items() if total != every]
    mirrored = table.mirrored(table.printed)
    broken = [f"{i}/{k}" for (i, k), holds in mirrored.items() if not holds]
    ours = all(table.mirrored(table.counts).values())
    whole = " and ".join(str(case) for case in table.reproduced)
    part = [str(k) for k in table.reproduced_determinant if k not in table.reproduced]
    also = f" (in case {' and '.join(part)} the PD column alone)" if part else ""
    worst = int(np.argmax(table.printed[:, 0] - table.counts[:, 0]))
    return [
        Claim(
            "V",
            "Corollary 1: where K_C is ND or NSD, K_θ − K_C is PD.",
            reproduced_if(form.negative_failures == 0 and form.negative_cases > 0),
            f"No exception among {form.negative_cases} poses and loads, up to 10⁸ N.",
        ),
        Claim(
            "V",
            "Conditions i to iii (leading minors) decide whether K_θ − K_C is PD.",
            reproduced_if(form.minors_agree),
            "As printed they agree with the eigenvalues at every pose and load tried.",
        ),
        Claim(
            "VI, Table IV",
            "Counts of PD, ND and indefinite K_C over the motion range.",
            reproduced_if(bool((table.printed == table.counts).all())),
            f'Cases {whole} come out exactly on a grid of {every} poses{also} if "PD" counts '
            "det(K_C) > 0. Two negative eigenvalues give that too: in case "
            f"{worst + 1} {table.counts[worst, 0]} matrices are positive definite, not "
            f"{table.printed[worst, 0]}.",
        ),
        Claim(
            "VI, Table IV",
            "The counts of opposite forces (cases 1/2, 3/6, 4/7, 5/8).",
            reproduced_if(not broken and not odd),
            "K_C is linear in the force, so PD(F) = ND(−F): "
            + ("ours obey it, " if ours else "")
            + f"the printed pairs {', '.join(broken)} do not. Even read as signs of the "
            f"determinant, the PD counts of cases {', '.join(odd)} do not add up to {every}.",
        ),
        Claim(
            "VI",
            "K_C is not always positive definite.",
            reproduced_if(indefinite > 0),
            f"It is indefinite at {indefinite} of {every} configurations or more, in every case.",
        ),
        Claim(
            "VI",
            f"K_θ − K_C, and so K_X, is always PD for forces of {COMPONENT:.0f} N per axis.",
            reproduced_if(positive == every),
            f"At {positive} of {every} configurations in every case; {size:.0f} N is "
            f"{100 * size / found.critical.smallest:.2f} % of the smallest critical force.",
        ),
        Claim(
            "Appendix II",
            "K_X has the definiteness of K_θ − K_C (congruence).",
            reproduced_if(form.congruence_failures == 0 and form.congruent_cases > 0),
            f"The classes agree in all {form.congruent_cases} poses and loads tried, away from "
            "singular poses, where K_X does not exist.",
        ),
        Claim(
            "Appendix II, eq. (20)",
            "f = (λ₁x₁² + λ₂x₂² + λ₁x₃²) − (...), the difference of two canonical forms.",
            Verdict.WRONG,
            "λ₁ stands where λ₃ belongs, twice; and the form decides only with x = P y, not for x "
            "and y on their own.",
        ),
    ]


def _critical(found: Findings) -> list[Claim]:
    found_at = found.critical
    ratio = found_at.smallest / CLAIMED_CRITICAL_FORCE
    by_diagonal = float(found_at.by_diagonal.min())
    return [
        Claim(
            "VI",
            "Forces as large as 10 kN are needed to make K_θ − K_C lose definiteness.",
            reproduced_if(0.3 < ratio < 3.0),
            f"It takes {found_at.smallest / 1e3:.0f} kN at least, {ratio:.0f} times as much: joint "
            "2's spring over the length of the upper arm, pressed along itself, "
            f"K2/L2 = {found_at.column / 1e3:.0f} kN. The median over poses and directions is "
            f"{found_at.quantiles[0.5] / 1e3:.0f} kN, and for {100 * found_at.without:.0f} % no "
            f"force is critical. At 10 kN K_C takes up {100 * found_at.share:.1f} % of K_θ, and "
            f"the flange would move {1e3 * found_at.deflection:.0f} mm.",
        ),
        Claim(
            "VI",
            "Definiteness goes when a diagonal element of K_C reaches that of K_θ.",
            reproduced_if(by_diagonal >= found_at.smallest * (1 - 1e-9)),
            f"Sufficient, as corollary 2 says: no diagonal element gets there below "
            f"{by_diagonal / 1e3:.0f} kN. On this arm it is also where definiteness goes first, "
            "because joints 2 and 3 turn absolute angles and do not couple in K_C.",
        ),
        Claim(
            "Abstract",
            "K_C does not influence the stability of the stiffness matrix.",
            reproduced_if(found_at.smallest > 10 * CLAIMED_CRITICAL_FORCE),
            f"True for every force this arm can carry. From "
            f"{found_at.smallest / 1e3:.0f} kN on, in the worst direction, it decides stability.",
        ),
    ]
