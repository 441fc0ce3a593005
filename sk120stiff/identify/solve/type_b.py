"""What is known of an instrument before it reads: its calibration, where readings say nothing.

A force sensor's gain and all springs make one product: if every force is read 1 % too large and
every spring is 1 % stiffer, no reading changes. Readings with such a direction tell the springs up
to the sensor's calibration, and no less: its usual error is a standard uncertainty of Type B (GUM,
4.3), which stands for what the readings do not tell. Where they do tell, it does not count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.identify.solve.polish import FAINTEST, seen_directions

# times as narrow as what is plausible, from where on a calibration tells something; and up to where
# what the readings tell is less than that
NARROWER = 1.0


@dataclass(frozen=True, eq=False)
class Calibrations:
    """Directions of the parameters that calibrations of instruments tell, and readings do not.

    Attributes:
        directions: (b, P) orthonormal, of parameters over `span`.
        errors: (P, b) orthonormal: where a step along a direction leads, over `usual`.
        sizes: (b,) how far that is.
        span: (P,) sizes beyond which the parameters are implausible.
        usual: (P,) standard uncertainties by calibration; infinite where there is none.
    """

    directions: Array
    errors: Array
    sizes: Array
    span: Array
    usual: Array

    @classmethod
    def of(cls, jacobian: Array, held: Mask, span: Array, usual: Array) -> Calibrations:
        """What a derivative (R, P) in units of the noise leaves open, `held` parameters at rest.

        A parameter that does not show at all is no matter of calibrations: nothing was read of it.
        """
        shows = np.linalg.norm(jacobian, axis=0) * span > FAINTEST
        moving = np.flatnonzero(~held & shows)
        directions, errors = np.zeros((0, len(span))), np.zeros((len(span), 0))
        if not np.isfinite(usual[moving]).any():
            return cls(directions, errors, np.zeros(0), span, usual)
        null = seen_directions(jacobian[:, moving], span[moving], NARROWER)[3]
        U, sizes, along = np.linalg.svd((span / usual)[moving, None] * null, full_matrices=False)
        told = sizes > NARROWER
        directions = np.zeros((int(told.sum()), len(span)))
        directions[:, moving] = along[told] @ null.T
        errors = np.zeros((len(span), len(directions)))
        errors[moving] = U[:, told]
        return cls(directions, errors, sizes[told], span, usual)

    def rows(self, unit: float) -> Array:
        """(b, P) rows of a derivative that say as much; the noise is `unit` times the assumed."""
        known = unit if np.isfinite(unit) else 0.0
        return np.asarray(known * self.sizes[:, None] * self.directions / self.span)

    def step(self, x: Array) -> Array:
        """(P,) what leads from parameters `x` to where the instruments are likeliest.

        To first order no prediction changes.
        """
        return np.asarray(-self.span * ((self.off(x)[0] / self.sizes) @ self.directions))

    def off(self, x: Array) -> tuple[Array, Array]:
        """(b,) how far parameters are off their calibrations there, and (b, P) its derivative."""
        return self.errors.T @ (x / self.usual), self.errors.T / self.usual

    def beside(self, change: Array) -> Array:
        """(P,) a change of the parameters without what calibrations alone tell of it."""
        over = change / self.span
        return np.asarray(self.span * (over - (self.directions @ over) @ self.directions))
