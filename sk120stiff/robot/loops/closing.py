"""Solving closed loops: Newton on the tangent, at many poses side by side."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.robot.kinematics.coupling import LinearCoupling
from sk120stiff.robot.loops.constraint import Constraint, Gap

STEP = 0.35  # how far the driven joints go in one step: rad, or parts of the loop's length
TRUST = 0.15  # how far Newton may correct a step along the tangent, in the same units
SHORTEST = 1e-4  # a step that must be shorter than this stands before a dead point
NEWTON = 8


@dataclass(frozen=True, eq=False)
class Closer:
    """All loops of a robot as one system C(q) = 0 with q = A [z; d] + b.

    Attributes:
        linear: Coupling of all joints to the driven coordinates z (n) and the dependent joints d
            (r).
        driven: Number n.
        scale: (n + r,) one rad, or the loops' length for what slides; infinite for coordinates that
            no loop feels.
        constraints: What closes the loops.
        rows: (e, r) combinations of the constraints' rows that determine d, the same at all poses;
            None where no fixed choice does, and least squares takes them all.
    """

    linear: LinearCoupling
    driven: int
    scale: Array
    constraints: tuple[Constraint, ...]
    rows: Array | None = None

    @cached_property
    def size(self) -> float:
        """Length round the longest loop [m]."""
        return max(constraint.size for constraint in self.constraints)

    def gaps(self, z: Array, d: Array) -> list[Gap]:
        """Gap of every constraint at z (N, n), d (N, r)."""
        q = self.linear.motion(np.concatenate([z, d], axis=1)).q
        return [constraint.gap(q) for constraint in self.constraints]

    def maps(self) -> list[Array]:
        """For every constraint (k, n + r): how its joints follow z and d."""
        return [self.linear.A[constraint.coordinates] for constraint in self.constraints]

    def system(self, gaps: list[Gap]) -> tuple[Array, Array]:
        """(N, e) residual C and (N, e, n + r) its derivative, the constraints stacked."""
        value = np.concatenate([gap.value for gap in gaps], axis=1)
        pairs = zip(gaps, self.maps(), strict=True)
        derivative = np.concatenate([gap.by_joint @ A for gap, A in pairs], axis=1)
        return value, derivative

    def reduced(self, values: Array) -> Array:
        """The rows that determine d: (N, e, ...) → (N, r, ...), or all of them."""
        if self.rows is None:
            return values
        return np.asarray(np.einsum("er,ne...->nr...", self.rows, values))

    def solve(self, C_d: Array, right: Array) -> Array:
        """C_d⁺ right for C_d (N, e, r) and right (N, e, k)."""
        if C_d.shape[1] == C_d.shape[2]:
            try:
                return np.asarray(np.linalg.solve(C_d, right))
            except np.linalg.LinAlgError:
                pass  # one pose of the batch is exactly singular
        return np.asarray(np.linalg.pinv(C_d) @ right)

    def newton(self, z: Array, d: Array) -> tuple[Array, Mask]:
        """d (N, r) that closes the loops at z, from a guess; and where it does so."""
        d = d.copy()
        sliding = self.scale[self.driven :]
        moving = np.full(len(z), np.inf)
        for _ in range(NEWTON):
            todo = np.flatnonzero(moving > 1e-14)
            if not len(todo):
                break
            value, derivative = self.system(self.gaps(z[todo], d[todo]))
            C_d = self.reduced(derivative[:, :, self.driven :])
            step = self.solve(C_d, self.reduced(value)[..., None])[..., 0]
            step = np.where(np.isfinite(step), step, 1e3)
            size = np.abs(step / sliding).max(axis=1)
            step *= np.minimum(1.0, 0.5 / np.maximum(size, 1e-300))[:, None]
            d[todo] -= step
            moving[todo] = size
        return d, moving < 1e-9

    def tangent(self, z: Array, d: Array) -> tuple[Array, Array]:
        """(N, r, n) ∂d/∂z, and (N,) sign of the system's determinant (zero if it has none)."""
        _, derivative = self.system(self.gaps(z, d))
        reduced = self.reduced(derivative)
        C_z, C_d = reduced[:, :, : self.driven], reduced[:, :, self.driven :]
        square = C_d.shape[1] == C_d.shape[2]
        sign = np.sign(np.linalg.det(C_d)) if square else np.zeros(len(z))
        return -self.solve(C_d, C_z), sign

    def follow(self, z: Array, d: Array, target: Array) -> tuple[Array, Mask, Array, Array]:
        """Walk from closed poses (z, d) straight to `target` (N, n).

        Steps are shortened until Newton corrects each of them by little and the determinant keeps
        its sign, so the assembly mode stays what it was.

        Returns:
            d, arrived: (N, r) dependent joints and (N,) where the walk came to its end.
            last_z, last_d: Where it stood at last: before a dead point, if it did not arrive.
        """
        z, d, target = z.copy(), d.copy(), np.asarray(target)
        count = len(z)
        arrived = np.zeros(count, dtype=bool)
        lost = np.zeros(count, dtype=bool)
        limit = np.full(count, STEP)
        slope, sign = self.tangent(z, d)
        while True:
            todo = np.flatnonzero(~(arrived | lost))
            if not len(todo):
                return d, arrived, z, d
            ahead = target[todo] - z[todo]
            far = np.abs(ahead / self.scale[: self.driven]).max(axis=1, initial=0.0)
            share = np.minimum(1.0, limit[todo] / np.maximum(far, 1e-300))
            change = share[:, None] * ahead
            z_next = np.where((share == 1.0)[:, None], target[todo], z[todo] + change)
            guess = d[todo] + np.einsum("nij,nj->ni", slope[todo], change)
            swing = np.abs((guess - d[todo]) / self.scale[self.driven :]).max(axis=1)
            d_next, closed = self.newton(z_next, guess)
            off = np.abs((d_next - guess) / self.scale[self.driven :]).max(axis=1)
            slope_next, sign_next = self.tangent(z_next, d_next)
            good = closed & (off < TRUST) & (swing < 2.0 * STEP) & (sign_next == sign[todo])
            kept = todo[good]
            z[kept], d[kept], slope[kept] = z_next[good], d_next[good], slope_next[good]
            arrived[kept] = share[good] == 1.0
            limit[kept] = np.minimum(1.5 * limit[kept], STEP)
            refused = todo[~good]
            limit[refused] = 0.4 * np.minimum(limit[refused], far[~good])
            lost[refused] = limit[refused] < SHORTEST
