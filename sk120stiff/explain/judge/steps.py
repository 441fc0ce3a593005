"""The gap with every effect that joins the model, on fitted and on held-out poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.effects import Effect, load_cases_of
from sk120stiff.errors import InputError, Refusal
from sk120stiff.explain.candidates.linearised import Linearised
from sk120stiff.explain.candidates.regression import regression_at
from sk120stiff.explain.findings import Step
from sk120stiff.explain.judge.beside_form import asked_anew
from sk120stiff.explain.judge.goes_with import Foretold, foretold
from sk120stiff.explain.judge.nuisance import nuisance_of
from sk120stiff.explain.localise.suspects import suspect_named
from sk120stiff.explain.select.beam import beam_search
from sk120stiff.explain.select.form import from_there, with_best_form
from sk120stiff.explain.select.own_sizes import with_settled_sizes
from sk120stiff.explain.select.stepwise import Selection, laws_of, refit, with_own_sizes
from sk120stiff.identify import Fit, Learn, Problem, fit, held_out
from sk120stiff.identify.estimate import fit_displacements
from sk120stiff.identify.uncertainty.errors_of_poses import with_model_form
from sk120stiff.measurements import Measurements

TRIED = 6  # sets whose fit may be refused before springs alone have to do
NARROW = 4  # models kept at each size of a search in one part: it is there to choose, not to rank


def gap_steps(
    found: Selection, effects: Sequence[Effect], holdout: Measurements | None, *, seed: int
) -> tuple[Step, ...]:
    """The base model, then one effect more at each step.

    Halfway, where an effect is still missing, a fit may have no answer; that step is told together
    with the next.

    Args:
        found: The base model, its readings, and the effects that were considered.
        effects: In the order in which they were added.
        holdout: Readings of other poses; without them poses are left out of the fit in turn.
        seed: Of the parts in which poses are left out.
    """
    fits: list[Fit] = []
    counts: list[int] = []
    labels: list[str] = []
    joined: list[str] = []
    for count in range(len(effects) + 1):
        if count:
            joined.append(f"+ {effects[count - 1].id}")
        try:
            fits.append(with_settled_sizes(refit(found.base, effects[:count], *fits[-1:])))
        except Refusal:
            if count == len(effects):
                raise
            continue
        counts.append(count)
        labels.append(" ".join(joined) if count else _base_name(found.base))
        joined.clear()
    if holdout is None:
        held = on_poses_left_out(found, counts, seed)
    else:
        held = [_on_file(each, holdout) for each in fits]
    return tuple(
        Step(label, each.rms, error) for label, each, error in zip(labels, fits, held, strict=True)
    )


def foretold_beside(beside: Selection, count: int, without: float, *, seed: int) -> Foretold | None:
    """What poses left out of the fit say of a suspect; None where they do not hold the model.

    Args:
        beside: Names beside the suspect.
        count: How many names there are.
        without: Gap on these poses with the names alone, rms per axis [m].
        seed: Of the parts in which poses are left out.
    """
    (gap,) = on_poses_left_out(beside, [count], seed)
    return foretold("Poses that are left out are", gap, without)


def foretold_on_file(
    found: Selection,
    beside: Selection,
    name: str,
    effects: Sequence[Effect],
    holdout: Measurements,
    without: float,
) -> Foretold | None:
    """What a hold-out file says of a suspect; None where that is of these readings' clock.

    Its columns are those of both files together: it may be scaled by the largest load of all.

    Args:
        found, beside: Names without the suspect, and beside it.
        name: That of the suspect.
        effects: The names.
        holdout: Readings of other poses.
        without: Gap on them with the names alone, rms per axis [m].
    """
    base, noise = found.base, beside.final.problem.noise
    readings = base.problem.measurements
    other = holdout.masked()
    other = replace(other, pose=tuple(f"hold-out {label}" for label in other.pose))
    try:
        both = load_cases_of(base.model.robot, readings + other)
        suspect = suspect_named(name, base.model, both)
        if suspect is None or suspect.family in ("series", "change"):
            return None
        model = base.model + nuisance_of(suspect, base.model, both)
        with_it = fit(model, readings, noise=noise)
        gap = _on_file(refit(with_it, effects) if effects else with_it, holdout)
    except (InputError, Refusal):  # of other points or joints; or they do not hold the model
        return None
    return foretold("The readings of the hold-out file are", gap, without)


def nested(found: Selection, counts: Sequence[int]) -> Learn:
    """Learning as `explain` learns: noise, effects and values from the readings at hand alone.

    It gives the base model, and for every count the best model with so many effects at most; the
    names need not be those that all readings bring. Beside laws that are not exact, the search is
    made once more beside the model-form error that the largest of its first models leaves.
    """
    start, alpha = found.base.problem.model, found.regression.alpha
    ids = [effect.id for effect in start.effects]
    whole = found.base.problem.noise

    def searched(
        base: Fit, counts: Sequence[int], near: Linearised | None = None, about: Fit | None = None
    ) -> tuple[list[Fit], Linearised | None]:
        if not any(counts):
            return [with_settled_sizes(base)] * len(counts), near
        regression = regression_at(
            base, found.candidates, ids,
            alpha=alpha, prior=found.regression.prior, soft=found.regression.soft, near=near,
        )  # fmt: skip
        base, regression = with_own_sizes(base, regression)
        ranked = beam_search(regression, width=NARROW, max_effects=max(counts))
        return [
            _first_fit(
                base, [laws_of(regression, m) for m in ranked if len(m.effects) <= count], about
            )
            for count in counts
        ], regression.linearised

    def beside_what_is_left(
        at: Fit, counts: Sequence[int], near: Linearised | None = None, about: Fit | None = None
    ) -> tuple[list[Fit], Linearised | None]:
        base = fit(start, at.problem.measurements, noise=with_model_form(at))
        return searched(base, counts, near, about)

    def learn(readings: Measurements) -> list[Fit]:
        base = fit_displacements(start, readings)
        if not whole.form and (whole.known or not base.sigma_known):  # laws that are exact
            return searched(base, counts)[0]
        once, near = beside_what_is_left(base, counts)
        if not any(counts):
            return once
        most = once[int(np.argmax(counts))]
        again, _ = beside_what_is_left(asked_anew(most, base), counts, near, most)
        return [
            second if count else first
            for count, first, second in zip(counts, once, again, strict=True)
        ]

    return learn


def _first_fit(base: Fit, choices: Sequence[Sequence[Effect]], about: Fit | None) -> Fit:
    """The first of some sets of effects that can be fitted at exact equilibrium.

    Values are sought about those of a fit to the same readings, if there is one with such effects.
    """
    for effects in choices[:TRIED]:
        ids = {effect.id for effect in effects}
        held = about is not None and ids <= {effect.id for effect in about.model.effects}
        try:
            found = refit(base, effects, about if held else None)
            return with_settled_sizes(with_best_form(effects, found, from_there)[1])
        except Refusal:
            continue
    return with_settled_sizes(base)


def _base_name(base: Fit) -> str:
    """Names of the base model's effects, each once."""
    return " + ".join(dict.fromkeys(effect.name for effect in base.model.effects))


def _on_file(found: Fit, holdout: Measurements) -> float:
    """Gap on a hold-out file, per axis [m]."""
    other = Problem(found.model, holdout.masked(), found.problem.noise)
    gap = other.measured - found.model.predict(other.load_cases.of_another_file)
    return rms(gap)


def on_poses_left_out(found: Selection, counts: Sequence[int], seed: int) -> list[float]:
    """Gap on poses left out in turn, per axis [m]; NaN where the others do not hold the model."""
    try:
        errors = held_out(found.base.problem.measurements, nested(found, counts), seed=seed)
    except (InputError, Refusal):
        return [float("nan")] * len(counts)
    return [error.rms for error in errors]
