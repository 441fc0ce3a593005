"""Faults in how sets of names are held against one another."""

# ruff: noqa: E501
from __future__ import annotations

from scripts.mutations_fault import Fault, of, tests

OF_SETS: tuple[Fault, ...] = (
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
)  # fmt: skip
