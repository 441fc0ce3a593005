"""What the noise of the readings is, from which source, with how many degrees of freedom.

The one answer that everything else is held against: identify, explain, and every page and file.

- stated: the data say it. It is exact; nothing overrules it.
- repeats: the same pose, load and branch read again.
- scatter: what single poses leave about lines through their loads, constants, curves and branches,
  which every elastic cause leaves alone, whatever the model lacks.
- computed: nothing of these, and the gap is smaller than any instrument reads: it is rounding.
- unknown: nothing tells. The gap itself is no yardstick of the gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array
from sk120stiff.errors import short
from sk120stiff.identify.checks.left_over import left_over, orthonormal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.noise.saturated import load_basis, pose_columns
from sk120stiff.measurements.noise.law import FINEST
from sk120stiff.measurements.noise.repeats import ENOUGH

Source = Literal["stated", "repeats", "scatter", "computed", "unknown"]
CONTRADICTED = 3.0  # times a stated σ from where on it is no slight optimism but a wrong number
ROUNDING = 1e-12  # share of the misfit that is rounding, not scatter

NAMES: dict[Source, str] = {
    "stated": "the stated uncertainty",
    "repeats": "the pure error of repeats",
    "scatter": "the scatter within poses",
    "computed": "the finest that instruments read",
    "unknown": "nothing",
}


@dataclass(frozen=True)
class Yardstick:
    """The noise of a fit's readings.

    Attributes:
        source: Where its size comes from.
        scale: Noise variance over the one that the fit assumed.
        freedom: Degrees of freedom behind it: infinite where it is exact, 0 where unknown.
        sigma: Standard uncertainty of one reading per axis [m]; None where unknown.
        floor: Rms per axis that this noise alone gives displacements [m]; None where unknown.
    """

    source: Source
    scale: float
    freedom: float
    sigma: float | None
    floor: float | None

    @property
    def name(self) -> str:
        """The source in words."""
        return NAMES[self.source]

    def tail(self, statistic: float, freedom: int) -> float:
        """Probability that noise makes a whitened sum of squares as large, for that many freedoms.

        Where the noise is unknown, `scale` is taken for exact.
        """
        if freedom < 1:
            return 1.0
        ratio = statistic / self.scale
        if np.isinf(self.freedom) or not self.freedom:
            return float(stats.chi2.sf(ratio, freedom))
        return float(stats.f.sf(ratio / freedom, freedom, self.freedom))

    def sentence(self) -> str:
        """What one reading is worth, and who says so."""
        if self.sigma is None:
            return "The noise of the readings is unknown: nobody stated it and nothing tells it."
        if self.source == "computed":
            return (
                f"Readings and model agree to less than {short(FINEST * 1e6)} µm, closer than any "
                "instrument reads: the readings were computed, and what is left is rounding."
            )
        told = f"{self.name} ({self.freedom:.0f} degrees of freedom)"
        if self.source == "stated":
            told = "the data's own statement"
        return f"One reading has a standard uncertainty of {short(self.sigma * 1e6)} µm, by {told}."


def yardstick(fit: Fit) -> Yardstick:
    """The noise that a fitted model is held against."""
    noise = fit.problem.noise
    if noise.known:
        return _yardstick(fit, "stated" if noise.stated else "repeats", 1.0, noise.freedom)
    if fit.rms < FINEST:
        return _yardstick(fit, "computed", (FINEST / noise.sigma) ** 2, np.inf)
    found = scatter(fit)
    if found is not None:
        return found
    unit = fit.noise_factor**2 if fit.degrees_of_freedom else 1.0
    return Yardstick("unknown", max(unit, 1e-300), 0.0, None, None)


def scatter(fit: Fit) -> Yardstick | None:
    """The scatter within poses, whatever was stated; None where poses have too few readings."""
    square, rank, _ = left_within_poses(fit, fit.residual, orthonormal(fit.jacobian))
    freedom = len(fit.residual) - rank
    if freedom < ENOUGH or square <= ROUNDING * fit.chi_square:
        return None  # readings that do not scatter at all are no yardstick
    return _yardstick(fit, "scatter", square / freedom, float(freedom))


def contradiction(fit: Fit) -> str | None:
    """What is to be said of a stated σ that single poses scatter far beyond, whatever the model.

    No cause that is smooth in the load makes readings scatter so. What is left are a wrong
    statement, spoilt readings, and branches that no column tells.
    """
    noise = yardstick(fit)
    found = scatter(fit) if noise.source == "stated" else None
    if found is None or found.sigma is None or found.scale < CONTRADICTED**2:
        return None
    return (
        f"Readings of single poses scatter {found.scale**0.5:.2g} times as much about all that is "
        "smooth in their loads as the stated uncertainty of one reading allows; standard errors "
        "are inflated. Check noise: {sigma: ..., unit: ...} in the YAML file (σ = "
        f"{short(found.sigma * 1e6)} µm would fit), rows that do not belong together, single "
        "readings far off ('identify --robust'), and unloading that no column branch tells."
    )


def left_within_poses(fit: Fit, white: Array, inside: Array) -> tuple[float, int, Array]:
    """What all that is smooth in the load leaves: its square, what it took, and the columns.

    Args:
        fit: Gives readings and noise.
        white: (R,) whitened gap.
        inside: (R, k) orthonormal basis of what the model's parameters can do.
    """
    load_cases = fit.problem.load_cases
    basis = load_basis(load_cases, jump=True, cubic=True, branches=True)
    columns = fit.problem.whitener.apply(pose_columns(basis))
    square, rank = left_over(white, inside, columns, fit.problem.pose)
    return square, rank, columns


def _yardstick(fit: Fit, source: Source, scale: float, freedom: float) -> Yardstick:
    problem = fit.problem
    own, zero = problem.noise.variances(problem.measurements, problem.sizes)
    return Yardstick(
        source=source,
        scale=scale,
        freedom=freedom,
        sigma=problem.noise.sigma * float(np.sqrt(scale)),
        floor=float(np.sqrt(np.mean((own + zero)[problem.read]) * scale)),
    )
