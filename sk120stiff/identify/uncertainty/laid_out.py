"""The gap of one fit laid out: its random effects, derivative and gap, and their products."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.measurements.noise.model_form import EXACT, form_columns, rows_of_poses


@dataclass(frozen=True, eq=False)
class LaidOut:
    """Random effects of unit size, derivative and gap of one fit, reading axes.

    Attributes:
        problem: That of the fit beside exact laws.
        drawn: (N, 3, q) random effects; every pose has its own.
        derivative: (N, 3, p + 1) by the parameters that move; the last column is the gap [m].
        proportional: How many of the q go in proportion to the load; the others are constant.
        signatures: How many of the q, the last ones, are signatures.
    """

    problem: Problem
    drawn: Array
    derivative: Array
    proportional: int
    signatures: int = 0

    @property
    def rows(self) -> int:
        """How many numbers R were read."""
        return int(self.problem.read.sum())

    @property
    def poses(self) -> list[Index]:
        """Rows of each pose among the R."""
        return rows_of_poses(self.problem.measurements)

    @classmethod
    def of(cls, fit: Fit, signature: Array | None = None) -> LaidOut:
        """From a fit, and (N, 3) what every pose may have a share of its own of [m]."""
        exact = replace(fit.problem.noise, form=EXACT)
        problem = Problem(fit.model, fit.problem.measurements, exact, fit.problem.weights)
        predicted, full = fit.model.predict_with_sensitivities(problem.load_cases)
        moving = problem.free[~fit.at_bound]
        gap = (problem.measured - predicted)[:, :, None]
        columns = full[:, :, moving] * problem.scale[~fit.at_bound]
        proportional, constant = form_columns(problem.measurements)
        more = [] if signature is None else [signature[:, :, None]]
        return cls(
            problem,
            np.concatenate([proportional, constant, *more], axis=2),
            np.concatenate([columns, gap], axis=2),
            proportional.shape[2],
            len(more),
        )

    def white(self) -> Products:
        """Products of what the noise alone whitens."""
        noise = self.problem.whitener
        return Products.of(noise.apply(self.drawn), noise.apply(self.derivative), self.poses)

    def raw(self) -> Products:
        """Products in metres."""
        read = self.problem.read
        return Products.of(self.drawn[read], self.derivative[read], self.poses)


@dataclass(frozen=True, eq=False)
class Products:
    """Products of random effects (q) and derivative with gap (p + 1), by poses and over all."""

    zz: Array  # (G, q, q)
    zx: Array  # (G, q, p + 1)
    xx: Array  # (p + 1, p + 1)

    @classmethod
    def of(cls, drawn: Array, derivative: Array, poses: list[Index]) -> Products:
        """Of (R, q) and (R, p + 1), and the rows of each pose."""
        return cls(
            np.stack([drawn[rows].T @ drawn[rows] for rows in poses]),
            np.stack([drawn[rows].T @ derivative[rows] for rows in poses]),
            derivative.T @ derivative,
        )


def orthonormal_parameters(information: Array) -> Array:
    """(p, k) combinations of parameters that the readings see, with information of one each."""
    scale, values, vectors = seen_directions(information)
    return np.asarray(vectors / np.sqrt(values) / scale[:, None])


def seen_directions(information: Array, least: float = 1e-10) -> tuple[Array, Array, Array]:
    """Scale (p,) of parameters, and eigenvalues (k,) and vectors (p, k) of what is seen of them."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    seen = values > least
    return scale, values[seen], vectors[:, seen]
