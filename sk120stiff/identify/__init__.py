"""Measurements + model become a `Fit`: least squares, uncertainty, what cannot be known."""

from sk120stiff.identify.fit import Fit, fit, solve
from sk120stiff.identify.problem import Problem
from sk120stiff.identify.weak import weak_directions

__all__ = ["Fit", "Problem", "fit", "solve", "weak_directions"]
