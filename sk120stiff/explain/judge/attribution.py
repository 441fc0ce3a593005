"""Which of the chosen effects may be named, beside which alternatives, on what evidence."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.aliases import aliases_by_design, exact_aliases
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.findings import Evidence, Finding
from sk120stiff.explain.judge.confirm import UNTRIED, confirm, unconfirmed
from sk120stiff.explain.judge.misspecified import stronger
from sk120stiff.explain.judge.posterior import posterior
from sk120stiff.explain.judge.random_effects import is_constant, joint_that_turns
from sk120stiff.explain.select.beam import exchanged, in_its_place
from sk120stiff.explain.select.score import Scored, score_set, unit
from sk120stiff.explain.select.stepwise import Selection, laws_of, with_effects

MARGIN = 6.0  # difference of scores below which two names cannot be told apart
MISSPECIFICATION = 0.35  # of what is explained that may be left where a law of one gear fell
MOST_NAMES = 8  # one answer may list; with more of them it says nothing
MOST_PLACES = 3  # the same beside model-form error, part of which fits at many places
EVEN = 0.5  # probability of a name below which it is none, and of chance above which it is that
SOME = 0.05  # share of the drawings of the poses from which on a law of the same gear counts
NUMBER = re.compile(r"\d+(\.\d+)?")


@dataclass(frozen=True)
class Fallen:
    """An effect that fits and may not be named.

    Attributes:
        id: ``name:where``.
        reason: Why, in a sentence.
        misspecification: It only mends the law of a stronger effect; else other poses do not
            confirm it.
        refuted: Poses left out, or drawn again, were asked and did not confirm it.
    """

    id: str
    reason: str
    misspecification: bool = False
    refuted: bool = False


@dataclass(frozen=True)
class Named:
    """What came of the chosen effects.

    Attributes:
        findings: Effects that may be named, in the order of their weight.
        fallen: Those that may not, the weakest last.
    """

    findings: tuple[Finding, ...] = ()
    fallen: tuple[Fallen, ...] = ()

    @property
    def doubted(self) -> tuple[str, ...]:
        """Ids of effects that other poses do not confirm."""
        return tuple(each.id for each in self.fallen if not each.misspecification)

    @property
    def misspecified(self) -> tuple[str, ...]:
        """Ids of effects that only mend the law of a stronger one."""
        return tuple(each.id for each in self.fallen if each.misspecification)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why these are not named, in sentences; where one fell on the same ground again, the last.

        Grounds differ by more than their numbers. What is in the set of a name is not said to have
        fallen.
        """
        told = {each.effect.id for each in self.findings}
        told |= {name for each in self.findings for name in each.alternatives}
        said: dict[tuple[str, str], str] = {}
        for each in self.fallen:
            if each.id in told:
                continue
            ground = each.id, NUMBER.sub("", each.reason)
            said.pop(ground, None)
            said[ground] = each.reason
        return tuple(said.values())


def judged(
    found: Selection, *, seed: int, least: float = -np.inf, unless_exceeding: bool = False
) -> tuple[Selection, Named]:
    """The selection with those effects alone that may be named, and what was said of each.

    Where some may not, the weakest of them falls, and the others are judged anew without it: names
    that overlap spoil each other's evidence, and theirs is that of the model that is written.

    Args:
        found: The selection.
        seed: Of folds and resampling.
        least: Gain of score that an effect has to bring.
        unless_exceeding: Nothing need be said of names that leave more than the noise.
    """
    fallen: list[Fallen] = []
    while True:
        found = _of_better_evidence(found, {each.id for each in fallen})
        if unless_exceeding and found.final.exceeds:
            return found, Named((), tuple(fallen))
        refuted = {each.id for each in fallen if each.refuted}
        findings, weakest = findings_of(found, seed=seed, least=least, refuted=refuted)
        if weakest is None:
            return found, Named(findings, tuple(fallen))
        fallen.append(weakest)
        kept = [e for e in _in_order(found) if e.id != weakest.id]
        found = with_the_strongest(found, kept)


def _of_better_evidence(found: Selection, fallen: Collection[str]) -> Selection:
    """The selection with another name in the place of one, where it explains more now."""
    regression = found.regression
    barred = [e for e, each in enumerate(regression.candidates) if each.id in fallen]
    better = exchanged(regression, found.scored, barred)
    if better.effects == found.scored.effects:
        return found
    try:
        return with_effects(found, laws_of(regression, better))
    except Refusal:
        return found


def _in_order(found: Selection) -> list[Effect]:
    """The chosen effects, the strongest first."""
    return [found.regression.candidates[e] for e in by_weight(found.regression, found.scored)]


def with_the_strongest(found: Selection, effects: list[Effect]) -> Selection:
    """The selection with these effects, or with as many of the strongest as a fit holds."""
    while True:
        try:
            return with_effects(found, effects)
        except Refusal:
            effects = effects[:-1]


def findings_of(
    found: Selection, *, seed: int, least: float = -np.inf, refuted: Collection[str] = ()
) -> tuple[tuple[Finding, ...], Fallen | None]:
    """Judge the chosen effects, each beside all the others, from the weakest up.

    Args:
        found: The selection.
        seed: Of folds and resampling.
        least: Gain of score that an effect has to bring.
        refuted: Ids of effects that other poses did not confirm: they speak for no set.

    Returns:
        findings, weakest: All effects in the order of their weight, and the weakest that may not be
            named: what is stronger is not confirmed then, since it will be judged anew.
    """
    order = by_weight(found.regression, found.scored)
    findings = [_finding(found, effect) for effect in order]
    for place in reversed(range(len(order))):
        objection = _objection(found, findings, place, least, refuted)
        if objection is None:
            findings[place] = _confirmed(found, order[place], findings[place], seed)
            said = findings[place].evidence.confirmation
            if said.holds and (found.regression.sigma_known or said.chance < EVEN):
                continue
            said_why = unconfirmed(findings[place])
            objection = Fallen(findings[place].effect.id, said_why, refuted=True)
        return tuple(findings), objection
    return tuple(findings), None


def _objection(
    found: Selection,
    findings: list[Finding],
    place: int,
    least: float,
    refuted: Collection[str] = (),
) -> Fallen | None:
    """Why an effect may not be named beside the others, the strongest first; None if it may."""
    finding, before = findings[place], findings[:place]
    name = finding.effect.id
    mended = stronger(found, findings, place)
    if mended is not None:
        return Fallen(
            name,
            f"{name} would take away a little more of the gap, but no more than the law of "
            f"{mended.effect.id} leaves over; it is not named.",
            misspecification=True,
        )
    turns = joint_that_turns(found, finding.effect)
    if turns is not None:
        return Fallen(
            name,
            f"{name} fits, but what poses have of their own lies along the turn of {turns}: more "
            "likely its drive does not begin every pose alike. It is not named.",
            misspecification=any(other.effect.where == turns for other in before),
        )
    if finding.effect.random_effects and not is_constant(found, finding.effect):
        return Fallen(
            name,
            f"{name} fits, but something in proportion to the load at every pose would fit as "
            "well; it is not named.",
        )
    beside = bool(found.base.problem.noise.form)
    if len(finding.others) > MOST_NAMES or (beside and finding.places > MOST_PLACES):
        return Fallen(
            name,
            f"{name} fits, but so do {len(finding.others)} other names; the readings do not tell "
            "what it is, and it is not named.",
        )
    lent = sum(finding.evidence.odds.get(rival, 0.0) for rival in {*finding.others} & {*refuted})
    if finding.probability - lent < EVEN:
        return Fallen(
            name,
            f"{name} fits a little better, but by its evidence is less likely at work than not; it "
            "is not named.",
        )
    if finding.gain < least:
        return Fallen(
            name,
            f"{name} fits a little better, but beside what the laws of real arms leave over its "
            f"evidence is weak ({finding.gain:.1f} where {least:.0f} is strong); it is not named.",
        )
    return None


def _confirmed(found: Selection, effect: int, finding: Finding, seed: int) -> Finding:
    """The finding with what other poses say of it.

    A gear has one curve, and its laws are one family: where the drawings agree on the gear, and not
    on the law, the other laws that won some of them are alternatives.
    """
    regression = found.regression

    def asked(each: Finding) -> Finding:
        same = [e for e, other in enumerate(regression.candidates) if other.id in each.alternatives]
        seen = confirm(regression, found.scored, effect, same, seed=seed)
        return replace(each, evidence=replace(each.evidence, confirmation=seen))

    alone = asked(finding)
    of_the_gear = {
        law.id for law in regression.candidates if law.of_gear and law.where == finding.effect.where
    }
    said = alone.evidence.confirmation
    laws = [name for name, share in said.others.items() if name in of_the_gear and share >= SOME]
    if said.holds or not finding.effect.of_gear or not laws:
        return alone
    wider = asked(replace(finding, alternatives=(*finding.alternatives, *laws)))
    return wider if wider.evidence.confirmation.holds else alone


def _finding(found: Selection, effect: int) -> Finding:
    """An effect with its evidence; other poses were not yet asked."""
    regression = found.regression
    with_it = found.scored
    rest = tuple(e for e in found.chosen if e != effect)
    without = score_set(regression, regression.sums(), rest, start=with_it.by_variant)
    chosen = regression.candidates[effect]
    rivals = in_its_place(regression, with_it, without, effect)
    exact = _aliases(found, effect, with_it, rivals)
    # A rival with more parameters is compared with the effect in full: that some of its own may be
    # equal is no evidence against the rival, nor is one parameter more. Any other is as simple.
    full = score_set(
        regression, regression.sums(), found.chosen, untied=effect, start=with_it.by_variant
    ).score
    own = _moving(regression, with_it, effect)
    margin = max(MARGIN, np.log(regression.rows) + 0.5)
    same = [
        e
        for e, model in rivals
        if model.score - (full if _moving(regression, model, e) > own else with_it.score) < margin
        or regression.candidates[e].id in exact
    ]
    others = [(e, model.score) for e, model in rivals if e not in same]
    runner_up = min(others, key=lambda pair: pair[1], default=None)
    names = [regression.candidates[e].id for e in same]
    gain = without.score - with_it.score
    return Finding(
        effect=chosen,
        alternatives=tuple(dict.fromkeys([*names, *exact])),
        exact=exact,
        evidence=Evidence(
            score_gain=gain,
            misfit_gain=(without.solved.rss - with_it.solved.rss) / unit(regression, with_it),
            runner_up=None if runner_up is None else regression.candidates[runner_up[0]].id,
            runner_up_gap=np.inf if runner_up is None else runner_up[1] - with_it.score,
            confirmation=UNTRIED,
            odds=posterior(
                {chosen.id: with_it.score}
                | {regression.candidates[e].id: model.score for e, model in rivals},
                none=without.score,
            ),
            rivals={regression.candidates[e].id: m.score - with_it.score for e, m in rivals},
        ),
    )


def _moving(regression: Regression, model: Scored, effect: int) -> int:
    """Number of parameters of an effect that move in a model."""
    own = regression.variants[effect][model.by_variant[effect]]
    return int(np.isin(own, model.solved.columns).sum())


def _aliases(
    found: Selection, effect: int, with_it: Scored, rivals: list[tuple[int, Scored]]
) -> tuple[str, ...]:
    """Names that no readings of this kind could tell from the effect."""
    regression, load_cases = found.regression, found.final.problem.load_cases
    chosen = regression.candidates[effect]
    close = [
        regression.candidates[e]
        for e, model in rivals
        if model.solved.rss - with_it.solved.rss < 2.0 * MARGIN
        and len(regression.columns[e]) <= len(regression.columns[effect]) + 1
    ]
    always = exact_aliases(
        found.final.model,
        chosen,
        close,
        point=load_cases.point,
    )
    X = regression.X
    here = aliases_by_design(
        chosen,
        regression.candidates,
        X[:, regression.columns[effect][0]],
        [X[:, own] for own in regression.columns],
    )
    return always + here


def by_weight(regression: Regression, model: Scored) -> list[int]:
    """Order in which a greedy observer would add the effects of a model."""
    sums, start = regression.sums(), model.by_variant
    order: list[int] = []

    def left_by(effect: int) -> float:
        return score_set(regression, sums, (*order, effect), start=start, only=()).solved.rss

    while len(order) < len(model.effects):
        order.append(min((e for e in model.effects if e not in order), key=left_by))
    return order
