"""Which noise model the data's own description asks for."""

from __future__ import annotations

from sk120stiff.measurements import Measurements
from sk120stiff.measurements.noise import NoiseModel, candidates

UNIT_SIGMA = 1e-5  # m; a start where no σ is stated, replaced by the estimate


def default_noise(measurements: Measurements) -> NoiseModel:
    """The first noise model that fits what the file says of itself."""
    return candidates(measurements)[0]
