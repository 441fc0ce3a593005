"""Sets of names near the chosen one, and how probable each is.

A name may be wrong together with others: two frames and a wave where one base rocks. So sets are
held against sets. From the chosen one on every set that differs by one name, or by one in another's
place, is looked at, and so on from each that is nearly as probable as the best (Occam's window,
Madigan & Raftery, J. Am. Stat. Assoc. 89, 1994, p. 1535).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import logsumexp

from sk120stiff.arrays import Array, Mask
from sk120stiff.explain.positions.select.choose import RIVAL, confirmed, gain, usual
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.explain.priors import FALLEN

WINDOW = 3.0  # loss of the logarithm of probability up to which others are looked for about a set
WORTH = 9.0  # loss up to which a set weighs at all
OPENED = 60  # sets about which others are looked for
HALF = 0.5  # of how often sets hold both of two names or neither, if these have nothing in common
HELD_BY_ALL = 0.99  # probability beyond which nothing stands in the place of a name
ASKED = 3  # sets that hold a name in which poses left out are asked for it
AGREED = 1e-6  # of a logarithm, by which names may be more probable than they are held back to
VIEWS = 2  # sets by which the errors are chosen beside which all are judged

Scores = tuple[Callable[[tuple[int, ...]], float], Callable[[tuple[int, ...]], tuple[Array, Mask]]]


@dataclass(frozen=True, eq=False)
class Sets:
    """Sets of candidates with their probabilities, which add up to 1.

    Attributes:
        weights: Of each set.
        chosen: The set about which the others were found.
        count: How many candidates there are.
    """

    weights: dict[frozenset[int], float]
    chosen: frozenset[int]
    count: int

    def with_any(self, names: Collection[int]) -> float:
        """Probability that one of these names at least is at work."""
        return float(self._weight[self._holds[:, list(names)].any(axis=1)].sum())

    def in_its_place(self, e: int) -> tuple[int, ...]:
        """What explains as much in the place of one of the chosen, the likeliest first.

        Sets hold it or the name; both or neither they hold less often than by chance, and neither
        is less likely than it is. What nearly every set holds has nothing in its place.
        """
        weight, holds = self._weight, self._holds
        if self.with_any((e,)) > HELD_BY_ALL:
            return ()
        found: list[int] = []
        while True:
            held = holds[:, [e, *found]].any(axis=1)
            without, beside = np.where(held, 0.0, weight), np.where(held, weight, 0.0)
            instead, both = without @ holds, beside @ holds
            neither, alone = without.sum() - instead, beside.sum() - both
            likeliest = (without[:, None] * holds).max(axis=0, initial=0.0)
            nothing = (without[:, None] * ~holds).max(axis=0, initial=0.0)
            as_much = likeliest >= np.exp(-RIVAL) * (beside[:, None] * ~holds).max(axis=0)
            likely = as_much & (both * neither < HALF * alone * instead) & (likeliest > nothing)
            likely[[*self.chosen]] = False
            if not likely.any():
                return tuple(found)
            found.append(int(np.argmax(np.where(likely, instead, -1.0))))

    @cached_property
    def _weight(self) -> Array:
        return np.array([*self.weights.values()])

    @cached_property
    def _holds(self) -> Mask:
        """(S, K) which sets hold which candidates."""
        return table_of(self.weights, self.count)


def table_of(sets: Collection[frozenset[int]], count: int) -> Mask:
    """(S, count) which sets hold which candidates."""
    holds = np.zeros((len(sets), count), dtype=bool)
    for row, each in zip(holds, sets, strict=True):
        row[list(each)] = True
    return holds


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
    log = _held_back(linear, start, [*found], np.array([*found.values()]))
    weight = np.exp(log - logsumexp(log))
    weights = dict(zip(found, map(float, weight), strict=True))
    return Sets(weights, start, len(linear.candidates))


def _held_back(
    linear: Linear, start: frozenset[int], sets: Sequence[frozenset[int]], log: Array
) -> Array:
    """Logarithms of probabilities, of what poses left out do not bear out no more than a share.

    Every such name counts against what there is without it; they are held back in turn, until all
    are.
    """
    holds = table_of(sets, len(linear.candidates))
    most = float(np.log(FALLEN))
    known = dict[int, bool]()

    def too_much(c: int) -> float:
        """By how much sets with a name have more than the share of those without."""
        among = holds[:, c]
        if among.all() or not among.any():
            return 0.0
        return float(logsumexp(log[among]) - logsumexp(log[~among])) - most

    names = [c for c in np.flatnonzero(holds.any(axis=0)).tolist() if c not in start]
    while True:
        above = {c: more for c in names if (more := too_much(c)) > AGREED}
        for c in above:
            if c not in known:
                own = np.where(holds[:, c], log, -np.inf)
                likeliest = [sets[k] for k in np.argsort(-own)[:ASKED] if holds[k, c]]
                known[c] = any(_confirmed(linear, each, c) for each in likeliest)
        refuted = [c for c in above if not known[c]]
        if not refuted:
            return log
        for c in refuted:
            log = log - max(too_much(c), 0.0) * holds[:, c]


def _confirmed(linear: Linear, whole: frozenset[int], e: int) -> bool:
    return confirmed(gain(linear, tuple(sorted(whole)), e), linear)


def _price_of(linear: Linear, e: int) -> float:
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
    price = np.array([_price_of(linear, e) for e in range(len(linear.candidates))])

    def likely(each: frozenset[int]) -> float:
        return score(tuple(sorted(each))) - float(price[list(each)].sum())

    found, opened = {start: likely(start)}, set[frozenset[int]]()
    for _ in range(OPENED):
        best = max(found.values())
        near = [e for e, own in found.items() if own >= best - WINDOW and e not in opened]
        if not near:
            break
        here = max(near, key=lambda each: found[each])
        opened.add(here)
        for rest in _with_less(linear, here):
            if rest not in found:
                found[rest] = likely(rest)
            order = tuple(sorted(rest))
            wider, exact = joined(order)
            wider = wider - price - float(price[list(rest)].sum())
            for c in linear.may_join(order):
                worth = wider[c] > best - WORTH
                if (whole := rest | {c}) in found or not (worth or linear.bound[c]):
                    continue
                found[whole] = float(wider[c]) if exact[c] else likely(whole)
    return found


def _with_less(linear: Linear, whole: frozenset[int]) -> Iterator[frozenset[int]]:
    """A set, and without each of its names and what needs it."""
    yield whole
    order = tuple(sorted(whole))
    for e in order:
        yield frozenset(linear.less(order, e))
