"""Every claim of the paper as text: where it stands, what it says, what decides, and the evidence.

A claim begins with its place in square brackets. The line with ``=`` names what decides: a verdict,
or something of `claims.decided` that makes it reproduced, and the verdict where that does not hold.
Braces hold fields of `Findings` and of `claims.numbers`, in the units of `claims.Words`.
"""

CLAIMS = """
[II] The five-bar is a parallelogram: the crank turns with the forearm, the rod stays parallel to
the upper arm.
= closed, else wrong
The loop of crank, rod and forearm stays closed to {formulation.loop_error!s} m over the whole
motion range.

[III, eq. (10)] The stiffness of a loaded arm is J⁻ᵀ (K_θ − K_C) J⁻¹.
= enhanced, else wrong
The slope of the exact deflection under {formulation.load!k:.0f} kN agrees with it to
{formulation.enhanced_error!s}, taken at the loaded pose.

[III, eq. (8)] Without K_C the formula holds only for an unloaded arm or a constant Jacobian.
= conventional, else wrong
Under {formulation.load!k:.0f} kN it misses by {formulation.conventional_error!c:.1f} %, without a
load by nothing. At the loads of Table II K_C changes the deflection by {most_of_K_C!u:.2f} µm rms
or less.

[IV, B] At every configuration the tool was perpendicular to the ground.
= down, else wrong
All printed configurations have it straight down to {tool_deg:.4f}°.

[IV, B] K_θ = diag(1.4098, 0.40076, 0.93528)·10⁹ N·mm/rad.
= not reproducible
{configurations} configurations were measured, {poses} are printed. From these come {springs} ·10⁶
N·m/rad, {off} from the paper's.

[IV, A] Interior-reflective Newton and Levenberg–Marquardt reach the same values; so do different
starts.
= one_minimum, else wrong
{attempts} runs of both, from {starts[0]:.0e} to {starts[1]:.0e} N·mm/rad, agree to
{identified.spread:.0e}.

[IV, B] The joint stiffness is constant and does not change with the configuration.
= constant, else not reproducible
The printed poses do not show it. Fitted to one pose at a time, the spring of joint 1 comes out as
{by_pose} ·10⁶ N·m/rad. If they were the same everywhere, poses would differ so much with a
probability of {identified.probability:.1g} (F = {identified.F:.1f}): something the three springs do
not describe depends on the pose.

[IV, B] Residual norm {residual_norm} by eq. (12).
= not reproducible
Its data are not printed, nor its unit. In mm² over all readings it would mean {per_axis:.0f} µm rms
per axis; the three printed poses have {squares:.4f} mm², {gap!u:.0f} µm rms.

[IV, Table II] Deflections calculated from the identified springs.
= calculated, else wrong
To {calculated!u:.2f} µm rms by eq. (11) and {exact!u:.2f} at exact equilibrium, poses 1 to 3. Two
things had to be found out: columns printed with the opposite sign ({signs}) and the load at the
flange with the wrist straight, no fixture.

[IV, Table II] The load acts on the fixture at the printed wrist angles.
= on_fixture, else not reproducible
The calculated column does not come from the printed configuration: {variants}. Straight and at the
flange: {table2.variants[0].calculated_rms_um:.2f} and {table2.variants[0].measured_rms_um:.0f} µm.

[IV, Table II] The difference of calculated and measured deflections is negligibly small.
= negligible, else wrong
It is {measured!u:.1f} µm rms in poses 1 to 3, {share!c:.0f} % of the deflections and
{resolutions:.0f} times the tracker's resolution. Springs identified from these rows leave
{identified.fit.rms!u:.1f} µm: the rest is not joint springs.

[IV, Table II] To tell the two formulations apart by deflections takes a far better tracker.
= unresolved, else wrong
K_C changes the calculated column by {table2.effect_of_K_C!u:.2f} µm rms, below the resolution of
{resolution!u:.2f} µm; the measured one is missed by {without!u:.2f} µm without and
{with_K_C!u:.2f} µm with it.

[IV, Table III] With K_C the works in Cartesian and joint space are precisely equal.
= equal_works, else wrong
To {table3.identity_error:.0e}. But that is algebra, not evidence: J turns one formula into the
other for any displacement at all; random ones fit as well as measured ones.

[IV, C] The conventional formulation violates the conservation of energy.
= violates, else wrong
When a force of {formulation.load!k:.0f} kN goes round a full circle and the arm follows by
increments, eq. (8) leaves over up to {formulation.conventional_cycle!c:.1f} % of the stored energy,
eq. (10) {formulation.enhanced_cycle:.0e} of it.

[IV, Table III] The unequal works of Table III show that violation.
= wrong
The table sets the enhanced K_X against the conventional joint stiffness. Their works differ by
½ Δθᵀ K_C Δθ by construction, whatever was displaced ({works[0]!u:.1f} to {works[1]!u:.0f} µJ for
predicted displacements); each formulation agrees with itself, as the paper notes. The true balance,
∫ F·dX along the loading path = energy in the springs, holds to {table3.balance_error:.0e} for these
springs, and no K_X enters it.

[IV, eqs. (14), (15)] The work of a load is Fᵀ ΔX + ½ ΔXᵀ K_X ΔX.
= wrong
That is the energy of a further displacement under a load that is already there. A load that grows
from zero does half of F·ΔX: eq. (14) gives {overcount[0]:.3f} to {overcount[1]:.3f} times the work
done. In eq. (15) ΔX is misprinted for Δθ.

[IV, Table III] The printed works.
= not reproducible
The deflections behind them are not printed. With predicted ones the printed values are
{ratio[0]:.1f} to {ratio[1]:.1f} times ours, {typical:.1f} times in the geometric mean; {beyond} of
{rows} exceed what a force of that size can do in any direction. The difference of the two columns
has our sign in {same_sign} of {rows} rows.

[IV, Table III] The works are in joule.
= wrong
They are N·mm: read as joule they would be {typical!m:.0f} times ours.

[IV, Table III] Pose {pose}, row {row}: Fy = {F[1]:g} N, Fz = {F[2]:g} N.
= no_repeat, else wrong
Repeated from row {after}. Its work over the square of the force is {own_work!u:.1f} µJ/N², in the
other rows of the pose {usual[0]!u:.1f} to {usual[1]!u:.1f}.

[IV, Figs. 4–6] Force-deflection curves at three configurations.
= not reproducible
Points and forces are drawn, not printed. The models' lines are drawn here for 0 to 50 kg along each
axis, with the paper's springs and those identified from Table II.

[IV, Figs. 4–6] The Cartesian stiffness changes significantly between configurations.
= changes, else wrong
The softest direction has {softest} N/µm in Figs. 4 to 6, and
{posture.softest[0]!M:.2f} to {posture.softest[4]!M:.2f} N/µm over the motion range.

[IV, B] Deadweights of 10 to 50 kg in steps of 10 kg.
= not reproducible
The printed forces of Tables II and III are {posture.force_share[0]:.2f} to
{posture.force_share[1]:.2f} times those weights; pulley friction and the sensor's own zero are not
given.

[V] K_C is symmetric and an exact differential: a conservative matrix.
= conservative, else wrong
For forces: asymmetry {formulation.force_asymmetry!s}, exact differential to
{formulation.third_derivatives!s}. A moment about fixed axes, which the paper leaves out, has no
potential: its K_C is not symmetric (‖K_C − K_Cᵀ‖ up to {formulation.moment_asymmetry:.2f} ‖K_C‖).

[V] Corollary 1: where K_C is ND or NSD, K_θ − K_C is PD.
= corollary, else wrong
No exception among {formulation.negative_cases} poses and loads, up to 10⁸ N.

[V] Conditions i to iii (leading minors) decide whether K_θ − K_C is PD.
= minors, else wrong
As printed they agree with the eigenvalues at every pose and load tried.

[VI, eq. (16)] C_ii is the sum over k of (∂J_k1/∂θ_k F_x + ...).
= wrong
The indices are misprinted: eq. (9) gives C_ii = Σ_k ∂J_ki/∂θ_i F_k, one part per force component.
Figs. 7 to 9 are drawn here by that formula.

[VI, Figs. 7–9] Parts of C11, C22 and C33 for unit forces over the motion range.
= not reproducible
Recomputed, and bounded by {parts[0]:.2f} (C11), {parts[1]:.2f} (C22), {parts[2]:.2f} (C33) N·m/rad
per N. The paper draws its values and prints none, so they cannot be compared digit by digit.

[VI, Table IV] Counts of PD, ND and indefinite K_C over the motion range.
= counts, else wrong
Cases {whole} come out exactly on a grid of {grid} poses{also} if "PD" counts det(K_C) > 0. Two
negative eigenvalues give that too: in case {worst} {true_PD} matrices are positive definite, not
{printed_PD}.

[VI, Table IV] The counts of opposite forces (cases 1/2, 3/6, 4/7, 5/8).
= opposites, else wrong
K_C is linear in the force, so PD(F) = ND(−F): {ours}the printed pairs {broken} do not. Even read as
signs of the determinant, the PD counts of cases {odd} do not add up to {grid}.

[VI] K_C is not always positive definite.
= indefinite, else wrong
It is indefinite at {least_indefinite} of {grid} configurations or more, in every case.

[VI] K_θ − K_C, and so K_X, is always PD for forces of {component:.0f} N per axis.
= positive, else wrong
At {positive} of {grid} configurations in every case; {load:.0f} N is {load_share!c:.2f} % of the
smallest critical force.

[VI] Forces as large as 10 kN are needed to make K_θ − K_C lose definiteness.
= ten_kN, else wrong
It takes {critical.smallest!k:.0f} kN at least, {times:.0f} times as much: joint 2's spring over the
length of the upper arm, pressed along itself, K2/L2 = {critical.column!k:.0f} kN. The median over
poses and directions is {median!k:.0f} kN, and for {critical.without!c:.0f} % no force is critical.
At 10 kN K_C takes up {critical.share!c:.1f} % of K_θ, and the flange would move
{critical.deflection!m:.0f} mm.

[VI] Definiteness goes when a diagonal element of K_C reaches that of K_θ.
= diagonal, else wrong
Sufficient, as corollary 2 says: no diagonal element gets there below {by_diagonal!k:.0f} kN. On
this arm it is also where definiteness goes first, because joints 2 and 3 turn absolute angles and
do not couple in K_C.

[Abstract] K_C does not influence the stability of the stiffness matrix.
= stable, else wrong
True for every force this arm can carry. From {critical.smallest!k:.0f} kN on, in the worst
direction, it decides stability.

[Abstract] New experimental results prove that the conventional formulation is incomplete.
= wrong
It is incomplete, but no measurement here shows it: in Table II K_C makes less than the tracker can
resolve, and Table III compares two formulas with each other, whatever was measured.

[Appendix I] The Jacobian, eq. (17), term by term.
= as_printed, else wrong
The sign of D4 in {slips} is misprinted: it contradicts J11, J13 and J23, and puts the element off
by up to {printed:.2f} m/rad. With it mended all nine elements agree with ours to {mended!s} m/rad
at random poses of all six joints. J11 and J21 also name different lengths, {harmless}; both are
zero in Table I.

[Appendix II] K_X has the definiteness of K_θ − K_C (congruence).
= congruent, else wrong
The classes agree in all {formulation.congruent_cases} poses and loads tried, away from singular
poses, where K_X does not exist.

[Appendix II, eq. (20)] f = (λ₁x₁² + λ₂x₂² + λ₁x₃²) − (...), the difference of two canonical forms.
= wrong
λ₁ stands where λ₃ belongs, twice; and the form decides only with x = P y, not for x and y on their
own.
"""
