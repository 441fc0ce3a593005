"""Sets of names that the positions do not refute, and how probable each is.

A name may be wrong together with others: two frames and a wave where one base rocks. So sets are
held against sets. From the chosen one on every set that differs by one name, or by one in another's
place, is looked at, and so on from each that is nearly as probable as the best (Occam's window,
Madigan & Raftery, J. Am. Stat. Assoc. 89, 1994, p. 1535).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.explain.positions.select.choose import RIVAL, confirmed, gain, usual
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.explain.priors import FALLEN

WINDOW = 3.0  # loss of the logarithm of probability up to which others are looked for about a set
WORTH = 9.0  # loss up to which a set weighs at all, and is worth an exact score
MOST = 3000  # sets that are looked at
HALF = 0.5  # of how often sets hold both of two names or neither, if these have nothing in common
ASKED = 3  # sets that hold a name in which poses left out are asked for it
VIEWS = 2  # sets by which the errors are chosen beside which all are judged

Scores = tuple[Callable[[tuple[int, ...]], float], Callable[[tuple[int, ...]], tuple[Array, Mask]]]


@dataclass(frozen=True, eq=False)
class Sets:
    """Sets of candidates with their probabilities, which add up to 1.

    Attributes:
        weights: Of each set.
        chosen: The set about which the others were found.
    """

    weights: dict[frozenset[int], float]
    chosen: frozenset[int]

    def with_any(self, names: Collection[int]) -> float:
        """Probability that one of these names at least is at work."""
        return sum(w for each, w in self.weights.items() if not each.isdisjoint(names))

    def in_its_place(self, e: int) -> tuple[int, ...]:
        """What explains as much in the place of one of the chosen, the likeliest first.

        Sets hold it or the name; both or neither they hold less often than by chance.
        """
        found: list[int] = []
        while True:
            held = {s: w for s, w in self.weights.items() if not s.isdisjoint((e, *found))}
            without = {s: w for s, w in self.weights.items() if s not in held}
            likely = dict[int, float]()
            for c in frozenset().union(*without) - self.chosen:
                instead = [w for s, w in without.items() if c in s]
                neither = [w for s, w in without.items() if c not in s]
                both = [w for s, w in held.items() if c in s]
                alone = [w for s, w in held.items() if c not in s]
                as_much = max(instead) >= np.exp(-RIVAL) * max(alone, default=0.0)
                if as_much and sum(both) * sum(neither) < HALF * sum(alone) * sum(instead):
                    likely[c] = sum(instead)
            if not likely:
                return tuple(found)
            found.append(max(likely, key=lambda c: likely[c]))


def not_refuted(linear: Linear, chosen: tuple[int, ...]) -> Sets:
    """The sets near the chosen one, and how probable each of them is.

    What is not chosen and poses left out do not bear out is no more probable than a fraction of
    what there is without it: few readings far from all others make as much evidence.
    """
    start = frozenset(chosen)
    views = [start]
    while True:
        found = _seen(linear, start, _scores(linear, views))
        best = max(found, key=lambda each: found[each])
        if linear.errors is None or best in views or len(views) == VIEWS:
            break
        views.append(best)
    weight = np.exp(np.array([*found.values()]) - max(found.values()))
    sets = [*found]
    for c in frozenset().union(*sets) - start:
        among = np.array([c in each for each in sets])
        without = float(weight[~among].sum())
        if weight[among].sum() <= FALLEN * without:
            continue
        likeliest = np.argsort(np.where(among, -weight, 0.0))[:ASKED]
        if not any(_confirmed(linear, sets[k], c) for k in likeliest if among[k]):
            weight[among] *= FALLEN * without / weight[among].sum()
    return Sets(dict(zip(sets, map(float, weight / weight.sum()), strict=True)), start)


def _confirmed(linear: Linear, whole: frozenset[int], e: int) -> bool:
    return confirmed(gain(linear, tuple(sorted(whole)), e), linear)


def price_of(linear: Linear, e: int) -> float:
    """Evidence that a name has to bring to be as probable as not: one of all, as usual as it is."""
    return float(np.log(len(linear.candidates))) - usual(linear.candidates[e])


def _scores(linear: Linear, views: Collection[frozenset[int]]) -> Scores:
    """The evidence of a set, and of all with one name more; see `Linear.joined`."""
    if linear.errors is not None:
        errors = linear.errors.likeliest([tuple(sorted(each)) for each in views])
        return errors.score, errors.joined
    noise = linear.noise(tuple(sorted(next(iter(views)))))
    return lambda each: linear.score(each, noise), lambda each: linear.joined(each, noise)


def _seen(linear: Linear, start: frozenset[int], scores: Scores) -> dict[frozenset[int], float]:
    """Sets and the logarithm of the probability of each, up to a constant."""
    score, joined = scores
    price = np.array([price_of(linear, e) for e in range(len(linear.candidates))])

    def likely(each: frozenset[int]) -> float:
        return score(tuple(sorted(each))) - float(price[list(each)].sum())

    found, done = {start: likely(start)}, set[frozenset[int]]()
    while len(found) < MOST:
        best = max(found.values())
        open_ones = [e for e, own in found.items() if own >= best - WINDOW and e not in done]
        if not open_ones:
            break
        here = max(open_ones, key=lambda each: found[each])
        done.add(here)
        for rest in _with_less(linear, here):
            if rest not in found:
                found[rest] = likely(rest)
            order = tuple(sorted(rest))
            near, exact = joined(order)
            near = near - price - float(price[list(rest)].sum())
            for c in linear.may_join(order):
                wider = rest | {c}
                if wider in found:
                    continue
                if exact[c]:
                    found[wider] = float(near[c])
                elif linear.bound[c] or near[c] > best - WORTH:
                    found[wider] = likely(wider)
    return found


def _with_less(linear: Linear, whole: frozenset[int]) -> Iterator[frozenset[int]]:
    """A set, and without each of its names and what needs it."""
    yield whole
    order = tuple(sorted(whole))
    for e in order:
        yield frozenset(linear.less(order, e))
