"""What is known before a reading is taken: draws are chance, and instruments were calibrated.

A force sensor's gain and all springs make one product: if every force is read 1 % too large and
every spring is 1 % stiffer, no reading of a stiff arm changes, and hardly one of a soft arm.
Readings with such a direction tell the springs up to the sensor's calibration, and no less: its
usual error is a standard uncertainty of Type B (GUM, 4.3) and counts beside the readings. Where
they tell ten times as much it does not: an error that was measured is what it was measured to be.

A zero reading that is off moves all readings of its pose alike, and so does a force sensor that
reads too much: with an offset for every pose little is left to tell the sensor by. But offsets are
chance, about zero and of one size. Of all that fit alike the smallest are the likeliest, and what
poses have in common is the sensor's (best linear unbiased prediction, Henderson 1975).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask, rms
from sk120stiff.identify.solve.prior import Prior
from sk120stiff.identify.solve.problem import Problem

COUNTS = 0.1  # of what readings tell, as standard errors, below which a calibration is no news
CHANCE = 1.0  # the same of draws: what readings tell of each by itself is no matter of chance


@dataclass(frozen=True, eq=False)
class Beforehand:
    """What counts beside the readings, where these leave something open.

    Attributes:
        draws: What draws of one size tell, being draws.
        calibrations: What calibrations of instruments tell beside these.
    """

    draws: Prior
    calibrations: Prior

    @classmethod
    def of(cls, problem: Problem, x: Array, jacobian: Array, held: Mask, unit: float) -> Beforehand:
        """At scaled estimates `x` with a derivative (R, P) over the noise assumed.

        Args:
            problem: Says which parameters are draws, and what instruments are calibrated to.
            x: (P,) estimates; the draws among them tell their own size.
            jacobian: The derivative.
            held: (P,) parameters that a bound holds.
            unit: The readings' noise over the noise assumed; infinite where nothing tells it.
        """
        span, size = problem.span, np.full(len(x), np.inf)
        for group in problem.draws:
            own = rms(x[group])
            size[group] = own if own > 0.0 else np.inf
        draws = Prior.of(jacobian, held, span, size, unit, CHANCE)
        read = np.vstack([jacobian, draws.rows()])
        return cls(draws, Prior.of(read, held, span, problem.usual, unit, COUNTS))

    def rows(self) -> Array:
        """(b, P) rows of a derivative over the noise assumed that say as much."""
        return np.vstack([self.draws.rows(), self.calibrations.rows()])

    def step(self, x: Array) -> Array:
        """(P,) what leads from parameters `x` to where draws and instruments are likeliest."""
        step = self.draws.step(x)
        return np.asarray(step + self.calibrations.step(x + step))

    @property
    def slope(self) -> Array:
        """(b, P) times parameters: by how many standard deviations they are off along each."""
        return np.vstack([self.draws.slope, self.calibrations.slope])
