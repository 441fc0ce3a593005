"""The smallest effects that these readings would have brought a name for.

An effect is named where the misfit falls by more than its price, and other poses confirm it. With
the readings' noise Gaussian, an effect of size v takes G ~ χ'²_k(λ) away from the misfit, λ = v² ‖M
s‖², s its signature in units of the noise and M projecting out the model's other parameters; so the
λ at which G exceeds the price in a given share of cases is a quantile. What confirmation takes away
beyond that is small where the price is paid: drawn readings put through search and confirmation
bring the name in 81 to 88 % of cases (`tests/explain/test_detectable.py`).
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy import optimize, stats

from sk120stiff.arrays import of_length_one
from sk120stiff.explain.answer.explanation import Explanation
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.findings import Detectable
from sk120stiff.explain.select.score import entry_fall, score_set

POWER = 0.8  # share of cases in which an effect of the size given is named


def detectable(
    answer: Explanation, regression: Regression
) -> tuple[tuple[Detectable, ...], tuple[str, ...]]:
    """Smallest size of every parameter that would have been named, and effects that never would.

    Args:
        answer: The named effects are part of the model beside which others would show.
        regression: Linearised readings.
    """
    sums = regression.sums()
    chosen = {finding.effect.id for finding in answer.findings}
    named = chosen.union(*(finding.alternatives for finding in answer.findings))
    inside = [k for k, e in enumerate(regression.candidates) if e.id in chosen]
    columns = score_set(regression, sums, inside).solved.columns
    basis, _ = np.linalg.qr(of_length_one(regression.X[:, columns]))
    left = regression.X - basis @ (basis.T @ regression.X)
    size = np.linalg.norm(left, axis=0)
    noise = 1.0 if regression.sigma_known else answer.final.noise_factor
    found: list[Detectable] = []
    invisible: list[str] = []
    for k, (candidate, own) in enumerate(
        zip(regression.candidates, regression.columns, strict=True)
    ):
        length = length_named(entry_fall(regression, k), len(own))
        seen = False
        for spec, column in zip(candidate.parameters, own, strict=True):
            need = length * noise / size[column] if size[column] > 0.0 else np.inf
            visible = need <= regression.plausible[column]
            seen = seen or bool(visible)
            value = spec.public(need * spec.typical) if visible else None
            found.append(Detectable(f"{candidate.id}.{spec.name}", value, spec.unit))
        if not seen and candidate.id not in named:
            invisible.append(candidate.id)
    return tuple(found), tuple(invisible)


@cache
def length_named(fall: float, count: int) -> float:
    """√λ at which the misfit falls by more than is needed in the share `POWER` of cases.

    Args:
        fall: What is needed, see `entry_fall`.
        count: Number of parameters that move with the effect.
    """

    def short(length: float) -> float:
        return float(stats.ncx2.sf(fall, count, length**2)) - POWER

    return float(optimize.brentq(short, 1e-3, 3.0 * np.sqrt(fall + count) + 10.0))
