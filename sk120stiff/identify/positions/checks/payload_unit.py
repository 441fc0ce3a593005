"""Payloads in pounds under a header of kilograms: told by sag that fits far better so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.effects import Effect, LoadError, Weighing
from sk120stiff.errors import Refusal
from sk120stiff.identify.positions.calibrate import Calibration, fitted

POUND = 0.45359237  # kg
BETTER = 0.8  # of the gap's rms, below which pounds must bring it
CLEAR = 10.0  # logarithm of the odds for them


def pounds(found: Calibration) -> list[str]:
    """That payloads look like pounds, where nothing but another unit explains the sag as well.

    Own weight and payloads bend the same springs: what stands in another unit bends them by too
    much against it. A payload that is the same in every row tells little, and one that is fitted
    nothing.
    """
    problem = found.problem
    said = problem.said
    if not said.payload.any() or not any(p.effect.joint_spring for p in found.parameters):
        return []
    if any(_weighs_otherwise(p.effect) for p in found.parameters):
        return []
    lighter = replace(said, payload=POUND * said.payload)
    readings = replace(problem.measurements, absolute=lighter)
    other = replace(problem, model=found.model, measurements=readings)
    try:
        tried = fitted(other)
    except Refusal:
        return []
    share = tried.chi_square / found.chi_square
    if share > BETTER**2 or -0.5 * len(found.residual) * np.log(share) < CLEAR:
        return []
    return [
        f"The payloads look like pounds: taken so, the fit leaves {100 * share**0.5:.0f} % of the "
        "gap. Write them in kg under payload[kg]."
    ]


def _weighs_otherwise(effect: Effect) -> bool:
    """May loads be of another size than stated with it? Where they act is no matter of size."""
    return isinstance(effect, Weighing) or (isinstance(effect, LoadError) and not effect.of_payload)
