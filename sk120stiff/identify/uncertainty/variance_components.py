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
from scipy.optimize import brentq, minimize

from sk120stiff.arrays import Array
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.uncertainty.laid_out import LaidOut, seen_directions
from sk120stiff.measurements.noise.model_form import EXACT, ModelForm

PROPORTIONS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)  # of a pose's compliance, where the search starts
ROUNDING = 1e-13  # of the largest random effect, so that none outweighs the noise by rounding
FAR = 4.0  # ln of the factor by which a size is sought away from its start
CONSTANTS = (0.0, 0.3, 1.0, 3.0, 10.0, 30.0)  # of the noise of one reading


@dataclass(frozen=True)
class Components:
    """What a gap says of its own covariance.

    Attributes:
        form: The likeliest sizes of the model-form error.
        noise_factor: Likeliest noise over the one assumed; 1 where σ counts as known.
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
    return likeliest_components(Deviance.of(LaidOut.of(fit)))


def likeliest_components(sums: Deviance) -> Components:
    """The sizes at which the deviance of a gap is least, each of them worth its freedom."""
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
        slack: Relative standard uncertainty of σ: 0 where it counts as known, infinite where
            nothing tells it.
        signatures: How many of the random effects, the last ones, are signatures.
    """

    proportional: int
    zz: Array  # (G, q, q)
    zx: Array  # (G, q, p + 1); the last column is the gap
    xx: Array  # (p + 1, p + 1)
    rows: int
    scale: float  # m
    slack: float
    signatures: int = 0

    @property
    def freedom(self) -> int:
        """Rows less parameters."""
        return max(self.rows - len(self.xx) + 1, 1)

    def __call__(self, form: ModelForm, spread: float = 0.0) -> float:
        """-2 ln L, up to a constant, at the likeliest noise.

        `form` is relative to the noise assumed: the likeliest factor goes over both. `spread` is
        the size of what poses have of the signature.
        """
        logdet, information, square = self._terms(form, spread)
        return logdet + information + self._of_noise(self._likeliest(square), square)

    def noise_factor(self, form: ModelForm, spread: float = 0.0) -> float:
        """The likeliest noise beside a form, over the one assumed."""
        return float(np.exp(self._likeliest(self._terms(form, spread)[2])))

    def unexplained(self, form: ModelForm) -> float:
        """Square of the gap over the noise assumed, beyond parameters and random effects."""
        return self._terms(form)[2]

    def with_noise(self, form: ModelForm, factor: float) -> float:
        """-2 ln L of a form in metres beside noise so many times as large as assumed."""
        logdet, information, square = self._terms(form.scaled(1.0 / factor), 0.0)
        return logdet + information + self._of_noise(float(np.log(factor)), square)

    def _of_noise(self, logarithm: float, square: float) -> float:
        """What the noise's factor adds to -2 ln L; σ has a normal prior of its logarithm."""
        if not self.slack:
            return square if logarithm == 0.0 else np.inf
        held = (logarithm / self.slack) ** 2
        return 2.0 * self.freedom * logarithm + square * float(np.exp(-2.0 * logarithm)) + held

    def _likeliest(self, square: float) -> float:
        """Logarithm of the likeliest factor of the noise."""
        if not self.slack:
            return 0.0
        free = 0.5 * float(np.log(square / self.freedom))
        if np.isinf(self.slack) or free == 0.0:
            return free

        def rise(logarithm: float) -> float:
            pull = square * float(np.exp(-2.0 * logarithm))
            return self.freedom - pull + logarithm / self.slack**2

        return float(brentq(rise, *sorted((0.0, free)), xtol=1e-6))

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
        taken = half.reshape(-1, half.shape[2])
        left = self.xx - taken.T @ taken
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
    def of(cls, laid: LaidOut, slack: float = 0.0) -> Deviance:
        """From the gap of a fitted model.

        Args:
            laid: Its gap; a model-form error that its noise holds already does not count.
            slack: Relative standard uncertainty of σ, where that is known.
        """
        white = laid.white()
        return cls(
            proportional=laid.proportional,
            zz=white.zz,
            zx=white.zx,
            xx=white.xx,
            rows=laid.rows,
            scale=float(laid.problem.noise.sigma),
            slack=slack if laid.problem.noise.known else np.inf,
            signatures=laid.signatures,
        )


def _projected(sums: Array) -> tuple[float, float]:
    """Square of the gap beyond the parameters, and ln det of their information."""
    p = len(sums) - 1
    scale, values, vectors = seen_directions(sums[:p, :p])
    along = vectors.T @ (sums[:p, -1] / scale)
    information = float(np.log(values).sum() + 2.0 * np.log(scale).sum())
    return max(float(sums[-1, -1] - (along**2 / values).sum()), 1e-300), information
