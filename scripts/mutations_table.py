"""Faults for `scripts/mutations.py`: what a slip of the hand could make of one line."""

# ruff: noqa: E501

from __future__ import annotations

from scripts.mutations_fault import Fault, of, tests
from scripts.mutations_loads import OF_LOADS
from scripts.mutations_positions import OF_POSITIONS

STIFFNESS = tests("stiffness", "complementary", "cartesian", "critical", "principal", "energy")
FIT = tests("identify", "fit", "uncertainty", "lack_of_fit", "noise")

FAULTS: tuple[Fault, ...] = (
    *OF_POSITIONS,
    *OF_LOADS,
    *of(
        "robot/kinematics/chain.py", "tests/robot/test_kinematics.py", "tests/model",
        a_mass_where_its_joint_would_be_at_rest=("position + own @ rotation if own.any() else position", "position + own[:, None] if own.any() else position"),
    ),
    *of(
        "explain/select/outliers.py", *tests("explain", "outliers"),
        what_came_twice_slipped=("unit[borne_out] = 0.0", "unit[borne_out] *= 1.0"),
        a_second_outlier_beside_the_first_shift=("left[each.readings] -= (each", "left[each.readings] -= 0.0 * (each"),
        a_shift_that_takes_nothing_of_the_readings=("residual = residual - new.T @ (new @ y)", "residual = residual + 0.0"),
        a_shift_counted_with_what_the_fit_has=("free = -(self.first.T @ near)", "free = (self.first.T @ near)"),
        slips_that_count_again=("> NEXT * scale", "> 99 * NEXT * scale"),
    ),
    *of(
        "explain/select/stepwise.py", *tests("explain", "outliers"),
        nothing_stands_apart_of_a_model=("    if not len(outliers):\n        outliers =", "    if False:\n        outliers ="),
        outliers_of_flanks_for_ever=("while len(still :=", "while 99 + 0 * len(still :="),
    ),
    *of(
        "measurements/table/branches.py", *tests("measurements/table", "branches"),
        a_foot_that_belongs_to_the_fall=("starts.append(row - 1 if again else row)", "starts.append(row)"),
    ),
    *of(
        "effects/gear/friction.py", *tests("effects", "curves"),
        a_cycle_that_left_nothing=("-reach * way[k], held)", "0.0 * way[k], held)"),
        a_cycle_the_other_way=("-reach * way[k], held)", "reach * way[k], held)"),
    ),
    *of(
        "effects/gear/hardening.py", *tests("effects", "laws"),
        softer_the_other_way=("np.minimum(torque, 0.0)[..., None]", "np.maximum(torque, 0.0)[..., None]"),
    ),
    *of(
        "data_checks/stuck.py", *tests("data_checks", "stuck"),
        a_coarse_gauge_is_stuck=("usual = max(float(beside), by_chance,", "usual = max(0.0, 0.0,"),
        one_end_of_a_range_alone=("np.abs(np.abs(values) - end)", "np.abs(values - end)"),
    ),
    *of(
        "workspace/compensate.py", *tests("workspace", "compensate"),
        weight_that_turns_no_gear=("point=point, absolute=True)", "point=point)"),
    ),
    *of(
        "explain/judge/selection_uncertainty.py", *tests("explain", "selection_uncertainty"),
        more_terms_that_nothing_asks_for=("other.score > now.score + REFUTED", "other.score > np.inf"),
    ),
    *of(
        "explain/candidates/linearised.py", *tests("explain", "linearised"),
        sensitivities_of_other_readings=("self.measurements is not fit.problem.measurements or ", ""),
    ),
    *of(
        "explain/candidates/sums.py", *tests("explain", "regression"),
        sums_of_a_pose_under_another_name=("np.tensordot(weights[labels], each", "np.tensordot(weights[labels[::-1]], each"),
    ),
    *of(
        "stiffness/cartesian.py", *STIFFNESS,
        sign_of_K_C_of_a_force=("cross_product(force, w), screws.linear", "cross_product(w, force), screws.linear"),
        sign_of_K_C_of_a_moment=("np.swapaxes(cross_product(moment, w)", "np.swapaxes(cross_product(w, moment)"),
        K_C_of_a_moment_not_transposed=("joints[:, None] > np.arange(w.shape[-2])", "joints[:, None] < np.arange(w.shape[-2])"),
        rows_of_K_C_below_the_diagonal_not_mirrored=("below = far[..., rows, :] @ np.swapaxes(near, -1, -2)", "below = near[..., rows, :] @ np.swapaxes(far, -1, -2)"),
        K_C_without_the_curvature_of_a_loop=("bent = screws.second.contracted(screws.joint", "bent = -screws.second.contracted(screws.joint"),
        symmetric_part_not_halved=("return 0.5 * (matrix + np", "return 1.0 * (matrix + np"),
    ),
    *of(
        "stiffness/cartesian.py", *tests("model", "model"), *tests("effects", "contract"),
        coordinates_in_a_wrong_order=("row = there.argmax(axis=0)", "row = there.argmax(axis=1)"),
    ),
    *of(
        "stiffness/cartesian.py", *STIFFNESS,
        K_X_without_a_transpose=("K_X = np.swapaxes(inverse, -1, -2) @ joint_stiffness", "K_X = inverse @ joint_stiffness"),
        K_X_at_singular_poses=("smallest > 1e-12 *", "smallest >= 0.0 *"),
    ),
    *of(
        "stiffness/principal.py", *STIFFNESS,
        principal_directions_not_transposed=("directions = np.swapaxes(vectors[..., ::-1], -1, -2)", "directions = vectors[..., ::-1]"),
        softest_last=("np.nan, values[..., ::-1])", "np.nan, values)"),
        negative_stiffness_made_positive=("1.0 / np.where(rigid, 1.0, found.values)", "1.0 / np.abs(np.where(rigid, 1.0, found.values))"),
        semidefinite_taken_for_definite=("positive & zero | ~positive", "~positive"),
        indefinite_taken_for_negative=("[4, 3, 2, 1]", "[2, 3, 2, 1]"),
    ),
    *of(
        "stiffness/energy.py", *STIFFNESS,
        energy_without_a_half=("linear + 0.5 * quadratic(K_X", "linear + quadratic(K_X"),
        energy_with_K_C_added=("quadratic(K_theta - K_C, d_theta)", "quadratic(K_theta + K_C, d_theta)"),
    ),
    *of(
        "stiffness/equilibrium.py", *tests("stiffness", "equilibrium", "deflection", "weight"),
        Newton_with_the_wrong_sign_of_K_C=("feedback = compliance[own] @ _load", "feedback = -compliance[own] @ _load"),
        weight_without_its_stiffness=("feedback = feedback + sag[own] @ hanging", "feedback = feedback"),
        balance_never_lost=("good = good & _stable(inner) &", "good = good &"),
        equilibrium_that_need_not_settle=("good = good & (largest[..., 0] <= tolerance)", "good = good & (largest[..., 0] <= 1e9)"),
    ),
    *of(
        "robot/kinematics/screws.py", *tests("robot", "kinematics"), *STIFFNESS,
        twist_about_the_wrong_side=("cross_product(self.axes, self.position[..., None, :] - self.origins)", "cross_product(self.position[..., None, :] - self.origins, self.axes)"),
    ),
    *of(
        "measurements/noise/law.py", *tests("measurements/noise", "noise", "repeats"),
        zero_reading_without_noise=("own, zero / measurements.zero_count", "own, 0.0 * zero / measurements.zero_count"),
        zero_readings_not_averaged=("own, zero / measurements.zero_count", "own, zero / measurements.zero_count ** 0"),
        growth_not_squared=("own + (self.growth * _sizes(measurements, sizes)) ** 2",
                            "own + self.growth * _sizes(measurements, sizes)"),
        separate_zeros_shared=('if self.zero == "separate":\n            own',
                               'if self.zero == "never":\n            own'),
        weights_upside_down=("own = own / weights[:, None]", "own = own * weights[:, None]"),
    ),
    *of(
        "measurements/noise/line_of_sight.py", *tests("measurements/noise", "line_of_sight"),
        across_counted_once=("0.5 * (variances[whole].sum(axis=1) - size**2)", "variances[whole].sum(axis=1) - size**2"),
        rays_of_any_law=("if off[0] > min(OFF, TELLS * varies):", "if off[0] > 10.0:"),
        rays_that_may_be_others=("apart > SAME_RAY:", "apart > 9.0:"),
        distance_not_squared=("np.repeat(distance**2, 3)", "np.repeat(distance, 3)"),
    ),
    *of(
        "measurements/noise/whitening.py", *tests("measurements/noise", "noise"), *FIT,
        shared_zero_counted_too_little=("gain = c / (1.0 + c *", "gain = c / (2.0 + c *"),
        variance_without_the_shared_part=("variance = own[rows] + gain", "variance = own[rows]"),
        whitening_with_the_wrong_sign=("block = block - gain", "block = block + gain"),
    ),
    *of(
        "stiffness/equilibrium.py", *tests("model", "model"), *tests("effects", "contract"),
        adjoint_not_transposed=("np.linalg.solve(np.swapaxes(newton, -1, -2), right)", "np.linalg.solve(newton, right)"),
    ),
    *of(
        "model/sensitivities.py", *tests("model", "model"), *tests("effects", "contract"),
        sensitivity_of_geometry_without_the_unloaded_arm=("-= adjoint_0[:, :, index] @ shifted", "-= 0.0 * adjoint_0[:, :, index] @ shifted"),
        reading_axes_the_wrong_way=("axes = np.swapaxes(solution.load_cases.reading_axes, -1, -2)", "axes = solution.load_cases.reading_axes"),
        load_errors_without_compliance=("per_wrench = adjoint @ rest.compliance @", "per_wrench = adjoint @"),
        standing_without_its_weight=("torques = hung", "torques = rest.torques"),
    ),
    *of(
        "model/assembly.py", *tests("model", "model"), *tests("effects", "contract"),
        tangent_of_a_nonlinear_law_forgotten=("+= found.by_torque", "+= 0.0 * found.by_torque"),
        every_pose_begins_as_the_first=("np.cumsum(fresh) - 1", "0 * np.cumsum(fresh)"),
    ),
    *of(
        "effects/closure.py", *tests("effects", "laws", "contract", "recovery"),
        coupling_one_way_only=("[[[0.0, 1.0], [1.0, 0.0]]]", "[[[0.0, 1.0], [0.0, 0.0]]]"),
        rod_softer_when_unfolded=("1.0 / np.maximum(lever, folded)", "np.maximum(lever, folded)"),
    ),
    *of(
        "effects/force_sensor.py", *tests("effects", "laws", "contract", "recovery"),
        force_bias_with_the_wrong_sign=("np.broadcast_to(-np.eye(6)[:, :3]", "np.broadcast_to(np.eye(6)[:, :3]"),
    ),
    *of(
        "identify/fit.py", *FIT,
        intervals_not_scaled_by_the_noise=("covariance * self.unit**2 +", "covariance +"),
        degrees_of_freedom_off_by_one=("return len(self.residual) - self.estimated", "return len(self.residual) - self.estimated - 1"),
        noise_not_divided_by_its_freedom=("np.sqrt(square / max(freedom, 1))", "np.sqrt(square / max(len(self.residual), 1))"),
        pure_error_not_taken_off=("max(square - repeats, 0.0) / (freedom - repeats)", "max(square, 0.0) / (freedom - repeats)"),
        likelihood_without_its_determinant=("self.problem.whitener.logdet + count", "count"),
        AIC_without_its_two=("return 2.0 * self._counted - 2.0 *", "return self._counted - 2.0 *"),
        noise_not_counted_as_a_parameter=("(0 if self.sigma_known else 1)", "0"),
    ),
    *of(
        "identify/solve/covariance.py", *FIT,
        covariance_of_single_singular_values=("(V / singular**2) @ V.T", "(V / singular) @ V.T"),
        covariance_without_its_scale=("block = block * np.outer(over, over)", "block = block * over"),
        unseen_parameters_get_a_number=("block[lost, lost] = np.inf", "block[lost, lost] *= 1.0"),
    ),
    *of(
        "identify/checks/lack_of_fit.py", *FIT,
        pure_error_in_the_wrong_place=("/ taken / (square / freedom)", "/ freedom / (square / taken)"),
    ),
    *of(
        "identify/checks/held_out.py", *tests("identify", "held_out", "comparison"),
        folds_that_leak=("learn(used.select(~rows))", "learn(used)"),
        last_fold_never_scored=("for k in range(count):\n        rows = part == k", "for k in range(count - 1):\n        rows = part == k"),
        postures_torn_apart=("np.random.default_rng(seed))[posture]",
                             "np.random.default_rng(seed))[posture * 0 + np.arange(len(posture)) % number]"),
    ),
    *of(
        "identify/robust.py", *tests("identify", "robust"),
        reading_trusted_to_judge_itself=("information = sums[0][group] - trust", "information = sums[0][group]"),
    ),
    *of(
        "identify/uncertainty/variance_components.py", *tests("identify", "variance_components"),
        REML_without_the_information=(
            "return logdet + information + self._of_noise(self._likeliest(square), square)",
            "return logdet + self._of_noise(self._likeliest(square), square)"),
        REML_without_its_log_determinant=(
            "return logdet + information + self._of_noise(self._likeliest(square), square)",
            "return information + self._of_noise(self._likeliest(square), square)"),
        REML_log_determinant_halved=("logdet = 2.0 * np.log(", "logdet = np.log("),
        REML_freedom_of_plain_likelihood=("self.rows - len(self.xx) + 1, 1)", "self.rows, 1)"),
    ),
    *of(
        "explain/localise/places.py", *tests("explain", "localise"),
        Holm_dropped=("corrected = holm([suspicion.probability for suspicion, _ in found])",
                      "corrected = [suspicion.probability for suspicion, _ in found]"),
    ),
    *of(
        "explain/judge/attribution.py", *tests("explain", "judging"),
        said_to_have_fallen_beside_its_set=("if each.id in told:", "if False:"),
    ),
    *of(
        "explain/judge/adequacy.py", *tests("explain", "evidence"),
        adequacy_without_Bonferroni=("min(1.0, len(tests) * min(", "min(1.0, min("),
        named_effects_explain_what_the_base_does=("signature - base @ (base.T @ signature)", "signature"),
    ),
    *of(
        "explain/judge/adequacy.py", *tests("explain", "noise"),
        noise_of_readings_told_by_their_scatter_alone=("found.inflation_gain > found.gain + LIKELIER", "False"),
        one_reading_a_pose_is_noise=("    if scatter(fit) is not None:\n        return True", "    return True"),
    ),
    *of(
        "explain/localise/changes.py", *tests("explain", "changes"),
        a_change_before_its_pose=("(clock >= first[order[k]])", "(clock < first[order[k]])"),
        a_pose_in_both_parts=("if ended[k - 1] < first[order[k]]", "if ended[k - 1] < np.inf"),
        rows_that_stand_in_any_order=("since if zero is None else since + zero, dtype", "np.arange(load_cases.count), dtype"),
    ),
    *of(
        "identify/solve/problem.py", *tests("identify", "unseen"),
        a_spring_that_does_not_show_is_measured=("plausible < 1.0:", "plausible < 0.0:"),
    ),
    *of(
        "explain/judge/confirm.py", *tests("explain", "evidence"),
        confirmation_folds_that_leak=("weigh((fold != k).astype(float))", "weigh(np.ones(regression.poses))"),
        last_confirmation_fold_never_scored=(
            "for k in range(int(fold.max(initial=0)) + 1):\n        train",
            "for k in range(int(fold.max(initial=0))):\n        train"),
        resampling_without_replacement=("rng.integers(0, poses, poses)", "rng.permutation(poses)"),
        rivals_never_counted=("rival_frequency=max(others.values(), default=0.0)", "rival_frequency=0.0"),
        what_beats_it_takes_its_place=("if both.plausible and fair[best] - both.score > WANTED", "if False"),
    ),
    *of(
        "explain/candidates/regression.py", *tests("explain", "regression"),
        candidates_judged_as_one=("self.alpha / max(len(self.candidates), 1), 1)", "self.alpha, 1)"),
    ),
    *of(
        "explain/select/score.py", *tests("explain", "regression"),
        looking_for_nothing=("score += price_of_looking(regression, n) *", "score += 0.0 *"),
    ),
    *of(
        "explain/select/promises.py", *tests("explain", "promises"),
        hopes_without_what_they_gain=("- self._best(self._worth) - more", "- more"),
        hopes_by_the_misfit_alone=("self._best(self._worth) - more)", "self._best(self._worth))"),
    ),
    *of(
        "explain/select/size_prices.py", *tests("explain", "regression", "size_prices"),
        sizes_for_nothing=("np.asarray(prices.sum(axis=1))", "np.asarray(0.0 * prices.sum(axis=1))"),
        rigid_axes_for_nothing=("+ 2.0 * math.log(math.comb(len(places), held + 1))", "+ 0.0"),
        held_alone=("        self._values -= along * self._values[place]\n", ""),
        spared_twice=("            self.hold(place)\n", ""),
    ),
    *of(
        "explain/judge/imitation.py", *tests("explain", "imitation", "lineup"),
        name_and_suspect_need_no_more_than_one_suspect=("max(beside, better - BETTER)", "max(beside, better)"),
        impostors_never_compared=("needed = 0.0 if certain and 0 in kept else BETTER", "needed = 1e9"),
        what_does_nothing_anyway_falls=("if alone[e] > line.price(e)]", "if True]"),
        draws_for_nothing=("np.linalg.slogdet(np.eye(len(own)) + told)[1]", "0.0"),
        spread_in_units_assumed=("likeliest[1] * sums.noise_factor(*likeliest)", "likeliest[1]"),
        spread_for_nothing=("return spread, least(0.0)[0] - value", "return spread, least(0.0)[0]"),
    ),
    *of(
        "explain/judge/posterior.py", *tests("explain", "evidence"),
        evidence_counted_twice=("np.exp(-0.5 * (values", "np.exp(-1.0 * (values"),
        none_never_likely=("weights / weights.sum()", "weights / weights[1:].sum()"),
        names_listed_until_most_of_what_names_have=("else min(NAMED, whole - LISTED)", "else NAMED * whole"),
    ),
    *of(
        "explain/localise/suspect.py", *tests("explain", "localise"),
        a_wave_among_many_for_nothing=("return 2.0 * float(np.log(self.alike))", "return 0.0"),
    ),
    *of(
        "model/uncertainty.py", *tests("model", "uncertainty", "loaded_uncertainty"),
        unseen_taken_for_known=("lost = hidden > HIDDEN * (", "lost = hidden > 1e99 * ("),
        unseen_that_is_small_left_out=("np.sqrt(known + hidden)", "np.sqrt(known)"),
        remainder_of_small_loads_too_large=("goes = size if self.grows", "goes = size**0 if self.grows"),
        remainder_whole_where_noise_may_be_all=("np.sqrt(self.share) * self.upper", "self.upper"),
        remainder_nothing_where_noise_may_be_all=("1.0 / (1.0 - np.e * p * np.log(p))", "p < 0.05"),
        moment_by_a_wrong_lever=("(moment**2).sum(axis=-1) / length**2", "(moment**2).sum(axis=-1) * length**2"),
        Student_taken_for_normal=("stats.t.ppf(upper, self.freedom)", "stats.norm.ppf(upper)"),
        interval_with_one_end=("upper = 0.5 * (1.0 + level)", "upper = level"),
    ),
    *of(
        "explain/select/outliers.py", *tests("explain", "outliers"),
        slips_hide_each_other=("last = max((k for k, far in enumerate(out, start=1) if far > ALONE), default=0)", "last = next((k for k, s in enumerate(states) if s.next <= ALONE), 0)"),
        crowd_that_does_not_stand_apart=("if last < len(states) and states[last].next <= LIMIT:", "if last < len(states):"),
    ),
    *of(
        "explain/judge/beside_suspect.py", *tests("explain", "beside_suspect"),
        only_what_leaves_noise_alone_is_an_account=("if each.total < without.total - WORTH]", "if each.total < -1e9]"),
    ),
    *of(
        "explain/judge/nuisance.py", *tests("explain", "nuisance"),
        suspects_alike=("return self is other", "return type(self) is type(other)"),
        other_columns_in_a_part=("if load_cases is not self.fitted:", "if False:"),
    ),
    *of(
        "data_checks/sheet.py", *tests("data_checks", "false_alarms"),
        every_load_is_evidence_of_its_own=("groups, group = connected_components(links, directed=False)", "groups, group = len(load), np.arange(len(load))"),
    ),
    *of(
        "data_checks/single_rows.py", *tests("data_checks", "single_rows"),
        slip_that_mends_one_axis_alone=("    if not len(off) or off.max() >= limit:\n", "    if len(off) and off.min() < limit:\n        return True\n    if not len(off) or off.max() >= limit:\n"),
        slip_that_leaves_all_axes_far_off=("TOGETHER * limit", "limit"),
        exchange_that_fits_one_way=("if all(_fits(read[a], told[b], limit)", "if any(_fits(read[a], told[b], limit)"),
    ),
    *of(
        "identify/solve/prior.py", *tests("identify", "type_b"),
        calibration_in_noise_assumed=("known = self.unit if np.isfinite(self.unit) else 0.0", "known = 1.0"),
        calibration_beside_noise_assumed=("[singular / unit, ", "[singular, "),
        calibration_of_what_was_not_read=("np.flatnonzero(~held & shows)", "np.flatnonzero(~held)"),
        calibration_of_one_axis=("told = (sizes > counts)", "told = (sizes > 1e9)"),
        instruments_away_from_their_calibration=("-self.span * (self.ways @ (self.slope @ x / self.sizes))", "0.0 * self.span"),
        moves_along_what_is_open=("over - self.ways @ (self.steps @ over)", "over"),
    ),
    *of(
        "identify/solve/beforehand.py", *tests("identify", "draws"),
        offsets_that_are_no_draws=("size[group] = own if own > 0.0 else np.inf", "size[group] = np.inf"),
        draws_shrunk_where_they_were_read=("CHANCE = 1.0", "CHANCE = 0.01"),
    ),
    *of(
        "explain/judge/foreign_cause.py", *tests("explain", "foreign_cause"),
        a_cause_that_undoes_calibrations=("np.vstack([J, fit.beforehand.rows()[:, moving] / unit])", "J"),
    ),
    *of(
        "explain/judge/judged_names.py", *tests("explain", "offsets_of_poses"),
        offsets_behind_a_statement=("if not drawn or not form.constant:", "if True:"),
    ),
    *of(
        "explain/findings.py", *tests("explain", "evidence"),
        gains_never_by_chance=("special.erfc(self.gain / max", "special.erfc(99.0 + self.gain / max"),
    ),
    *of(
        "explain/judge/judged_names.py", *tests("explain", "rough"),
        scatter_taken_for_a_cause=("variance_components(base).probability > BY_CHANCE", "variance_components(base).probability > -1.0"),
    ),
    *of(
        "explain/judge/posterior.py", *tests("explain", "rough"),
        names_sure_of_no_witness=("found if noise_known else found.doubted(chance)", "found"),
    ),
    *of(
        "identify/solve/problem.py", *tests("identify", "null_space"),
        calibration_of_what_has_none=("p.spec.usual if p.effect.calibrated else np.inf", "p.spec.usual"),
    ),
    *of(
        "model/assembly.py", *tests("positions", "link_masses"), *tests("positions", "sensitivities"),
        masses_that_weigh_as_stated=("return 1.0 + float(values[self.weighing].sum())", "return 1.0"),
    ),
    *of(
        "model/sensitivities.py", *tests("positions", "link_masses"), *tests("positions", "sensitivities"),
        masses_that_show_twice=("adjoint @ (rest.weight.compliance @ stated", "2.0 * adjoint @ (rest.weight.compliance @ stated"),
        masses_that_hang_on_a_gears_curve=("adjoint @ (rest.weight.compliance @ stated", "adjoint @ (rest.compliance @ stated"),
    ),
    *of(
        "measurements/placing/slips.py", *tests("measurements/placing", "conventions"),
        joints_mended_one_by_one=("ranked[:KEPT]", "ranked[:1]"),
        joints_beyond_their_limits=("return beyond, int(", "return 0, int("),
    ),
    *of(
        "measurements/importers/tracker/several_markers.py", *tests("measurements/importers/tracker", "several_markers"),
        markers_read_as_one=("if column is not None and len(names) > 1:", "if False:"),
        points_apart_unseen=("if far and len(far) > MOST * len(pairs):", "if False:"),
    ),
    *of(
        "plan/design.py", *tests("plan", "design"),
        displacement_as_sure_as_one_reading=("noise = sigma * DISPLACEMENT", "noise = sigma"),
        other_parameters_held_for_known=("0.5 * (whole - rest)", "0.5 * whole"),
        readings_taken_already_forgotten=("before += information(model, known, span).sum(axis=0)", "before += 0.0 * information(model, known, span).sum(axis=0)"),
        choice_never_exchanged=("if value > reached + BETTER:", "if False:"),
        single_loads_exchanged_alone=("kept = [row for row in rows if owner[row] != own]", "kept = rows[1:]"),
    ),
    *of(
        "plan/discriminate.py", *tests("plan", "design"),
        rival_imitates_nothing=("information[..., -1, -1] - (border * solved).sum(-1)", "information[..., -1, -1]"),
        signature_known_beforehand=("ridge[-1, -1] = 0.0", "ridge[-1, -1] = 1.0"),
        the_easier_effect_to_tell=("_evidence(both).min(axis=-1)", "_evidence(both).max(axis=-1)"),
    ),
    *of(
        "workspace/compensate.py", *tests("workspace", "compensate"),
        correction_doubles_the_error=("error = -now.away[active]", "error = now.away[active]"),
        orientation_turned_the_wrong_way=("[error, -now.turned[active]]", "[error, now.turned[active]]"),
        correction_beyond_a_limit=("upper = np.maximum(robot.upper, given)", "upper = given + 9.0"),
        correction_where_none_is_allowed=("used = np.where(free[:, None, :], J, 0.0)", "used = J"),
    ),
    *of(
        "workspace/standing_uncertainty.py", *tests("workspace", "standing_uncertainty"),
        distance_of_one_axis_alone=("std[rows] = np.linalg.norm(axes, axis=1)", "std[rows] = axes[:, 0]"),
        budget_without_what_is_unseen=("covariance[unknown, unknown] = np.inf", "covariance[unknown, unknown] *= 1.0"),
    ),
)  # fmt: skip
