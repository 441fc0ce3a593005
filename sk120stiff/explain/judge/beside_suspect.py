"""Names beside a cause that has none: one suspect joins the model with free factors of its own.

Where the laws of the catalogue leave something over, what is left may all go with one thing that
`localise` suspects: the load in axes of the base, the angle of a joint. As nuisance parameters of
the model it does for the foreign cause what no name can, and if nothing is left then beyond the
noise, the names that stand beside it were not asked to imitate it. Such an account is complete; it
takes the place of names that were judged beside an error of unknown form.

On a real arm seldom all goes with one thing. Where names, a suspect and a smaller error of unknown
form are likelier than names and the larger error, the names that stand beside both take that place
too: what imitated the part that has a place falls, what hid behind it shows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.regression import Regression, regression_at
from sk120stiff.explain.judge.attribution import (
    MARGIN,
    Fallen,
    Named,
    judged,
    with_the_strongest,
)
from sk120stiff.explain.judge.beside_form import unless_imitating
from sk120stiff.explain.judge.goes_with import GoesWith
from sk120stiff.explain.judge.nuisance import Nuisance, nuisance
from sk120stiff.explain.localise.places import line_up, look_at, ranked
from sk120stiff.explain.select.beam import beam_search
from sk120stiff.explain.select.best_selection import Try
from sk120stiff.explain.select.stepwise import Selection, refit
from sk120stiff.identify import Fit, fit, yardstick
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.uncertainty.errors_of_poses import with_model_form
from sk120stiff.measurements import NoiseModel

ROUNDS = 3  # of estimating what is left beside a suspect, searching and judging
WORTH = 6.0  # evidence (BIC) by which a suspect that leaves something has to win
TRIED = 1  # suspects, of those that come nearest to the gap of the springs and of the names
NARROW = 4  # models kept by the search that tells which suspect is worth a whole one
LEFT = 2.5  # times the noise's variance: what names may leave, before any law is exact
INSIDE = 0.3  # share of its length below which an effect is part of a suspect


@dataclass(frozen=True)
class Account:
    """Names, and the suspect beside which they leave nothing but noise, or little more.

    Attributes:
        selection: The names beside model-form error, without the suspect.
        named: What was said of each name, beside the suspect where that changed which stand.
        suspect: Completes the sentence "The gap goes with ...".
        beside: The names with the suspect in the model.
        left: Beside it beyond the noise, rms per axis [m]; zero: nothing.
    """

    selection: Selection
    named: Named
    suspect: str
    beside: Selection
    left: float = 0.0

    def goes_with(self, rms: float) -> GoesWith:
        """What the remainder goes with, and what of its size [m] is left beside that."""
        share = min(self.left / _form_of(self.selection.final), 1.0) if self.left else 0.0
        return GoesWith(self.suspect, share * rms, rms, bool(self.named.findings))


def _form_of(fit: Fit) -> float:
    """The model-form error that a fit stands beside, rms per axis [m]."""
    return fit.problem.noise.form.rms(fit.problem.measurements)


def _left_by(fit: Fit) -> float:
    """The same, estimated from what the fit leaves; where that shows no structure, as it stands."""
    found = with_model_form(fit).form.rms(fit.problem.measurements)
    return found or _form_of(fit)


@dataclass(frozen=True)
class _Told:
    """What is named beside one suspect.

    Attributes:
        suspect: The suspect, as parameters of the base model.
        found, named: Selection and names beside it.
        total: Score of the whole, noise and choice of the suspect included.
        complete: Nothing is left beyond the noise.
    """

    suspect: Nuisance
    found: Selection
    named: Named
    total: float
    complete: bool


def account_beside(
    at: Fit,
    found: Selection,
    named: Named,
    *,
    under: Try,
    complete: Callable[[Selection, Named, NoiseModel], bool],
    seed: int,
) -> Account | None:
    """The likeliest account by names and one suspect that tells all or most; None: there is none.

    A suspect that holds a name, or is the free form of a candidate's law, says what that says. It
    is not tried. Only the one with which names explain most may leave noise alone, and goes before
    any that leaves more then. Where only the account itself tells the noise, that it leaves nothing
    beyond that noise is no reason to say nothing, and neither is one that leaves more: names stand
    against an account without any.

    Args:
        at: Fit of the base model under the noise of the readings.
        found, named: What was named beside model-form error.
        under: Makes a selection.
        complete: Nothing is left that this noise does not explain.
        seed: Of folds and resampling.
    """
    fits = [at, found.final, *_with_the_last_fallen(found, named)]
    suspects = {name: nuisance(name, at) for name in _nearest(fits, found)}
    names = [finding.effect for finding in named.findings]
    scores = {
        name: _at_best(at, each, found.regression)
        for name, each in suspects.items()
        if not any(_holds(each, known, found) for known in names)
    }
    partial: list[_Told] = []
    for place, name in enumerate(sorted(scores, key=lambda name: scores[name])):
        exact = place == 0 and scores[name] < np.inf
        told = _beside(suspects[name], at, found, named, under, complete if exact else None, seed)
        if told is not None and told.complete:
            return _accounted(told, at, found, named, under, seed)
        partial += [] if told is None else [told]
    told = min(partial, key=lambda each: each.total, default=None)
    return None if told is None else _accounted(told, at, found, named, under, seed)


def _accounted(
    told: _Told, at: Fit, without: Selection, named: Named, under: Try, seed: int
) -> Account | None:
    """The account with the names that imitate nothing beside its suspect.

    Where these are those that stand without it, only where the rest lives is told with it.
    """
    suspect = told.suspect.suspect
    try:
        beside_it, said = unless_imitating(told.found, told.named, seed)
        left = 0.0 if told.complete else _left_by(beside_it.final)
        if not told.complete and _names(said) == _names(named):
            return Account(without, named, suspect, beside_it, left)
        effects = [finding.effect for finding in said.findings]
        beside = under(with_model_form(refit(at, effects)))
    except Refusal:
        return None
    kept = with_the_strongest(beside, effects)
    stand = {effect.id for effect in kept.effects}
    findings = tuple(each for each in said.findings if each.effect.id in stand)
    if named.findings and not findings and not (at.sigma_known and told.complete):
        return None
    fallen = (*_fallen(named, stand, suspect), *said.fallen)
    return Account(kept, Named(findings, fallen), suspect, beside_it, left)


def _beside(
    suspect: Nuisance,
    at: Fit,
    without: Selection,
    named: Named,
    under: Try,
    complete: Callable[[Selection, Named, NoiseModel], bool] | None,
    seed: int,
) -> _Told | None:
    """What is named beside a suspect; None where it does no better than model-form error alone.

    Where more is left than the noise that was stated, and it has no structure, σ was understated:
    its size is let free. Where what is left has structure, it is model-form error once more, of
    another size, and what is named goes on with it until both stay (as in `beside_form.py`).

    Args:
        suspect: As parameters of the base model.
        at: Fit of the base model under the noise of the readings.
        without, named: What is named beside model-form error alone.
        under: Makes a selection.
        complete: Nothing is left that this noise does not explain; None: that is not asked.
        seed: Of folds and resampling.
    """
    noise, ends, before = at.problem.noise, list[_Told](), _names(named)
    try:
        if complete is None:
            noise = with_model_form(_with_suspect(suspect, at, without.effects))
        for _ in range(ROUNDS):
            if complete is None and not noise.form:
                break
            tried = under(noise, suspect)
            if noise.form and tried.searched + suspect.price > without.searched - WORTH:
                break
            least = MARGIN if noise.form else -np.inf
            found, said = judged(tried, seed=seed, least=least, unless_exceeding=not noise.form)
            if not noise.form and complete is not None and complete(found, said, noise):
                return _Told(suspect, found, said, found.total + suspect.price, complete=True)
            if noise.form:
                total = found.total + suspect.price
                ends.append(_Told(suspect, found, said, total, complete=False))
                if _names(said) == before:
                    break
                before = _names(said)
            noise = with_model_form(found.final)
            if not noise.form and not at.problem.noise.known:
                break
    except Refusal:
        return None
    better = [each for each in ends if each.total < without.total - WORTH]
    return min(better, key=lambda each: (not each.named.findings, each.total), default=None)


def _with_suspect(suspect: Nuisance, at: Fit, effects: Sequence[Effect]) -> Fit:
    """Fit of the base model, a suspect and effects."""
    problem = at.problem
    base = fit(at.model + suspect, problem.measurements, noise=problem.noise)
    return refit(base, effects) if effects else base


def _names(named: Named) -> set[str]:
    return {finding.effect.id for finding in named.findings}


def _holds(suspect: Nuisance, effect: Effect, found: Selection) -> bool:
    """Does a suspect do what an effect does, beyond what the base model can?"""
    regression, problem = found.regression, found.final.problem
    load_cases = problem.load_cases
    read = np.swapaxes(load_cases.reading_axes, 1, 2) @ suspect.offsets(load_cases)
    place = next(e for e, each in enumerate(regression.candidates) if each.id == effect.id)
    base = orthonormal(regression.X[:, regression.base])
    own, free = regression.X[:, regression.columns[place]], problem.whitener.apply(read)
    own, free = own - base @ (base.T @ own), free - base @ (base.T @ free)
    inside = orthonormal(free)
    left = own - inside @ (inside.T @ own)
    return bool((left**2).sum() < INSIDE**2 * (own**2).sum())


def _with_the_last_fallen(found: Selection, named: Named) -> list[Fit]:
    """The fit with the name that stood longest: beside it a suspect may show that hides without.

    A name that fell and came back in another's place is in the fit already.
    """
    inside = {each.id for each in found.effects}
    last = {each.id for each in named.fallen[-1:]} - inside
    effects = [each for each in found.regression.candidates if each.id in last]
    try:
        return [refit(found.base, [*found.effects, *effects])] if effects else []
    except Refusal:
        return []


def _nearest(fits: Sequence[Fit], found: Selection) -> list[str]:
    """Suspects that come nearest to what each fit leaves: of springs, of names."""
    free = {name for e in found.regression.candidates for name in (e.id, e.name)}
    out: list[str] = []
    for each in fits:
        look = look_at(each, yardstick(each))
        lineup = line_up(look)
        order = [k for _, k in ranked(look, lineup, look.inside)]
        allowed = [
            lineup.suspects[k].name for k in order if not free & set(lineup.suspects[k].frees)
        ]
        out += [name for name in allowed[:TRIED] if name not in out]
    return out


def _at_best(at: Fit, beside: Nuisance, candidates: Regression) -> float:
    """Score of the best names beside a suspect, infinite where they leave far more than noise."""
    try:
        base = _with_suspect(beside, at, ())
    except Refusal:
        return float(np.inf)
    ids = [effect.id for effect in base.model.effects]
    regression = regression_at(
        base, candidates.candidates, ids,
        alpha=candidates.alpha, prior=candidates.prior, soft=candidates.soft,
    )  # fmt: skip
    best = beam_search(regression, width=NARROW)[0]
    left = best.solved.rss / max(regression.rows - len(best.solved.columns), 1)
    return float(np.inf) if regression.sigma_known and left > LEFT else best.score + beside.price


def _fallen(named: Named, stand: set[str], suspect: str) -> tuple[Fallen, ...]:
    """Why names no longer stand, and why others never did."""
    before = tuple(each for each in named.fallen if each.id not in stand)
    return before + tuple(
        Fallen(
            finding.effect.id,
            f"{finding.effect.id} fits, but beside {suspect} nothing is left for it; it is not "
            "named.",
        )
        for finding in named.findings
        if finding.effect.id not in stand
    )
