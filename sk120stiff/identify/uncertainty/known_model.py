"""From a `Fit` to what its model says of its own uncertainty."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.errors import short
from sk120stiff.identify.checks.yardstick import Yardstick, yardstick
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.beforehand import Beforehand
from sk120stiff.identify.solve.covariance import covariance_of
from sk120stiff.identify.solve.polish import FAINTEST, seen_directions
from sk120stiff.identify.uncertainty.left_over import LeftOver, left_over
from sk120stiff.model import Model, Remainder, Uncertainty
from sk120stiff.model.uncertainty import load_size
from sk120stiff.robot.anatomy import arm_length

SIGNIFICANT = 0.05  # probability of noise alone below which something is left
AS_WELL = 3.0  # of the noise's variance: other models fit worse by up to 10 in χ², evenly spread
OMITTED = 1.0  # of the noise's variance: what is left out is told no worse than what was estimated
ROUNDING = 1e-12  # of a standard error over the plausible change that does not show


def known_of_displacements(fit: Fit, left: LeftOver | None = None) -> Model:
    """See `sk120stiff.identify.run.known_model`.

    It has none where as many values were estimated as were read and no σ was stated. Estimates on
    a physical bound count as free: to be cut by a bound takes an estimate no farther from the
    truth (a projection on a convex set), so nothing is said too surely.
    """
    if not np.isfinite(fit.unit):
        return fit.model
    noise = yardstick(fit)
    sigma = noise.sigma or fit.problem.noise.sigma * fit.noise_factor
    known = known_estimates(fit, sigma, _source(fit, noise))
    told = None if fit.problem.weights is not None else _remainder(fit, left or left_over(fit))
    if told is not None:
        known = replace(known, remainder=told)
    return fit.model.known(known)


def known_estimates(fit: Fit, sigma: float | None, source: str) -> Uncertainty:
    """What the readings show of the estimates, and what they do not.

    Args:
        fit: A fit with a known size of its noise.
        sigma: Standard uncertainty of one reading per axis [m]; None where none is a length.
        source: Which readings it comes from, in words.
    """
    problem = fit.problem
    scale, span = problem.scale, problem.span
    free = np.zeros(len(fit.x), dtype=bool)
    before = Beforehand.of(problem, fit.x, fit.small[0], free, fit.unit)
    informed = np.vstack([fit.small[0], before.rows()])
    _, singular, V, null = seen_directions(informed, span)
    lost = np.isinf(np.diag(covariance_of(informed, free, span)))
    size = span * scale
    per_noise = (V / singular) * size[:, None]
    covariance = fit.unit**2 * per_noise @ per_noise.T
    covariance = covariance + _beside_noise(fit, informed / fit.unit) * np.outer(scale, scale)
    whole = (null**2).T @ (problem.plausible / span)  # a change that does not show is plausible
    shows = np.linalg.norm(informed, axis=0)[:, None] * span[:, None] * np.abs(null) * whole
    unseen = np.where(lost[:, None] | (shows > FAINTEST), null * size[:, None] * whole, 0.0).T
    nothing = np.sqrt(np.diag(covariance)) < ROUNDING * np.abs(unseen).max(axis=0, initial=0.0)
    covariance = np.where(nothing | nothing[:, None], 0.0, covariance)
    return Uncertainty(
        names=tuple(parameter.name for parameter in fit.parameters),
        values=np.array([parameter.internal for parameter in fit.parameters]),
        covariance=0.5 * (covariance + covariance.T),
        unseen=unseen[np.abs(unseen).max(axis=1, initial=0.0) > 0.0],
        noise=sigma,
        freedom=None if np.isinf(fit.freedom) else float(fit.freedom),
        source=source,
    )


def _beside_noise(fit: Fit, informed: Array) -> Array:
    """(P, P) what is not of the readings' noise, of the estimates.

    Another model that explains the readings as well moves the estimates, each by so much, and yet
    together to where the readings are predicted nearly alike; so does what the model leaves out. A
    foreign cause has moved them by more than noise may, and together.

    Args:
        fit: The fit.
        informed: (R, P) derivative in units of the noise, and what is known beforehand.
    """
    moves = fit.moves
    models = _together(np.diag(moves.models**2) + moves.parts + moves.by_form, informed, AS_WELL)
    return np.asarray(moves.foreign + models + _together(moves.omitted, informed, OMITTED))


def _together(moved: Array, informed: Array, allowed: float) -> Array:
    """(P, P) covariance of moves such that readings are predicted alike up to some noise.

    Of moves with the covariance M = H Hᵀ readings with a derivative J leave
    (M⁻¹ + Jᵀ J / a)⁻¹ = H (1 + (J H)ᵀ J H / a)⁻¹ Hᵀ, where they may be off by a times the noise's
    variance: what does not move does not make up for what does.
    """
    size = np.sqrt(np.diag(moved))
    own = size > 0.0
    together = np.zeros(moved.shape)
    inside = np.ix_(own, own)
    shares, ways = np.linalg.eigh(moved[inside] / np.outer(size[own], size[own]))
    H = size[own, None] * ways * np.sqrt(np.maximum(shares, 0.0))  # rounding is no variance
    seen = informed[:, own] @ H
    factor = np.linalg.cholesky(np.eye(H.shape[1]) + seen.T @ seen / allowed)
    half = np.linalg.solve(factor, H.T)
    together[inside] = half.T @ half
    return together


def _source(fit: Fit, noise: Yardstick) -> str:
    measurements = fit.problem.measurements
    said = "noise unknown"
    if noise.sigma is not None:
        said = f"noise {short(noise.sigma * 1e6)} µm per axis, by {noise.name}"
    poses = len(measurements.poses)
    return f"{measurements.n_readings} readings at {poses} poses; {said}"


def _remainder(fit: Fit, left: LeftOver) -> Remainder | None:
    """What the fit leaves over, as predictions need it; None where no load tells its size."""
    problem = fit.problem
    length = arm_length(problem.model.robot) or 1.0
    load = rms(load_size(problem.load_cases.wrench, length))
    if load == 0.0 or not np.isfinite(left.upper):
        return None
    return Remainder(
        rms=np.full(3, left.rms),
        upper=np.full(3, left.upper),
        freedom=_freedom(fit),
        load=load,
        length=length,
        grows=left.grows,
        probability=left.probability,
        significant=left.probability < SIGNIFICANT,
    )


def _freedom(fit: Fit) -> Array:
    """(3,) readings of an axis less the parameters that it determined."""
    moving = ~fit.at_bound
    U = seen_directions(fit.jacobian[:, moving], fit.problem.span[moving])[0]
    axis = np.nonzero(fit.problem.read)[1]
    taken = np.bincount(axis, (U**2).sum(axis=1), minlength=3)
    return np.asarray(np.maximum(np.bincount(axis, minlength=3) - taken, 0.0))
