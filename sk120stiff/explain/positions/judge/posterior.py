"""How probable a chosen name is, and which others explain as much in its place."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import expit

from sk120stiff.explain.positions.judge.sets import Sets, not_refuted
from sk120stiff.explain.positions.select.choose import Chosen, confirmed, frames_of, gain
from sk120stiff.explain.positions.select.linear import Linear

CLEARLY = 3.0  # times as probable as the chosen set, for which another takes its place


@dataclass(frozen=True, eq=False)
class Posterior:
    """Chosen names beside all sets near them.

    Attributes:
        linear: The positions linearised.
        chosen: The names.
    """

    linear: Linear
    chosen: tuple[int, ...]

    @cached_property
    def sets(self) -> Sets:
        """The sets, and how probable each is."""
        return not_refuted(self.linear, self.chosen)

    @cached_property
    def names(self) -> dict[int, tuple[tuple[int, ...], float]]:
        """Of each name, what explains as much in its place, and the probability of one of them."""
        return {e: self._of(e) for e in self.chosen}

    def standing(self, e: int) -> dict[str, float]:
        """Probability of one of the chosen, and of each that explains as much in its place.

        Each by itself: of all sets that hold it, as one of them at least has that of `names`. Where
        two may be at work together they add up to more.
        """
        rivals, probability = self.names[e]
        held = probability / max(self.sets.with_any((e, *rivals)), 1e-300)
        return {
            self.linear.candidates[c].id: min(held * self.sets.with_any((c,)), 1.0)
            for c in (e, *rivals)
        }

    def likelier(self, found: Chosen, tried: Collection[frozenset[int]]) -> Chosen | None:
        """The likeliest set of no more names, where it is clearly likelier; None: there is none.

        Poses left out have to agree, with every name of it and with all together. What becomes of
        the last name is for the caller to say.

        Args:
            found: The chosen, and what fell, which does not come back.
            tried: Sets that had their turn.
        """
        weights, linear = self.sets.weights, self.linear
        here = frozenset(self.chosen)
        own = linear.left_out(self.chosen, linear.noise(self.chosen))
        likely = (
            each
            for each, weight in weights.items()
            if 0 < len(each) <= len(here)
            and each not in tried
            and each.isdisjoint(found.dropped)
            and weight > CLEARLY * weights[here]
        )
        for best in sorted(likely, key=lambda each: -weights[each]):
            order = (*(e for e in self.chosen if e in best), *sorted(best - here))
            left = linear.left_out(order, linear.noise(order))
            if left > own or not borne_out(linear, order):
                continue
            instead = " and ".join(linear.candidates[e].id for e in sorted(best - here))
            place = f"with {instead} in its place" if instead else "without it"
            why = f"fits, but the readings are likelier {place}."
            gone = {e: f"{linear.candidates[e].id} {why}" for e in here - best}
            return Chosen(order, {**found.dropped, **gone})
        return None

    def _of(self, e: int) -> tuple[tuple[int, ...], float]:
        rivals = self.sets.in_its_place(e)
        narrow = self.sets.with_any((e, *rivals))
        return rivals, _beside_what_every_arm_has(self.linear, self.chosen, (e, *rivals), narrow)


def borne_out(linear: Linear, chosen: tuple[int, ...]) -> bool:
    """Do poses left out bear every one of the chosen out?"""
    return all(confirmed(gain(linear, chosen, e), linear) for e in chosen)


def of_all(linear: Linear, chosen: tuple[int, ...]) -> float:
    """Probability that what all of the chosen take off together is no part of an unknown cause.

    Of errors of geometry that stand for one another none is likely by itself.
    """
    if linear.errors is None:
        return 1.0
    odds = linear.errors.score(chosen) - linear.errors.score(())
    return float(expit(odds - np.log(len(linear.candidates) + 1.0)))


def _beside_what_every_arm_has(
    linear: Linear, chosen: tuple[int, ...], own: tuple[int, ...], narrow: float
) -> float:
    """Probability of a name, averaged over the chosen model and that with all frames and springs.

    Where few numbers are left over, those that nothing asked for may bring as much; where many are,
    they cost more than they explain, and do not count.

    Args:
        linear: The positions linearised.
        chosen: The causes of the answer.
        own: The name, and what explains as much in its place.
        narrow: Its probability where nothing else is at work.
    """
    springs = (c for c, effect in enumerate(linear.candidates) if effect.joint_spring)
    usual_ones = [c for c in (*frames_of(linear), *springs) if c not in (*chosen, *own)]
    if not usual_ones:
        return narrow
    wide = (*chosen, *usual_ones)
    without = linear.less(wide, own[0])
    sets = chosen, wide, without
    if linear.errors is None:
        scores = [linear.score(each, linear.noise(each)) for each in sets]
    else:
        scores = [linear.errors.score(each) for each in sets]
    others = len(linear.candidates) - len(chosen)
    taken = float(expit(scores[1] - scores[2] - np.log(others + 1.0)))
    share = float(expit(scores[1] - scores[0]))
    return (1.0 - share) * narrow + share * min(taken, narrow)
