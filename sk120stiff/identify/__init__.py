"""Measurements + model become a `Fit`: least squares, uncertainty, what cannot be known."""

from sk120stiff.identify.fit import Fit, fit, solve
from sk120stiff.identify.problem import Problem

__all__ = ["Fit", "Problem", "fit", "solve"]
