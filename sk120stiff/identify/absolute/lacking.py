"""What the causes that a calibration lacks move its values by.

Springs swallow what a model lacks: the noise tells nothing of by how much. Where what is left asks
for other causes beyond doubt, the values are as uncertain as they differ from those beside these
causes, and they differ together: positions like those that were read are foretold much the same.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit

from sk120stiff.arrays import Array, Mask, lengths_of
from sk120stiff.effects import CATALOGUE, Catalogue, Effect, LinearElastic
from sk120stiff.errors import listed
from sk120stiff.identify.absolute.asked_for import CLEAR, Blocks
from sk120stiff.identify.absolute.calibrate import Calibration
from sk120stiff.identify.absolute.left_out import posterior
from sk120stiff.identify.written import with_values

MOST = 0.5  # of a spring that may be a part's beside it


def beside_lacking(found: Calibration, catalogue: Catalogue = CATALOGUE) -> Calibration:
    """The calibration with the causes that it lacks beyond doubt, and standard errors beside them.

    One of many that are looked at is beyond doubt by as much more as there are.
    """
    if not np.isfinite(found.unit) or not found.unit:
        return found
    blocks = Blocks.of(found, catalogue)
    beyond_doubt = CLEAR + 2.0 * float(np.log(max(len(blocks.causes), 1)))
    chosen = blocks.at_least(beyond_doubt, blocks.asked_for())
    if not chosen:
        return found
    step, spread = _moved(
        found,
        np.concatenate([blocks.whole[k] for k in chosen], axis=1),
        np.concatenate([blocks.positive[k] for k in chosen]),
    )
    causes = tuple(blocks.causes[k].id for k in chosen)
    moved = replace(found, foreign=np.outer(step, step) + spread)
    return replace(with_values(moved), lacks=causes)


def beside_parts(
    found: Calibration,
    catalogue: Catalogue = CATALOGUE,
    among: Collection[Effect] | None = None,
) -> Calibration:
    """The calibration, uncertain by links, bearings and floors that it leaves rigid.

    Where joints yield, so may these: before anything is read, that one shows is as likely as not.
    By how far each moves the estimates, times its probability, they are uncertain, and together
    (Bayesian model averaging). What shows nothing beside a spring is counted in that spring, and
    moves nothing; parts that show alike are one. No part takes more from a spring than it leaves
    there: gears are softer.

    Args:
        found: The calibration.
        catalogue: All that may be at work.
        among: What may be; None: all of it.
    """
    springs = np.array([p.effect.joint_spring for p in found.parameters], dtype=bool)
    springs &= found.x > 0.0
    if found.lacks or not springs.any() or not np.isfinite(found.unit) or not found.unit:
        return found
    others = None if among is None else {effect.id for effect in among}

    def may_be(cause: Effect) -> bool:
        yields = isinstance(cause, LinearElastic) and all(s.lower == 0.0 for s in cause.parameters)
        return yields and not cause.joint_spring and (others is None or cause.id in others)

    parts = Blocks.of(found, catalogue, may_be)
    moves = np.zeros((len(parts.causes), len(found.x)))
    shown = np.zeros((len(parts.causes), len(found.residual)))
    likely = np.zeros(len(parts.causes))
    for k, (own, whole) in enumerate(zip(parts.columns, parts.whole, strict=True)):
        positive, left = parts.positive[k], found.residual / found.unit
        shown[k], evidence = _fitted(own / found.unit, positive, left)
        likely[k] = expit(evidence)
        step = _moved(found, whole, positive)[0]
        most = np.abs(step[springs] / found.x[springs]).max()
        moves[k] = min(1.0, MOST / max(most, 1e-300)) * step
    moves *= np.sqrt(_as_one(likely, shown))[:, None]
    foreign = np.zeros((len(found.x),) * 2) if found.foreign is None else found.foreign
    notes = (*found.notes, *_mostly_by(found, parts.causes, moves))
    return with_values(replace(found, foreign=foreign + moves.T @ moves, notes=notes))


def _as_one(likely: Array, shown: Array) -> Array:
    """(K,) probabilities of parts, of which those that show (K, M) alike share that of any of them.

    How far two are alike is the squared cosine between what they show.
    """
    size = lengths_of(shown.T)
    ways = np.divide(shown, size[:, None], out=np.zeros_like(shown), where=size[:, None] > 0.0)
    alike = (ways @ ways.T) ** 2
    any_of_them = -np.expm1(alike @ np.log1p(-np.minimum(likely, 1.0 - 1e-9)))
    return np.asarray(likely * any_of_them / np.maximum(alike @ likely, 1e-300))


def _mostly_by(found: Calibration, parts: Sequence[Effect], moves: Array) -> Iterator[str]:
    """Which springs are uncertain mostly by parts, and by which; moves (K, P) of the estimates."""
    known = np.diag(found.covariance)
    by = [
        (p.effect.id, parts[int(np.argmax(np.abs(moves[:, k])))].id)
        for k, p in enumerate(found.parameters)
        if p.effect.joint_spring and moves[:, k] @ moves[:, k] > known[k]
    ]
    if by:
        springs = listed([f"{spring} (by {part})" for spring, part in by])
        yield (
            f"The ± of {springs} comes mostly from what links and bearings beside may yield, which "
            "these positions leave open. Further payloads, and poses in which the one is bent "
            "without the other, tell them apart."
        )


def _fitted(columns: Array, positive: Mask, left: Array) -> tuple[Array, float]:
    """(M,) what columns (M, p) of unit normal factors make up of what is left, and the logarithm of
    their evidence over that for none."""
    while True:
        inner = np.eye(columns.shape[1]) + columns.T @ columns
        pull = columns.T @ left
        factors = np.linalg.solve(inner, pull)
        wrong = positive & (factors < 0.0)
        if not wrong.any():
            evidence = 0.5 * (pull @ factors - np.linalg.slogdet(inner)[1])
            return columns @ factors, float(evidence)
        columns, positive = columns[:, ~wrong], positive[~wrong]


def _moved(found: Calibration, more: Array, positive: Mask) -> tuple[Array, Array]:
    """(P,) move of the estimates beside further columns (M, p), and (P, P) what that adds to their
    covariance."""
    moving, per = ~found.at_bound, 1.0 / found.unit
    kept, left = -per * found.jacobian[:, moving], per * found.residual
    drawn = 1.0 / found.problem.prior[moving] ** 2
    here, alone = posterior(kept, drawn, left)
    while True:
        both = np.column_stack([kept, per * more])
        there, beside = posterior(both, np.concatenate([drawn, np.ones(more.shape[1])]), left)
        wrong = positive & (there[len(here) :] < 0.0)
        if not wrong.any():
            break
        more, positive = more[:, ~wrong], positive[~wrong]
    count = len(here)
    spread, ways = np.linalg.eigh(beside[:count, :count] - alone)
    step, wider = np.zeros(len(found.x)), np.zeros((len(found.x),) * 2)
    step[moving] = there[:count] - here
    wider[np.ix_(moving, moving)] = (ways * np.maximum(spread, 0.0)) @ ways.T
    return step, wider
