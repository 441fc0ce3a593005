"""What each effect and each joint moves the point by, at given loads: the error budget.

To first order a displacement is the sum of what every parameter brings, d = Σ_p (∂d/∂p) v_p, with
v_p the internal value, which is zero where the effect is absent. The parts add as vectors, and so
their sizes need not add up: springs and tilts may pull opposite ways.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Situation
from sk120stiff.identify import Fit


@dataclass(frozen=True)
class Share:
    """What one effect brings.

    Attributes:
        name: ``name:where``.
        rms: Of the displacements that it brings, per axis [m].
        std: Standard error of `rms` [m]; None where nothing tells it.
    """

    name: str
    rms: float
    std: float | None


def error_budget(fit: Fit, situation: Situation | None = None) -> tuple[Share, ...]:
    """Shares of all effects of a fitted model, the largest first.

    Args:
        fit: The fitted model.
        situation: Poses and loads of a task; None: those that were measured.
    """
    at = fit.problem.situation if situation is None else situation
    _, derivative = fit.model.predict_with_sensitivities(at)
    values = fit.model.values
    covariance = np.zeros((len(values), len(values)))
    free = np.ix_(fit.problem.free, fit.problem.free)
    covariance[free] = fit.covariance * np.outer(fit.problem.scale, fit.problem.scale)
    ids = [parameter.effect.id for parameter in fit.model.parameters]
    shares = []
    for name in dict.fromkeys(ids):
        own = np.array([k for k, other in enumerate(ids) if other == name])
        shares.append(
            _share(name, derivative[:, :, own], values[own], covariance[np.ix_(own, own)])
        )
    return tuple(sorted(shares, key=lambda share: -share.rms))


def _share(name: str, columns: Array, values: Array, covariance: Array) -> Share:
    """Size of what some parameters bring: columns (N, 3, p), values (p,), covariance (p, p)."""
    moved = columns @ values
    rms = float(np.sqrt(np.mean(moved**2)))
    if not np.isfinite(covariance).all():
        return Share(name, rms, None)
    if rms == 0.0:
        return Share(name, 0.0, 0.0)
    slope = np.einsum("ni,nip->p", moved, columns) / (moved.size * rms)
    return Share(name, rms, float(np.sqrt(max(slope @ covariance @ slope, 0.0))))
