"""From a `Fit` to what its model says of its own uncertainty.

The remainder is judged at poses left out. Gap and derivative are whitened pose by pose, so the fit
without the readings g of a pose follows from the fit of all to first order, which is exact for
compliances at small loads: with A = JᵀJ and H = J_g A⁻¹ J_gᵀ, the estimates move by
A⁻¹ J_gᵀ (I − H)⁻¹ r_g. What such gaps have beyond the noise and beyond the covariance of the
parameters is what the model lacks at poses like these, what it did to the parameters included.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.identify.checks.lack_of_fit import LackOfFit, lack_of_fit
from sk120stiff.identify.checks.yardstick import Yardstick, yardstick
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.covariance import covariance_of
from sk120stiff.identify.solve.polish import seen_directions
from sk120stiff.measurements.poses import rows_by_label
from sk120stiff.model import Model, Remainder, Uncertainty
from sk120stiff.model.uncertainty import load_size
from sk120stiff.robot.anatomy import arm_length

COUNTS = 0.05  # probability of the misfit by noise alone below which the remainder counts
ROUNDING = 1e-12  # of a standard error over the plausible change that does not show
ALONE = 1e-6  # information that the other poses have, below which a pose cannot be left out


def known_model(fit: Fit) -> Model:
    """The fitted model with its uncertainty, as it is written to a file.

    It has none where as many values were estimated as were read and no σ was stated. Estimates on
    a physical bound count as free: to be cut by a bound takes an estimate no farther from the
    truth (a projection on a convex set), so nothing is said too surely.
    """
    if not np.isfinite(fit.unit):
        return fit.model
    test, noise = lack_of_fit(fit), yardstick(fit)
    sigma = noise.sigma or fit.problem.noise.sigma * fit.noise_factor
    known = known_estimates(fit, sigma, _source(fit, noise))
    if test is not None:
        known = replace(known, remainder=_remainder(fit, known, test))
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
    _, singular, V, blind = seen_directions(fit.jacobian, span)
    lost = np.isinf(np.diag(covariance_of(fit.jacobian, free, span)))
    size = span * scale
    per_noise = (V / singular) * size[:, None]
    covariance = fit.unit**2 * per_noise @ per_noise.T
    if fit.doubt is not None:
        covariance = covariance + np.diag((fit.doubt * scale) ** 2)
    unseen = np.where(lost[:, None], blind * size[:, None], 0.0).T
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


def _source(fit: Fit, noise: Yardstick) -> str:
    measurements = fit.problem.measurements
    said = "noise unknown"
    if noise.sigma is not None:
        said = f"noise {noise.sigma * 1e6:.3g} µm per axis, by {noise.name}"
    poses = len(measurements.poses)
    return f"{measurements.n_readings} readings at {poses} poses; {said}"


def _remainder(fit: Fit, known: Uncertainty, test: LackOfFit) -> Remainder | None:
    """What is left at poses left out, per axis of the base; None if none can be left out."""
    problem = fit.problem
    situation = problem.situation
    values = problem.values(fit.x)
    predicted, derivative = problem.model.predict_with_sensitivities(situation, values)
    derivative = derivative[:, :, problem.free]
    step, usable = _steps_without_each_pose(fit)
    if not usable.any():
        return None
    moved = np.einsum("nip,np->ni", derivative, step[situation.pose] * problem.scale)
    axes = situation.reading_axes
    gap = np.einsum("nij,nj->ni", axes, problem.measured - predicted - moved)
    L = known.factors(known.names)[0]
    own = (np.einsum("nij,njp,pr->nir", axes, derivative, L) ** 2).sum(axis=-1)
    noise = np.einsum("nij,nj->ni", axes**2, _noise(fit, test))
    here = usable[situation.pose]
    length = arm_length(problem.model.robot) or 1.0
    size = load_size(situation.wrench, length)[here]
    load = float(np.sqrt(np.mean(size**2)))
    if load == 0.0:
        return None
    surplus, variance = (gap**2 - own - noise)[here], (own + noise)[here]
    square, error = _mean_over_poses(surplus, situation.pose[here])
    rms = np.sqrt(np.maximum(square, 0.0))
    growing = variance + (rms * size[:, None] / load) ** 2
    return Remainder(
        rms=rms,
        upper=np.sqrt(np.maximum(square, 0.0) + error),
        freedom=_freedom(fit),
        load=load,
        length=length,
        grows=_misfit(gap[here], growing) <= _misfit(gap[here], variance + rms**2),
        probability=test.probability,
        significant=test.probability < COUNTS,
    )


def _mean_over_poses(surplus: Array, pose: Array) -> tuple[Array, Array]:
    """(3,) mean of (N, 3) over the readings, and its standard error from pose to pose."""
    labels, place, count = np.unique(pose, return_inverse=True, return_counts=True)
    sums = np.zeros((len(labels), 3))
    np.add.at(sums, place, surplus)
    mean = surplus.mean(axis=0)
    if len(labels) < 2:
        return mean, np.abs(mean)
    # A ratio of sums over poses: its error is that of the sums about the mean (Cochran 1977).
    off = sums - count[:, None] * mean
    error = np.sqrt((off**2).sum(axis=0) * len(labels) / (len(labels) - 1)) / len(surplus)
    return mean, error


def _steps_without_each_pose(fit: Fit) -> tuple[Array, np.ndarray]:
    """(poses, P) by how much the scaled estimates move when a pose is left out, and can it be?"""
    problem = fit.problem
    moving = np.flatnonzero(~fit.at_bound)
    span = problem.span[moving]
    _, singular, V, _ = seen_directions(fit.jacobian[:, moving], span)
    root = (V / singular) * span[:, None]  # A⁻¹ = root rootᵀ, over what is seen
    count = len(problem.situation.poses)
    group = np.repeat(problem.situation.pose, 3)
    steps, usable = np.zeros((count, len(fit.x))), np.zeros(count, dtype=bool)
    for rows in rows_by_label(group):
        pose = group[rows[0]]
        own = fit.jacobian[rows][:, moving] @ root
        left, vectors = np.linalg.eigh(np.eye(own.shape[1]) - own.T @ own)
        usable[pose] = left.min(initial=1.0) > ALONE
        if usable[pose]:
            # (I − H)⁻¹ after J_gᵀ is (I − J_gᵀJ_g)⁻¹ before it, in the coordinates of `root`.
            slope = vectors @ ((vectors.T @ (own.T @ fit.residual[rows])) / left)
            steps[pose, moving] = root @ slope
    return steps, usable


def _noise(fit: Fit, test: LackOfFit) -> Array:
    """(N, 3) variance of the displacements by the noise alone [m²], axes of the readings.

    A σ that was estimated from the whole gap holds what the model lacks; the scatter that the
    misfit was held against does not.
    """
    problem = fit.problem
    own, zero = problem.noise.variances(problem.measurements, problem.sizes)
    return np.asarray((own + zero) * _noise_factor(fit, test) ** 2)


def _noise_factor(fit: Fit, test: LackOfFit) -> float:
    if fit.sigma_known or test.lacking:
        return float(np.sqrt(yardstick(fit).scale))
    return fit.noise_factor


def _freedom(fit: Fit) -> Array:
    """(3,) readings of an axis less the parameters that it determined."""
    moving = ~fit.at_bound
    U = seen_directions(fit.jacobian[:, moving], fit.problem.span[moving])[0]
    taken = (U**2).sum(axis=1).reshape(-1, 3).sum(axis=0)
    return np.asarray(np.maximum(len(U) / 3.0 - taken, 0.0))


def _misfit(gap: Array, variance: Array) -> float:
    """Minus twice the logarithm of the likelihood of independent gaps."""
    return float((gap**2 / variance + np.log(variance)).sum())
