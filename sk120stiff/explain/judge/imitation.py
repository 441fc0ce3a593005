"""Does a name only imitate part of a cause that the catalogue lacks?

Beside whatever comes nearest to it, such a cause leaves something over, and two questions tell the
impostor from a cause that stands beside the foreign one.

Do the poses agree about its size? A parameter is a constant of the arm. With s_p what the effect
explains at pose p, V + κ² Σ_p s_p s_pᵀ lets every pose have a share of its own; restricted
likelihood says how far they differ (a random coefficient: Searle, Casella & McCulloch, *Variance
Components*). Half of a real cause's size at every pose is no constant.

Does something without a name do better in its place? Of all that `localise` suspects, from base to
tool, one may explain the gap better and leave nothing to the effect, or to several effects that
imitate it together.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.optimize import minimize

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import Effect
from sk120stiff.explain.judge.budget import brought
from sk120stiff.explain.localise.places import INDISTINCT, line_up, look_at
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.identify import Fit, yardstick
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.uncertainty.laid_out import LaidOut
from sk120stiff.identify.uncertainty.variance_components import Deviance
from sk120stiff.measurements.noise.model_form import ModelForm

DIFFER = 0.5  # spread of its size over the poses, relative to it, from which on it is no constant
BEYOND_CHANCE = 9.55  # gain in -2 ln L that chance brings in one of a thousand, half a χ² of one
BETTER = 6.0  # evidence (BIC) by which something without a name has to win
NOTHING = 0.3  # share of its length that is left to an effect of which another does the work
STARTS = (0.1, 0.3, 1.0)  # spreads from which the likeliest is looked for
FAR = 4.0  # ln of the factor by which a size is sought away from its start
VISIBLE = 1e-6  # share of a column that must remain beyond the model's own
NEGLIGIBLE = 1e6  # precision, in that of the readings, of random effects that are none
ALIKE = 1e-9  # square of a direction's length beyond others below which they are the same


@dataclass(frozen=True)
class Instead:
    """What would do in the place of names.

    Attributes:
        name: Completes the sentence "The gap goes with ...".
        better: Evidence (BIC) by which it wins, beyond what it needs.
        effects: Ids of the effects to which it leaves hardly anything.
    """

    name: str
    better: float
    effects: tuple[str, ...]


def own_columns(fit: Fit, effect: Effect) -> Mask:
    """(P_free,) which of a fit's parameters are the effect's."""
    return np.array([parameter.effect.id == effect.id for parameter in fit.parameters], dtype=bool)


def spread_over_poses(fit: Fit, effect: Effect) -> tuple[float, float]:
    """How far poses differ in the size of one effect, and how sure that is.

    Returns:
        spread, gain: Standard deviation κ over the poses, relative to the size; and the fall of
            -2 ln L against a size that is the same everywhere, or against poses that differ in the
            size of everything else, where that is likelier: then it is nothing of the effect's.
    """
    spread, gain = _spread(fit, brought(fit, effect.id))
    if spread > DIFFER and gain > BEYOND_CHANCE:
        others = {each.id for each in fit.model.effects} - {effect.id}
        gain -= max(_spread(fit, brought(fit, *others))[1], 0.0)
    return spread, gain


def _spread(fit: Fit, signature: Array) -> tuple[float, float]:
    """Likeliest κ of what every pose has a share of its own of, (N, 3) [m], and its gain."""
    sums = Deviance.of(LaidOut.of(fit, signature))
    form = fit.problem.noise.form
    free = np.array([form.proportional, form.constant]) > 0.0

    def least(spread: float) -> tuple[float, float]:
        """-2 ln L and spread where it is least, near a spread; zero stays zero."""

        def moved(logarithms: Array) -> tuple[ModelForm, float]:
            factor = np.ones(2)
            factor[free] = np.exp(np.clip(logarithms[1:], -FAR, FAR))
            other = replace(
                form,
                proportional=form.proportional * factor[0],
                constant=form.constant * factor[1],
            )
            return other, spread * float(np.exp(np.clip(logarithms[0], -FAR, FAR)))

        def at(logarithms: Array) -> float:
            return sums(*moved(logarithms))

        start = np.zeros(1 + free.sum())
        steps = np.vstack([start, 0.5 * np.eye(len(start))])
        rough = {"initial_simplex": steps, "xatol": 0.03, "fatol": 0.02, "maxiter": 200}
        found = minimize(at, start, method="Nelder-Mead", options=rough)
        likeliest = moved(found.x)
        return float(found.fun), likeliest[1] * sums.noise_factor(*likeliest)

    value, spread = min(least(begin) for begin in STARTS)
    return spread, least(0.0)[0] - value


def instead_of(
    fit: Fit, names: Sequence[Effect], alternatives: Sequence[Sequence[str]] = ()
) -> Instead | None:
    """The best of all suspects in the place of some of the names; None where none does better.

    With every suspect in the model those names leave it, one at a time, to which it leaves no
    evidence, or hardly any of their length. What a name does not do beside the other names alone,
    no suspect takes from it: nothing is said of such a name. A suspect that is the free form of a
    name's own law, or of the law of an effect that the readings do not tell from it, says what the
    name says, and is no reason against it; neither is one in the place of one name beside which it
    would explain less than it costs: fewer columns for the same make no better cause. The strongest
    name has to be beaten clearly, and by all that stand without it beside one suspect: names and
    any other suspect may stand together, and then both accounts hold a cause without a name.
    Beside model-form error such a cause is at work for certain and needs no evidence of its own: a
    further name has to do better than it, and it may stand for several. Where laws seem exact it
    takes the place of one.

    Args:
        fit: The fitted model.
        names: Effects that were added to it, the strongest first.
        alternatives: Ids of the effects that the readings do not tell from each of them.
    """
    line = line_up_with(fit, names)
    own = [{name.id, name.name} for name in names]
    for said, others in zip(own, alternatives, strict=False):
        said.update(others, (other.partition(":")[0] for other in others if ":" in other))
    everything = range(len(names))
    whole = line.score(everything)
    alone = [line.takes(everything) - line.takes(set(everything) - {e}) for e in everything]
    certain = bool(fit.problem.noise.form)
    tried = [e for e in everything if alone[e] > line.price(e)]
    found: list[Instead] = []
    beside = 0.0  # the best evidence with all names in the model
    for k, suspect in enumerate(line.suspects):
        kept = list(everything)
        while True:
            losses = {
                e: line.takes(kept, k) - line.takes(set(kept) - {e}, k) for e in kept if e in tried
            }
            idle = [
                e
                for e, loss in losses.items()
                if not own[e] & set(suspect.frees)
                and loss < max(line.price(e), NOTHING**2 * alone[e])
            ]
            if not idle or (len(kept) < len(names) and not certain):
                break
            kept.remove(min(idle, key=lambda e: losses[e]))
        if len(kept) == len(names) - 1 and line.score(everything, k) > whole:
            continue  # it says the same as the name
        better = whole - line.score(kept, k)
        fallen = tuple(names[e].id for e in everything if e not in kept)
        if fallen:
            needed = 0.0 if certain and 0 in kept else BETTER
            found.append(Instead(suspect.name, better - needed, fallen))
        else:
            beside = max(beside, better - BETTER)
    won = [each for each in found if each.better > (beside if names[0].id in each.effects else 0.0)]
    return max(won, key=lambda each: each.better, default=None)


@dataclass(frozen=True, eq=False)
class Lineup:
    """Names and suspects beyond the other parameters of a model, each column of length one.

    Sizes that are drawn (random effects) have the precision of their distribution beside that of
    the readings, and pay by their marginal likelihood; how widely they scatter is one parameter.
    """

    suspects: tuple[Suspect, ...]
    gram: Array  # (K, K)
    moment: Array  # (K,) with the gap that is left without names, in units of the noise
    names: list[Index]
    parts: list[Index]
    unit: float  # ln of the number of readings, what a parameter costs
    drawn: Mapping[int, float]  # precision of the sizes of those names that are random effects

    def price(self, name: int) -> float:
        """What the parameters of a name cost."""
        own = self.names[name]
        if name not in self.drawn:
            return self.unit * len(own)
        told = self.gram[np.ix_(own, own)] / self.drawn[name]
        return float(np.linalg.slogdet(np.eye(len(own)) + told)[1]) + self.unit

    def takes(self, names: Iterable[int], suspect: int | None = None) -> float:
        """Fall of the misfit that names and a suspect bring together, in noise variances."""
        chosen = sorted(names)
        own = [self.names[e] for e in chosen] + ([] if suspect is None else [self.parts[suspect]])
        at = np.concatenate(own or [np.zeros(0, dtype=np.intp)])
        prior = np.zeros(len(at))
        prior[: sum(map(len, own[: len(chosen)]))] = np.repeat(
            [self.drawn.get(e, 0.0) for e in chosen], [len(self.names[e]) for e in chosen]
        )
        values, vectors = np.linalg.eigh(self.gram[np.ix_(at, at)] + np.diag(prior))
        seen = values > ALIKE
        along = vectors[:, seen].T @ self.moment[at]
        return float((along**2 / values[seen]).sum())

    def score(self, names: Iterable[int], suspect: int | None = None) -> float:
        """Bayesian information criterion, up to a constant."""
        chosen = tuple(names)
        price = sum(self.price(e) for e in chosen)
        if suspect is not None:
            price += self.unit * len(self.parts[suspect])
            price += self.suspects[suspect].price_of_choice
        return price - self.takes(chosen, suspect)


def line_up_with(fit: Fit, names: Sequence[Effect]) -> Lineup:
    """Names of a fit and all suspects, side by side."""
    look = look_at(fit, yardstick(fit))
    # Without the names nothing of theirs is read, or misread.
    ids = (effect.id for effect in names)
    explained = np.einsum("nij,nj->ni", fit.problem.load_cases.reading_axes, brought(fit, *ids))
    lineup = line_up(replace(look, predicted=look.predicted - explained))
    own = [own_columns(fit, effect) for effect in names]
    free = np.any(own, axis=0)
    moving = ~fit.at_bound
    others = orthonormal(fit.jacobian[:, moving & ~free])
    counts = [int((mask & moving).sum()) for mask in own]
    both = np.hstack([*(fit.jacobian[:, mask & moving] for mask in own), lineup.white])
    gap = fit.jacobian[:, free] @ fit.x[free] - fit.residual
    beyond = both - others @ (others.T @ both)
    length, left = np.linalg.norm(both, axis=0), np.linalg.norm(beyond, axis=0)
    visible = left > np.where(np.arange(len(left)) < sum(counts), VISIBLE, INDISTINCT) * length
    beyond = np.where(visible, beyond / np.where(visible, left, 1.0), 0.0)
    ends = np.cumsum([0, *counts])
    spans = [slice(int(a), int(b)) for a, b in pairwise(ends)]
    spans += [slice(int(ends[-1]) + part.start, int(ends[-1]) + part.stop) for part in lineup.parts]
    at = [np.arange(span.start, span.stop)[visible[span]] for span in spans]
    drawn = {
        k: _precision(fit.x[mask & moving], left[span], look.noise.scale)
        for k, (effect, mask, span) in enumerate(zip(names, own, spans, strict=False))
        if effect.random_effects
    }
    return Lineup(
        suspects=lineup.suspects,
        gram=beyond.T @ beyond,
        moment=beyond.T @ gap / np.sqrt(look.noise.scale),
        names=at[: len(names)],
        parts=at[len(names) :],
        unit=float(np.log(max(len(gap), 2))),
        drawn=drawn,
    )


def _precision(sizes: Array, length: Array, scale: float) -> float:
    """Of the distribution of random effects, by its moments, where a column has length one."""
    spread = float(np.mean(sizes**2 * length**2)) / scale - 1.0  # every estimate scatters by one
    return 1.0 / max(spread, 1.0 / NEGLIGIBLE)


def imitated(
    fit: Fit, names: Sequence[Effect], alternatives: Sequence[Sequence[str]] = ()
) -> tuple[str, str] | None:
    """The weakest name that may be no cause of its own, and why, in a sentence; None: no name.

    Args:
        fit: The fitted model.
        names: Effects that were added to it, the strongest first.
        alternatives: Ids of the effects that the readings do not tell from each of them.
    """
    other = instead_of(fit, names, alternatives) if names else None
    if other is not None:
        return other.effects[-1], (
            f"{other.effects[-1]} fits, but the gap goes better with {other.name}, beside which "
            "nothing is left for it; it may imitate part of another cause and is not named."
        )
    for effect in reversed(names):
        spread, gain = spread_over_poses(fit, effect)
        if spread > DIFFER and gain > BEYOND_CHANCE:
            return effect.id, (
                f"{effect.id} fits, but poses differ in its size by "
                f"{100.0 * min(spread, 9.99):.0f} %; what is no constant of the arm may imitate "
                "part of another cause, and is not named."
            )
    return None
