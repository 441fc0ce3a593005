"""Measurements + model become a `Fit`: estimates, their covariance, and how well they agree."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from sk120stiff.errors import InputError
from sk120stiff.identify.problem import Problem
from sk120stiff.identify.solvers import Method, minimise
from sk120stiff.measurements import Measurements, NoiseModel, candidates
from sk120stiff.model import Model, Parameter
from sk120stiff.robot.coupling import Array


@dataclass(frozen=True, eq=False)
class Fit:
    """A model whose free parameters were estimated from readings.

    Attributes
    ----------
    problem
        What was fitted; its noise has the scale that was stated or assumed before the fit.
    model
        The model with the estimates and their standard errors.
    x
        (P_free,) estimates in units of `problem.scale`.
    residual, jacobian
        (3N,) whitened gap and (3N, P_free) its derivative by `x`.
    at_bound
        (P_free,) estimates that lie on a physical bound.
    iterations
        Evaluations of the model.
    """

    problem: Problem
    model: Model
    x: Array
    residual: Array
    jacobian: Array
    at_bound: NDArray[np.bool_]
    iterations: int

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The estimated parameters."""
        return tuple(self.model.parameters[k] for k in self.problem.free)

    @cached_property
    def gap(self) -> Array:
        """(N, 3) measured minus predicted [m]."""
        return self.problem.gap(self.x)

    @property
    def sigma_stated(self) -> bool:
        """Was the noise's size known? Else it is estimated from the residual."""
        return self.problem.noise.stated

    @property
    def rms(self) -> float:
        """Root mean square of the gap over all readings and axes [m]."""
        return float(np.sqrt(np.mean(self.gap**2)))

    @property
    def chi_square(self) -> float:
        """Sum of squares of the whitened gap."""
        return float(self.residual @ self.residual)

    @property
    def degrees_of_freedom(self) -> int:
        """Readings of single axes minus estimates that are free to move."""
        return len(self.residual) - int((~self.at_bound).sum())

    @property
    def noise_factor(self) -> float:
        """Noise that the residual shows over the noise assumed; 1 if all is well."""
        return float(np.sqrt(self.chi_square / max(self.degrees_of_freedom, 1)))

    @property
    def sigma(self) -> float:
        """Standard uncertainty of one reading per axis, stated or else estimated [m]."""
        return self.problem.noise.sigma * (1.0 if self.sigma_stated else self.noise_factor)

    @property
    def lack_of_fit(self) -> float | None:
        """Probability of a larger χ² if the model were true; None where σ was not stated."""
        if not self.sigma_stated:
            return None
        return float(stats.chi2.sf(self.chi_square, self.degrees_of_freedom))

    @cached_property
    def covariance(self) -> Array:
        """(P_free, P_free) covariance of `x`; zero for estimates on a bound, infinite if unknown."""
        return covariance_of(self.jacobian, self.at_bound) * self._variance_factor

    @property
    def _variance_factor(self) -> float:
        return 1.0 if self.sigma_stated else self.noise_factor**2

    @cached_property
    def correlation(self) -> Array:
        """(P_free, P_free) correlations of the estimates."""
        std = np.sqrt(np.diag(self.covariance))
        usable = np.isfinite(std) & (std > 0.0)
        safe = np.where(usable, std, 1.0)
        found = np.where(np.isfinite(self.covariance), self.covariance, 0.0)
        correlation = found / np.outer(safe, safe)
        return np.where(np.outer(usable, usable), correlation, np.eye(len(std)))

    @cached_property
    def condition(self) -> float:
        """Condition number of the whitened derivative with columns of unit length."""
        norms = np.linalg.norm(self.jacobian, axis=0)
        if not len(norms):
            return 1.0
        if (norms == 0.0).any():
            return float(np.inf)
        singular = np.linalg.svd(self.jacobian / norms, compute_uv=False)
        return float(singular[0] / singular[-1]) if singular[-1] > 0.0 else float(np.inf)


def covariance_of(jacobian: Array, held: NDArray[np.bool_]) -> Array:
    """(JᵀJ)⁻¹ over the columns that are not held; infinite along directions without information."""
    P = jacobian.shape[1]
    covariance = np.zeros((P, P))
    moving = np.flatnonzero(~held)
    if not len(moving):
        return covariance
    part = jacobian[:, moving]
    norms = np.linalg.norm(part, axis=0)
    safe = np.where(norms > 0.0, norms, 1.0)
    _, singular, Vt = np.linalg.svd(part / safe, full_matrices=False)
    blind = singular <= max(part.shape) * np.finfo(float).eps * max(singular[0], 1e-300)
    inverse = np.where(blind, 0.0, 1.0 / np.where(blind, 1.0, singular) ** 2)
    block = (Vt.T * inverse) @ Vt
    lost = (np.abs(Vt[blind]) > 1e-8).any(axis=0) | (norms == 0.0)
    block = block / np.outer(safe, safe)
    block[lost, lost] = np.inf
    covariance[np.ix_(moving, moving)] = block
    return covariance


def fit(
    model: Model,
    measurements: Measurements,
    *,
    noise: NoiseModel | None = None,
    method: Method = "trf",
) -> Fit:
    """Estimate a model's free parameters from readings, at exact equilibrium.

    Parameters
    ----------
    model
        Starting values, and which parameters are free (`Parameter.free`).
    measurements
        Readings with displacements; masked rows are left out.
    noise
        Covariance of the readings. Default: what the data say of themselves; a σ that they do not
        state is estimated with the fit.
    method
        ``"trf"`` (trust region, bounds) or ``"lm"`` (Levenberg–Marquardt); both reach the same.

    Raises
    ------
    InputError
        No displacements, or more parameters than readings.
    Refusal
        The solver failed, or no equilibrium exists.
    """
    used = measurements.masked()
    problem = Problem(model, used, noise or candidates(used)[0])
    if 3 * used.n_readings < len(problem.free):
        raise InputError(
            f"{len(problem.free)} parameters cannot be estimated from {used.n_readings} readings "
            f"of three axes",
            where=str(used.path or "measurements"),
            remedy="Measure more poses, or fix parameters in the model (free: false).",
        )
    return solve(problem, method=method)


def solve(problem: Problem, *, method: Method = "trf") -> Fit:
    """Solve a least-squares problem: first to first order in load, then at exact equilibrium."""
    residual_0, jacobian_0 = problem.first_order

    def linear(x: Array) -> tuple[Array, Array]:
        return residual_0 + jacobian_0 @ x, jacobian_0

    rough = minimise(linear, problem.start, problem.bounds, method)
    best = minimise(problem.evaluate, rough.x, problem.bounds, method)
    found = Fit(
        problem=problem,
        model=problem.model,
        x=best.x,
        residual=best.residual,
        jacobian=best.jacobian,
        at_bound=best.at_bound,
        iterations=rough.iterations + best.iterations,
    )
    return _with_model(found)


def _with_model(found: Fit) -> Fit:
    std: list[float | None] = [p.std for p in found.problem.model.parameters]
    errors = np.sqrt(np.diag(found.covariance)) * found.problem.scale
    for index, error, held in zip(found.problem.free, errors, found.at_bound, strict=True):
        std[index] = None if held else float(error)
    values = found.problem.values(found.x)
    on_bound = found.problem.free[found.at_bound]
    values[on_bound] = np.where(np.abs(values[on_bound]) < 1e-6 * _typical(found)[on_bound], 0.0, values[on_bound])
    return replace(found, model=found.problem.model.with_values(values, std, origin="identified"))


def _typical(found: Fit) -> Array:
    return np.array([p.spec.typical for p in found.problem.model.parameters])
