"""Is anything left over once the named effects are in the model?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from sk120stiff.explain.regression import Index, Regression
from sk120stiff.identify import Fit
from sk120stiff.identify.left_over import left_over, orthonormal
from sk120stiff.identify.saturated import load_basis, pose_columns
from sk120stiff.robot.coupling import Array

LEVEL = 1e-3


@dataclass(frozen=True)
class Adequacy:
    """Tests of what a model leaves over.

    Attributes
    ----------
    probability
        Smallest probability of the tests, times their number (Bonferroni).
    excess
        Size of the left-over structure in units of the noise, √λ.
    explained
        Size of what the named effects explain beyond the base model, in the same units.
    tests
        For each test its name and probability.
    """

    probability: float
    excess: float
    explained: float
    tests: dict[str, float]

    @property
    def lacking(self) -> bool:
        """Something is missing beyond doubt."""
        return self.probability < LEVEL


def adequacy(fit: Fit, regression: Regression, columns: Index) -> Adequacy:
    """Test the whitened gap of a fitted model.

    Two tests where the noise is known: the whole misfit (χ²), and the part that goes in proportion
    to the load at single poses, where every elastic cause shows. Where the noise is estimated, the
    second is an F test against what the pose-by-pose regression leaves.

    Parameters
    ----------
    fit
        The fitted model.
    regression
        Linearised at that fit.
    columns
        Its columns in the regression.
    """
    inside = orthonormal(regression.X[:, columns])
    r = fit.residual - inside @ (inside.T @ fit.residual)
    total, freedom = float(r @ r), max(len(r) - inside.shape[1], 1)
    rest, rest_freedom = _beyond_poses(fit, r, inside)
    structured, dimension = total - rest, freedom - rest_freedom
    tests: dict[str, float] = {}
    scale = 1.0
    if regression.sigma_known:
        tests["whole misfit"] = float(stats.chi2.sf(total, freedom))
        if dimension:
            tests["in proportion to the load"] = float(stats.chi2.sf(structured, dimension))
    elif dimension and rest_freedom >= 5:
        scale = rest / rest_freedom
        ratio = structured / dimension / scale
        tests["in proportion to the load"] = float(stats.f.sf(ratio, dimension, rest_freedom))
    probability = min(1.0, len(tests) * min(tests.values(), default=1.0))
    beyond = max(structured / scale - dimension, total / scale - freedom, 0.0)
    return Adequacy(probability, float(np.sqrt(beyond)), _explained(regression, columns), tests)


def _beyond_poses(fit: Fit, r: Array, inside: Array) -> tuple[float, int]:
    """Sum of squares that model and pose-by-pose regression together leave, and its freedom."""
    situation = fit.problem.situation
    local = fit.problem.whitener.apply(pose_columns(load_basis(situation)))
    group = np.repeat(situation.pose, 3)
    rest, rank = left_over(r, inside, local, group)
    return rest, len(r) - rank


def _explained(regression: Regression, columns: Index) -> float:
    """‖M_B S v‖: what the chosen candidates explain that the base model cannot imitate."""
    named = np.setdiff1d(columns, regression.base)
    if not len(named):
        return 0.0
    values = np.linalg.lstsq(regression.X[:, columns], regression.y, rcond=None)[0]
    part = dict(zip(columns.tolist(), values, strict=True))
    signature = regression.X[:, named] @ np.array([part[int(c)] for c in named])
    base = orthonormal(regression.X[:, regression.base])
    return float(np.linalg.norm(signature - base @ (base.T @ signature)))
