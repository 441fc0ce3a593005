"""The part of the readings in which model-form error outweighs the noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.identify import Fit
from sk120stiff.measurements import FormWhitener


@dataclass(frozen=True, eq=False)
class FormRows:
    """Whitened readings, turned pose by pose, in which model-form error outweighs the noise.

    How large that error is goes with what a model explains, so every model has its own size of it:
    else what one effect more explains would be held against an error that holds the effect itself.

    Attributes:
        y, X, group: As of `Regression`, in these directions.
        noise_share: Mean share of the noise in their variance; no model leaves less.
    """

    y: Array
    X: Array
    group: Index
    noise_share: float


def form_rows(fit: Fit, X: Array, y: Array) -> FormRows | None:
    """These rows of whitened sensitivities (R, P) and readings (R,); None where there are none."""
    whitener = fit.problem.whitener
    if not isinstance(whitener, FormWhitener):
        return None
    turned, rows = whitener.outweighing(np.column_stack([X, y]))
    if not len(rows):
        return None
    group = fit.problem.pose[rows]
    return FormRows(turned[:, -1], turned[:, :-1], group, whitener.noise_share)
