"""What a user brought, much softer than is customary: a foundation on wheels, a tool on rubber.

How soft a part of an arm may be, its maker's trade tells. What a user stands it on, or puts on its
flange, may be softer by decades; but a cause of any size would stand for much of what every arm has
beyond its laws. So it is looked for within what is customary, unless little else would do: its size
lies beyond, and without that by far more is left, or it takes more causes to leave as little.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.linearised import Linearised
from sk120stiff.explain.candidates.regression import Regression, regression_at
from sk120stiff.explain.select.beam import beam_search
from sk120stiff.explain.select.score import Scored, score_set
from sk120stiff.explain.select.stepwise import Selection, laws_of, refit
from sk120stiff.identify import Fit
from sk120stiff.model import Parameter

BY_FAR = 2.0  # times the squares that are left, within what is customary
DECISIVE = 10.0  # difference of scores (BIC: Kass & Raftery 1995) that it takes besides
KNOWN = 2.0  # standard errors from which on a size is told for being out of line
NARROW = 4  # models kept at each size of the search
MOST = 3  # effects of a model: the soft part, and what is seen beside it


def brought(
    base: Fit,
    candidates: Sequence[Effect],
    *,
    alpha: float,
    prior: Mapping[str, float] | None = None,
) -> tuple[frozenset[str], Linearised | None]:
    """Ids of those candidates that are softer than is customary, and sensitivities at the fit.

    Args:
        base: Fit of the base model.
        candidates: Effects that may be missing.
        alpha, prior: See `Regression`.
    """
    some = frozenset(e.id for e in candidates if any(spec.customary for spec in e.parameters))
    ids = [effect.id for effect in base.model.effects]
    asked = partial(regression_at, alpha=alpha, prior=prior)
    usual = asked(base, candidates, ids)
    near, at = usual.linearised, base
    softer: frozenset[str] = frozenset()
    for exact in (False, True):
        wide = asked(at, candidates, ids, soft=some, near=usual.linearised)
        if not _any_beyond(usual, wide, some):
            return frozenset(), near
        best = _best(wide)
        softer = some & {wide.candidates[e].id for e in best.effects if _beyond(usual, best, e)}
        if exact or not softer:
            break
        try:  # where the base model has to do with springs alone, all of them look soft
            at = refit(base, laws_of(wide, best))
        except Refusal:
            return frozenset(), near
        usual = asked(at, candidates, ids)
    if not softer:
        return softer, near
    within = _best(usual)
    far = within.solved.rss > BY_FAR * best.solved.rss or len(within.effects) > len(best.effects)
    return softer if far and within.score > best.score + DECISIVE else frozenset(), near


def _best(regression: Regression) -> Scored:
    return beam_search(regression, width=NARROW, max_effects=MOST)[0]


def _any_beyond(usual: Regression, wide: Regression, some: Collection[str]) -> bool:
    """Would one of some candidates, alone beside the springs, be softer than is believed?"""
    places = [e for e, each in enumerate(wide.candidates) if each.id in some]
    return any(_beyond(usual, score_set(wide, wide.sums(), (e,)), e) for e in places)


def _beyond(usual: Regression, model: Scored, effect: int) -> bool:
    """Is a value of an effect beyond what is believed of its like?"""
    solved = model.solved
    own = np.isin(solved.columns, usual.variants[effect][model.by_variant[effect]])
    return bool((np.abs(solved.values) > usual.believed(solved))[own].any())


@dataclass(frozen=True)
class SoftRivals:
    """Soft foundations or tools that would do in the place of names.

    Attributes:
        regression: The readings, with all sizes of such parts believed.
        best: Place of a name among the candidates → the model with the soft part instead, and its
            place.
        named: Score of the model with the names.
    """

    regression: Regression
    best: Mapping[int, tuple[Scored, int]]
    named: float


def soft_rivals(found: Selection) -> SoftRivals | None:
    """What would do as well as a name, were it far softer than is customary; None: nothing."""
    regression = found.regression
    some = frozenset(e.id for e in found.candidates if any(s.customary for s in e.parameters))
    named = [e for e in found.chosen if regression.candidates[e].id not in some]
    tried = [
        e
        for e, each in enumerate(regression.candidates)
        if each.id in some and e not in found.chosen
    ]
    if not named or not tried:
        return None
    wide = regression_at(
        found.final,
        found.candidates,
        [effect.id for effect in found.base.model.effects],
        alpha=regression.alpha,
        prior=regression.prior,
        soft=regression.soft | some,
        near=regression.linearised,
    )
    best: dict[int, tuple[Scored, int]] = {}
    sums, now = wide.sums(), found.scored.score
    for name in named:
        rest = [e for e in found.chosen if e != name]
        start = {e: k for e, k in found.scored.by_variant.items() if e != name}
        instead = [(score_set(wide, sums, (*rest, e), start=start), e) for e in tried]
        model, soft = min(instead, key=lambda each: each[0].score)
        if model.score < now + DECISIVE and _beyond(regression, model, soft):
            best[name] = model, soft
    return SoftRivals(wide, best, now) if best else None


def softer_instead(rivals: SoftRivals | None) -> dict[str, str]:
    """Names in whose place a soft foundation or tool would do as well → that, in a sentence.

    What is customary goes before what is not. But a user knows what hangs on the flange, and
    nothing in the readings does.
    """
    told: dict[str, str] = {}
    if rivals is None:
        return told
    wide = rivals.regression
    for name, (best, soft) in rivals.best.items():
        far = best.score < rivals.named - DECISIVE
        of = wide.candidates[name].id
        told[of] = _instead(
            wide, best, soft, of, "would explain far more" if far else "would do as well"
        )
    return told


def _instead(wide: Regression, best: Scored, soft: int, name: str, does: str) -> str:
    """That a soft part would do in place of a name, by its softest value."""
    variant = best.by_variant[soft]
    law, columns = wide.laws[soft][variant], wide.variants[soft][variant]
    values = dict(zip(best.solved.columns.tolist(), best.solved.values.tolist(), strict=True))
    softest = max(  # one column may stand for several parameters that are alike
        ((values.get(c, 0.0) * s.typical / (s.customary or np.inf), values.get(c, 0.0), s)
         for c, s in zip(columns.tolist(), law.parameters, strict=False)),
        key=lambda each: each[0],
    )  # fmt: skip
    _, value, spec = softest
    return (
        f"{law.id} {does} in place of {name}, far softer than is customary "
        f"({spec.name} {spec.public(value * spec.typical):.2g} {spec.unit}): make sure that what "
        f"was put on, or stands below, is not as soft. '--exclude {name}' shows it."
    )


def softer_than_customary(final: Fit, soft: Collection[str]) -> list[str]:
    """That causes that had to be so `soft` are, one sentence for each, by its softest value."""
    softest: dict[str, Parameter] = {}
    for p in final.parameters:
        if p.effect.id in soft and _times(p) > 1.0 and _is_known(p):
            known = softest.get(p.effect.id)
            if known is None or _times(p) > _times(known):
                softest[p.effect.id] = p
    return [
        f"{p.name} = {p.value:.3g} {p.spec.unit} is softer than is customary, which is "
        f"{p.spec.public(p.spec.customary or 0.0):.2g} and more: as on wheels or rubber. Little "
        "else would explain these readings."
        for p in softest.values()
    ]


def _is_known(p: Parameter) -> bool:
    """Is a size more than what its error may be?"""
    return p.internal_std is None or p.internal > KNOWN * p.internal_std


def _times(p: Parameter) -> float:
    """How many times softer than is customary a value is; 0 where that is no question."""
    return p.internal / p.spec.customary if p.spec.customary else 0.0
