"""Which set of effects explains the gap best: a beam search over models of the catalogue."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.select.promises import promises
from sk120stiff.explain.select.score import Scored, score_set, score_sets

BEAM = 12  # models kept at each size of the search
SETTLED = 2  # of them whose effects all try their variants
HOPELESS = 20.0  # score by which larger models lose that have no future: twice decisive
SLACK = 6.0  # score by which a set may come out better than hoped; few do by more
CONTENDERS = 24  # candidates that are tried in the place of an effect
NEAR = 40.0  # difference of scores within which their neighbours may take other laws
FIRST = 4  # of them whose neighbours may anyway: a strong beam by another taper hides much
WORTH = 4.0  # fall of the misfit that a gear's curve promises, to join in with all others


def beam_search(regression: Regression, *, width: int = BEAM, max_effects: int = 4) -> list[Scored]:
    """The best models met, best first; the base model is always among them.

    Args:
        regression: Linearised readings.
        width: Models kept at each size.
        max_effects: Largest number of effects.
    """
    total = regression.sums()
    seen: dict[tuple[int, ...], Scored] = {}

    def scored(models: Iterable[Mapping[int, int]]) -> list[Scored]:
        """Models by these variants, until they prove good enough to look at all."""
        wanted: dict[tuple[int, ...], Mapping[int, int]] = {}
        for variants in models:
            wanted.setdefault(tuple(sorted(variants)), dict(sorted(variants.items())))
        new = [key for key in wanted if key not in seen]
        found = score_sets(regression, total, [wanted[key] for key in new])
        seen.update(zip(new, found, strict=True))
        return [seen[key] for key in wanted]

    def settled(model: Scored) -> Scored:
        seen[model.effects] = score_set(regression, total, model.effects, start=model.by_variant)
        return seen[model.effects]

    def leading(hope: Mapping[tuple[int, ...], float]) -> dict[tuple[int, ...], Scored]:
        """Those children that may be among the best of their size, the most hopeful first."""
        grown: dict[tuple[int, ...], Scored] = {}
        order = sorted(hope, key=lambda effects: hope[effects])
        for begin in range(0, len(order), 2 * width):
            part = order[begin : begin + 2 * width]
            best = sorted(m.score for m in grown.values() if m.plausible)
            if len(best) >= width and hope[part[0]] > best[width - 1] + SLACK:
                break
            grown |= {m.effects: m for m in scored(children[effects] for effects in part)}
        return grown

    front = [score_set(regression, total, ())]
    seen[()] = front[0]
    for _ in range(max_effects):
        children: dict[tuple[int, ...], dict[int, int]] = {}
        hope: dict[tuple[int, ...], float] = {}
        for model in front:
            promised = promises(regression, total, model.solved)
            hopes = promised.hopes(model)
            order = [int(e) for e in np.argsort(-promised.most) if int(e) not in model.effects]
            room = len(model.effects) < max_effects  # gears that joined together took more
            steps: list[tuple[int, ...]] = [(e,) for e in order[: 2 * width]] if room else []
            steps += _all_gears(regression, model, promised.most, max_effects)
            for step in steps:
                effects = tuple(sorted((*model.effects, *step)))
                likely = {e: promised.likeliest(e) for e in step}
                children.setdefault(effects, model.by_variant | likely)
                together = len(step) > 1  # what they do jointly no promise tells
                own = -np.inf if together else float(hopes[step[0]])
                hope[effects] = min(hope.get(effects, np.inf), own)
        grown = leading(hope)
        least = min((m.score for m in grown.values() if m.plausible), default=np.inf)
        beyond = (m for m in grown.values() if not m.plausible and m.score < least)
        for model in sorted(beyond, key=lambda m: m.score)[:width]:  # by another law they may be
            grown[model.effects] = settled(model)
        ranked = sorted((m for m in grown.values() if m.plausible), key=lambda m: m.score)
        ranked[:SETTLED] = [settled(m) for m in ranked[:SETTLED]]
        front = sorted((m for m in ranked[:width] if m.plausible), key=lambda m: m.score)
        if not front:
            break
        best_before = min(
            (m.score for m in seen.values() if m.plausible and m.effects not in grown),
            default=np.inf,
        )
        # Larger models that lose to a smaller one by far have no future.
        if front[0].score > best_before + HOPELESS:
            break
    for model in sorted(seen.values(), key=lambda m: m.score)[:width]:
        smaller = model
        while smaller.effects:  # backward: what became superfluous
            less = scored(
                {f: k for f, k in smaller.by_variant.items() if f != e} for e in smaller.effects
            )
            before, smaller = smaller, min(less, key=lambda m: (not m.plausible, m.score))
            if smaller.score > before.score:
                break
    best = sorted((m for m in seen.values() if m.plausible), key=lambda m: m.score)
    best[:SETTLED] = sorted((settled(m) for m in best[:SETTLED]), key=lambda m: m.score)
    return best


def exchanged(regression: Regression, model: Scored, barred: Collection[int] = ()) -> Scored:
    """A model after exchanges of one effect for another, for as long as one has better evidence.

    What grows by one effect at a time keeps its first, though beside the later ones, or without one
    that may not be named, another would explain more.

    Args:
        regression: Linearised readings.
        model: What to begin with.
        barred: Candidates that may not enter.
    """
    while True:
        before = model
        for e in before.effects:
            rest = tuple(f for f in before.effects if f != e)
            without = score_set(regression, regression.sums(), rest, start=before.by_variant)
            rivals = in_its_place(regression, before, without, e)
            fair = (rival for f, rival in rivals if f not in barred)
            model = min([model, *fair], key=lambda m: m.score)
        if model is before:
            return model


def in_its_place(
    regression: Regression, model: Scored, without: Scored, effect: int
) -> list[tuple[int, Scored]]:
    """The other candidates that promise most in the place of one effect, with their models.

    Args:
        regression: Linearised readings.
        model, without: A model with the effect, and the same without it.
        effect: The one whose place it is.
    """
    sums, rest, start = regression.sums(), without.effects, model.by_variant
    promised = promises(regression, sums, without.solved)
    order = [int(e) for e in np.argsort(-promised.most) if int(e) not in (*rest, effect)]
    hopes, near = promised.hopes(without), model.score + NEAR
    found: list[tuple[int, Scored]] = []
    for e in sorted(order[:CONTENDERS], key=lambda e: hopes[e]):
        if len(found) >= FIRST and hopes[e] > near + SLACK:
            break
        found.append((e, score_set(regression, sums, (*rest, e), start=start, only=(e,))))
        near = max([model.score + NEAR, *sorted(m.score for _, m in found)[:FIRST]])
    settled = [
        (e, score_set(regression, sums, m.effects, start=m.by_variant) if m.score <= near else m)
        for e, m in found
    ]
    return [(e, m) for e, m in settled if m.plausible]


def _all_gears(
    regression: Regression, model: Scored, promise: Array, max_effects: int
) -> list[tuple[int, ...]]:
    """One law at the gears of all joints together: alone, each may hide what the others do."""
    gears: dict[str, dict[str, int]] = {}
    for e, effect in enumerate(regression.candidates):
        if effect.of_gear and e not in model.effects and promise[e] > WORTH:
            gears.setdefault(effect.name, {})[effect.where] = e
    sets = [tuple(places.values()) for places in gears.values()]
    return [each for each in sets if 1 < len(each) <= max_effects - len(model.effects)]
