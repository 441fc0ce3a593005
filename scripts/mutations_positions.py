"""Faults in what is made of positions: placing, calibration, names."""

# ruff: noqa: E501

from __future__ import annotations

from scripts.mutations_fault import Fault, of, tests
from scripts.mutations_sets import OF_SETS

POSITIONS = tests("positions/explain", "linear", "choose", "names")

OF_POSITIONS: tuple[Fault, ...] = (
    *OF_SETS,
    *of(
        "identify/positions/checks/force_axes.py", *tests("positions/checks", "force_axes"),
        forces_never_negated=("for sign in (1.0, -1.0)", "for sign in (1.0,)"),
        forces_that_turn_the_other_way=('("z", angle, degrees=True).as_matrix()', '("z", -angle, degrees=True).as_matrix()'),
        other_axes_as_good_as_any=("AS_GOOD * least", "np.inf * least"),
    ),
    *of(
        "identify/positions/checks/force_axes.py", *tests("positions", "gauges"),
        columns_exchanged_the_other_way=("sensor @ columns @ sensor.T", "sensor @ columns.T @ sensor.T"),
    ),
    *of(
        "measurements/directions.py", *tests("positions", "gauge_forms"),
        axes_turned_away_from_a_gauge=("v = np.cross(e, u)", "v = np.cross(u, e)"),
        gauges_against_an_axis_as_along_it=("np.where(along < 0.0, -1.0, 1.0)", "np.where(along < 0.0, 1.0, 1.0)"),
        axes_of_gauges_forgotten=("    if measurements.directions is None:\n        return np.broadcast_to", "    if True:\n        return np.broadcast_to"),
        oblique_gauges_share_an_axis=("np.where(along_axes(directions), 0, 1 + axis)", "np.zeros_like(axis)"),
    ),
    *of(
        "measurements/noise/model_form.py", *tests("positions", "gauge_forms"),
        what_a_pose_has_along_axes_of_gauges=("np.swapaxes(turns_onto(measurements.directions), 1, 2)", "turns_onto(measurements.directions)"),
    ),
    *of(
        "measurements/importers/columns/unread_axes.py", *tests("measurements/importers/columns", "axes_not_read", "reading_direction"),
        a_gauge_against_its_axis_keeps_its_sign=("negated(cell) if s < 0.0 else cell", "cell"),
    ),
    *of(
        "identify/positions/noise/model_form.py", *tests("positions", "gauges"),
        a_smooth_error_of_what_does_not_yield=("    if not products:", "    if False:"),
    ),
    *of(
        "identify/positions/solve/pose_errors.py", *tests("positions/noise", "pose_errors"),
        any_turn_is_taken=("turned if turned.gained > found.gained + CLEAR else found", "turned"),
        turns_count_as_joints_make_them=("np.where(turning_ways, turning, 1.0)", "np.where(turning_ways, 1.0, 1.0)"),
    ),
    *of(
        "identify/positions/calibrate.py", *tests("positions/noise", "pose_errors"),
        turns_that_no_fit_sees=("common, turning = told.size, told.turning\n        again", "common, turning = told.size, 1.0\n        again"),
    ),
    *of(
        "measurements/placing/levels.py", *tests("positions/checks", "levels"),
        gravity_the_other_way=("np.linalg.lstsq(A, -levels.sine", "np.linalg.lstsq(A, levels.sine"),
        one_wild_level_is_a_slip=("int((1.0 - WILD) * len(values))", "len(values)"),
        levels_exchanged_the_other_way=("LEVELS[order.index(k)]", "LEVELS[order[k]]"),
    ),
    *of(
        "identify/positions/uncertainty/undetected.py", *tests("positions/uncertainty", "undetected"),
        springs_without_a_name_are_rigid=("more = len(problem.free) - len(found.x)\n", "return found\n"),
    ),
    *of(
        "explain/positions/answer/balancer.py", *tests("positions/explain", "balancer"),
        any_wave_is_a_balancer=("chance_of_gear(*_wave(effect, final)) >= SURE", "chance_of_gear(*_wave(effect, final)) >= 2.0"),
        a_balancer_that_needs_no_telling=("exact=exact, untold=(name,))", "exact=exact)"),
        balancers_as_usual_as_gears=("BALANCED = USUAL", "BALANCED = 1.0 - USUAL"),
    ),
    *of(
        "explain/positions/select/choose.py", *POSITIONS,
        confirmed_by_its_share_alone=("gained.share > SHARE and gained.errors > sure and", "gained.share > SHARE and"),
        looking_at_many_for_nothing=("CLEAR + float(np.log(max(len(linear.candidates), 1)))", "CLEAR"),
        gain_at_poses_that_were_fitted=("linear.gap(each, linear.noise(each), held_out=True)", "linear.gap(each, linear.noise(each), held_out=False)"),
    ),
    *of(
        "explain/positions/select/choose.py", *tests("positions/explain", "choose"),
        less_likely_names_kept=("odds[best] > odds[e] + MENTION", "odds[best] > odds[e] + 1e9"),
        ties_exchanged=("odds[best] > odds[e] + MENTION", "odds[best] > odds[e] - 1e-9"),
    ),
    *of(
        "explain/positions/judge/smooth_error.py", *tests("positions/explain", "smooth_error"),
        an_error_that_costs_nothing=("problem.score(chosen, 1.0) - volume", "problem.score(chosen, 1.0)"),
        only_the_error_that_is_left=("        for each in (*alike, sum(alike, 0.0) / max(len(alike), 1)):", "        for each in ():"),
        the_base_forgotten_beside_an_error=("rest = white[:, P:] - Q @ (Q.T @ white[:, P:])", "rest = white[:, P:]"),
    ),
    *of(
        "explain/positions/judge/fallen.py", *tests("positions/explain", "smooth_error"),
        the_strongest_falls_first=("weakest = min(likely", "weakest = max(likely"),
        what_came_to_nothing_stands=("    if gone := _nothing_left(linear, found, final):", "    if gone := []:"),
        names_less_likely_than_not_stand=("if likely[weakest] >= EVEN:", "if likely[weakest] >= 0.0:"),
    ),
    *of(
        "identify/positions/checks/parts.py", *tests("positions", "stations"),
        a_tracker_that_goes_back=("int(np.argmin(best[: k + 1]))", "int(np.argmin(best))"),
    ),
    *of(
        "measurements/moved.py", *tests("positions/checks", "slips"),
        pushes_in_the_order_of_the_file=("if clock is None else clock\n", "\n"),
        masked_rows_of_the_first_part=("np.maximum.accumulate(known[order])", "known[order]"),
    ),
    *of(
        "measurements/placing/groups.py", *tests("positions/checks", "remounted"),
        series_of_loaded_rows_without_a_place=("off = np.array([place.get(label, place.get(of[label], np.zeros(3))) for label in labels])", "off = apart"),
    ),
    *of(
        "explain/positions/select/linear.py", *POSITIONS,
        evidence_without_its_volume=("return -0.5 * (square + volume)", "return -0.5 * square"),
        poses_left_out_in_the_fit=("G = self.whole if without is None else self.whole - self.sums[without]", "G = self.whole"),
        parts_softer_than_rigid=("wrong = (pick >= P) & (x < 0.0)", "wrong = (pick >= P) & (x < -1e99)"),
        noise_smaller_than_stated=("return max(left, together) if self.stated else left", "return left"),
    ),
    *of(
        "explain/positions/judge/laws.py", *tests("positions/explain", "explain"),
        fitted_laws_by_the_columns_of_others=("linear = linear.by_law(e, *_block(linear, seen, law, found[law]))", "pass"),
    ),
    *of(
        "measurements/placing/turned.py", *tests("positions", "targets", "stated"),
        no_arm_is_off_by_more_than_three_degrees=("ASKEW = np.radians(10.0)", "ASKEW = np.radians(3.0)"),
        any_rotation_is_a_tools=("    if left < ASKEW:", "    if True:"),
    ),
    *of(
        "identify/positions/omitted/nuisances.py", *tests("positions/uncertainty", "own_weight"),
        springs_blind_to_the_arms_weight=("more = np.column_stack([more, problem", "more = 0.0 * np.column_stack([more, problem"),
    ),
    *of(
        "exports/urdf.py", *tests("exports", "urdf"),
        exported_masses_as_before=("_weigh(root, model.assembly.heavier(model.values))", "_weigh(root, 1.0)"),
    ),
    *of(
        "arrays.py", *tests("", "arrays"),
        rounding_taken_for_a_column=("lengths > ROUNDING * lengths", "lengths > 0.0 * lengths"),
    ),
    *of(
        "identify/positions/solve/gauss_newton.py", *POSITIONS,
        prior_centred_elsewhere=("(centre - x) / span])", "(x - centre) / span])"),
    ),
    *of(
        "model/sensitivities.py", *tests("positions", "moved"),
        turns_against_nothing=("on[:, 3:, 3:] = turn", "on[:, 3:, 3:] = 0.0"),
        turns_since_zero_unturned=("adjoint_0 = on @ adjoint_0", "adjoint_0 = adjoint_0 + 0.0"),
        turns_in_axes_of_the_base=("parts.append(axes @ moved[:, 3:])", "parts.append(moved[:, 3:])"),
    ),
    *of(
        "model/standing.py", *tests("positions", "moved"),
        turns_the_other_way=("self.rest.screws.rotation @ np.swapaxes(before, -1, -2)", "before @ np.swapaxes(self.rest.screws.rotation, -1, -2)"),
    ),
    *of(
        "model/assembly.py", *tests("positions", "moved"),
        a_marker_moved_since_zero=("points = self._marker(load_cases, values)", "points = load_cases.point"),
    ),
    *of(
        "measurements/channels.py", *tests("positions", "moved"),
        axes_not_read_are_zero=("np.where(np.isnan(self.turn), said, self.turn)", "np.nan_to_num(self.turn)"),
        uncertainty_of_no_displacement=('_OF_ROWS = ("position", "displacement")', '_OF_ROWS = ("position",)'),
    ),
    *of(
        "measurements/absolute.py", *tests("positions", "moved"),
        zero_readings_without_error=("since_zero = np.sqrt(2.0) if twice else 1.0", "since_zero = 1.0"),
    ),
    *of(
        "data_checks/turns.py", *tests("positions", "moved"),
        any_change_is_a_slip=("after >= SOUND and 1.0 - now > CLEARER * (1.0 - after)", "after >= SOUND"),
        turns_of_any_arm=("    if now >= NONE:", "    if now >= 0.0:"),
    ),
    *of(
        "data_checks/from_a_row_on.py", *tests("data_checks", "from_a_row_on"),
        rows_above_that_are_off_too=("own[row] + off[-1] - off[row]", "off[row] + off[-1] - off[row]"),
        rows_from_the_best_of_few=("    for _ in range(2):", "    for _ in range(1):"),
    ),
    *of(
        "plan/simulated_channels.py", *tests("plan", "simulated_channels"),
        angles_as_noisy_as_lengths=("(angle if kind in ANGLES else length)", "length"),
        readings_where_none_were=("if said.channels.present:", "if not said.channels.present:"),
    ),
    *of(
        "explain/positions/judge/budget.py", *tests("positions/explain", "budget"), *tests("positions", "moved"),
        the_tracker_moves_the_arm=("isinstance(effect, Viewpoint | Mounting) or marks", "isinstance(effect, Mounting) or marks"),
        a_load_moves_by_weight_too=("if problem.channels.displacements_alone:", "if not problem.channels.displacements_alone:"),
    ),
    *of(
        "identify/positions/solve/pose_problem.py", *tests("positions", "uneven_moved"),
        poses_that_yield_alike=("        if self.channels.displacements_alone:\n            return self._by_springs\n", ""),
    ),
    *of(
        "identify/positions/solve/gauss_newton.py", *tests("positions", "uneven_moved"),
        any_fall_will_do=("- WORTH * share * promised", "- 0.0 * promised"),
    ),
    *of(
        "explain/positions/select/candidates.py", *tests("positions", "moved"),
        loads_misread_by_sensors_alone=("    return next(law for law in laws if taken[law] >= ALIKE * max(taken.values()))", "    return laws[0]"),
    ),
    *of(
        "measurements/placing/laying.py", *tests("measurements/placing", "registration"),
        mirrored_frames=("np.linalg.det(u @ vt) < 0.0", "np.linalg.det(u @ vt) < -9.0"),
        residual_not_divided_by_its_freedom=("spare = 3 * count - 6 * stations - 3 * markers * fitted", "spare = 3 * count"),
        stations_laid_as_one=("weight = kept[..., None] * clouds.of_station", "weight = kept[..., None] * np.ones_like(clouds.of_station)"),
    ),
    *of(
        "measurements/placing/registration.py", *tests("measurements/placing", "registration"),
        covariance_of_a_frame_without_its_scale=("(vt.T / values)[:frames] / size[:frames, None]", "(vt.T / values)[:frames]"),
    ),
    *of(
        "measurements/placing/slips.py", *tests("positions/checks", "rows_apart"),
        a_tracker_moved_never=("(np.arange(len(cloud.x)) >= row)", "(np.arange(len(cloud.x)) >= 10**9)"),
        rows_moved_the_other_way=("of = rows + by * (rows >= row)", "of = rows - by * (rows >= row)"),
        a_row_found_roughly=("best, step = min(near, key=left), step // 2", "step = 0"),
    ),
    *of(
        "effects/tracker_frame.py", *tests("positions", "stations", "sensitivities"),
        all_seen_from_the_first_station=("return rotation_of(frames[:, 3:])[stood], frames[stood, :3]", "return rotation_of(frames[:, 3:])[0 * stood], frames[0 * stood, :3]"),
        a_station_that_moves_the_others=("J, own = left_jacobian(frame[3:]), stood == k", "J, own = left_jacobian(frame[3:]), stood >= 0"),
        unknown_stations_taken_for_the_first=("if label not in self.stations]", "if False]"),
    ),
    *of(
        "identify/positions/checks/reregistration.py", *tests("positions", "stations"),
        an_arm_that_changed_placed_away=("goal = np.inf if strange else BETTER * before", "goal = np.inf"),
        a_marker_moved_for_nothing=("            goal = BETTER * after", "            goal = np.inf"),
        wild_rows_pull_the_tracker=("near = far <= max(FAR * float(np.median(far)), 1e-9)", "near = far <= 1e9"),
    ),
    *of(
        "identify/positions/checks/slips.py", *tests("positions/checks", "joint_slips"),
        a_slip_where_a_label_says_there_is_none=("if each.change.sure and each.cause in unsaid]", "if each.change.sure]"),
        a_law_of_the_joint_taken_for_a_slip=("<= CLEARER * steps.by_places", "<= 0.0"),
    ),
    *of(
        "identify/positions/checks/change_points.py", *tests("positions/checks", "joint_slips"),
        stairs_of_a_drift_taken_for_slips=("courses if len(cuts) > 1 else", "courses if len(cuts) > 9 else"),
        the_joint_that_takes_off_least=("int(np.argmax([replace", "int(np.argmin([replace"),
        sizes_of_what_does_not_slip=("[-len(cuts) * self.frame.shape[1] :]", "[: len(cuts) * self.frame.shape[1]]"),
    ),
    *of(
        "identify/positions/checks/slips.py", *tests("positions/checks", "rivals"),
        a_jump_taken_for_what_poses_have_of_their_own=("    if problem.common:\n", "    if problem.common > 9.0:\n"),
    ),
    *of(
        "identify/positions/checks/likeliest.py", *tests("positions/checks", "rivals"),
        the_richest_cause_taken_for_the_likeliest=("halvings = times + (self.cause != simpler.cause)", "halvings = -9"),
        rivals_with_any_number_of_moves_and_any_gap=("or not fewer or behind > BEYOND_DOUBT", "or False"),
    ),
    *of(
        "identify/positions/checks/change_points.py", *tests("positions/checks", "slips"),
        creeping_taken_for_a_push=("if after <= HALF * min(before, steady):", "if after <= HALF * before:"),
        a_push_for_a_little=("HALF = 0.5", "HALF = 0.99"),
        borders_in_the_joints_taken_for_a_push=("> CLEARER * self.by_places", "> 0.0"),
        a_place_from_the_first_row_on=("self.frame * (self.when >= cut)[:, None] for cut in cuts", "self.frame * (self.when >= 0)[:, None] for cut in cuts"),
    ),
    *of(
        "identify/positions/checks/slips.py", *tests("positions/checks", "slips"),
        a_push_where_labels_say_there_is_none=("if columns and told[cause] is None", "if columns"),
    ),
    *of(
        "measurements/importers/tracker/stations.py", *tests("measurements/importers/campaign", "several_files"),
        frames_for_few_positions=("if left[w] <= np.hypot(AS_WELL * best, sag)), as_well[0])", "if left[w] <= 0.0), (\"station\",))"),
        a_marker_always_where_it_was=("ways += [(\"series\",), (\"station\", \"series\")]", "ways += []"),
    ),
    *of(
        "measurements/importers/tracker/stations.py", *tests("measurements/importers/tracker", "moved_or_bent"),
        sag_taken_for_a_tracker_that_moved=("sag = 0.0 if well else SAGS * arm_length(robot)", "sag = 0.0"),
        same_poses_read_again_for_nothing=("any(len(own & others) >= TOLD for other, others in at.items() if other != name)", "False"),
        every_file_its_own_frame=("if out[other] == other and apart <= sag:", "if False:"),
    ),
    *of(
        "measurements/importers/tracker/moved_or_bent.py", *tests("measurements/importers/tracker", "moved_or_bent"),
        a_push_never_seen=("return size if size > LEAST and", "return size if size > 1.0 and"),
        sag_of_no_spring=("springs = J * np.einsum(\"pik,i->pk\", J, down)[:, None, :]", "springs = 0.0 * J"),
    ),
    *of(
        "measurements/importers/tracker/frames.py", *tests("measurements/importers/tracker", "moved_or_bent"),
        repeats_of_a_pose_place_a_tracker=("pairs = {(str(labels[k]), str(poses[k])) for k in rows}", "pairs = {(str(labels[k]), str(k)) for k in rows}"),
    ),
    *of(
        "measurements/importers/loads/hung_masses.py", *tests("measurements/importers/loads", "hung_masses"),
        files_without_a_mass_taken_for_free=("    if lost:\n        first", "    if False:\n        first"),
        comment_and_name_at_odds=("if len(said) > 1 and not", "if False and not"),
    ),
    *of(
        "measurements/importers/loads/masses_in_words.py", *tests("measurements/importers/loads", "hung_masses"),
        a_capacity_taken_for_a_payload=("if len(tokens) == 1 and _STATED.fullmatch", "if len(tokens) == 1 or _STATED.fullmatch"),
        what_a_robot_bears_taken_for_a_load=("elif not called and len(_alike(before, beside)) < 2:", "elif False:"),
        a_load_that_is_denied=("if _DENYING.search(stem):", "if False:"),
        half_of_a_mass=("elif _PART.search(before) and not", "elif False and not"),
    ),
    *of(
        "measurements/importers/layout/lost_readings.py", *tests("measurements/importers/layout", "lost_readings"),
        nines_within_what_was_measured=("FAR * np.ptp(read, axis=0).max()", "-1.0"),
        zeros_taken_for_positions=("if zero and zeros.sum() >= AGAIN:", "if False:"),
    ),
    *of(
        "identify/positions/omitted/waves.py", *tests("positions/uncertainty", "omitted_bias"),
        another_cause_taken_for_waves=("if loss[k] > most and", "if"),
    ),
    *of(
        "identify/positions/checks/gravity_direction.py", *tests("positions/uncertainty", "omitted_bias"),
        a_base_that_yields_taken_for_a_slope=("if lead > 0.0:", "if lead > 1e9:"),
    ),
    *of(
        "identify/positions/noise/sizes.py", *tests("positions/uncertainty", "omitted_bias"),
        a_tail_taken_for_slips=("FAR * max(size, float(np.quantile(ends[~far & (count > 0)], TAIL)))", "FAR * size"),
    ),
    *of(
        "identify/positions/checks/beside_frames.py", *tests("positions/checks", "gravity_direction"),
        waves_taken_for_sag=("for kinds in ((JointFrame, TransmissionError), (JointSprings,))", "for kinds in ((JointFrame,), (JointSprings,))"),
    ),
    *of(
        "identify/positions/checks/gravity_direction.py", *tests("positions/checks", "gravity_direction"),
        a_balancer_taken_for_a_ceiling=("if odds < BEYOND_DOUBT or after > AS_WELL * sag.signed(stated):", "if odds < BEYOND_DOUBT:"),
        springs_that_push=("return float(nnls(self._along(way), self.gap)[1] ** 2)", "return self.signed(way)"),
        gravity_along_one_axis_alone=("[under(way) for way in (*np.eye(3), np.zeros(3))]", "[under(way) for way in (*np.eye(3)[[2, 2, 2]], np.zeros(3))]"),
        a_load_taken_for_weight=("by_axis = sag.along[:3] - sag.along[3]", "by_axis = sag.along[:3] + 0.0"),
        what_the_file_states_overruled=("if readings.gravity is not None:", "if readings.gravity is None and readings.path is None:"),
    ),
    *of(
        "plan/positions_pool.py", *tests("plan", "of_positions"),
        positions_read_already_forgotten=("before += B.T @ B", "before += 0.0 * (B.T @ B)"),
        frame_and_marker_taken_for_known=("wide = PoseProblem(start, there", "wide = PoseProblem(model, there"),
    ),
    *of(
        "plan/of_positions.py", *tests("plan", "of_positions"),
        payloads_that_no_motor_holds=("return within, a[held], (", "return within, a, ("),
        foretold_with_what_was_known_alone=("total = design.known + design.gains[list(design.rows)].sum(axis=0)", "total = design.known"),
    ),
    *of(
        "explain/positions/advise/other_poses.py", *tests("positions/explain", "advice"),
        poses_that_tell_nothing_proposed=("if found.after >= TOLD:", "if found.after >= 0.0:"),
    ),
    *of(
        "identify/positions/omitted/other_causes.py", *tests("positions", "payload_place"),
        payloads_that_hang_where_the_file_says=("(kind.of_payload and hung)", "(kind.of_payload and loaded)"),
        one_mass_that_hangs_elsewhere_twice=("hung = said is not None and said.payload_differs", "hung = said is not None"),
    ),
    *of(
        "effects/force_sensor.py", *tests("positions", "payload_place"),
        a_mass_as_well_placed_as_a_hook=("plausible, typical = (0.5, 0.02) if self.hung", "plausible, typical = (0.1, 5e-3) if self.hung"),
    ),
    *of(
        "explain/positions/answer/explained.py", *tests("positions/explain", "advice"),
        one_of_a_class_left_open=("return not self.others and not self.untold", "return not self.alternatives and not self.untold"),
    ),
    *of(
        "identify/positions/checks/drift.py", *tests("positions/checks", "drift"),
        a_creep_where_the_order_is_stated=("if readings.order is not None or readings.time is not None:", "if readings.time is not None:"),
    ),
    *of(
        "measurements/placing/slips.py", *tests("positions", "zeros"),
        a_zero_of_the_first_joint_alone=("best, joint, zero = tried[near], k, float(ZEROS[near])", "best, joint, zero = tried[near], 0, float(ZEROS[near])"),
        a_zero_the_other_way=("return Convention(rms, np.eye(n), zero * np.eye(n)[joint])", "return Convention(rms, np.eye(n), -zero * np.eye(n)[joint])"),
    ),
    *of(
        "data_checks/turned_axes.py", *tests("data_checks", "turned_axes"),
        axes_turned_the_other_way=("turned by {degrees:g} deg", "turned by {-degrees:g} deg"),
        loads_left_as_they_are=("        if what != \"d\":", "        if False:"),
    ),
    *of(
        "identify/positions/uncertainty/undetected.py", *tests("positions/uncertainty", "undetected"),
        what_stands_fixed_set_to_zero=("- set(found.model.names)", "- {each.name for each in found.parameters}"),
    ),
    *of(
        "explain/positions/judge/changed.py", *tests("positions/explain", "changed"),
        a_change_of_nothing=("shares[best] < WORTH", "shares[best] < 1.0"),
        a_change_in_any_order=("/ (1 + DRAWN) > CHANCE", "/ (1 + DRAWN) > 1.0"),
    ),
    *of(
        "identify/positions/words.py", *tests("positions", "payload_place"),
        weight_that_is_sure=("if said.payload[readings.use].any():", "if True:"),
    ),
    *of(
        "identify/positions/residuals/remainder.py", *tests("positions/noise", "remainder"),
        a_gap_that_is_all_noise=("return 0.0, float(np.sqrt(square / freedom)), 1.0", "return 0.0, 0.0, 1.0"),
        repeats_that_tell_no_noise=("square - again.freedom * pure", "square"),
    ),
    *of(
        "measurements/importers/columns/masses.py", *tests("measurements/importers/columns", "masses"),
        grams_taken_for_kilograms=('"g": 1e-3', '"g": 1.0'),
        any_word_a_mass=("elif len(heavy) == 1:", "elif False:"),
    ),
    *of(
        "effects/load_cases.py", *tests("positions", "references"),
        warmth_over_that_of_each_file=("values + (reference.until(own) or 0.0)", "values + 0.0 * (reference.until(own) or 0.0)"),
    ),
    *of(
        "effects/reference.py", *tests("positions", "references"),
        every_clock_is_the_same=("if other.last < self.value - lasted or other.value > self.last + lasted:", "if False and lasted:"),
        a_clock_that_ends_with_the_fit=("other.value > self.last + lasted", "other.value > self.last"),
        a_clock_that_begins_with_the_fit=("other.last < self.value - lasted", "other.last < self.value"),
    ),
    *of(
        "effects/counting.py", *tests("positions", "references"),
        a_reference_of_every_fit=("self.reference.beside(own) if self.reference else own", "own"),
    ),
    *of(
        "effects/reading_drift.py", *tests("positions", "references"),
        what_has_warmed_up_before_the_first=("np.maximum(elapsed, 0.0) if load_cases.absolute else elapsed", "elapsed"),
    ),
)  # fmt: skip
