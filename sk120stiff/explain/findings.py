"""What is found, as frozen data: a named effect with its evidence, and what stands beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import special

from sk120stiff.effects import Effect
from sk120stiff.model import Model, Share

ENOUGH = 3.3  # standard deviations from which on readings settle which of two names it is
CERTAIN = 300.0  # logarithm of odds from which on a number holds no larger ones
NAMED = 0.95  # probability from which on a name stands alone


def sentence_in(model: Model, effect: Effect) -> str:
    """What an effect does, in a sentence, as the values that the model has of it tell."""
    return effect.told({p.spec.name: p.value for p in model.parameters if p.effect == effect})


@dataclass(frozen=True)
class Confirmation:
    """How an effect fares on poses that did not speak for it.

    Attributes:
        folds_improved, folds: In how many of the folds the held-out misfit falls when the effect is
            added.
        gain, gain_error: Fall of the held-out misfit per reading axis [noise variances], and the
            standard error over poses that what is left gives it.
        frequency: Share of resamplings of the poses in which the same name (or an alternative of
            it) wins.
        rival_frequency: Share in which the most frequent of the other names wins.
        foretells: The effect says something of poses that were not measured. Draws, one for every
            pose, do not; no fold can gain by them, and their name rests on the resampling alone.
        others: Share in which each of the other names (``name:where``) wins.
    """

    folds_improved: int
    folds: int
    gain: float
    gain_error: float
    frequency: float
    rival_frequency: float
    foretells: bool = True
    others: Mapping[str, float] = field(default_factory=dict)

    @property
    def chance(self) -> float:
        """At most so probable is it that what is left scatters by as much; 0: no pose can tell."""
        if not self.foretells:
            return 0.0
        if self.gain <= 0.0:
            return 1.0
        return float(special.erfc(self.gain / max(self.gain_error, 1e-300) / np.sqrt(2.0)))

    @property
    def holds(self) -> bool:
        """The name may be given: other poses gain by it, and it wins on most drawings of the poses.

        Four of five folds have to gain. Three will do if the gain of all is positive, and fewer if
        it goes beyond what the rest scatters: few poses may carry a small effect. Where no other
        name comes near, a third of the drawings is enough: a weak effect drowns in some of them.
        """
        mostly = self.folds_improved >= 0.6 * self.folds or self.gain > self.gain_error
        gains = (
            not self.foretells
            or self.folds_improved >= 0.8 * self.folds
            or (mostly and self.gain > 0.0)
        )
        wins = self.frequency >= 0.5
        alone = self.frequency >= 0.33 and self.rival_frequency <= 0.5 * self.frequency
        return gains and (wins or alone)


@dataclass(frozen=True)
class Evidence:
    """Why an effect was named.

    Attributes:
        score_gain: By how much the extended BIC gets worse without the effect.
        misfit_gain: By how much the misfit (χ²) grows without it.
        runner_up, runner_up_gap: The best effect that is no alternative (``name:where``), and by
            how much it loses.
        confirmation: Cross-validation and resampling of the poses.
        odds: Probability of each candidate (``name:where``) in this effect's place beside the other
            effects, as far as the catalogue goes; what is missing to one is that of none.
        rivals: By how much the extended BIC is worse with each rival (``name:where``) in its place.
    """

    score_gain: float
    misfit_gain: float
    runner_up: str | None
    runner_up_gap: float
    confirmation: Confirmation
    odds: Mapping[str, float]
    rivals: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Finding:
    """One named effect.

    Attributes:
        effect: The effect.
        alternatives: Other effects (``name:where``) that these readings cannot tell from it.
        exact: Those of the alternatives that no readings of this kind could tell from it.
        evidence: Why it was named.
    """

    effect: Effect
    alternatives: tuple[str, ...]
    exact: tuple[str, ...]
    evidence: Evidence

    @property
    def probability(self) -> float:
        """Probability that the effect or one of its alternatives is at work."""
        return sum(
            self.evidence.odds.get(name, 0.0) for name in {self.effect.id, *self.alternatives}
        )

    @property
    def gain(self) -> float:
        """By how much the extended BIC gets worse without the effect and its alternatives.

        They share one piece of evidence: readings that do not tell which of them it is say no less
        that it is one of them.
        """
        own = self.evidence.odds.get(self.effect.id, 0.0)
        shared = 2.0 * float(np.log(self.probability / own)) if own else 0.0
        return self.evidence.score_gain + shared

    @property
    def others(self) -> tuple[str, ...]:
        """Alternatives that other readings could tell from it."""
        return tuple(name for name in self.alternatives if name not in self.exact)

    @property
    def places(self) -> int:
        """At how many places of the arm it may be."""
        return len({name.partition(":")[2] for name in (self.effect.id, *self.others)})

    @property
    def settled(self) -> bool:
        """One name, or one class of names, is sure enough; no further poses could tell more."""
        return not self.others and self.probability >= NAMED

    def headed_by(self, effect: Effect) -> Finding:
        """The same finding by another law of its name, or with one of its rivals before it."""
        old, evidence = self.effect.id, self.evidence
        if effect.id == old:
            return replace(self, effect=effect)
        behind = evidence.rivals.get(effect.id, 0.0)
        rivals = {name: gap - behind for name, gap in evidence.rivals.items() if name != effect.id}
        told = replace(
            evidence,
            score_gain=evidence.score_gain - behind,
            runner_up_gap=evidence.runner_up_gap - behind,
            rivals=rivals | {old: -behind},
        )
        others = tuple(name for name in self.alternatives if name != effect.id)
        return replace(self, effect=effect, alternatives=(old, *others), evidence=told)

    def beside(self, rival: str, gap: float) -> Finding:
        """The same finding with one more name in its set, whose score is worse by `gap`."""
        said = self.evidence
        share = said.odds.get(self.effect.id, 1.0) * float(np.exp(min(-0.5 * gap, CERTAIN)))
        whole = 1.0 + share - said.odds.get(rival, 0.0)
        odds = {name: p / whole for name, p in {**said.odds, rival: share}.items()}
        told = replace(said, odds=odds, rivals={**said.rivals, rival: gap})
        names = tuple(dict.fromkeys([*self.alternatives, rival]))
        return replace(self, alternatives=names, evidence=told)

    def doubted(self, impostor: float) -> Finding:
        """The same where, with this probability, it imitates part of what has no name."""
        odds = {name: (1.0 - impostor) * share for name, share in self.evidence.odds.items()}
        return replace(self, evidence=replace(self.evidence, odds=odds))


@dataclass(frozen=True)
class Apart:
    """How far the proposed readings tell two names apart.

    Attributes:
        name, rival: What stands in one place, ``name:where``.
        apart: What the rival cannot imitate of the name, by the proposed readings alone, in
            standard deviations of the noise (√λ).
    """

    name: str
    rival: str
    apart: float

    @property
    def settled(self) -> bool:
        """They tell which of the two it is, whatever the noise."""
        return self.apart >= ENOUGH


@dataclass(frozen=True)
class Step:
    """The gap with one more effect in the model, rms per axis [m].

    Attributes:
        label: Names of the base model's effects, then ``+ name:where``.
        fit_rms: On the readings that were fitted.
        heldout_rms: On poses left out of the fit (cross-validation), or on the hold-out file.
    """

    label: str
    fit_rms: float
    heldout_rms: float

    @property
    def joined(self) -> tuple[str, ...]:
        """Names that joined here: several where those between found no fit by themselves."""
        first, *names = f" {self.label}".split(" + ")
        return () if first else tuple(names)


@dataclass(frozen=True)
class Contender:
    """What comes nearest to an explanation where none is confirmed.

    Attributes:
        id: ``name:where``.
        heldout_gain: By how much the held-out gap falls with it in the model, rms per axis [m]; NaN
            if poses that are left do not hold it.
    """

    id: str
    heldout_gain: float


@dataclass(frozen=True)
class TaskBudget:
    """What moves the loaded tool on a task that someone has to do, by the final model.

    Attributes:
        path: Name of the task's file.
        points: How many it has.
        effects, joints: Shares of every effect, and of all that yields at each joint.
    """

    path: str
    points: int
    effects: tuple[Share, ...]
    joints: tuple[Share, ...]


@dataclass(frozen=True)
class Detectable:
    """Smallest size of one parameter that these readings would have shown.

    `value` is in the parameter's public unit (for a stiffness: the largest one that shows); None
    means that no plausible value would have shown.
    """

    name: str
    value: float | None
    unit: str


def likely(probability: float, of: str = "P") -> str:
    """A probability of a name: none is told as certain.

    Examples:
        >>> likely(0.62), likely(0.9993), likely(0.002)
        ('P = 0.62', 'P > 0.99', 'P < 0.01')
    """
    if probability > 0.99:
        return f"{of} > 0.99"
    if probability < 0.01:
        return f"{of} < 0.01"
    return f"{of} = {probability:.2f}"
