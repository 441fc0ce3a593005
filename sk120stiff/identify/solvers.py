"""The paper's two algorithms on a whitened least-squares problem with bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from sk120stiff.errors import Refusal
from sk120stiff.robot.coupling import Array

Method = Literal["trf", "lm"]
Evaluate = Callable[[Array], tuple[Array, Array]]

TOLERANCE = 1e-14


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where a solver stopped.

    Attributes
    ----------
    x
        (P,) parameters.
    residual, jacobian
        (R,) whitened gap and (R, P) derivative there.
    at_bound
        (P,) parameters held at a physical bound.
    iterations
        Evaluations of the model.
    """

    x: Array
    residual: Array
    jacobian: Array
    at_bound: NDArray[np.bool_]
    iterations: int


def minimise(
    evaluate: Evaluate, start: Array, bounds: tuple[Array, Array], method: Method
) -> Minimum:
    """Least squares within bounds.

    ``trf`` is the trust-region-reflective method (the paper's interior-reflective Newton method) and
    knows bounds. ``lm`` is Levenberg–Marquardt, which does not: parameters that leave their bounds
    are set onto them and the rest is fitted again, until none leaves and none wants back.

    Raises
    ------
    Refusal
        The solver did not converge.
    """
    start = np.clip(start, *bounds)
    if method == "trf":
        return _solve(evaluate, start, bounds, np.zeros(len(start), dtype=bool), "trf")
    held = np.zeros(len(start), dtype=bool)
    x = start.copy()
    for _ in range(2 * len(start) + 1):
        found = _solve(evaluate, x, bounds, held, "lm")
        x = np.clip(found.x, *bounds)
        outside = ~held & (found.x != x)
        if outside.any():
            held |= outside
            continue
        gradient = found.jacobian.T @ found.residual
        inward = held & np.where(x <= bounds[0], gradient < 0.0, gradient > 0.0)
        size = np.linalg.norm(found.jacobian, axis=0) * np.linalg.norm(found.residual)
        inward &= np.abs(gradient) > 1e-10 * np.maximum(size, 1e-300)
        if not inward.any():
            return found
        held &= ~inward
    raise Refusal("Levenberg–Marquardt kept going in and out of a bound", remedy="Use --method trf.")


def _solve(
    evaluate: Evaluate,
    start: Array,
    bounds: tuple[Array, Array],
    held: NDArray[np.bool_],
    method: Method,
) -> Minimum:
    moving = np.flatnonzero(~held)
    cache: dict[bytes, tuple[Array, Array]] = {}
    count = 0

    def at(part: Array) -> tuple[Array, Array]:
        nonlocal count
        x = start.copy()
        x[moving] = part
        key = x.tobytes()
        if key not in cache:
            count += 1
            cache.clear()
            cache[key] = evaluate(x)
        return cache[key]

    if len(moving):
        residual, jacobian = at(start[moving])
        if method == "lm" and len(residual) < len(moving):
            raise Refusal("fewer readings than parameters", remedy="Free fewer parameters.")
        limits = (-np.inf, np.inf) if method == "lm" else (bounds[0][moving], bounds[1][moving])
        norms = np.linalg.norm(jacobian[:, moving], axis=0)
        found = least_squares(
            lambda part: at(part)[0],
            start[moving],
            jac=lambda part: at(part)[1][:, moving],
            method=method,
            bounds=limits,
            x_scale=1.0 / np.where(norms > 0.0, norms, 1.0),
            xtol=TOLERANCE,
            ftol=TOLERANCE,
            gtol=TOLERANCE,
            max_nfev=400,
        )
        if found.status == 0:
            raise Refusal(
                "the least-squares solver did not converge in 400 steps",
                remedy="Free fewer parameters, or start nearer.",
            )
        best = found.x
    else:
        best = start[moving]
    residual, jacobian = at(best)
    x = start.copy()
    x[moving] = best
    width = 1e-9 * np.maximum(1.0, np.abs(x))
    on = held | (x - bounds[0] <= width) | (bounds[1] - x <= width)
    return Minimum(x, residual, jacobian, on, count)
