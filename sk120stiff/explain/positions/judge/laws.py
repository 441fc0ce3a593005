"""By which law a named cause acts: a beam's taper and planes, a play's flanks and sides.

The catalogue's own law is the usual one. Another takes its place where the evidence asks for it, at
the price that it has among displacements too, and poses left out agree. What laws and names that
remain possible make of the other parameters is their doubt.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
from scipy.special import expit

from sk120stiff.arrays import Array
from sk120stiff.effects import Counting, Effect, Elastic, LoadCases, Weighing, referred
from sk120stiff.explain.candidates.regression import price_of_law
from sk120stiff.explain.judge.selection_uncertainty import (
    LAWS,
    LOOKED_AT,
    REFUTED,
    bent_at_no_load,
)
from sk120stiff.explain.positions.judge.posterior import Posterior
from sk120stiff.explain.positions.select.candidates import usual_sizes
from sk120stiff.explain.positions.select.choose import Chosen, usual
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.explain.select.form import alike_but_for_form
from sk120stiff.explain.select.score import SWEEPS
from sk120stiff.identify.checks.left_over import beside
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.nuisances import COUNTED, frames_off
from sk120stiff.identify.positions.omitted.other_causes import slopes
from sk120stiff.identify.positions.solve.start import options_of
from sk120stiff.identify.written import with_values
from sk120stiff.model import Parameter

EVEN = 0.5  # of the links' weight, from where on they hardly weigh and the rest is no share of it
HALF_A_STEP = 12.0**-0.5  # standard deviation of what is anywhere from half a step down to one up

Block = tuple[Effect, Array, Array]  # a law, usual sizes (p,) and columns (M, p) of its parameters
Laws = dict[int, list[Block]]  # of a candidate, the usual one first


def laws_at(linear: Linear, chosen: tuple[int, ...], seen: Calibration) -> Laws:
    """Every law of each of the chosen that has several, the usual one first.

    Args:
        linear: The positions linearised.
        chosen: Candidates.
        seen: The calibration about which they were.
    """
    problem, model = seen.problem, seen.model
    told = options_of(problem.measurements)
    laws: dict[int, tuple[Effect, ...]] = {}
    for e in chosen:
        own = linear.candidates[e]
        usual = type(own).at(model.robot, own.where, told)
        if isinstance(own, Counting) and own.reference is not None:
            usual = referred(usual, [own.reference])
        others = usual.other_laws(problem.load_cases)
        near = [law.nearby_laws(problem.load_cases) for law in (usual, *others)]
        others = (*others, *chain.from_iterable(near))
        if others:
            # a law may stand that other rows made usual: a wild one was the heaviest
            laws[e] = tuple(dict.fromkeys((usual, *others, own)))
    found = slopes(
        problem,
        model,
        [law for e, own in laws.items() for law in own if law != linear.candidates[e]],
    )

    def block(e: int, law: Effect) -> Block:
        if law == linear.candidates[e]:
            part = linear.slices[e]
            return law, linear.sizes[part], linear.columns[:, part]
        return _block(linear, seen, law, found[law])

    return {e: [block(e, law) for law in own] for e, own in laws.items()}


def as_fitted(
    linear: Linear, chosen: tuple[int, ...], seen: Calibration, final: Calibration
) -> Linear:
    """The chosen by the laws that were fitted, whose forms lie between those that were tried.

    Args:
        linear: The positions linearised.
        chosen: Candidates.
        seen: The calibration about which they were.
        final: That with the chosen, fitted.
    """
    fitted = {effect.id: effect for effect in final.model.effects}
    laws = {e: fitted.get(linear.candidates[e].id) for e in chosen}
    other = {
        e: law
        for e, law in laws.items()
        if law is not None and law.form is not None and law != linear.candidates[e]
    }
    found = slopes(seen.problem, seen.model, list(other.values()))
    for e, law in other.items():
        linear = linear.by_law(e, *_block(linear, seen, law, found[law]))
    return linear


def _block(linear: Linear, seen: Calibration, law: Effect, slope: Array) -> Block:
    """A law about a calibration, from the derivatives (M, p) of the readings by its parameters."""
    sizes = usual_sizes(law, frames_off(seen.model))
    white = seen.problem.of_channels.apply
    return law, sizes, beside(linear.base, white(slope * sizes))


def by_best_laws(linear: Linear, chosen: tuple[int, ...], laws: Laws) -> Linear:
    """The chosen by the laws that explain most, one after the other until none changes."""
    for _ in range(SWEEPS):
        before = linear
        for e, own in laws.items():
            k, now = chosen.index(e), linear.only(chosen)
            whole = tuple(range(len(chosen)))
            noise = now.noise(whole)
            left = now.left_out(whole, noise)
            tried: list[tuple[float, Block]] = []
            for place, law in enumerate(own):
                count = len(own) - 1 if place else 1
                price = 0.5 * price_of_law(law[0], count, usual=not place)
                other = now.by_law(k, *law)
                tried.append((other.score(whole, noise) - price, law))
                if law[0] == linear.candidates[e]:
                    standing = tried[-1][0]
            score, best = max(tried, key=lambda each: each[0])
            if score > standing and now.by_law(k, *best).left_out(whole, noise) < left:
                linear = linear.by_law(e, *best)
        if linear is before:
            break
    return linear


def with_fewer(linear: Linear, found: Chosen, laws: Laws) -> tuple[Linear, Chosen]:
    """Without a name that another law of a second one makes needless.

    That the light payload and all links are off by as much is that the heavy one is off.
    """
    for e, own in laws.items():
        for gone in [each for each in found.order if usual(linear.candidates[each]) <= 0.0]:
            rest = linear.less(found.order, gone)
            if e not in rest or len(rest) < len(found.order) - 1:
                continue
            noise = linear.noise(found.order)
            now = linear.score(found.order, noise) + usual(linear.candidates[gone])
            for law in own:
                price = 0.5 * price_of_law(law[0], len(own), usual=law == own[0])
                other = linear.by_law(e, *law)
                if other.score(rest, noise) - price >= now:
                    linear, found = other, replace(found, order=rest)
                    break
    return linear, found


def beside_laws(final: Calibration, posterior: Posterior, laws: Laws) -> Calibration:
    """The calibration, its errors widened by laws and names that the positions do not refute.

    Between two laws that are tried lie others: a taper may be anywhere from the middle towards one
    to the middle towards the next.
    """
    linear, chosen = posterior.linear, posterior.chosen
    noise, load_cases = linear.noise(chosen), final.problem.load_cases
    here = _at_rest(linear, chosen, noise, load_cases)
    doubt = dict.fromkeys(here, 0.0)
    for other, share in (
        *((other, 1.0) for other in _others(posterior, laws, noise, load_cases)),
        *_next_to(linear, chosen, laws, noise, load_cases),
    ):
        there = _at_rest(*other, noise, load_cases)
        for name in doubt.keys() & there.keys():
            doubt[name] = max(doubt[name], share * abs(there[name] - here[name]))
    off = _by_weight(final)
    more = [
        0.0
        if isinstance(p.effect, COUNTED)
        else max(
            doubt.get(p.quantity, 0.0),
            off * abs(p.internal) if isinstance(p.effect, Elastic) else 0.0,
        )
        for p in final.parameters
    ]
    moved = np.array(more) / final.problem.scale
    return with_values(replace(final, selection_uncertainty=moved))


def _by_weight(final: Calibration) -> float:
    """Share by which all that yields is off, if not the links but the payloads weigh otherwise."""
    own = [p.internal for p in final.parameters if isinstance(p.effect, Weighing)]
    return max((abs(value) / max(1.0 + value, EVEN) for value in own), default=0.0)


def _at_rest(
    linear: Linear, chosen: tuple[int, ...], noise: float, load_cases: LoadCases
) -> dict[str, float]:
    """Values of the chosen by quantity; of a spring that a law bends the compliance at rest."""
    values = linear.values(chosen, noise)
    for e, spring in linear.bent.items():
        if {e, spring} <= set(chosen):
            effect, (own,) = linear.candidates[e], linear.candidates[spring].parameters
            bends = np.array([values[f"{effect.id}.{spec.name}"] for spec in effect.parameters])
            slope = bent_at_no_load(effect, load_cases, bends)
            values[f"{linear.candidates[spring].id}.{own.name}"] += slope
    named = [
        Parameter(linear.candidates[e], s) for e in chosen for s in linear.candidates[e].parameters
    ]
    return {parameter.quantity: values[parameter.name] for parameter in named}


def _next_to(
    linear: Linear, chosen: tuple[int, ...], laws: Laws, noise: float, load_cases: LoadCases
) -> Iterator[tuple[tuple[Linear, tuple[int, ...]], float]]:
    """The same by laws next to those that stand, and the standard deviation of what lies between.

    It is in steps: that of as much as half a step either way, or more where the next law is nearly
    as likely.
    """
    small, whole = linear.only(chosen), tuple(range(len(chosen)))
    standing = small.solved(whole, noise).square
    for e, own in laws.items():
        for law in own:
            now = linear.candidates[e]
            if _adjacent(now, law[0], load_cases) and not alike_but_for_form(law[0], now):
                other = small.by_law(chosen.index(e), *law)
                worse = max(other.solved(whole, noise).square - standing, 0.0) / noise
                yield (other, whole), max(HALF_A_STEP, float(np.sqrt(expit(-0.5 * worse))))


def _adjacent(one: Effect, other: Effect, load_cases: LoadCases) -> bool:
    return other in one.nearby_laws(load_cases) or one in other.nearby_laws(load_cases)


def _others(
    posterior: Posterior, laws: Laws, noise: float, load_cases: LoadCases
) -> Iterator[tuple[Linear, tuple[int, ...]]]:
    """The same by other laws, the likeliest of those not refuted, and by other names."""
    linear, chosen = posterior.linear, posterior.chosen
    small, whole = linear.only(chosen), tuple(range(len(chosen)))
    most = small.solved(whole, noise).square + REFUTED * noise
    for e, own in laws.items():
        k, now = chosen.index(e), linear.candidates[e]
        tried = [
            small.by_law(k, *law)
            for law in own
            if law[0] != now
            and not _adjacent(now, law[0], load_cases)
            and not alike_but_for_form(law[0], now)
        ]
        near = sorted(tried, key=lambda each: each.solved(whole, noise).square)[:LAWS]
        yield from ((each, whole) for each in near if each.solved(whole, noise).square < most)
    for e, (rivals, _) in posterior.names.items():
        for rival in rivals[:LOOKED_AT]:
            yield linear, (*linear.less(chosen, e), rival)
