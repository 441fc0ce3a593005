"""How large the model-form error is at each pose, where few poses must not set it for all.

What a model lacks is no normal error: it is large where a joint is bent hard and small elsewhere.
Random effects of a t distribution have a variance of their own at every pose (Lange, Little &
Taylor 1989; Pinheiro, Liu & Wu 2001). While causes are sought it is found from what the whole
catalogue leaves, so that none of them is taken for such an error. Once the names stand, what they
leave themselves tells it, together with their values.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.select.outliers import LEAST_LEFT, everything, robust_scale
from sk120stiff.identify import Fit, Problem, solve_near
from sk120stiff.identify.solve.polish import Evaluate, polish
from sk120stiff.measurements import FormWhitener
from sk120stiff.measurements.noise.model_form import ModelForm

TAILS = 4.0  # degrees of freedom, the usual choice where they are not estimated
FACTORS = np.exp(np.linspace(-3.0, 4.0, 141))  # on a pose's variance, that are tried
ROUNDS = 20  # of sizes and values to first order, until they agree
REFITS = 4  # at exact equilibrium, likewise


def own_sizes(regression: Regression, problem: Problem) -> ModelForm:
    """The model-form error of a problem with the likeliest factor of every pose."""
    form, whitener = problem.noise.form, problem.whitener
    if not isinstance(whitener, FormWhitener):
        return form
    residual, leverage = everything(regression)
    scale = robust_scale(residual, leverage)
    fair = residual / (scale * np.sqrt(np.maximum(1.0 - leverage, LEAST_LEFT)))
    return _with_factors(problem, whitener, fair)


def with_settled_sizes(found: Fit) -> Fit:
    """The same model with the likeliest values and factors together; as it is beside exact laws.

    That is maximum likelihood of the t distribution whose variance is the one found of all poses.
    The factors are given back as weights of one on average, so that standard errors stay those of
    that variance.
    """
    noise = found.problem.noise
    even = replace(noise.form, of_poses=())
    scale = even.scaled(float(np.sqrt((TAILS - 2.0) / TAILS)))
    problem = replace(found.problem, noise=replace(noise, form=scale))
    whitener = problem.whitener
    if not isinstance(whitener, FormWhitener):
        return found
    for _ in range(REFITS):
        form, x = _settled(problem, whitener, found, even)
        if form == found.problem.noise.form:
            break
        found = solve_near(replace(problem, noise=replace(noise, form=form)), x)
    return found


def _settled(
    problem: Problem, whitener: FormWhitener, found: Fit, even: ModelForm
) -> tuple[ModelForm, Array]:
    """Likeliest factors and values (P_free,) together, to first order around a fit.

    Args:
        problem: With the variance of the t distribution's scale and no factors, and its whitener.
        whitener: Its own.
        found: The fit.
        even: Model-form error of the variance found of all poses.
    """
    rows = len(found.residual)
    free = np.sqrt(max(rows - found.estimated, 1) / rows)  # share that the parameters leave
    _, derivative = problem.model.predict_with_sensitivities(
        problem.load_cases, problem.values(found.x)
    )
    slopes = derivative[:, :, problem.free] * problem.scale
    x, form = found.x, found.problem.noise.form
    for _ in range(ROUNDS):
        gap = found.gap - slopes @ (x - found.x)
        now = _with_factors(problem, whitener, whitener.apply(gap) / free)
        mean = len(now.of_poses) / sum(1.0 / s for _, s in now.of_poses)
        now = replace(even, of_poses=tuple((pose, s / mean) for pose, s in now.of_poses))
        if now == form:
            break
        form = now
        by = replace(problem, noise=replace(problem.noise, form=form)).whitener
        linear = _linear(by.apply(gap), -by.apply(slopes), x)
        x = polish(linear, x, problem.bounds, problem.span).x
    return form, x


def _linear(residual: Array, jacobian: Array, at: Array) -> Evaluate:
    """A whitened gap that is linear around `at`, for `polish`."""

    def evaluate(x: Array) -> tuple[Array, Array]:
        return residual + jacobian @ (x - at), jacobian

    return evaluate


def _with_factors(problem: Problem, whitener: FormWhitener, fair: Array) -> ModelForm:
    """The form with the likeliest factors, from residuals (R,) whitened without any."""
    factors = [_likeliest(U.T @ fair[rows], strength) for rows, U, strength in whitener.strengths]
    poses = tuple(zip(problem.measurements.poses, factors, strict=True))
    return replace(problem.noise.form, of_poses=poses)


def price_of_factors(form: ModelForm) -> float:
    """-2 ln p of the factors of all poses, beside that of factors of one."""
    return TAILS * float(sum(np.log(s) + 1.0 / s - 1.0 for _, s in form.of_poses))


def _likeliest(along: Array, strength: Array) -> float:
    """The likeliest factor on variances (k,) over the noise's, from components (k,) of size one."""
    grown = 1.0 + FACTORS[:, None] * strength
    fall = np.log(grown).sum(axis=1) + (along**2 * (1.0 + strength) / grown).sum(axis=1)
    return float(FACTORS[np.argmin(fall + TAILS * (np.log(FACTORS) + 1.0 / FACTORS))])
