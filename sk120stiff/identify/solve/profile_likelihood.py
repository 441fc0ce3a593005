"""Where the misfit has risen: ends of likelihood intervals, all other parameters refitted.

The signed distance z(x_k) = ± √(χ²(x_k) − χ²_min) is a straight line where the readings are linear
and no bound is near, so its root is sought by interpolation (Bates & Watts 1988, chapter 6).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.identify.solve.polish import TRIAL, Evaluate, Minimum, polish

TRIALS = 20  # values looked at for one end of an interval
CLOSE = 1e-3  # of the distance that is sought


@dataclass(frozen=True, eq=False)
class Valley:
    """A least-squares problem around its minimum.

    Attributes:
        evaluate: Residual (R,) in units of the noise and derivative (R, P), of parameters (P,).
        x, misfit: (P,) minimum within bounds, and the sum of squares there.
        bounds: Lower and upper (P,).
        span: (P,) sizes over which a change has to show, see `seen_directions`.
        plausible: (P,) sizes beyond which the parameters are implausible.
        std: (P,) standard errors, to start from; zero where a bound holds the estimate.
        slopes: (P,) lengths of the columns of the derivative at the minimum.
    """

    evaluate: Evaluate
    x: Array
    misfit: float
    bounds: tuple[Array, Array]
    span: Array
    plausible: Array
    std: Array
    slopes: Array

    def end(self, k: int, side: float, goal: float) -> float:
        """Value of parameter k on one side (±1) where the misfit is goal² higher, or its bound."""
        start = float(self.x[k])
        limit = float(self.bounds[0 if side < 0.0 else 1][k])
        room = abs(limit - start)
        if room == 0.0:
            return limit
        near = self.x
        low, high = (0.0, 0.0), (np.inf, np.inf)  # (way, distance) below and above the goal
        width = float(self.std[k]) or 1.0 / max(float(self.slopes[k]), 1e-300)
        way = min(goal * width, room)
        for _ in range(TRIALS):
            value = limit if way == room else start + side * way
            try:
                solved = self._refitted(k, value, near)
            except Refusal:  # no answer out there: the misfit is as good as infinite
                high = (way, np.inf)
                way = 0.5 * (low[0] + way)
                continue
            rise = float(solved.residual @ solved.residual) - self.misfit
            distance = float(np.sqrt(max(rise, 0.0)))
            if abs(distance - goal) <= CLOSE * goal:
                return value
            if distance < goal:
                if way == room:
                    return limit
                low, near = (way, distance), solved.x
            else:
                high = (way, distance)
            if np.isfinite(high[1]):
                way = low[0] + (goal - low[1]) / (high[1] - low[1]) * (high[0] - low[0])
            elif np.isfinite(high[0]):
                way = 0.5 * (low[0] + high[0])
            else:
                way = min(way * min(goal / max(distance, 0.25 * goal), 4.0), room)
        return start + side * low[0]

    def _refitted(self, k: int, value: float, near: Array) -> Minimum:
        """All parameters but k fitted again, as far as is plausible, with k at a value."""
        others = np.delete(np.arange(len(near)), k)
        whole = near.copy()
        whole[k] = value

        def evaluate(part: Array) -> tuple[Array, Array]:
            x = whole.copy()
            x[others] = part
            residual, jacobian = self.evaluate(x)
            return residual, jacobian[:, others]

        far = np.maximum(self.plausible, np.abs(self.x))
        lower, upper = (np.clip(bound, -far, far)[others] for bound in self.bounds)
        found = polish(evaluate, near[others], (lower, upper), self.span[others], faint=TRIAL)
        whole[others] = found.x
        return replace(found, x=whole)


def linear_valley(
    x: Array,
    residual: Array,
    jacobian: Array,
    bounds: tuple[Array, Array],
    span: Array,
    plausible: Array,
    std: Array,
) -> Valley:
    """The valley of the linearised problem, its many rows folded into as many as parameters."""
    folded = np.asarray(np.linalg.qr(np.column_stack([jacobian, residual]), mode="r"))
    J, r = folded[:, :-1], folded[:, -1]

    def evaluate(at: Array) -> tuple[Array, Array]:
        return r + J @ (at - x), J

    slopes = np.linalg.norm(jacobian, axis=0)
    return Valley(evaluate, x, float(r @ r), bounds, span, plausible, std, slopes)
