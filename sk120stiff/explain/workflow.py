"""Fit becomes an `Explanation`: search, tell apart, confirm, add, judge what is left."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np

from sk120stiff.effects import CATALOGUE, Catalogue
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.explain.adequacy import Adequacy, adequacy
from sk120stiff.explain.best_attempt import best_attempt, held_against
from sk120stiff.explain.consequences import completed
from sk120stiff.explain.doubt import with_doubt
from sk120stiff.explain.explanation import Explanation
from sk120stiff.explain.naming import SHADOW, Named, judged
from sk120stiff.explain.settling import Attempt, attempt, with_effects
from sk120stiff.explain.steering import Options, candidates_for, with_assumed
from sk120stiff.explain.steps import gap_steps
from sk120stiff.identify import refuse_unusable
from sk120stiff.measurements import Measurements, NoiseModel, decided
from sk120stiff.measurements import candidates as noise_candidates
from sk120stiff.model import Model
from sk120stiff.slips import look, refuse_unbelievable, without_copies

LEFT_OVER = 0.2  # share of the named signature that may remain unexplained before a name is doubted

Progress = Callable[[str, float], None]


def explain(
    model: Model,
    measurements: Measurements,
    *,
    holdout: Measurements | None = None,
    options: Options | None = None,
    catalogue: Catalogue = CATALOGUE,
    progress: Progress | None = None,
) -> Explanation:
    """Find where model and readings disagree, name what is missing, add it, judge the rest.

    Parameters
    ----------
    model
        The base model; its effects are part of every model considered.
    measurements
        Readings to be explained.
    holdout
        Readings of other poses, kept out of everything; the gap on them is reported.
    options
        How the search is steered.
    catalogue
        The effects that may be missing, ``CATALOGUE + Mine`` with your own.
    progress
        Called with a phrase and a share of the work done.

    Raises
    ------
    InputError
        No displacements, too few readings, one pose alone, or an effect that does not exist.
    Refusal
        The data look written down wrongly, they contradict their stated uncertainty, or the base
        model itself cannot be fitted.

    Examples
    --------
    >>> import sk120stiff as sk
    >>> readings = sk.read(sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv")
    >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
    >>> answer.verdict
    'none'
    """
    wish = options or Options()
    tell = progress or _silent
    _refuse_unexplainable(model, measurements)
    sound = _sound(model, measurements)
    used, rows = sound.masked(), np.flatnonzero(sound.use)
    tell("searching the catalogue", 0.05)
    found, noise = _best_attempt(model, used, wish, catalogue)
    left = _adequacy(found, noise)
    named = Named()
    allowed = LEFT_OVER
    if not _too_much(left, allowed):
        tell("confirming on other poses", 0.5)
        found, named = judged(found, seed=wish.seed)
        left = _adequacy(found, noise)
        if named.shadows:
            allowed = SHADOW
    findings = named.findings
    reasons = (*decided(noise, used), *left.of_the_statement())
    base = held_against(noise, found.base)
    if _too_much(left, allowed):
        nearest = [effect.id for effect in found.effects]
        return _finished(
            with_effects(found, []),
            Explanation(
                verdict="outside",
                findings=(),
                base=base,
                final=base,
                steps=gap_steps(found, (), holdout, seed=wish.seed),
                noise=noise,
                noise_reasons=reasons,
                set_aside=tuple(rows[found.aside].tolist()),
                readings=measurements,
                adequacy=left,
                unnamed=named.reasons,
                limits=wish.limits,
                suspects=tuple(dict.fromkeys([*nearest, *named.doubted])),
                catalogue=catalogue,
            ),
            wish,
        )
    if not findings:
        left.refuse_contradicted(str(measurements.path or "the measurements"))
    tell("the gap step by step", 0.7)
    effects = [finding.effect for finding in findings]
    settled = all(finding.settled for finding in findings)
    answer = Explanation(
        verdict="none" if not findings else "named" if settled else "ambiguous",
        findings=findings,
        base=base,
        final=held_against(noise, with_doubt(found, findings)),
        steps=gap_steps(found, effects, holdout, seed=wish.seed),
        noise=noise,
        noise_reasons=reasons,
        set_aside=tuple(rows[found.aside].tolist()),
        readings=measurements,
        adequacy=left,
        unnamed=named.reasons,
        limits=wish.limits,
        catalogue=catalogue,
    )
    tell("what these readings cannot tell", 0.85)
    return _finished(found, answer, wish)


def _refuse_unexplainable(model: Model, measurements: Measurements) -> None:
    refuse_unusable(model, measurements)
    if len(measurements.masked().poses) < 2:
        raise InputError(
            "readings of one pose alone cannot be explained: no other pose can confirm a name",
            where=str(measurements.path or "measurements"),
            remedy="Measure at two poses or more; springs alone come from 'sk120stiff identify'.",
        )


def _best_attempt(
    model: Model, measurements: Measurements, wish: Options, catalogue: Catalogue
) -> tuple[Attempt, NoiseModel]:
    """The attempt that explains most, and the noise that it is held against."""
    base_model = with_assumed(model, measurements, wish.assume, catalogue)
    candidates = candidates_for(base_model, measurements, wish, catalogue)
    plain = tuple(effect for effect in candidates if not effect.exchangeable)
    undescribed = len({noise.zero for noise in noise_candidates(measurements)}) > 1

    def under(chosen: NoiseModel) -> Attempt:
        # Constants of single poses are what a shared zero brings; it need not have been separate.
        return attempt(
            base_model,
            measurements,
            chosen,
            plain if undescribed and chosen.zero == "separate" else candidates,
            max_effects=wish.max_effects,
            alpha=wish.alpha,
        )

    return best_attempt(measurements, under)


def _sound(model: Model, measurements: Measurements) -> Measurements:
    """The readings with copied rows masked, once nothing in them looks like a slip of the pen."""
    doubts = look(model, measurements)
    refuse_unbelievable(doubts, model, measurements)
    doubts.refuse_to_explain(str(measurements.path or "the measurements"))
    for said in doubts.sentences:
        warnings.warn(said, ToolkitWarning, stacklevel=3)
    single, told = without_copies(measurements)
    if told:
        warnings.warn(told, ToolkitWarning, stacklevel=3)
    return single


def _silent(phrase: str, share: float) -> None:
    """No one wants to know."""
    del phrase, share


def _adequacy(found: Attempt, noise: NoiseModel) -> Adequacy:
    final = held_against(noise, found.final)
    return adequacy(final, found.regression, found.scored.solved.columns)


def _too_much(left: Adequacy, allowed: float) -> bool:
    """Is more left over than a name may leave?"""
    return left.lacking and left.excess > allowed * left.explained


def _finished(found: Attempt, answer: Explanation, wish: Options) -> Explanation:
    return completed(answer, found.regression, seed=wish.seed)
