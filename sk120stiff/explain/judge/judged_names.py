"""Names judged against the noise alone, else beside model-form error or one suspect."""

from __future__ import annotations

from collections.abc import Sequence

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.judge.adequacy import Adequacy, adequacy
from sk120stiff.explain.judge.attribution import MISSPECIFICATION, Named, judged
from sk120stiff.explain.judge.beside_form import (
    beside_model_form,
    unless_imitating,
)
from sk120stiff.explain.judge.beside_suspect import Account, account_beside
from sk120stiff.explain.select.best_selection import Try, held_against
from sk120stiff.explain.select.stepwise import Selection, refit
from sk120stiff.identify import Fit
from sk120stiff.identify.uncertainty.errors_of_poses import with_model_form
from sk120stiff.identify.uncertainty.variance_components import variance_components
from sk120stiff.measurements import NoiseModel

BY_CHANCE = 0.01  # up to this probability that noise of one size shows as much, it has no one size
LEFT_OVER = 0.2  # share of the named signature that may remain unexplained before a name is doubted


def judged_names(
    found: Selection, base: Fit, under: Try, *, seed: int
) -> tuple[Selection, Named, Account | None]:
    """The names that stand: against noise alone, else beside model-form error or one suspect.

    Args:
        found: What the search settled on.
        base: The base model, held against the noise of the readings.
        under: Makes a selection.
        seed: Of folds and resampling.
    """
    noise, at, standing = base.problem.noise, base, set[str]()
    if not found.final.exceeds:
        exactly = unless_imitating(*judged(found, seed=seed), seed)
        if _explains(*exactly, noise):
            return *_or_rough(exactly, base, under, seed), None
        at = held_against(noise, exactly[0].final)
        standing = {effect.id for effect in exactly[0].effects}
    drawn = [each for each in found.regression.candidates if each.random_effects]
    found, named = beside_model_form(at, under, names=standing, seed=seed)
    offsets = _beside_offsets(found, named, drawn, noise, under, seed)
    if offsets is not None:
        return *offsets, None
    account = account_beside(
        base,
        found,
        named,
        under=under,
        complete=lambda tried, _said, noise: (
            not tried.final.exceeds and not adequacy_of(tried, noise).lacking
        ),
        seed=seed,
    )
    if account is None or (_drawn(account.named) and adequacy_of(account.selection, noise).lacking):
        return found, named, None
    return account.selection, account.named, account


def _or_rough(
    exactly: tuple[Selection, Named], base: Fit, under: Try, seed: int
) -> tuple[Selection, Named]:
    """What stands against noise of one size, or beside model-form error where that is likelier.

    Where nobody said how large the noise is, an error that grows with the load may look like a
    cause: it is asked where such an error shows beyond chance.
    """
    known = exactly[0].base.problem.noise.known or base.problem.noise.known
    if known or variance_components(base).probability > BY_CHANCE:
        return exactly
    beside = beside_model_form(base, under, seed=seed)
    return min(exactly, beside, key=lambda each: each[0].total)


def _beside_offsets(
    found: Selection,
    named: Named,
    drawn: Sequence[Effect],
    noise: NoiseModel,
    under: Try,
    seed: int,
) -> tuple[Selection, Named] | None:
    """What stands where single poses have a constant of their own, and draws are named for it.

    Model-form error of that kind is what an offset of each pose is: the same number has a name.
    None where more than noise is left beside the draws, be it larger than stated.

    Args:
        found, named: What stands beside model-form error.
        drawn: Candidates that are draws of single poses.
        noise: Of the readings, as it was stated.
        under: Makes a selection.
        seed: Of folds and resampling.
    """
    form = found.final.problem.noise.form
    if not drawn or not form.constant:
        return None
    effects = [*(finding.effect for finding in named.findings), *drawn]
    try:
        at = held_against(noise, refit(found.base, effects))
    except Refusal:
        return None
    if with_model_form(at).form:
        return None
    tried = beside_model_form(at, under, names={each.id for each in effects}, seed=seed)
    return tried if _drawn(tried[1]) and not adequacy_of(tried[0], noise).lacking else None


def _explains(found: Selection, named: Named, noise: NoiseModel) -> bool:
    """Do these names leave no more than names may leave?"""
    left = adequacy_of(found, noise)
    if _drawn(named):
        return not left.lacking
    return not _too_much(left, MISSPECIFICATION if named.misspecified else LEFT_OVER)


def _drawn(named: Named) -> bool:
    """Has something a name whose values are draws of single poses?

    Draws take on part of any cause, and with a suspect beside them they explain everything: such
    names stand where they leave nothing by themselves.
    """
    return any(finding.effect.random_effects for finding in named.findings)


def _too_much(left: Adequacy, allowed: float) -> bool:
    """Is more left over than a name may leave?"""
    return left.lacking and left.excess > allowed * left.explained


def adequacy_of(found: Selection, noise: NoiseModel) -> Adequacy:
    """Tests of what the selection leaves, against the noise as it was stated."""
    return adequacy(held_against(noise, found.final), {effect.id for effect in found.effects})
