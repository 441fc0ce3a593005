"""Least squares to the last digit within bounds: where the two algorithms meet.

Gauss–Newton steps by singular values. Directions in which no plausible change of the parameters
would show in the readings do not move. Where the misfit is large the curvature of the model counts
too, Σ r_i ∇²r_i; it is learned from the steps by symmetric rank-one updates, and used where the sum
is positive definite (Dennis, Gay & Welsch 1981 do it by rank two). Bounds are kept by an active
set: a step ends at the first bound it meets, and a parameter leaves its bound only if the misfit
falls inwards (Lawson & Hanson 1974, chapter 23).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import Refusal

Evaluate = Callable[[Array], tuple[Array, Array]]

FAINTEST = 0.1  # a change by all that is plausible that shows by less of the noise is not seen
STEPS = 100  # of Newton, at most; four more for every parameter
PATIENCE = 20  # evaluations of the model after which the misfit must have fallen
FALLEN = 1e-4  # by more than this share of what one reading adds to it
FINE = 1e-12  # relative step at which nothing is left to gain
LEARNED = 1e-6  # relative step below which rounding hides the curvature
SOUND = 0.1  # least curvature over that of Gauss and Newton for which the learned one is trusted
LONGER = 4.0  # times the last step that led downhill, in shares of Newton's, the next is tried
GRAIN = 1e-9  # relative rounding of a sum of squares of whitened gaps
FAINT = 1e-10  # change of the predictions, in units of their noise, that is below all rounding
TRIAL = 1e-5  # step of a trial that is the last, as a share of the noise that is left
ENOUGH = (
    0.1  # a last step by which no parameter moves by more than this share of its standard error
)
SLOPE = 1e-9  # cosine between residual and a column below which the misfit counts as flat


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where a search ended.

    Attributes:
        x: (P,) parameters.
        residual, jacobian: (R,) whitened gap and (R, P) derivative there.
        at_bound: (P,) parameters that a physical bound holds: the misfit would fall beyond it.
        iterations: Evaluations of the model.
    """

    x: Array
    residual: Array
    jacobian: Array
    at_bound: Mask
    iterations: int


def polish(
    evaluate: Evaluate,
    start: Array,
    bounds: tuple[Array, Array],
    span: Array,
    *,
    faint: float = 0.0,
    steps: int | None = None,
) -> Minimum:
    """Least squares within bounds from a start that is near.

    Args:
        evaluate: Gives residual (R,) in units of the noise, and its derivative (R, P).
        start: (P,) clipped to the bounds. Along directions that are not seen the answer stays
            there.
        bounds: Lower and upper (P,).
        span: (P,) sizes of the parameters over which a change has to show.
        faint: Step by which the predictions move so little that nothing is left to gain, over the
            root mean square of the residual. Default: what rounding hides.
        steps: How many there may be. Default: `STEPS`, and four for every parameter.

    Raises:
        Refusal: The steps do not become small, or the model cannot be evaluated at the start.
    """
    x = _snapped(start, bounds)
    residual, jacobian = evaluate(x)
    count, last, due, share = 1, np.inf, 1, 1.0
    held = _pushed_out(x, residual, jacobian, bounds)
    curvature = np.zeros((len(x), len(x)))
    misfit = np.inf
    for _ in range(STEPS + 4 * len(x) if steps is None else steps):
        if count >= due:  # a law with jumps lets the steps creep on for ever
            due = count + PATIENCE
            fallen, misfit = misfit - float(residual @ residual), float(residual @ residual)
            if fallen < FALLEN * misfit / max(len(residual), 1):
                break
        step = _newton(jacobian, residual, held, span, curvature)
        size = _size(step, x)
        least = max(FAINT, faint * _noise(residual))
        if size <= FINE or _rounding(size, last, jacobian @ step, least):
            wanted = _wants_in(x, residual, jacobian, bounds, held)
            if wanted is None:
                return Minimum(x, residual, jacobian, held, count)
            held[wanted] = False
            last = np.inf
            continue
        last = size
        reach, hits = _until_bound(x, step, bounds)
        if reach > 0.0:
            new, found, tries = _descend(evaluate, x, share * reach * step, residual, bounds)
            count += tries
            share = min(LONGER * share * 0.5 ** (tries - 1), 1.0) if found is not None else 1.0
            if found is None and curvature.any():
                curvature[:] = 0.0  # what was learned misleads here
                continue
            if found is None:
                break
            if size > LEARNED:
                change = (found[1] - jacobian).T @ found[0] * span
                _learn(curvature, (new - x) / span, change)
            x, (residual, jacobian) = new, found
        held |= hits & ((x == bounds[0]) | (x == bounds[1]))
    step = _newton(jacobian, residual, held, span, np.zeros_like(curvature))
    if float(np.linalg.norm(jacobian @ step)) > ENOUGH * max(_noise(residual), 1e-12):
        raise Refusal(
            "the least-squares fit did not converge",
            remedy="Free fewer parameters, or leave out the effect that was added last.",
        )
    return Minimum(x, residual, jacobian, held, count)


def seen_directions(
    jacobian: Array, span: Array, faintest: float = FAINTEST
) -> tuple[Array, Array, Array, Array]:
    """Directions of the parameters, each over its span, split by what the readings see of them.

    A change by all that is plausible that shows by less than `faintest` of the noise is not seen.

    Returns:
        U, singular, V, null: (R, r), (r,), (P, r): J diag(span) = U diag(singular) Vᵀ over
            directions that are seen; (P, b) an orthonormal basis of those that are not.
    """
    scaled = jacobian * span
    missing = max(scaled.shape[1] - len(scaled), 0)
    scaled = np.vstack([scaled, np.zeros((missing, scaled.shape[1]))])
    U, singular, Vt = np.linalg.svd(scaled, full_matrices=False)
    least = max(faintest, 1e-13 * float(singular.max(initial=0.0)))
    rank = int((singular > least).sum())
    return U[: len(jacobian), :rank], singular[:rank], Vt[:rank].T, Vt[rank:].T


def _newton(jacobian: Array, residual: Array, held: Mask, span: Array, curvature: Array) -> Array:
    step = np.zeros(jacobian.shape[1])
    moving = np.flatnonzero(~held)
    if not len(moving):
        return step
    U, singular, V, _ = seen_directions(jacobian[:, moving], span[moving])
    slope = U.T @ residual  # of the misfit, in units in which JᵀJ is the identity
    own = V / singular
    bent = own.T @ curvature[np.ix_(moving, moving)] @ own
    values, vectors = np.linalg.eigh(np.eye(len(slope)) + bent)
    if len(values) and values[0] > SOUND:
        slope = vectors @ ((vectors.T @ slope) / values)
    step[moving] = -span[moving] * (own @ slope)
    return step


def _learn(curvature: Array, step: Array, change: Array) -> None:
    """Symmetric rank-one update in place: curvature @ step becomes the change of the slope."""
    missed = change - curvature @ step
    along = float(missed @ step)
    if abs(along) > 1e-8 * float(np.linalg.norm(missed) * np.linalg.norm(step)):
        curvature += np.outer(missed, missed) / along


def _until_bound(x: Array, step: Array, bounds: tuple[Array, Array]) -> tuple[float, Mask]:
    """Share of the step that stays within bounds, and the parameters that end it."""
    room = np.where(step < 0.0, bounds[0] - x, bounds[1] - x)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(step != 0.0, room / step, np.inf)
    reach = min(float(share.min(initial=np.inf)), 1.0)
    return max(reach, 0.0), share <= reach if reach < 1.0 else np.zeros(len(x), dtype=bool)


def _descend(
    evaluate: Evaluate, x: Array, step: Array, residual: Array, bounds: tuple[Array, Array]
) -> tuple[Array, tuple[Array, Array] | None, int]:
    """The longest of the steps 1, 1/2, 1/4 ... that does not raise the misfit."""
    before = float(residual @ residual)
    for tries in range(1, 13):
        new = _snapped(x + step, bounds)
        try:
            found = evaluate(new)
        except Refusal:
            found = None
        if found is not None and float(found[0] @ found[0]) <= before * (1.0 + GRAIN) + 1e-18:
            return new, found, tries
        step = 0.5 * step
    return x, None, 12


def _slopes(residual: Array, jacobian: Array) -> Array:
    """(P,) cosines between the columns and the residual; zero where nothing is seen."""
    norms = np.linalg.norm(jacobian, axis=0)
    size = np.where(norms > 0.0, norms, 1.0) * max(float(np.linalg.norm(residual)), 1e-300)
    return np.asarray(jacobian.T @ residual / size)


def _snapped(x: Array, bounds: tuple[Array, Array]) -> Array:
    """`x` within bounds, and exactly on a bound where it is as near as rounding."""
    width = 1e-12 * np.maximum(1.0, np.abs(x))
    x = np.where(x - bounds[0] <= width, bounds[0], x)
    return np.where(bounds[1] - x <= width, bounds[1], x)


def _pushed_out(x: Array, residual: Array, jacobian: Array, bounds: tuple[Array, Array]) -> Mask:
    """Parameters on a bound beyond which the misfit falls."""
    slopes = _slopes(residual, jacobian)
    low = (x == bounds[0]) & (slopes > SLOPE)
    return np.asarray(low | ((x == bounds[1]) & (slopes < -SLOPE)))


def _wants_in(
    x: Array, residual: Array, jacobian: Array, bounds: tuple[Array, Array], held: Mask
) -> int | None:
    """The held parameter whose misfit falls most steeply inwards, if there is one."""
    slopes = _slopes(residual, jacobian)
    inward = np.where(x == bounds[0], -slopes, slopes)
    inward = np.where(held, inward, -np.inf)
    if not len(x) or inward.max() <= SLOPE:
        return None
    return int(np.argmax(inward))


def _rounding(size: float, last: float, change: Array, faint: float) -> bool:
    """The step is as small as rounding lets it become, or as it need be."""
    return (size <= 1e-9 and size > 0.25 * last) or float(np.linalg.norm(change)) <= faint


def _noise(residual: Array) -> float:
    """Root mean square of the residual."""
    return float(np.linalg.norm(residual)) / sqrt(max(len(residual), 1))


def _size(step: Array, x: Array) -> float:
    return float(np.max(np.abs(step) / np.maximum(np.abs(x), 1e-2), initial=0.0))
