"""Faults in how sets of names are held against one another."""

# ruff: noqa: E501
from __future__ import annotations

from scripts.mutations_fault import Fault, of, tests

OF_SETS: tuple[Fault, ...] = (
    *of(
        "explain/judge/rigid_gears.py", *tests("explain", "rigid_gears"),
        rigid_gears_for_nothing=("if prices.max(initial=0.0) >= OUT_OF_LINE:", "if False:"),
        drives_out_of_line_for_nothing=("(np.log(tried / usual) / SPREAD) ** 2", "0.0 * tried"),
        rivals_are_not_asked=("(own, *(e for e in rivals if e not in chosen))", "(own,)"),
    ),
    *of(
        "explain/judge/soft_parts.py", *tests("explain", "brought"),
        soft_parts_always_lose=("gap > LOST or", "gap > -1e9 or"),
        soft_parts_are_not_borne_out=("if not said.holds:", "if said.holds:"),
        what_lies_far_behind_stays_in_the_set=("if -gap < LOST:", "if True:"),
    ),
    *of(
        "explain/positions/judge/posterior.py", *tests("positions/explain", "sets"),
        larger_sets_take_the_place=("if 0 < len(each) <= len(here)", "if True"),
        what_fell_comes_back=("            and each.isdisjoint(found.dropped)\n", ""),
        equals_take_turns=("weight > CLEARLY * weights[here]", "weight >= 0.0 * weights[here]"),
    ),
    *of(
        "explain/positions/judge/sets.py", *tests("positions/explain", "sets", "linear"),
        names_that_cost_nothing=("return float(np.log(len(linear.candidates))) - usual", "return 0.0 * usual"),
        what_poses_left_out_refute_counts=("log = log - max(too_much(c), 0.0) * holds[:, c]", "known[c] = True"),
        twins_are_held_back_once=("        if not refuted:\n            return log\n        for c in refuted:\n            log = log - max(too_much(c), 0.0) * holds[:, c]\n", "        for c in refuted:\n            log = log - max(too_much(c), 0.0) * holds[:, c]\n        return log\n"),
        what_comes_and_goes_stands_instead=("as_much & (both * neither < HALF * alone * instead)", "as_much"),
        anything_stands_instead=("likely = as_much & (both", "likely = (both"),
        rivals_of_what_every_set_holds=("if self.with_any((e,)) > HELD_BY_ALL:", "if False:"),
    ),
    *of(
        "explain/positions/judge/accounts.py", *tests("positions/explain", "shares"),
        nothing_is_weighed_alike=("for linear, white in ways[:1] if as_fitted else ways:", "for linear, white in ways[:1]:"),
    ),
    *of(
        "explain/positions/run.py", *tests("positions/explain", "shares"),
        shares_as_readings_weigh=("gain(linear, posterior.chosen, e), account.share(e)", "gain(linear, posterior.chosen, e), gain(linear, posterior.chosen, e).share"),
    ),
    *of(
        "explain/positions/select/linear.py", *tests("positions/explain", "sets"),
        scores_at_once_without_what_is_chosen=("own + np.linalg.slogdet(block / noise)[1]", "np.linalg.slogdet(block / noise)[1]"),
        signs_that_do_not_bind=("low[P:][self.positive] = 0.0", "low[P:][self.positive] = -np.inf"),
    ),
    *of(
        "explain/positions/select/choose.py", *tests("positions/explain", "beside_frames"),
        zeros_fall_beside_frames=("return abs(value) > max(typical)", "return False"),
    ),
    *of(
        "explain/positions/select/choose.py", *tests("positions/uncertainty", "nuisances"),
        small_turns_of_frames_are_zeros=("return abs(value) > max(typical)", "return True"),
    ),
    *of(
        "identify/positions/solve/minimal_parameters.py", *tests("positions/explain", "beside_frames"),
        a_shift_along_for_one_across=("for least in (AT_ONCE, 0.0):", "for least in (0.0,):"),
        weakly_seen_is_not_seen=("for least in (AT_ONCE, 0.0):", "for least in (AT_ONCE,):"),
    ),
    *of(
        "effects/thermal_growth.py", *tests("positions/explain", "warmth"),
        every_link_grows_as_one_of_a_metre=("typical = of_metre * self.length", "typical = of_metre"),
    ),
    *of(
        "effects/thermal_drift.py", *tests("positions/explain", "warmth"),
        stands_that_never_grow=("kelvin[:, None, None] * np.eye(3)", "0.0 * kelvin[:, None, None] * np.eye(3)"),
    ),
    *of(
        "explain/positions/answer/next_step.py", *tests("positions/explain", "warmth"),
        advice_to_use_what_no_arm_has=("if far := implausible(answer.final):", "if far := []:"),
    ),
    *of(
        "model/typical.py", *tests("cli/commands", "stiffness"),
        any_geometry_is_plausible=("and abs(p.internal) > p.spec.plausible", "and False"),
    ),
    *of(
        "measurements/placing/under_load.py", *tests("positions/checks", "under_load"),
        loads_move_a_tool_anywhere=("if far.mean() < WILD:", "if True:"),
        one_wild_row_stops_all=("if far.mean() < WILD:", "if not far.any():"),
        no_row_is_apart=("    refuse_from_a_row_on(cloud, told, least, readings, rows)\n", ""),
    ),
)  # fmt: skip
