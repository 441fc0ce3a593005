"""How far parts that a model leaves rigid may yield, and what estimates take of it.

Each way to yield counts by its probability: before anything is read it shows with some odds, with a
compliance that is of its usual size (half-normal), and the readings say more or less of both
(Bayesian model averaging).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit, log_ndtr

from sk120stiff.arrays import Array, Mask, lengths_of
from sk120stiff.effects import Effect, LinearElastic
from sk120stiff.errors import listed
from sk120stiff.identify.checks.left_over import beside, orthonormal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.covariance import posterior
from sk120stiff.identify.written import AnyFit, with_values

MOST = 0.5  # of a spring that may be a part's beside it: gears are softer
DRAWS = 200  # of the noise that readings will have
ROUNDING = 1e-9  # of the largest singular value, below which columns tell nothing new


def taken(kept: Array, prior: Array, ways: Array) -> Array:
    """(K, P) what estimates with derivative (M, P) and prior (P,) take of parts (M, K)."""
    covariance = posterior(kept, prior, np.zeros(len(kept)))[1]
    return np.asarray((covariance @ (kept.T @ ways)).T)


def weights(shown: Array, share: Array, told: Array, odds: float = 1.0) -> Array:
    """(K,) mean squares of parts in units of their usual sizes, as readings leave them.

    Args:
        shown: (M, K) what of them shows beside all that is estimated, in units of what is left.
        share: (K,) of a spring that each would be at its usual size, at the most.
        told: (K,) its product with what is left.
        odds: That a part shows, before anything is read; as likely as not by default.
    """
    spread = 1.0 / (1.0 + (shown**2).sum(axis=0))
    evidence, square = half_normal(spread * told, spread)
    weight = as_one(expit(evidence + np.log(odds)), shown) * (1.0 - spread)
    size = np.sqrt(square) * share
    return np.asarray(weight * square * np.minimum(1.0, MOST / np.maximum(size, 1e-300)) ** 2)


def expected_weights(shown: Array, share: Array, rng: np.random.Generator) -> Array:
    """`weights` as they will be where parts are rigid: their mean over draws of the noise."""
    told = rng.standard_normal((DRAWS, len(shown))) @ shown
    return np.asarray(np.mean([weights(shown, share, each) for each in told], axis=0))


def springs_told(found: Fit) -> Mask:
    """(P,) springs that parts may have moved; none where nothing tells the noise."""
    springs = np.array([p.effect.joint_spring for p in found.parameters], dtype=bool)
    known = bool(np.isfinite(found.unit) and found.unit)
    return springs & (found.x > 0.0) & found.identifiable & known


def moved_by_parts(
    found: AnyFit,
    kept: Array,
    prior: Array,
    ways: Array,
    effects: Sequence[Effect],
    *,
    base: Array,
    left: Array,
    odds: float = 1.0,
) -> AnyFit:
    """The fit with what parts may have made of its estimates in their standard errors.

    Everything is in units of what is left.

    Args:
        found: The fit.
        kept, prior: (M, Q) derivative by estimates on no bound, whatever else is beside them behind
            it, and their inverse variances before.
        ways: (M, K) what parts do per usual size of their compliances.
        effects: The part that each of these is of.
        base: (M, B) columns of all that is estimated.
        left: (M,) what is left.
        odds: See `weights`.
    """
    springs, moving = springs_told(found), ~found.at_bound
    takes = np.zeros((ways.shape[1], len(found.x)))
    takes[:, moving] = taken(kept, prior, ways)[:, : moving.sum()]
    shown = beside(orthonormal(base, ROUNDING), ways)
    share = np.abs(takes[:, springs] / found.x[springs]).max(axis=1)
    moves = np.sqrt(weights(shown, share, shown.T @ left, odds))[:, None] * takes
    by = [effects[int(k)].id for k in np.argmax(np.abs(moves), axis=0)]
    by = [name if moves[:, k].any() else "" for k, name in enumerate(by)]
    return with_values(replace(found, parts=moves.T @ moves, parts_by=tuple(by)))


def mostly_parts(found: Fit) -> tuple[str, ...]:
    """A sentence on springs of which most of the ± is what a part may yield in their place."""
    if found.parts is None:
        return ()
    own, whole = np.diag(found.parts), np.diag(found.covariance)
    by = [
        f"{p.effect.id} ({part})"
        for p, part, most in zip(found.parameters, found.parts_by, own > 0.5 * whole, strict=True)
        if p.effect.joint_spring and most
    ]
    if not by:
        return ()
    return (
        f"Most of the ± of {listed(by)} is what the part in brackets may yield in its place, "
        "which these readings leave open: other loads, or poses that load the two differently, "
        "tell them apart.",
    )


def half_normal(mean: Array, spread: Array) -> tuple[Array, Array]:
    """(K,) logarithm of the evidence for factors over that for none, and their mean squares.

    Of factors with a half-normal law of unit size that readings by themselves would leave at `mean`
    with variance `spread`, a normal law of unit size in it.
    """
    size = np.sqrt(spread)
    a = mean / size
    evidence = np.log(2.0 * size) + 0.5 * a**2 + log_ndtr(a)
    ratio = np.exp(-0.5 * a**2 - 0.5 * np.log(2.0 * np.pi) - log_ndtr(a))  # φ / Φ
    return evidence, spread * (1.0 + a**2 + a * ratio)


def as_one(likely: Array, shown: Array) -> Array:
    """(K,) probabilities of parts, of which those that show (M, K) alike share that of any of them.

    How far two are alike is the squared cosine between what they show.
    """
    size = lengths_of(shown)
    ways = np.divide(shown, size, out=np.zeros_like(shown), where=size > 0.0)
    alike = (ways.T @ ways) ** 2
    any_of_them = 1.0 - np.prod(1.0 - alike * likely, axis=1)
    return np.asarray(likely * any_of_them / np.maximum(alike @ likely, 1e-300))


def yields(cause: Effect) -> bool:
    """Is it a part that a calibration leaves rigid, and no spring of a joint?"""
    compliant = isinstance(cause, LinearElastic) and not cause.joint_spring
    return compliant and all(spec.lower == 0.0 for spec in cause.parameters)
