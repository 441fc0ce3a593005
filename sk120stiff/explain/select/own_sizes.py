"""How large the model-form error is at each pose, where few poses must not set it for all.

What a model lacks is no normal error: it is large where a joint is bent hard and small elsewhere.
Random effects of a t distribution have a variance of their own at every pose (Lange, Little &
Taylor 1989; Pinheiro, Liu & Wu 2001). It is found from what the whole catalogue leaves, so that
no cause like those in it is taken for such an error.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.select.outliers import LEAST_LEFT, everything, robust_scale
from sk120stiff.identify import Problem
from sk120stiff.measurements import FormWhitener
from sk120stiff.measurements.model_form import ModelForm

TAILS = 4.0  # degrees of freedom, the usual choice where they are not estimated
FACTORS = np.exp(np.linspace(-3.0, 4.0, 141))  # on a pose's variance, that are tried


def own_sizes(regression: Regression, problem: Problem) -> ModelForm:
    """The model-form error of a problem with the likeliest factor of every pose."""
    form, whitener = problem.noise.form, problem.whitener
    if not isinstance(whitener, FormWhitener):
        return form
    residual, leverage = everything(regression)
    scale = robust_scale(residual, leverage)
    fair = residual / (scale * np.sqrt(np.maximum(1.0 - leverage, LEAST_LEFT)))
    factors = [_likeliest(U.T @ fair[rows], strength) for rows, U, strength in whitener.strengths]
    return replace(form, of_poses=tuple(zip(problem.measurements.poses, factors, strict=True)))


def price_of_factors(form: ModelForm) -> float:
    """-2 ln p of the factors of all poses, beside that of factors of one."""
    return TAILS * float(sum(np.log(s) + 1.0 / s - 1.0 for _, s in form.of_poses))


def _likeliest(along: Array, strength: Array) -> float:
    """The likeliest factor on variances (k,) over the noise's, from components (k,) of size one."""
    grown = 1.0 + FACTORS[:, None] * strength
    fall = np.log(grown).sum(axis=1) + (along**2 * (1.0 + strength) / grown).sum(axis=1)
    return float(FACTORS[np.argmin(fall + TAILS * (np.log(FACTORS) + 1.0 / FACTORS))])
