"""Do all poses scatter alike? Noise that was only stated too small does; a cause does not."""

from __future__ import annotations

import numpy as np
from scipy import stats

from sk120stiff.identify import Fit
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.checks.saturated import load_basis, pose_columns
from sk120stiff.measurements.poses import rows_by_label

FEWEST = 3  # degrees of freedom without which the scatter of a pose says nothing


def unlike_scatter(fit: Fit) -> dict[str, tuple[float, float]]:
    """Bartlett's test (1937) of equal scatter within poses: its name, probability and excess.

    Empty where fewer than two poses have readings enough.
    """
    load_cases = fit.problem.load_cases
    basis = load_basis(load_cases, jump=True, cubic=True, branches=True)
    columns = fit.problem.whitener.apply(pose_columns(basis))
    squares, freedom = [], []
    for rows in rows_by_label(fit.problem.pose):
        block = orthonormal(columns[rows])
        white = fit.residual[rows]
        left = white - block @ (block.T @ white)
        if len(white) - block.shape[1] >= FEWEST:
            squares.append(float(left @ left))
            freedom.append(len(white) - block.shape[1])
    if len(squares) < 2 or min(squares) <= 0.0:
        return {}
    nu, variance = np.array(freedom, dtype=float), np.array(squares) / np.array(freedom)
    pooled = float(nu @ variance / nu.sum())
    T = float(nu.sum() * np.log(pooled) - nu @ np.log(variance))
    T /= 1.0 + (float((1.0 / nu).sum()) - 1.0 / nu.sum()) / (3.0 * (len(nu) - 1))
    chance = float(stats.chi2.sf(T, len(nu) - 1))
    return {"scatter that differs between poses": (chance, T - (len(nu) - 1))}
