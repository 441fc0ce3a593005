"""Does a fitted model agree with its readings? One test, against one yardstick of the noise."""

from __future__ import annotations

from dataclasses import dataclass

from scipy import stats

from sk120stiff.identify.fit import LEVEL, Fit
from sk120stiff.identify.left_over import orthonormal
from sk120stiff.identify.yardstick import Source, Yardstick, left_within_poses, yardstick

DOUBTFUL = 0.05  # probability below which an agreement is said with a doubt


@dataclass(frozen=True)
class LackOfFit:
    """The test of a fitted model.

    Attributes
    ----------
    against
        What the misfit is held against.
    statistic
        χ² against a stated σ, else F (Fisher 1922).
    freedom
        Degrees of freedom of the misfit, and of the yardstick (None: known exactly).
    probability
        Of a larger value if the model were true.
    factor
        Rms of the whole misfit in units of the yardstick; 1 if noise is all there is.
    """

    against: Source
    statistic: float
    freedom: tuple[int, int | None]
    probability: float
    factor: float

    @property
    def lacking(self) -> bool:
        """The model does not agree with the readings."""
        return self.probability < LEVEL

    def sentence(self) -> str:
        """The finding in words."""
        verdict = "agree"
        if self.lacking:
            verdict = "do not agree"
        elif self.probability < DOUBTFUL:
            verdict = "hardly agree"
        name, freedom = "χ²", f"{self.freedom[0]}"
        if self.freedom[1] is not None:
            name, freedom = "F", f"{self.freedom[0]} and {self.freedom[1]}"
        against = Yardstick(self.against, 1.0, 0.0, None, None).name
        return (
            f"Held against {against}, model and readings {verdict}: {name} = "
            f"{self.statistic:.4g} on {freedom} degrees of freedom, p = {self.probability:.2g}."
        )


def lack_of_fit(fit: Fit) -> LackOfFit | None:
    """Test the whole misfit against the yardstick of the readings' noise.

    Parameters
    ----------
    fit
        A fit by least squares.

    Returns
    -------
    LackOfFit
        None where nothing tells the noise, and for a robust fit, whose misfit is no sum of squares.
    """
    if fit.problem.weights is not None or fit.degrees_of_freedom < 1:
        return None
    noise = yardstick(fit)
    factor = fit.noise_factor / noise.scale**0.5
    if fit.misfit is not None:
        return LackOfFit(noise.source, *fit.misfit, factor)
    if noise.source != "scatter":
        return None
    square, rank, _ = left_within_poses(fit, fit.residual, orthonormal(fit.jacobian))
    freedom = len(fit.residual) - rank
    taken = fit.degrees_of_freedom - freedom
    if taken < 1:
        return None
    ratio = max(fit.chi_square - square, 0.0) / taken / (square / freedom)
    chance = float(stats.f.sf(ratio, taken, freedom))
    return LackOfFit("scatter", ratio, (taken, freedom), chance, factor)
