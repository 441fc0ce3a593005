"""What the derivative of a fit says of its uncertainty: covariance, intervals, condition."""

from __future__ import annotations

import numpy as np
from scipy import linalg

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import ParameterSpec
from sk120stiff.identify.solve.polish import seen_directions
from sk120stiff.identify.solve.profile_likelihood import linear_valley

HIDDEN = 0.1  # variance by which null directions may move an estimate, over its own


def covariance_of(jacobian: Array, held: Mask, span: Array) -> Array:
    """(JᵀJ)⁻¹ over the columns that are not held; infinite along directions without information.

    Args:
        jacobian: (R, P) whitened derivative.
        held: (P,) parameters that a bound holds; their rows and columns are zero.
        span: (P,) sizes over which a change has to show. A parameter is lost if as large a change
            that does not show would move it by a third of its standard error or more.
    """
    P = jacobian.shape[1]
    covariance = np.zeros((P, P))
    moving = np.flatnonzero(~held)
    if not len(moving):
        return covariance
    over = span[moving]
    _, singular, V, null = seen_directions(jacobian[:, moving], over)
    block = (V / singular**2) @ V.T
    hidden = (null**2).sum(axis=1)
    lost = (hidden > HIDDEN * np.diag(block)) | (np.diag(block) == 0.0)
    block = block * np.outer(over, over)
    block[lost, lost] = np.inf
    covariance[np.ix_(moving, moving)] = block
    return covariance


def posterior(jacobian: Array, prior: Array, left: Array) -> tuple[Array, Array]:
    """(P,) step to the best values, and covariance, of derivative (M, P), prior (P,) and gap (M,).

    The prior's own pull counts in neither: two steps are compared. Of what the numbers cannot see
    neither says anything.
    """
    information = jacobian.T @ jacobian + np.diag(prior)
    size = np.sqrt(np.diag(information))
    inverse = linalg.pinvh(information / np.outer(size, size)) / np.outer(size, size)
    return np.asarray(inverse @ (jacobian.T @ left)), np.asarray(inverse)


def correlation_of(covariance: Array) -> Array:
    """(P, P) correlations; zero with what is held or unknown."""
    std = np.sqrt(np.diag(covariance))
    usable = np.isfinite(std) & (std > 0.0)
    safe = np.where(usable, std, 1.0)
    found = np.where(np.isfinite(covariance), covariance, 0.0) / np.outer(safe, safe)
    found = np.where(np.outer(usable, usable), np.clip(found, -1.0, 1.0), 0.0)
    np.fill_diagonal(found, 1.0)
    return np.asarray(found)


def condition_of(jacobian: Array) -> float:
    """Condition number with columns of unit length; infinite if something is not seen at all."""
    norms = np.linalg.norm(jacobian, axis=0)
    if not len(norms):
        return 1.0
    if (norms == 0.0).any() or len(jacobian) < len(norms):
        return float(np.inf)
    singular = np.linalg.svd(jacobian / norms, compute_uv=False)
    return float(singular[0] / singular[-1]) if singular[-1] > 0.0 else float(np.inf)


def internal_intervals(
    x: Array,
    jacobian: Array,
    residual: Array,
    held: Mask,
    bounds: tuple[Array, Array],
    span: Array,
    plausible: Array,
    reach: float,
    unit: float,
) -> Array:
    """(P, 2) likelihood intervals of the linearised problem within its bounds.

    The misfit over the noise rises by reach² at their ends, all other parameters refitted. Where no
    bound is near, that is x ± reach·std.

    Args:
        x, jacobian, residual, held, bounds, span, plausible: Of the fit, in scaled parameters.
        reach: Quantile of the normal or Student distribution.
        unit: Noise seen over noise assumed; infinite where nobody knows.
    """
    std = np.sqrt(np.diag(covariance_of(jacobian, held, span)))
    lost = ~np.isfinite(std)
    if not np.isfinite(unit) or lost.all():
        return np.column_stack(bounds)
    half = np.where(lost, np.inf, reach * unit * std)
    ends = np.column_stack([np.maximum(x - half, bounds[0]), np.minimum(x + half, bounds[1])])
    near = ~lost & ((x - half <= bounds[0]) | (x + half >= bounds[1]))
    if not near.any():
        return ends
    valley = linear_valley(x, residual, jacobian, bounds, span, plausible, np.where(lost, 0.0, std))
    for k in np.flatnonzero(~lost):
        ends[k] = [valley.end(int(k), side, reach * unit) for side in (-1.0, 1.0)]
    return ends


def public_interval(spec: ParameterSpec, low: float, high: float) -> tuple[float, float]:
    """An interval of internal values as people write it.

    The reciprocal of an interval that reaches to zero is open to infinity; if it holds both signs,
    nothing is excluded but small stiffnesses, which no interval can say: it is (-inf, inf).
    """
    if not spec.reciprocal:
        return low, high
    if low < 0.0 < high:
        return -np.inf, np.inf
    with np.errstate(divide="ignore"):
        ends = (float(np.divide(1.0, high)), float(np.divide(1.0, low)))
    if high == 0.0:
        ends = (-np.inf, ends[1])
    return ends
