"""Least squares for geometry: Gauss and Newton with what is plausible as a weak prior, and bounds.

Small errors of geometry enter nearly linearly, but many of them are hardly told apart. A prior of
the plausible size keeps such directions where they mean something; what the readings tell is some
hundred times sharper and does not feel it. Each step is the exact solution of the linear problem
within bounds (Stark & Parker 1995).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.identify.solve.polish import Evaluate, Minimum

STEPS, HALVINGS = 60, 8  # an unknown load on unknown springs takes a curved way
WORTH = 0.1  # of the fall that a step promises, which it must bring: one that overshoots is halved
ENOUGH = 1e-3  # a step that changes the predictions by less than this share of their noise is none


def gauss_newton(
    evaluate: Evaluate,
    start: Array,
    bounds: tuple[Array, Array],
    span: Array,
    centre: Array,
) -> Minimum:
    """Least squares within bounds from a start that is near.

    Args:
        evaluate: Gives residual (M,) in units of the noise, and its derivative (M, P).
        start: (P,) where the search begins.
        bounds: Lower and upper (P,).
        span: (P,) sizes of the parameters beyond which they are implausible: widths of the prior.
        centre: (P,) where the prior is centred.

    Raises:
        Refusal: The steps do not become small.
    """
    x = np.clip(start, *bounds)
    residual, jacobian = evaluate(x)
    count = 1
    for _ in range(STEPS):
        step = linear_step(jacobian, residual, x, centre, bounds, span)
        noise = float(np.sqrt(residual @ residual / len(residual)))
        if np.linalg.norm(jacobian @ step) <= ENOUGH * max(noise, 1e-9) * np.sqrt(len(x) + 1.0):
            held = ((x <= bounds[0]) | (x >= bounds[1])) & np.isfinite(x)
            return Minimum(x, residual, jacobian, held, count)
        cost = _cost(residual, x, centre, span)
        promised = cost - _cost(residual + jacobian @ step, x + step, centre, span)
        share = 1.0
        for _ in range(HALVINGS):
            new = np.clip(x + step, *bounds)
            try:
                found = evaluate(new)
            except Refusal:
                step, share = 0.5 * step, 0.5 * share
                continue
            count += 1
            enough = cost * (1.0 + 1e-12) - WORTH * share * promised
            if _cost(found[0], new, centre, span) < enough:
                break
            step, share = 0.5 * step, 0.5 * share
        else:
            held = ((x <= bounds[0]) | (x >= bounds[1])) & np.isfinite(x)
            return Minimum(x, residual, jacobian, held, count)
        x, (residual, jacobian) = new, found
    raise Refusal(
        "the fit of geometry does not settle",
        remedy="Check that rows of joints and positions belong together, and the start of the "
        "model's parameters.",
    )


def linear_step(
    jacobian: Array,
    residual: Array,
    x: Array,
    centre: Array,
    bounds: tuple[Array, Array],
    span: Array,
) -> Array:
    """(P,) step to the minimum of the linearised problem within the bounds."""
    R = np.asarray(np.linalg.qr(np.column_stack([jacobian, residual]), mode="r"))
    A = np.concatenate([R[:, :-1], np.diag(1.0 / span)])
    b = np.concatenate([-R[:, -1], (centre - x) / span])
    size = np.linalg.norm(A, axis=0)
    lower, upper = (bounds[0] - x) * size, (bounds[1] - x) * size
    A = A / size
    free = np.linalg.lstsq(A, b, rcond=None)[0]
    if (free < lower).any() or (free > upper).any():
        lower = np.where(lower >= upper, upper - 1e-12, lower)
        free = lsq_linear(A, b, (lower, upper), method="bvls").x
    return np.asarray(free / size)


def _cost(residual: Array, x: Array, centre: Array, span: Array) -> float:
    return float(residual @ residual + (((x - centre) / span) ** 2).sum())
