"""Does a fitted model agree with its readings? Tests against what is known of their noise.

Three yardsticks, whichever the data offer:

- a stated σ: the whole misfit against χ²;
- repeats: the misfit beyond pure error against pure error, an F test (Fisher 1922);
- the scatter about lines through the loads of single poses, which every elastic cause leaves
  alone, whatever the model lacks: an F test too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import stats

from sk120stiff.identify.fit import Fit
from sk120stiff.identify.left_over import left_over, orthonormal
from sk120stiff.identify.saturated import load_basis, pose_columns
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.poses import rows_by_label
from sk120stiff.robot.coupling import Array

Yardstick = Literal["stated uncertainty", "pure error", "scatter within poses"]
LEVEL = 0.01  # probability below which model and readings are said to disagree
FEWEST = 3  # degrees of freedom without which a yardstick is none


@dataclass(frozen=True)
class LackOfFit:
    """One test of a fitted model.

    Attributes
    ----------
    against
        What the misfit is held against.
    statistic
        χ², or F.
    freedom
        Degrees of freedom of the misfit, and of the yardstick (None: known exactly).
    probability
        Of a larger value if the model were true.
    """

    against: Yardstick
    statistic: float
    freedom: tuple[int, int | None]
    probability: float

    @property
    def lacking(self) -> bool:
        """The model does not agree with the readings."""
        return self.probability < LEVEL

    def sentence(self) -> str:
        """The finding in words."""
        verdict = "do not agree" if self.lacking else "agree"
        name, freedom = "χ²", f"{self.freedom[0]}"
        if self.freedom[1] is not None:
            name, freedom = "F", f"{self.freedom[0]} and {self.freedom[1]}"
        return (
            f"Held against the {self.against}, model and readings {verdict}: {name} = "
            f"{self.statistic:.4g} on {freedom} degrees of freedom, p = {self.probability:.2g}."
        )


ROUNDING = 1e-12  # share of the misfit that is rounding, not scatter


def lack_of_fit(fit: Fit) -> tuple[LackOfFit, ...]:
    """Every test that the readings allow; none for a robust fit, whose misfit is no sum of squares.

    Parameters
    ----------
    fit
        A fit by least squares.
    """
    if fit.problem.weights is not None or fit.degrees_of_freedom < 1:
        return ()
    tests = []
    if fit.lack_of_fit is not None:
        tests.append(
            LackOfFit(
                "stated uncertainty",
                fit.chi_square,
                (fit.degrees_of_freedom, None),
                fit.lack_of_fit,
            )
        )
    measurements = fit.problem.measurements
    repeated = _against(fit, _cell_columns(measurements), "pure error")
    if repeated is not None:
        tests.append(repeated)
    elif not fit.sigma_stated:
        lines = pose_columns(load_basis(fit.problem.situation, jump=True, cubic=True))
        within = _against(fit, lines, "scatter within poses")
        if within is not None:
            tests.append(within)
    return tuple(tests)


def _cell_columns(measurements: Measurements) -> Array:
    """(N, 3, 3c) one column per axis for the mean of each cell of repeats of a pose."""
    branch = np.zeros(measurements.n_readings)
    if measurements.branch is not None:
        branch = np.array([float(word == "unload") for word in measurements.branch])
    keys = np.column_stack([measurements.pose_index, np.round(measurements.wrench, 9), branch])
    _, cell = np.unique(keys, axis=0, return_inverse=True)
    member = np.zeros(len(cell), dtype=np.intp)
    for rows in rows_by_label(measurements.pose_index):
        member[rows] = np.unique(cell[rows], return_inverse=True)[1]
    indicator = (member[:, None] == np.arange(member.max() + 1)).astype(float)
    return pose_columns(indicator)


def _against(fit: Fit, columns: Array, against: Yardstick) -> LackOfFit | None:
    """F test of the misfit that columns, free at every pose, take beyond the model."""
    local = fit.problem.whitener.apply(columns)
    group = np.repeat(fit.problem.situation.pose, 3)
    rest, rank = left_over(fit.residual, orthonormal(fit.jacobian), local, group)
    freedom = len(fit.residual) - rank
    taken = fit.degrees_of_freedom - freedom
    if freedom < FEWEST or taken < 1 or rest <= ROUNDING * fit.chi_square:
        return None  # readings that do not scatter at all are no yardstick
    ratio = max(fit.chi_square - rest, 0.0) / taken / (rest / freedom)
    return LackOfFit(against, ratio, (taken, freedom), float(stats.f.sf(ratio, taken, freedom)))
