"""Noise that grows with the displacement, from what a model leaves of readings.

Forces that were pulled by hand, or by a cable that hangs a little askew, are off by a share of
themselves, from reading to reading anew. Nobody states that. What a model leaves over grows with
the displacement then, and a constant σ, found from small and large readings alike, takes what
large ones have too much for a cause.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from sk120stiff.arrays import Array
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.noise import NoiseModel

HINT = 2.0  # twice the log-likelihood by which it must be likelier to be tried: causes decide
_REACH = (-4.0, 4.0)  # natural logarithm of growth·|d|/σ at the usual displacement
_MOST = 0.5  # growth beside the σ that a fit starts from


def growing(noise: NoiseModel, measurements: Measurements, left: Array) -> NoiseModel | None:
    """The noise with a part that grows with the displacement; None unless something hints at it.

    The part over σ is the likeliest one in what is left, σ at its best (as where repeats tell it,
    `repeats.py`). What was stated, or told by repeats, stays.

    Args:
        noise: Which the readings were fitted with; its own growth does not count.
        measurements: Readings in use.
        left: (N, 3) measured minus predicted, m.
    """
    stated = measurements.noise.growth is not None or measurements.sigma is not None
    if noise.known or noise.form or stated:
        return None
    usual = float(np.median(np.linalg.norm(measurements.moved, axis=1)))
    if usual == 0.0:
        return None

    def grown(ratio: float) -> NoiseModel:
        sigma = min(noise.sigma, _MOST / ratio)
        return replace(noise, sigma=sigma, growth=ratio * sigma)

    def unlikely(tried: NoiseModel) -> float:
        whitener = tried.whitener(measurements)
        white = whitener.apply(left)
        return len(white) * float(np.log(max(float(white @ white), 1e-300))) + whitener.logdet

    best = minimize_scalar(
        lambda logarithm: unlikely(grown(float(np.exp(logarithm)) / usual)),
        bounds=_REACH,
        method="bounded",
        options={"xatol": 0.02},
    )
    if unlikely(replace(noise, growth=0.0)) - best.fun <= HINT:
        return None
    return grown(float(np.exp(best.x)) / usual)
