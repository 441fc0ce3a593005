"""The question "what is missing?" as one linear regression over the whole catalogue.

At a fitted model the readings are linear in all parameters to very good accuracy, those of absent
effects included: y ≈ X v, with X the whitened sensitivities and v internal values (zero: absent).
Everything that searches, resamples and cross-validates works on sums over poses of XᵀX and Xᵀy, so
that thousands of models cost no more than a blink. What wins is refitted at exact equilibrium.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from statistics import median

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import Effect
from sk120stiff.explain.candidates.form_rows import FormRows, form_rows
from sk120stiff.explain.candidates.linearised import Linearised, linearised_at
from sk120stiff.explain.candidates.sums import Solved, Sums, sums_of, weighing
from sk120stiff.explain.priors import price
from sk120stiff.identify import Fit

BY_FAR = 1.5  # times the square that springs allow a coupling: what errors of readings bring


@dataclass(frozen=True, eq=False)
class Regression:
    """Linearised readings against the parameters of base model and candidates.

    Attributes:
        y: (R,) whitened readings, R numbers that were read.
        X: (R, P) whitened sensitivities, in typical sizes of the parameters.
        group: (R,) pose of each row; resampling and folds never cut a pose.
        base: Columns of the base model, part of every model.
        candidates: The effects that may be missing.
        columns: For each candidate the columns of its parameters.
        variants: For each candidate the sets of columns by which it may enter: its parameters;
            where some of them are often equal, one common column for those; the parameters of its
            other laws.
        laws: For each of these variants the effect whose law it is.
        tied, usual: For each candidate which of its variants has the common column (-1: none), and
            which has the law that the catalogue gives it.
        lower: (P,) physical lower bounds in typical sizes (0 or -inf).
        plausible: (P,) magnitudes in typical sizes beyond which a value explains nothing, on an arm
            as soft as the springs of the base model alone say; see `believed`.
        softness: How many times softer than usual that is.
        springs: Columns of the springs of the joints.
        compliances: (P,) which columns are compliances.
        sigma_known: The noise's size is known; else it is estimated by every model for itself.
        alpha: Probability at which a first effect may be named where nothing is missing.
        prior: Probabilities of effects that the user gave, by ``name`` or ``name:where``.
        soft: Ids of candidates that may be softer than is customary, see `brought.py`.
        form: Its part in which model-form error outweighs the noise; None where there is none.
        linearised: What it was made from; its sensitivities may be those of another fit nearby.
    """

    y: Array
    X: Array
    group: Index
    base: Index
    candidates: tuple[Effect, ...]
    columns: tuple[Index, ...]
    variants: tuple[tuple[Index, ...], ...]
    laws: tuple[tuple[Effect, ...], ...]
    tied: tuple[int, ...]
    usual: tuple[int, ...]
    lower: Array
    plausible: Array
    softness: float
    springs: Index
    compliances: Mask
    sigma_known: bool
    alpha: float
    prior: Mapping[str, float]
    soft: frozenset[str] = frozenset()
    form: FormRows | None = None
    linearised: Linearised | None = None

    @cached_property
    def unusual(self) -> tuple[float, ...]:
        """What each candidate pays for being less usual than others."""
        return tuple(price(effect, self.prior) for effect in self.candidates)

    @property
    def rows(self) -> int:
        """Number of whitened readings R."""
        return len(self.y)

    @cached_property
    def prices_of_choice(self) -> tuple[Array, ...]:
        """For each candidate what each of its variants pays, see `price_of_choice`."""
        return tuple(
            np.array([price_of_choice(self, e, k) for k in range(len(parts))])
            for e, parts in enumerate(self.variants)
        )

    @cached_property
    def every_variant(self) -> tuple[Array, Array]:
        """(V,) number of parameters and (V,) price of every variant, see `prices_of_choice`."""
        counts = [len(part) for parts in self.variants for part in parts]
        return np.array(counts), np.concatenate([*self.prices_of_choice, np.zeros(0)])

    @cached_property
    def first_variants(self) -> Index:
        """(candidates + 1,) place of each candidate's first variant among all V; V comes last."""
        return np.append(0, np.cumsum([len(parts) for parts in self.variants])).astype(np.intp)

    @cached_property
    def in_base(self) -> Mask:
        """(P,) which columns belong to the base model."""
        out = np.zeros(self.X.shape[1], dtype=bool)
        out[self.base] = True
        return out

    def believed(self, solved: Solved) -> Array:
        """Magnitudes beyond which a value of a solution is not believed, of its columns.

        The springs beside which it was found tell how soft the arm is, not those of another model:
        where a soft base is missing, springs alone look soft as well.
        """
        mine = self._is_spring[solved.columns]
        ratio = softness(solved.values[mine])
        limits = self.plausible[solved.columns]
        return np.where(self.compliances[solved.columns], limits * ratio / self.softness, limits)

    def is_believed(self, solved: Solved) -> bool:
        """Is every value of an added parameter believed, and does no part give off energy?"""
        return self.are_sizes_believed(solved) and self._is_passive(solved)

    def _is_passive(self, solved: Solved) -> bool:
        """Does no compliance that couples two others exceed by far what their springs allow?

        By little it does where a part is stiff one way and its readings err; a fit does not let it.
        """
        if not self._couple[solved.columns].any():
            return True
        for i, j, k, most in self._couplings:
            if k in solved.columns:
                own = (float(solved.values[solved.columns == column].sum()) for column in (i, j, k))
                first, second, coupling = own  # a compliance at its bound is no column: zero
                if coupling**2 > BY_FAR * most * first * second:
                    return False
        return True

    @cached_property
    def _couplings(self) -> tuple[tuple[int, int, int, float], ...]:
        """Columns i, j, k of every law of which k couples i and j, and the most of k² / i j."""
        found = []
        for variants, laws in zip(self.variants, self.laws, strict=True):
            for columns, law in zip(variants, laws, strict=True):
                typical = [spec.typical for spec in law.parameters]
                for i, j, k in law.couplings if len(columns) == len(typical) else ():
                    most = typical[i] * typical[j] / typical[k] ** 2
                    found.append((int(columns[i]), int(columns[j]), int(columns[k]), most))
        return tuple(dict.fromkeys(found))

    @cached_property
    def _couple(self) -> Mask:
        """(P,) which columns couple two others."""
        out = np.zeros(self.X.shape[1], dtype=bool)
        out[[k for _, _, k, _ in self._couplings]] = True
        return out

    def are_sizes_believed(self, solved: Solved) -> bool:
        """Does no value of an added parameter lie beyond what is believed?"""
        size = np.abs(solved.values)
        if not (size > self._always[solved.columns]).any():
            return True
        return not ((size > self.believed(solved)) & ~self.in_base[solved.columns]).any()

    @cached_property
    def _always(self) -> Array:
        """(P,) what is believed of the stiffest arm, of the base model anything."""
        limits = np.where(self.compliances, self.plausible / self.softness, self.plausible)
        return np.where(self.in_base, np.inf, limits)

    @cached_property
    def _is_spring(self) -> Mask:
        out = np.zeros(self.X.shape[1], dtype=bool)
        out[self.springs] = True
        return out

    @cached_property
    def least_fall(self) -> float:
        """χ² quantile that one parameter has to reach at alpha over the number of candidates."""
        return float(stats.chi2.isf(self.alpha / max(len(self.candidates), 1), 1))

    def law(self, candidate: int, variant: int) -> Effect:
        """The effect that a candidate is when it enters by one of its variants."""
        return self.laws[candidate][variant]

    @cached_property
    def variants_by_size(self) -> tuple[tuple[Index, Index], ...]:
        """Places (m,) among all variants and their columns (m, k), for every k there is."""
        by_size: dict[int, list[int]] = {}
        every = [part for parts in self.variants for part in parts]
        for place, part in enumerate(every):
            by_size.setdefault(len(part), []).append(place)
        return tuple(
            (np.array(places), np.array([every[place] for place in places]))
            for size, places in by_size.items()
            if size
        )

    @cached_property
    def poses(self) -> int:
        """Number of groups."""
        return int(self.group.max()) + 1 if len(self.group) else 0

    def sums(self) -> Sums:
        """Sums over all poses, each counted once; it remembers what was scored by them."""
        return self._all

    def weighing(self, columns: Index) -> Callable[[Array], Sums]:
        """Sums over poses as a function of how often each counts, of some columns; others are zero.

        A model that has only these columns is scored as by all of them, in a fraction of the time.
        """
        size = self.X.shape[1]
        parts = [
            weighing(rows.X[:, columns], rows.y, rows.group, columns, size)
            for rows in (self, self.form)
            if rows
        ]

        def weighed(weights: Array) -> Sums:
            whole, *form = (part(weights) for part in parts)
            return replace(whole, form=form[0]) if form else whole

        return weighed

    @cached_property
    def _all(self) -> Sums:
        whole = sums_of(self.X, self.y)
        form = None if self.form is None else sums_of(self.form.X, self.form.y)
        return replace(whole, form=form)


def price_of_choice(regression: Regression, effect: int, variant: int, tied: bool = True) -> float:
    """What an effect pays for the variant by which it enters, and for being less usual.

    The law that the catalogue gives it is the usual one, with its parameters equal or not. The
    others together are as likely, those less that are rarer by themselves (`Effect.law_prior`).
    """
    usual = {regression.usual[effect]}
    if regression.usual[effect] == 0 and regression.tied[effect] > 0 and tied:
        usual.add(regression.tied[effect])
    others = len(regression.variants[effect]) - len(usual)
    count = len(usual) if variant in usual else others
    law = regression.law(effect, variant)
    return price_of_law(law, count, usual=variant in usual) + regression.unusual[effect]


def price_of_law(law: Effect, count: int, *, usual: bool) -> float:
    """What one of `count` laws pays: the usual ones nothing but for being several, any other twice,
    and a rare one for that.

    So much must the misfit fall for it in units of the noise's variance.
    """
    return 2.0 * float(np.log((count if usual else 2.0 * count) / law.law_prior))


def regression_at(
    fit: Fit,
    candidates: Sequence[Effect],
    base_effects: Sequence[str],
    *,
    alpha: float,
    prior: Mapping[str, float] | None = None,
    soft: frozenset[str] = frozenset(),
    near: Linearised | None = None,
) -> Regression:
    """Linearise the readings at a fit, over its own parameters and all candidates.

    Args:
        fit: A fitted model; effects of it that are not in `base_effects` count as candidates.
        candidates: Effects to consider besides; those that the model holds already are skipped.
        base_effects: Ids of the effects that belong to every model.
        alpha, prior, soft: See `Regression`; without `prior` the table of `priors.py` counts alone.
        near: Sensitivities at another fit, see `linearised_at`.
    """
    problem = fit.problem
    linear = linearised_at(fit, candidates, base_effects, near)
    full, chosen, others = linear.model, linear.candidates, linear.laws
    specs = [parameter.spec for parameter in full.parameters]
    typical = np.array([spec.typical for spec in specs])
    X = problem.whitener.apply(linear.sensitivities)
    gap = problem.whitener.apply(fit.gap)
    fixed = np.array([not p.free for p in full.parameters])
    y = gap + X[:, ~fixed] @ (full.values / typical)[~fixed]

    same: dict[str, int] = {}  # a parameter of two laws of one effect has one column
    first = [same.setdefault(p.name, k) for k, p in enumerate(full.parameters)]

    owned: dict[Effect, list[int]] = {}
    for k, p in enumerate(full.parameters):
        if p.free:
            owned.setdefault(p.effect, []).append(first[k])

    def columns_of(effect: Effect) -> Index:
        return np.array(owned.get(effect, []), dtype=np.intp)

    base = [columns_of(effect) for effect in full.effects if effect.id in base_effects]
    columns = tuple(columns_of(effect) for effect in chosen)
    lower = np.array([0.0 if spec.lower == 0.0 else -np.inf for spec in specs])
    springs = [p.internal / p.spec.typical for p in fit.parameters if p.effect.joint_spring]
    softer = softness(np.array(springs))
    compliances = np.array([spec.reciprocal for spec in specs])
    any_size = {*soft, *base_effects}
    plausible = np.array([
        (p.spec.plausible if p.effect.id in any_size else p.spec.believed) / p.spec.typical
        for p in full.parameters
    ])  # fmt: skip
    plausible[compliances] *= softer
    tied, sources, variants = _variants(chosen, columns, X)
    plain = {effect.id: effect for effect in candidates}
    all_laws = tuple(
        (*(effect for _ in own), *laws)
        for effect, own, laws in zip(chosen, variants, others, strict=True)
    )
    whole = np.hstack([X, tied])
    return Regression(
        y=y,
        X=whole,
        group=problem.pose,
        base=np.concatenate([*base, np.zeros(0, dtype=np.intp)]),
        candidates=tuple(chosen),
        columns=columns,
        variants=tuple(
            (*own, *(columns_of(law) for law in laws))
            for own, laws in zip(variants, others, strict=True)
        ),
        laws=all_laws,
        tied=tuple(1 if len(own) > 1 else -1 for own in variants),
        usual=tuple(
            laws.index(plain[laws[0].id]) if plain.get(laws[0].id) in laws else 0
            for laws in all_laws
        ),
        lower=np.concatenate([lower, lower[sources]]),
        plausible=np.concatenate([plausible, plausible[sources]]),
        softness=softer,
        springs=np.array(
            [first[k] for k, p in enumerate(full.parameters) if p.effect.joint_spring and p.free],
            dtype=np.intp,
        ),
        compliances=np.concatenate([compliances, compliances[sources]]),
        sigma_known=fit.sigma_known,
        alpha=alpha,
        prior=prior or {},
        soft=soft,
        form=form_rows(fit, whole, y),
        linearised=linear,
    )


def softness(springs: Array) -> float:
    """How many times softer than others of its length an arm is, by the median; at least 1.

    What is plausible of a bearing or a link goes with the whole arm: where every drive is a hundred
    times softer than usual, a bearing may be. What the readings do not show of a spring is as good
    as rigid in a solution, and must not speak for the arm.

    Args:
        springs: Compliances of its joints in typical sizes; what is rigid does not count.
    """
    moving = [math.log(each) for each in springs.tolist() if each > 0.0]
    return max(math.exp(median(moving)), 1.0) if moving else 1.0


def _variants(
    effects: Sequence[Effect], columns: Sequence[Index], X: Array
) -> tuple[Array, Index, tuple[tuple[Index, ...], ...]]:
    """Columns of tied parameters, a column that each resembles, and the variants of all effects."""
    tied: list[Array] = []
    sources: list[int] = []
    variants: list[tuple[Index, ...]] = []
    for effect, own in zip(effects, columns, strict=True):
        found = [own]
        if effect.ties and len(own) == len(effect.parameters):
            bound = {k for group in effect.ties for k in group}
            entry = [int(own[k]) for k in range(len(own)) if k not in bound]
            for group in effect.ties:
                entry.append(X.shape[1] + len(tied))
                sources.append(int(own[group[0]]))
                tied.append(X[:, own[list(group)]].sum(axis=1))
            found.append(np.array(entry, dtype=np.intp))
        variants.append(tuple(found))
    extra = np.column_stack(tied) if tied else np.zeros((len(X), 0))
    return extra, np.array(sources, dtype=np.intp), tuple(variants)
