"""The search where the laws are not exact: names are judged against model-form error beside noise.

Where all that is found leaves more than the noise allows, no name can be held against the noise
alone: a search that takes every micrometre for a cause finds impostors, and one that asks for
agreement never says anything of a real arm. So the size of the model-form error is estimated from
what the model leaves, the search is made beside it, and the names that stand are put into the model
that the size is estimated from anew.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.judge.attribution import MARGIN, Fallen, Named, judged, with_the_strongest
from sk120stiff.explain.judge.imitation import imitated
from sk120stiff.explain.judge.outweighed import outweighed
from sk120stiff.explain.judge.posterior import NONE, one_more
from sk120stiff.explain.select.best_selection import Try
from sk120stiff.explain.select.stepwise import Selection, refit
from sk120stiff.identify import Fit
from sk120stiff.identify.uncertainty.errors_of_poses import with_model_form

ROUNDS = 3  # of estimating, searching and judging


def beside_model_form(
    at: Fit, under: Try, *, names: Collection[str] = (), seed: int
) -> tuple[Selection, Named]:
    """The selection beside model-form error, with the effects alone that may be named.

    What confirmed names explain is no model-form error: the search begins beside what they leave.
    Beside what springs alone leave a cause may drown in an error that holds the cause itself. So
    where nothing is named it begins once more beside what the nearest candidate leaves, unless it
    began beside that, and the likelier of both ends counts, its noise included.

    Args:
        at: Fit under the noise of the readings, of the base model with the effects that stand
            against the noise alone.
        under: Makes a selection under one noise model.
        names: Ids of these effects.
        seed: Of folds and resampling.
    """
    found, named = _settled(at, under, names, seed)
    nearest = None if named.findings else _nearest(found)
    if nearest is not None and nearest.id not in names:
        try:
            beside = _settled(refit(at, [nearest]), under, {nearest.id}, seed)
        except Refusal:
            beside = found, named
        if beside[0].total < found.total:
            found, named = beside
    stood = bool(named.findings)
    found, named = unless_imitating(found, named, seed)
    return _by_itself(found, named, seed) if stood and not named.findings else (found, named)


def _by_itself(found: Selection, named: Named, seed: int) -> tuple[Selection, Named]:
    """The likeliest candidate alone, where names that were found together have all fallen."""
    nearest = _nearest(found)
    if nearest is None or nearest.id in {each.id for each in named.fallen}:
        return found, named
    alone = judged(with_the_strongest(found, [nearest]), seed=seed, least=MARGIN)
    single, said = unless_imitating(*alone, seed)
    fallen = (*named.fallen, *said.fallen)
    return (single, Named(said.findings, fallen)) if said.findings else (found, named)


def _settled(at: Fit, under: Try, names: Collection[str], seed: int) -> tuple[Selection, Named]:
    """Selection and names, once what they leave is what they were sought beside.

    A round may take the noise for larger than stated; the next asks again whether it is. Where one
    set leads to another and that one back, what was confirmed beside its own model-form error is
    not lost: of those with names the likeliest counts.
    """
    before, ends = set(names), list[tuple[Selection, Named]]()
    for _ in range(ROUNDS):
        found, named = judged(under(with_model_form(at)), seed=seed, least=MARGIN)
        ends.append((found, named))
        now = {finding.effect.id for finding in named.findings}
        if now == before:
            return ends[-1]
        at, before = asked_anew(found.final, at), now
    return min(ends, key=lambda end: (not end[1].findings, end[0].total))


def _nearest(found: Selection) -> Effect | None:
    """The candidate that would explain most beside what is chosen."""
    likely = one_more(found.regression, found.chosen)
    likely.pop(NONE)
    best = max(likely, key=lambda name: likely[name], default=None)
    return next((each for each in found.regression.candidates if each.id == best), None)


def unless_imitating(found: Selection, named: Named, seed: int) -> tuple[Selection, Named]:
    """The same without names that imitate part of a cause that the catalogue lacks.

    They fall one at a time, the weakest first, and the others are judged anew; those that stand do
    so beside whatever is left.
    """
    effects = [finding.effect for finding in named.findings]
    alike = [finding.alternatives for finding in named.findings]
    reason = imitated(found.final, effects, alike) or outweighed(found, effects)
    if reason is None:
        return found, named
    kept = [effect for effect in effects if effect.id != reason[0]]
    found, again = judged(with_the_strongest(found, kept), seed=seed, least=MARGIN)
    fallen = (*named.fallen, Fallen(*reason), *again.fallen)
    return unless_imitating(found, Named(again.findings, fallen), seed)


def asked_anew(fit: Fit, at: Fit) -> Fit:
    """The fit with the size of its noise as well known as that of another."""
    noise = replace(fit.problem.noise, freedom=at.problem.noise.freedom)
    return replace(fit, problem=replace(fit.problem, noise=noise))
