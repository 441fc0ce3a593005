"""One number in the place of all springs: the gain by which the force would have been misread.

Force, compliance and displacement enter as one product, so a force that is misread by a constant
factor looks like springs that are all softer by it. Springs that explain no more than that factor
does are no better founded than it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from sk120stiff.identify.fit import Fit
from sk120stiff.model import Model

REACH = (0.5, 2.0)  # beyond it no sensor is misread, but a unit is wrong


@dataclass(frozen=True)
class OneGain:
    """A model with every force times one gain, fitted to the readings of a fit.

    Attributes:
        gain: True force over the force as it was read.
        rms: Gap that it leaves, root mean square per axis [m].
    """

    gain: float
    rms: float


def one_gain(model: Model, fit: Fit) -> OneGain:
    """The gain that suits a model best, by the noise of a fit, at exact equilibrium.

    Args:
        model: Its values stay as they are.
        fit: Gives readings and noise.
    """
    problem = fit.problem
    load_cases = problem.load_cases

    def gap(gain: float) -> np.ndarray:
        loaded = replace(load_cases, wrench=gain * load_cases.wrench)
        return np.asarray(problem.measured - model.predict(loaded))

    def misfit(gain: float) -> float:
        return float(np.sum(problem.whitener.apply(gap(gain)) ** 2))

    gain = float(minimize_scalar(misfit, bounds=REACH, method="bounded").x)
    return OneGain(gain, float(np.sqrt(np.nanmean(gap(gain) ** 2))))
