"""Stepwise selection under one noise model: linearise, search and refit until it settles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from scipy.optimize import lsq_linear

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Effect
from sk120stiff.effects.reading_drift import warm_ups
from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.linearised import Linearised
from sk120stiff.explain.candidates.regression import Regression, regression_at
from sk120stiff.explain.select.beam import beam_search, exchanged
from sk120stiff.explain.select.form import from_there, with_best_form
from sk120stiff.explain.select.outliers import outlying_rows, standing_apart, still_outlying
from sk120stiff.explain.select.own_sizes import own_sizes, price_of_factors
from sk120stiff.explain.select.score import Scored, score_set
from sk120stiff.identify import Fit, Problem, fit, solve, solve_near
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.measurements.noise.repeats import borne_out
from sk120stiff.model import Model

TRIED = 1  # models whose fit may be refused before smaller ones are tried
ROUNDS = 4  # of linearising, searching and refitting
BOUNDLESS = 1e3  # times its plausible size: that is no size, the other effects undo it
MORE = 1.2  # times the misfit as to first order: the fit went another way
ROUNDING = 1e-12  # of the largest column: what is smaller is no first-order effect of a parameter


@dataclass(frozen=True, eq=False)
class Selection:
    """A base model, the model that the search settled on, and everything to judge it by.

    Attributes:
        base, final: Fits of the base model and of the model with the chosen effects.
        regression: Readings linearised at `final`.
        chosen: Candidates in `final`.
        outliers: Rows (of the readings given) that were set aside as outliers.
        candidates: All effects considered.
        total: Score of the whole, noise included; those under other zeros compare by it.
        searched: The same of the set that the search settled on, of which some may have fallen.
        at_base: Sensitivities of all readings at the base model.
    """

    base: Fit
    final: Fit
    regression: Regression
    chosen: tuple[int, ...]
    outliers: Index
    candidates: tuple[Effect, ...]
    total: float
    searched: float
    at_base: Linearised | None = None

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The chosen effects."""
        return tuple(self.regression.candidates[e] for e in self.chosen)

    @cached_property
    def scored(self) -> Scored:
        """The chosen model in the regression."""
        return score_set(self.regression, self.regression.sums(), self.chosen)


def select(
    model: Model,
    measurements: Measurements,
    noise: NoiseModel,
    candidates: Sequence[Effect],
    *,
    max_effects: int,
    alpha: float,
    prior: Mapping[str, float] | None = None,
    soft: frozenset[str] = frozenset(),
    near: Linearised | None = None,
) -> Selection:
    """Settle on a set of effects under one noise model.

    Args:
        model: The base model.
        measurements: Readings in use.
        noise: Their noise.
        candidates: Effects that may be missing.
        max_effects: Largest number of them to add.
        alpha: Probability of naming something where nothing is missing.
        prior: Probabilities of effects that the user gave.
        soft: Ids of effects that may be softer than is customary.
        near: Sensitivities at another fit of the base model.
    """
    base = fit(model, measurements, noise=noise)
    ids = tuple(effect.id for effect in model.effects)
    asked = partial(regression_at, alpha=alpha, prior=prior, soft=soft)
    regression = asked(base, candidates, ids, near=near)
    at_base = regression.linearised
    slow, certain = warm_ups(base.problem.load_cases), borne_out(measurements)
    outliers = outlying_rows(regression, base.problem.whitener, slow, certain)

    def without(rows: Index) -> tuple[Fit, Regression]:
        keep = np.ones(measurements.n_readings, dtype=bool)
        keep[rows] = False
        fitted = fit(model, measurements.select(keep), noise=noise)
        return fitted, asked(fitted, candidates, ids)

    if len(outliers):
        base, regression = without(outliers)
    base, regression = with_own_sizes(base, regression)
    final, regression, chosen = _settle(base, regression, candidates, ids, max_effects)
    if not len(outliers):
        outliers = standing_apart(regression, base.problem.whitener, chosen, certain)
        if len(outliers):
            base, regression = with_own_sizes(*without(outliers))
            final, regression, chosen = _settle(base, regression, candidates, ids, max_effects)
    while len(still := _still_outlying(final, measurements, outliers)) < len(outliers):
        outliers = still
        base, regression = with_own_sizes(*without(outliers))
        final, regression, chosen = _settle(base, regression, candidates, ids, max_effects)
    whole = base.problem.whitener.logdet + price_of_factors(base.problem.noise.form)
    score = score_set(regression, regression.sums(), chosen).score
    numbers = np.log(float(measurements.read.sum()))
    total = score + whole + numbers * float(measurements.read[outliers].sum())
    return Selection(
        base=base,
        final=final,
        regression=regression,
        chosen=chosen,
        outliers=outliers,
        candidates=tuple(candidates),
        total=total,
        searched=total,
        at_base=at_base,
    )


def _still_outlying(final: Fit, measurements: Measurements, outliers: Index) -> Index:
    """Those of the rows set aside that the model does not hold."""
    if not len(outliers):
        return outliers
    problem = Problem(final.model, measurements, final.problem.noise)
    residual, _ = problem.evaluate(final.x)
    scale = max(final.noise_factor, 1.0) if final.sigma_known else final.noise_factor
    return still_outlying(outliers, residual, problem, scale)


def with_own_sizes(base: Fit, regression: Regression) -> tuple[Fit, Regression]:
    """The same with the size that model-form error has at every pose; as they are without any."""
    problem = base.problem
    if not problem.noise.form:
        return base, regression
    noise = replace(problem.noise, form=own_sizes(regression, problem))
    again = solve_near(replace(problem, noise=noise), base.x)
    ids = [effect.id for effect in problem.model.effects]
    return again, regression_at(
        again, regression.candidates, ids,
        alpha=regression.alpha, prior=regression.prior, soft=regression.soft,
        near=regression.linearised,
    )  # fmt: skip


def with_effects(found: Selection, effects: Sequence[Effect]) -> Selection:
    """The same selection with other effects chosen, refitted and linearised there."""
    ids = tuple(effect.id for effect in found.base.model.effects)
    final = refit(found.base, effects, found.final)
    effects, final = with_best_form(effects, final, from_there)
    linear = found.regression
    regression = regression_at(
        final, found.candidates, ids,
        alpha=linear.alpha, prior=linear.prior, soft=linear.soft, near=linear.linearised,
    )  # fmt: skip
    chosen = positions(regression, effects)
    score = score_set(regression, regression.sums(), chosen).score
    return replace(
        found,
        final=final,
        regression=regression,
        chosen=chosen,
        total=found.total + score - found.scored.score,
        at_base=None,
    )


def refit(
    base: Fit,
    effects: Sequence[Effect],
    near: Fit | None = None,
    *,
    refused: set[tuple[Effect, ...]] | None = None,
) -> Fit:
    """The base model with effects added, fitted at exact equilibrium to the same readings.

    Args:
        base: Fit of the base model.
        effects: What joins it.
        near: A fit with most of them, about whose values theirs are sought; without one they are
            sought from the readings to first order in load.
        refused: Sets that found no fit from the readings alone with this base, and will find none:
            they are sought about `near` only. What is refused so joins them.

    Raises:
        Refusal: No equilibrium was found, or two effects undo each other without end.
    """
    if not effects:
        return base
    key, known = tuple(effects), set[tuple[Effect, ...]]() if refused is None else refused
    try:
        found = _fitted_with(base, effects, near, alone=key not in known)
    except Refusal:
        known.add(key)
        raise
    for parameter in found.parameters:
        if parameter.effect in effects and not abs(parameter.internal) < (
            BOUNDLESS * parameter.spec.plausible
        ):
            raise Refusal(f"{parameter.name} is undone by another effect, and grows without end")
    return found


def _fitted_with(
    base: Fit, effects: Sequence[Effect], near: Fit | None, *, alone: bool = True
) -> Fit:
    """See `refit`; `alone`: from the readings alone, too."""
    model = base.model
    for effect in effects:
        model = model + effect
    problem = Problem(model, base.problem.measurements, base.problem.noise)
    starts = [*([] if near is None else [near]), *([None] if alone else [])]
    for about in starts:
        try:
            x, foretold = _start(problem, about)
            found = solve_near(problem, x, most=MORE * foretold)
        except Refusal:
            continue
        if _misfit(found.residual) <= MORE * foretold:
            return found
    if not alone:
        raise Refusal("the fit did not converge before, and does not from here")
    return solve(problem)


def _start(problem: Problem, near: Fit | None) -> tuple[Array, float]:
    """(P_free,) the best values to first order, most of them on their bounds; the misfit there.

    About the values of a fit that is near, or about an arm that does not move; a misread
    displacement shows once there is one, and is seen about what the base model makes of it. What
    shows in neither, like the spring of a last joint about which the point turns, stays where it
    is.

    Raises:
        Refusal: A parameter shows in one of the two only, where the values are sought in the other.
    """
    x = np.zeros(len(problem.free))
    if near is not None:
        known = {parameter.name: parameter.internal for parameter in near.parameters}
        own = [known.get(p.name, p.internal) for p in problem.model.parameters]
        x = np.clip(np.array(own)[problem.free] / problem.scale, *problem.bounds)
    residual, jacobian = problem.evaluate(x)
    size = _sizes(jacobian)
    at_rest = near is None
    if not size.all():
        moved = np.clip(problem.start, *problem.bounds)
        there = problem.evaluate(moved)
        shown = _sizes(there[1])
        if not (shown > 0.0)[size == 0.0].any():  # nowhere: it stays at its start
            x = np.where(size > 0.0, x, moved)
        elif near is None and (shown > 0.0)[size > 0.0].all():
            at_rest, x, (residual, jacobian), size = False, moved, there, shown
        else:
            raise Refusal("a parameter does not show to first order")
    seen = np.flatnonzero(size)
    rows, wanted = jacobian[:, seen] / size[seen], -residual
    if not at_rest:  # drawn towards zero by what is plausible, where no reading tells
        span = problem.span[seen]
        rows = np.vstack([rows, np.diag(1.0 / (span * size[seen]))])
        wanted = -np.concatenate([residual, x[seen] / span])
    bounds = tuple((bound - x)[seen] * size[seen] for bound in problem.bounds)
    step = np.zeros(len(x))
    with np.errstate(invalid="ignore"):  # scipy asks how far it is to a bound at infinity
        step[seen] = lsq_linear(rows, wanted, bounds).x / size[seen]
    return x + step, _misfit(residual + jacobian @ step)


def _misfit(residual: Array) -> float:
    return float(residual @ residual)


def _sizes(jacobian: Array) -> Array:
    """(P,) lengths of the columns; zero where one is rounding beside the others."""
    size = np.linalg.norm(jacobian, axis=0)
    return np.asarray(np.where(size > ROUNDING * size.max(initial=0.0), size, 0.0))


def positions(regression: Regression, effects: Sequence[Effect]) -> tuple[int, ...]:
    """Places of effects among the candidates, ascending."""
    where = {effect.id: k for k, effect in enumerate(regression.candidates)}
    return tuple(sorted(where[effect.id] for effect in effects))


def _settle(
    base: Fit,
    regression: Regression,
    candidates: Sequence[Effect],
    ids: Sequence[str],
    max_effects: int,
) -> tuple[Fit, Regression, tuple[int, ...]]:
    """Linearise, search, refit exactly, until the search confirms the model it was made at.

    Exchanges are looked for once it does: they cost as much as the search itself.
    """
    final = base
    effects: list[Effect] = []
    exchanging, refused = False, set[tuple[Effect, ...]]()
    for number in range(ROUNDS):
        ranked = beam_search(regression, max_effects=max_effects)
        if exchanging or set(laws_of(regression, ranked[0])) == set(effects):
            exchanging = True
            better = exchanged(regression, ranked[0])
            ranked = ranked if better is ranked[0] else [better, *ranked]
        if set(laws_of(regression, ranked[0])) == set(effects):
            break
        before = effects
        effects, final = _first_that_fits(base, regression, ranked, final, refused)
        if number and set(effects) == set(before):  # what ranks higher has no fit
            break
        regression = regression_at(
            final, candidates, ids,
            alpha=regression.alpha, prior=regression.prior, soft=regression.soft,
        )  # fmt: skip
        if number and len(effects) >= max_effects and final.exceeds:
            break  # no set is enough: another will be looked for beside model-form error
    return final, regression, positions(regression, effects)


def laws_of(regression: Regression, scored: Scored) -> list[Effect]:
    """The effects of a model, each by the law by which it entered."""
    return [regression.law(e, k) for e, k in zip(scored.effects, scored.variants, strict=True)]


def _first_that_fits(
    base: Fit,
    regression: Regression,
    ranked: Sequence[Scored],
    near: Fit,
    refused: set[tuple[Effect, ...]],
) -> tuple[list[Effect], Fit]:
    """The best model that can be fitted at exact equilibrium too; see `refit` for `refused`."""
    count, most = 0, max((len(model.effects) for model in ranked), default=0)
    for model in ranked:
        if len(model.effects) > most:
            continue
        effects = laws_of(regression, model)
        try:
            found = refit(base, effects, near if near is not base else None, refused=refused)
            return with_best_form(effects, found, from_there)
        except Refusal:
            count += 1
            if count >= TRIED:  # what is so large does not converge, whatever is in it
                most = len(effects) - 1
    return [], base
