"""How large model-form error and noise are: variance components by restricted likelihood.

With r the gap of a fitted model and X the derivative by its parameters, the restricted likelihood
(Patterson & Thompson 1971) of a covariance V is

    -2 ln L = ln|V| + ln|Xᵀ V⁻¹ X| + rᵀ P r,   P = V⁻¹ − V⁻¹X (XᵀV⁻¹X)⁻¹ XᵀV⁻¹,

which does not take for certain what the parameters could imitate. V = V_noise + Z Zᵀ is inverted by
a small matrix per pose.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats
from scipy.optimize import minimize

from sk120stiff.arrays import Array
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.measurements.model_form import (
    EXACT,
    ModelForm,
    form_columns,
    rows_of_poses,
)

PROPORTIONS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)  # of a pose's compliance, where the search starts
ROUNDING = 1e-13  # of the largest random effect, so that none outweighs the noise by rounding
FAR = 4.0  # ln of the factor by which a size is sought away from its start
# relative standard uncertainty of a stated σ: that of a scatter of 15 readings (GUM, table E.1)
STATED = 0.19
CONSTANTS = (0.0, 0.3, 1.0, 3.0, 10.0, 30.0)  # of the noise of one reading


@dataclass(frozen=True)
class Components:
    """What a gap says of its own covariance.

    Attributes:
        form: The likeliest sizes of the model-form error.
        noise_factor: Likeliest noise over the one assumed; 1 where σ is known.
        gain: Fall of -2 ln L against noise alone.
        inflation: Factor by which σ would have to grow, were the gap noise alone.
        inflation_gain: Fall of -2 ln L by that factor.
    """

    form: ModelForm
    noise_factor: float
    gain: float
    inflation: float
    inflation_gain: float

    @property
    def probability(self) -> float:
        """Probability of as large a gain where there is noise alone: half a χ² of two."""
        return float(0.5 * stats.chi2.sf(max(self.gain, 0.0), 2)) if self.gain > 0.0 else 1.0


def variance_components(fit: Fit) -> Components:
    """The likeliest model-form error beside the noise of a fit's readings."""
    sums = Deviance.of(fit)
    grid = [ModelForm(p, c * sums.scale) for p in PROPORTIONS for c in CONSTANTS]
    values = [sums(form) for form in grid]
    plain = values[0]
    start = grid[int(np.argmin(values))]
    best, least = EXACT, plain
    for form in (start, replace(start, constant=0.0), replace(start, proportional=0.0)):
        refined, value = _refined(sums, form)
        # One component more has to be worth its freedom.
        if value + 2.0 * _count(refined) < least + 2.0 * _count(best):
            best, least = refined, value
    factor = sums.noise_factor(best)
    return Components(
        best.scaled(factor), factor, plain - least, sums.inflation, plain - sums.inflated
    )


def _count(form: ModelForm) -> int:
    return int(form.proportional > 0.0) + int(form.constant > 0.0)


def _refined(sums: Deviance, start: ModelForm) -> tuple[ModelForm, float]:
    """The likeliest sizes near a start; what is zero there stays zero."""
    sizes = np.array([start.proportional, start.constant])
    free = sizes > 0.0
    if not free.any():
        return EXACT, sums(EXACT)

    def form_at(logarithms: Array) -> ModelForm:
        found = np.zeros(2)
        # Farther from where the search began lies another point of the grid.
        found[free] = sizes[free] * np.exp(np.clip(logarithms, -FAR, FAR))
        return ModelForm(float(found[0]), float(found[1]))

    done = minimize(
        lambda x: sums(form_at(x)),
        np.zeros(free.sum()),
        method="Nelder-Mead",
        options={
            "initial_simplex": np.vstack([np.zeros(free.sum()), 0.5 * np.eye(free.sum())]),
            "xatol": 0.02,
            "fatol": 0.01,
            "maxiter": 120,
        },
    )
    return form_at(done.x), float(done.fun)


@dataclass(frozen=True, eq=False)
class Deviance:
    """-2 ln L of the model-form error of one fit's gap, as a function of its sizes.

    Attributes:
        proportional: How many of the q random effects of a pose go in proportion to the load; the
            others are constant.
        zz, zx, xx: Products, over every pose and over all rows, of random effects (q), derivative
            (p) and gap, whitened by the noise alone; the gap is the last of p + 1 columns.
        rows: Whitened readings.
        scale: σ of one reading [m].
        known: σ is known; else its likeliest value is taken at every form.
        signatures: How many of the random effects, the last ones, are signatures.
    """

    proportional: int
    zz: Array  # (G, q, q)
    zx: Array  # (G, q, p + 1); the last column is the gap
    xx: Array  # (p + 1, p + 1)
    rows: int
    scale: float  # m
    known: bool
    signatures: int = 0

    @property
    def freedom(self) -> int:
        """Rows less parameters."""
        return max(self.rows - len(self.xx) + 1, 1)

    def __call__(self, form: ModelForm, spread: float = 0.0) -> float:
        """-2 ln L, up to a constant; where σ is not known, at its likeliest value.

        Then `form` is relative to the noise assumed: the likeliest factor goes over both. `spread`
        is the size of what poses have of the signature.
        """
        logdet, information, square = self._terms(form, spread)
        if self.known:
            return logdet + information + square
        return logdet + information + self.freedom * float(np.log(square / self.freedom))

    def noise_factor(self, form: ModelForm, spread: float = 0.0) -> float:
        """The likeliest noise beside a form, over the one assumed; 1 where σ is known."""
        return 1.0 if self.known else float(np.sqrt(self._terms(form, spread)[2] / self.freedom))

    def with_noise(self, form: ModelForm, factor: float) -> float:
        """-2 ln L of a form in metres beside noise so many times as large as assumed.

        A stated σ is known to `STATED` of itself, as a normal prior of its logarithm.
        """
        logdet, information, square = self._terms(form.scaled(1.0 / factor), 0.0)
        logarithm = float(np.log(factor))
        held = (logarithm / STATED) ** 2 if self.known else 0.0
        return logdet + information + 2.0 * self.freedom * logarithm + square / factor**2 + held

    def _terms(self, form: ModelForm, spread: float = 0.0) -> tuple[float, float, float]:
        """ln|V| beyond the noise, ln|XᵀV⁻¹X| and rᵀPr."""
        size = np.full(self.zz.shape[1], form.constant)
        size[: self.proportional] = form.proportional
        size[self.zz.shape[1] - self.signatures :] = spread
        drawn = self.zz * np.outer(size, size)
        largest = np.trace(drawn, axis1=1, axis2=2)[:, None, None]
        inner = drawn + np.eye(len(size)) * (1.0 + ROUNDING * largest)
        factor = np.linalg.cholesky(inner)
        half = np.linalg.solve(factor, self.zx * size[:, None])
        left = self.xx - np.einsum("gqi,gqj->ij", half, half)
        logdet = 2.0 * np.log(np.diagonal(factor, axis1=1, axis2=2)).sum()
        square, information = _projected(left)
        return float(logdet), information, square

    @property
    def inflation(self) -> float:
        """√(χ² over its degrees of freedom)."""
        return float(np.sqrt(_projected(self.xx)[0] / self.freedom))

    @property
    def inflated(self) -> float:
        """-2 ln L of noise alone with σ at its likeliest value."""
        square, information = _projected(self.xx)
        return float(information + self.freedom * (1.0 + np.log(square / self.freedom)))

    @classmethod
    def of(cls, fit: Fit, signature: Array | None = None) -> Deviance:
        """From a fitted model; a model-form error that its noise holds already does not count.

        Args:
            fit: The fitted model.
            signature: (N, 3) what every pose may have a share of its own of [m].
        """
        exact = replace(fit.problem.noise, form=EXACT)
        problem = Problem(fit.model, fit.problem.measurements, exact, fit.problem.weights)
        readings = problem.measurements
        predicted, full = fit.model.predict_with_sensitivities(problem.load_cases)
        moving = problem.free[~fit.at_bound]
        both = np.concatenate(
            [
                full[:, :, moving] * problem.scale[~fit.at_bound],
                (problem.measured - predicted)[:, :, None],
            ],
            axis=2,
        )
        noise = problem.whitener
        proportional, constant = form_columns(readings)
        more = [] if signature is None else [signature[:, :, None]]
        Z = noise.apply(np.concatenate([proportional, constant, *more], axis=2))
        white = noise.apply(both)
        poses = rows_of_poses(readings)
        return cls(
            proportional=proportional.shape[2],
            zz=np.stack([Z[rows].T @ Z[rows] for rows in poses]),
            zx=np.stack([Z[rows].T @ white[rows] for rows in poses]),
            xx=white.T @ white,
            rows=len(white),
            scale=float(exact.sigma),
            known=fit.problem.noise.known,
            signatures=len(more),
        )


def _projected(sums: Array) -> tuple[float, float]:
    """Square of the gap beyond the parameters, and ln det of their information."""
    p = len(sums) - 1
    if not p:
        return max(float(sums[-1, -1]), 1e-300), 0.0
    scale = np.sqrt(np.maximum(np.diag(sums)[:p], 1e-300))
    values, vectors = np.linalg.eigh(sums[:p, :p] / np.outer(scale, scale))
    seen = values > 1e-10
    along = vectors[:, seen].T @ (sums[:p, -1] / scale)
    information = float(np.log(values[seen]).sum() + 2.0 * np.log(scale).sum())
    return max(float(sums[-1, -1] - (along**2 / values[seen]).sum()), 1e-300), information
