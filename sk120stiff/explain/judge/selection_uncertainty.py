"""Standard errors that hold what another possible name would make of a parameter.

Where the readings cannot tell two names apart, or two laws of one gear, the springs come out
differently under each. What a single model calls its standard error is then too small by far: the
largest difference is added in squares. The spring of a bent gear is compared where all its laws
mean the same by it, at no load: one law's parameter is the slope there, another's the slope beyond
its last step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect, Elastic, LoadCases
from sk120stiff.errors import Refusal
from sk120stiff.explain.findings import Finding
from sk120stiff.explain.judge.foreign_cause import moved_by_a_foreign_cause
from sk120stiff.explain.judge.remainder import remainder_of
from sk120stiff.explain.select.form import alike_but_for_form
from sk120stiff.explain.select.own_sizes import price_of_factors, with_settled_sizes
from sk120stiff.explain.select.score import score_set, unit
from sk120stiff.explain.select.stepwise import Selection, refit
from sk120stiff.identify import Fit
from sk120stiff.identify.written import with_values

REFUTED = 10.0  # twice the log-likelihood by which another law may be worse at most
LOOKED_AT = 8  # alternatives of one name
LAWS = 3  # other laws of one name


def with_selection_uncertainty(
    found: Selection, findings: Sequence[Finding], beside: Fit | None = None
) -> Fit:
    """The final fit, its standard errors and intervals widened by the models that remain possible.

    Args:
        found: The selection with its final fit.
        findings: The named effects with their alternatives.
        beside: The same names beside a cause that has none, where it leaves noise alone: there the
            estimates have not taken on what that cause does.
    """
    final = found.final
    place = {parameter.quantity: k for k, parameter in enumerate(final.parameters)}
    moves = np.zeros(len(final.x))
    here = _at_no_load(final)
    others = [] if beside is None else [beside]
    for effects in _others(found, findings):
        try:
            other = with_settled_sizes(refit(found.base, effects, found.final))
        except Refusal:
            continue
        if _deviance(other) - _deviance(final) <= REFUTED:
            others.append(other)
    for other in others:
        there = dict(zip((p.quantity for p in other.parameters), _at_no_load(other), strict=True))
        moved = np.array([
            there.get(p.quantity, 0.0 if p.effect.calibrated else here[k]) - here[k]
            for k, p in enumerate(final.parameters)
        ])  # fmt: skip
        moved = np.abs(final.beforehand.calibrations.beside(moved))
        moves = np.maximum(moves, np.where([name in there for name in place], moved, 0.0))
    foreign = None
    if found.base.problem.noise.form:
        foreign = moved_by_a_foreign_cause(final, remainder_of(final).rms)
    return with_values(replace(final, selection_uncertainty=moves, foreign=foreign))


def _deviance(fit: Fit) -> float:
    """-2 ln L with the sizes of its poses, up to a constant."""
    return price_of_factors(fit.problem.noise.form) - 2.0 * fit.log_likelihood


def _at_no_load(fit: Fit) -> Array:
    """(P_free,) the estimates; of springs that a law bends, the whole compliance at no load."""
    x, model, load_cases = fit.x.copy(), fit.model, fit.problem.load_cases
    for effect in model.effects:
        values = np.array([p.internal for p in model.parameters if p.effect == effect])
        slope = bent_at_no_load(effect, load_cases, values)
        for k, parameter in enumerate(fit.parameters):
            if slope and parameter.effect.joint_spring and parameter.effect.where == effect.where:
                x[k] += slope / fit.problem.scale[k]
    return np.asarray(x)


def bent_at_no_load(effect: Effect, load_cases: LoadCases, values: Array) -> float:
    """Compliance at no load that a law with these values (p,) adds to its joint's spring; or 0."""
    if not (effect.bends_a_spring and isinstance(effect, Elastic)):
        return 0.0
    rest = np.zeros((load_cases.count, 1))
    return float(effect.elongation(rest, load_cases, values).by_torque.mean())


def _others(found: Selection, findings: Sequence[Finding]) -> Iterator[list[Effect]]:
    """Sets of effects that may be meant as well, if they fit."""
    regression = found.regression
    where = {effect.id: k for k, effect in enumerate(regression.candidates)}
    for finding in findings:
        rest = [other.effect for other in findings if other is not finding]
        named = {effect.id for effect in rest}
        # Beside model-form error constants of poses are part of it, and no candidates.
        free = [each for each in finding.alternatives if each in where and each not in named]
        for name in free[:LOOKED_AT]:
            yield [*rest, regression.candidates[where[name]]]
        for law in _other_laws(found, where[finding.effect.id]):
            yield [*rest, law]


def _other_laws(found: Selection, effect: int) -> list[Effect]:
    """Laws of one effect that the readings do not refute, the likeliest first.

    A law that has all of the named one and more leaves less in any case: it counts where the
    evidence does not speak against what it has beyond.
    """
    regression, sums, now = found.regression, found.regression.sums(), found.scored
    laws, own = regression.laws[effect], _quantities(regression.candidates[effect])
    fits: dict[Effect, float] = {}
    for k, law in enumerate(laws):
        other = score_set(
            regression, sums, now.effects, start=now.by_variant | {effect: k}, only=()
        )
        if alike_but_for_form(law, laws[0]):
            continue  # what its numbers are known to counts by itself
        if own < _quantities(law) and other.score > now.score + REFUTED:
            continue
        fits[law] = min(other.solved.rss, fits.get(law, np.inf))
    most = now.solved.rss + REFUTED * unit(regression, now)
    near = [law for law in fits if law != laws[0] and fits[law] < most]
    return sorted(near, key=lambda law: fits[law])[:LAWS]


def _quantities(law: Effect) -> frozenset[str]:
    return frozenset(spec.quantity or spec.name for spec in law.parameters)
