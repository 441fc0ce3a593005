"""Is anything left over once the named effects are in the model?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from sk120stiff.explain.localise import localise
from sk120stiff.explain.regression import Index, Regression
from sk120stiff.identify import Fit
from sk120stiff.identify.left_over import orthonormal

LEVEL = 1e-3
OWN = {
    "proportional": "in proportion to the load at single poses",
    "constant": "constant at single poses",
    "drift": "drifting at single poses",
}
ORDERS = {
    "constant": "constant at single poses, beyond what is in proportion to the load",
    "curved": "curved in the load at single poses",
}


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
    """Test the gap that a fitted model leaves.

    Tested are the whole misfit (χ²) where the noise is stated; the parts that go at single poses in
    proportion to the load, as every elastic cause does, known or not, that are constant there, that
    are curved, or go with the order; and whatever the gap goes with most closely of all that
    `localise` suspects. Whoever took a cause for noise is caught by these: noise goes with nothing.

    Parameters
    ----------
    fit
        The fitted model.
    regression
        Linearised at that fit.
    columns
        Its columns in the regression.
    """
    found = localise(fit)
    tests: dict[str, tuple[float, float]] = {}  # probability, excess
    if regression.sigma_known:
        freedom = max(fit.degrees_of_freedom, 1)
        chance = float(stats.chi2.sf(fit.chi_square, freedom))
        tests["whole misfit"] = chance, fit.chi_square - freedom
    for order in found.orders:
        if order.probability is not None and order.name in ORDERS:
            tests[ORDERS[order.name]] = order.probability, order.excess
    for own in found.own:
        tests[OWN[own.name]] = own.probability, own.statistic - own.freedom
    if found.suspects:
        closest = min(found.suspects, key=lambda suspicion: suspicion.probability)
        beyond = closest.statistic - closest.freedom
        tests[f"together with {closest.name}"] = closest.probability, beyond
    chances = {name: chance for name, (chance, _) in tests.items()}
    probability = min(1.0, len(tests) * min(chances.values())) if tests else 1.0
    excess = max((beyond for _, beyond in tests.values()), default=0.0)
    return Adequacy(
        probability, float(np.sqrt(max(excess, 0.0))), _explained(regression, columns), chances
    )


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
