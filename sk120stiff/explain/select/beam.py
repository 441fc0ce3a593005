"""Which set of effects explains the gap best: a beam search over models of the catalogue."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.candidates.sums import Solved, Sums
from sk120stiff.explain.select.score import Scored, score_set, score_sets
from sk120stiff.explain.select.size_prices import price_of_sizes

BEAM = 12  # models kept at each size of the search
SETTLED = 2  # of them whose effects all try their variants
HOPELESS = 40.0  # score by which larger models lose that have no future
CONTENDERS = 24  # candidates that are tried in the place of an effect
NEAR = 40.0  # difference of scores within which their neighbours may take other laws
FIRST = 4  # of them whose neighbours may anyway: a strong beam by another taper hides much
WORTH = 4.0  # fall of the misfit that a gear's curve promises, to join in with all others


def promises(regression: Regression, sums: Sums, model: Solved) -> list[Array]:
    """For each candidate, what each of its variants could take away from the misfit of a model.

    One projection serves all: with S the columns of one variant and M projecting out the model, it
    is ‖orth(M S)ᵀ r‖², no bound of a parameter kept but that of one alone.
    """
    inside = model.columns
    gram_in = sums.gram[np.ix_(inside, inside)] + np.diag(regression.plausible[inside] ** -2.0)
    scale = np.sqrt(np.maximum(np.diag(gram_in), 1e-300))
    cross = sums.gram[inside] / scale[:, None]
    solved = np.linalg.solve(gram_in / np.outer(scale, scale), cross)
    residual = sums.moment - solved.T @ (sums.moment[inside] / scale)
    out = [np.zeros(len(parts)) for parts in regression.variants]
    size = np.sqrt(np.maximum(np.diag(sums.gram), 1e-300))
    for pairs, columns in regression.variants_by_size:
        blocks = sums.gram[columns[:, :, None], columns[:, None, :]]
        blocks = blocks - cross.T[columns] @ np.swapaxes(solved.T[columns], 1, 2)
        scales = size[columns]
        right = residual[columns] / scales
        values, vectors = np.linalg.eigh(blocks / (scales[:, :, None] * scales[:, None, :]))
        along = np.einsum("mki,mk->mi", vectors, right)
        seen = values > 1e-9
        found = np.where(seen, along**2 / np.where(seen, values, 1.0), 0.0).sum(axis=1)
        if columns.shape[1] == 1:
            found[(right[:, 0] < 0.0) & (regression.lower[columns[:, 0]] == 0.0)] = 0.0
        for (e, k), gain in zip(pairs, found, strict=True):
            out[e][k] = gain
    return out


def gains(regression: Regression, sums: Sums, model: Solved) -> Array:
    """(candidates,) upper bound on the misfit that each candidate could take away from a model."""
    return largest(promises(regression, sums, model))


def largest(promised: list[Array]) -> Array:
    """(candidates,) the most that any variant promises."""
    return np.array([float(each.max(initial=0.0)) for each in promised])


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

    front = [score_set(regression, total, ())]
    seen[()] = front[0]
    for _ in range(max_effects):
        children: list[dict[int, int]] = []
        for model in front:
            promised = promises(regression, total, model.solved)
            promise = largest(promised)
            order = [int(e) for e in np.argsort(-promise) if int(e) not in model.effects]
            room = len(model.effects) < max_effects  # gears that joined together took more
            steps: list[tuple[int, ...]] = [(e,) for e in order[: 2 * width]] if room else []
            steps += _all_gears(regression, model, promise, max_effects)
            for step in steps:
                likely = {e: likeliest(regression, total, e, promised[e]) for e in step}
                children.append(model.by_variant | likely)
        grown = {child.effects: child for child in scored(children)}
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
    promise = gains(regression, sums, without.solved)
    order = [int(e) for e in np.argsort(-promise) if int(e) not in (*rest, effect)][:CONTENDERS]
    found = [(e, score_set(regression, sums, (*rest, e), start=start, only=(e,))) for e in order]
    near = max([model.score + NEAR, *sorted(m.score for _, m in found)[:FIRST]])
    settled = [
        (e, score_set(regression, sums, m.effects, start=m.by_variant) if m.score <= near else m)
        for e, m in found
    ]
    return [(e, m) for e, m in settled if m.plausible]


def likeliest(regression: Regression, sums: Sums, effect: int, promised: Array) -> int:
    """The variant that promises the best score."""
    counts = np.array([len(part) for part in regression.variants[effect]])
    sizes = price_of_sizes(promised, counts, max(sums.count, 2.0))
    return int(np.argmax(promised - sizes - regression.prices_of_choice[effect]))


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
