"""What links, bearings and floors that a calibration leaves rigid may make of its springs.

No link is rigid. What one yields as a spring does is counted in that spring; what shows beside it,
and nothing asks for, moves the springs all the same. Each way in which a part yields counts by its
probability: before anything is read it shows as likely as not, with a compliance that is of its
usual size (half-normal), and the readings say more or less of both (Bayesian model averaging).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit, log_ndtr

from sk120stiff.arrays import Array, lengths_of
from sk120stiff.effects import CATALOGUE, Catalogue, Effect, LinearElastic
from sk120stiff.errors import listed
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.nuisances import posterior
from sk120stiff.identify.positions.omitted.other_causes import beside
from sk120stiff.identify.positions.omitted.selection import Blocks
from sk120stiff.identify.written import with_values

MOST = 0.5  # of a spring that may be a part's beside it: gears are softer
DRAWS = 200  # of the noise that readings will have
ROUNDING = 1e-9  # of the largest singular value, below which columns tell nothing new


def beside_parts(
    found: Calibration, catalogue: Catalogue = CATALOGUE, without: Collection[str] = ()
) -> Calibration:
    """The calibration, its values uncertain by parts that may yield.

    Causes that it lacks beyond doubt (`lacks`) stand beside them, and are none of them.

    Args:
        found: The calibration.
        catalogue: All that may be at work.
        without: Effects that are known to be rigid, by ``name`` or ``name:where``.
    """
    springs = np.array([p.effect.joint_spring for p in found.parameters], dtype=bool)
    springs &= (found.x > 0.0) & found.identifiable
    if not springs.any() or not np.isfinite(found.unit) or not found.unit:
        return found

    def wanted(cause: Effect) -> bool:
        part = yields(cause) and not {cause.id, cause.name} & set(without)
        return part or cause.id in found.lacks

    blocks, moving = Blocks.of(found, catalogue, wanted), ~found.at_bound
    lacking = [k for k, cause in enumerate(blocks.causes) if cause.id in found.lacks]
    parts = [k for k in range(len(blocks.causes)) if k not in lacking]
    if not parts:
        return found
    beyond = np.hstack([np.zeros((len(found.residual), 0)), *(blocks.whole[k] for k in lacking)])
    kept = np.hstack([-found.jacobian[:, moving], beyond]) / found.unit
    prior = np.concatenate([1.0 / found.problem.prior[moving] ** 2, np.ones(beyond.shape[1])])
    ways = np.hstack([blocks.whole[k] for k in parts]) / found.unit
    takes = np.zeros((ways.shape[1], len(found.x)))
    takes[:, moving] = taken(kept, prior, ways)[:, : moving.sum()]
    shown = beside(orthonormal(np.hstack([blocks.base, beyond]), ROUNDING), ways)
    share = np.abs(takes[:, springs] / found.x[springs]).max(axis=1)
    told = shown.T @ (found.residual / found.unit)
    moves = np.sqrt(weights(shown, share, told))[:, None] * takes
    effects = [blocks.causes[k] for k in parts for _ in blocks.causes[k].parameters]
    notes = (*found.notes, *_mostly_by(found, effects, moves))
    return with_values(replace(found, parts=moves.T @ moves, notes=notes))


def taken(kept: Array, prior: Array, ways: Array) -> Array:
    """(K, P) what estimates with derivative (M, P) and prior (P,) take of parts (M, K)."""
    covariance = posterior(kept, prior, np.zeros(len(kept)))[1]
    return np.asarray((covariance @ (kept.T @ ways)).T)


def weights(shown: Array, share: Array, told: Array) -> Array:
    """(K,) mean squares of parts in units of their usual sizes, as readings leave them.

    Args:
        shown: (M, K) what of them shows beside all that is estimated, in units of what is left.
        share: (K,) of a spring that each would be at its usual size, at the most.
        told: (K,) its product with what is left.
    """
    spread = 1.0 / (1.0 + (shown**2).sum(axis=0))
    evidence, square = half_normal(spread * told, spread)
    weight = as_one(expit(evidence), shown) * (1.0 - spread)
    size = np.sqrt(square) * share
    return np.asarray(weight * square * np.minimum(1.0, MOST / np.maximum(size, 1e-300)) ** 2)


def expected_weights(shown: Array, share: Array, rng: np.random.Generator) -> Array:
    """`weights` as they will be where parts are rigid: their mean over draws of the noise."""
    told = rng.standard_normal((DRAWS, len(shown))) @ shown
    return np.asarray(np.mean([weights(shown, share, each) for each in told], axis=0))


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


def _mostly_by(found: Calibration, parts: Sequence[Effect], moves: Array) -> Iterator[str]:
    """Which springs are uncertain mostly by parts, and by which; moves (K, P) of the estimates."""
    known = np.diag(found.covariance)
    by = [
        f"{p.effect.id} ({parts[int(np.argmax(np.abs(moves[:, k])))].id})"
        for k, p in enumerate(found.parameters)
        if p.effect.joint_spring and moves[:, k] @ moves[:, k] > known[k]
    ]
    if by:
        yield (
            f"Most of the ± of {listed(by)} is what the part in brackets may yield in its place, "
            "which these positions leave open: other payloads, or poses that load the two "
            "differently, tell them apart."
        )
