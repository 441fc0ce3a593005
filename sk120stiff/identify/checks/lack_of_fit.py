"""Does a fitted model agree with its readings? One test, against one yardstick of the noise."""

from __future__ import annotations

from dataclasses import dataclass

from scipy import stats

from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.checks.yardstick import Source, Yardstick, left_within_poses, yardstick
from sk120stiff.identify.fit import LEVEL, Fit
from sk120stiff.identify.solving import against_noise_alone

DOUBTFUL = 0.05  # probability below which an agreement is said with a doubt
TOO_LARGE = 0.8  # of a stated σ; what comes nearer is not worth a word
SURELY = 1e-3  # probability below which a stated σ is said to be off


@dataclass(frozen=True)
class LackOfFit:
    """The test of a fitted model.

    Attributes:
        against: What the misfit is held against.
        statistic: χ² against a σ that is exact, else F (Fisher 1922).
        freedom: Degrees of freedom of the misfit, and of the yardstick (None: known exactly).
        probability: Of a larger value if the model were true.
        factor: Rms of the whole misfit in units of the yardstick; 1 if noise is all there is.
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
            f"{self.statistic:.4g} on {freedom} degrees of freedom, {chance(self.probability)}."
        )

    def of_the_statement(self) -> str:
        """What the misfit says of a stated σ; empty where it bears σ out, or σ was not stated."""
        if self.against != "stated":
            return ""
        if self.lacking and self.factor > 1.0:
            return (
                "σ is stated too small, or something is missing in the model: 'sk120stiff "
                "explain' tells which."
            )
        return self.too_large()

    def too_large(self) -> str:
        """That a stated σ looks too large, or nothing."""
        if self.probability > 1.0 - SURELY and self.factor < TOO_LARGE:
            return f"σ looks {1.0 / self.factor:.2f} times too large; it stays the yardstick."
        return ""


def chance(probability: float) -> str:
    """A probability in words."""
    if probability < 1e-6:
        return "p < 0.000001"
    return f"p = {probability:.2g}" if probability >= 1e-4 else f"p = {probability:.0e}"


def lack_of_fit(fit: Fit) -> LackOfFit | None:
    """Test the whole misfit against the yardstick of the readings' noise.

    Model-form error that a fit took into account is no noise: it is what this test looks for.

    Args:
        fit: A fit by least squares.

    Returns:
        LackOfFit: None where nothing tells the noise, and for a robust fit, whose misfit is no sum
            of squares.
    """
    if fit.problem.weights is not None or fit.degrees_of_freedom < 1:
        return None
    fit = against_noise_alone(fit)
    noise = yardstick(fit)
    factor = fit.noise_factor / noise.scale**0.5
    if fit.misfit is not None:
        return LackOfFit(noise.source, *fit.misfit, factor)
    if noise.source == "computed":
        square = fit.chi_square / noise.scale
        freedom = fit.degrees_of_freedom
        return LackOfFit(
            "computed", square, (freedom, None), noise.tail(fit.chi_square, freedom), factor
        )
    if noise.source != "scatter":
        return None
    square, rank, _ = left_within_poses(fit, fit.residual, orthonormal(fit.jacobian))
    freedom = len(fit.residual) - rank
    taken = fit.degrees_of_freedom - freedom
    if taken < 1:
        return None
    ratio = max(fit.chi_square - square, 0.0) / taken / (square / freedom)
    probability = float(stats.f.sf(ratio, taken, freedom))
    return LackOfFit("scatter", ratio, (taken, freedom), probability, factor)
