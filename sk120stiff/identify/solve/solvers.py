"""The paper's two algorithms on a whitened least-squares problem with bounds."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.optimize import least_squares

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import Refusal
from sk120stiff.identify.solve.polish import (
    Evaluate,
    Minimum,
    polish,
    seen_directions,
)

Method = Literal["trf", "lm"]

TOLERANCE = 1e-4  # of the two algorithms; the last digits come from the polish
EVALUATIONS = 200  # after which the polish must be near enough


def minimise(
    evaluate: Evaluate, start: Array, bounds: tuple[Array, Array], span: Array, method: Method
) -> Minimum:
    """Least squares within bounds, by one of two algorithms and a common last polish.

    ``trf`` is the trust-region-reflective method (the paper's interior-reflective Newton method)
    and knows bounds. ``lm`` is Levenberg–Marquardt, which does not: parameters that leave their
    bounds are set onto them and the rest is fitted again. Both end in `polish`, which also lets go
    of bounds that were taken too early, so they give the same values to the last digits.

    Args:
        evaluate: Gives residual (R,) and derivative (R, P); raises `Refusal` where the model has no
            answer.
        start: (P,) where it has one; clipped to the bounds. Along directions that the readings do
            not see the answer stays there.
        bounds: Lower and upper (P,).
        span: (P,) sizes beyond which the parameters are implausible.
        method: ``"trf"`` or ``"lm"``.

    Raises:
        Refusal: The fit did not converge.
    """
    x = np.clip(start, *bounds)
    counted = _Counted(evaluate)
    if len(x):
        resting = _resting(counted(x)[1], span)
        held = resting.copy()
        while not held.all():
            x, outside = _run(counted, x, bounds, held, method)
            if not outside.any():
                break
            held |= outside
    best = polish(counted, x, bounds, span)
    return replace(best, iterations=counted.count)


def _resting(jacobian: Array, span: Array) -> Mask:
    """A least set of parameters without which every direction of the others is seen.

    Along directions that are hardly seen a solver would wander far beyond what is plausible. So one
    parameter of each rests at its start: the one most involved, of equals the last.
    """
    resting = np.zeros(len(span), dtype=bool)
    while not resting.all():
        moving = np.flatnonzero(~resting)
        null = seen_directions(jacobian[:, moving], span[moving])[3]
        involved = np.round((null**2).sum(axis=1), 6)
        if not null.shape[1]:
            break
        resting[moving[len(moving) - 1 - int(np.argmax(involved[::-1]))]] = True
    return resting


class _Counted:
    """An `Evaluate` that remembers its last answer and counts the evaluations of the model."""

    def __init__(self, evaluate: Evaluate) -> None:
        self.count = 0
        self._evaluate = evaluate
        self._key = b""
        self._answer: tuple[Array, Array] | None = None

    def __call__(self, x: Array) -> tuple[Array, Array]:
        key = x.tobytes()
        if self._answer is None or key != self._key:
            self.count += 1
            self._answer = self._evaluate(x)
            self._key = key
        return self._answer


def _run(
    evaluate: Evaluate, start: Array, bounds: tuple[Array, Array], held: Mask, method: Method
) -> tuple[Array, Mask]:
    """One run over the parameters that are not held; also which of them it wants out of bounds."""
    moving = np.flatnonzero(~held)
    if not len(moving):
        return start, held & False
    residual, jacobian = evaluate(start)
    norms = np.linalg.norm(jacobian[:, moving], axis=0)
    # A step to where the model has no answer must look bad: trf asks for a number that is not
    # finite, MINPACK for a large one.
    bad = np.full(len(residual), np.inf)
    if method == "lm":
        bad = np.full(len(residual), 1e3 * (1.0 + float(np.abs(residual).max())))

    def full(part: Array) -> Array:
        x = start.copy()
        x[moving] = part
        return x

    def misfit(part: Array) -> Array:
        try:
            return evaluate(full(part))[0]
        except Refusal:
            return bad

    if method == "lm" and len(residual) < len(moving):
        return start, held & False  # MINPACK cannot; the polish does it all
    found = least_squares(
        misfit,
        start[moving],
        jac=lambda part: evaluate(full(part))[1][:, moving],
        method=method,
        bounds=(-np.inf, np.inf) if method == "lm" else (bounds[0][moving], bounds[1][moving]),
        x_scale=1.0 / np.where(norms > 0.0, norms, 1.0),
        xtol=TOLERANCE,
        ftol=TOLERANCE,
        gtol=TOLERANCE,
        max_nfev=EVALUATIONS,
    )
    wanted = full(found.x)
    x = np.clip(wanted, *bounds)
    return x, x != wanted
