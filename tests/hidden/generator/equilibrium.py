"""Exact static equilibrium of all elastic coordinates together.

In compliance form the equilibrium reads x = Phi(f(x)): Phi are the laws of the springs, f the
generalised forces of the loads *at the deflected pose*. The map contracts by the ratio of load
stiffness to spring stiffness (about 1e-3 for such arms), so plain iteration ends at rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .mechanism import Mechanism, Standing
from .rotations import Array

Law = Callable[[Array, Array], tuple[int, Array]]  # (f, x) -> a coordinate and what it adds (N,)
Load = Callable[[Standing], tuple[Array, Array, Array]]  # -> point, force, moment


class NoEquilibrium(RuntimeError):
    """The iteration did not come to rest: the load is beyond what the springs carry."""


@dataclass(frozen=True)
class Springs:
    """Linear compliances per coordinate and row, couplings between two, and any other laws."""

    compliance: Array  # (K, N)
    couplings: Sequence[tuple[int, int, float]] = ()
    laws: Sequence[Law] = ()

    def deflect(self, f: Array, x: Array) -> Array:
        out = self.compliance * f
        for i, j, c in self.couplings:
            out[i] += c * f[j]
            out[j] += c * f[i]
        for law in self.laws:
            index, extra = law(f, x)
            out[index] += extra
        return out


@dataclass(frozen=True)
class Rest:
    """A pose at rest: elastic coordinates x and generalised forces f (K, N), and placements."""

    x: Array
    f: Array
    standing: Standing


def settle(
    mechanism: Mechanism,
    commanded: Array,
    crank: Array | None,
    springs: Springs,
    load: Load,
    *,
    iterations: int = 60,
    tolerance: float = 1e-14,
) -> Rest:
    """Elastic coordinates at which every spring carries exactly what the deflected arm asks.

    `iterations=1` gives the first-order deflection: loads at the rigid pose.
    """
    x = np.zeros((len(mechanism.labels), commanded.shape[1]))
    for step in range(iterations):
        standing = mechanism.stand(commanded, x, crank)
        f = mechanism.generalised(standing, *load(standing))
        change = springs.deflect(f, x) - x
        x = x + change
        if step == 0 and not np.any(change):
            return Rest(x, f, standing)
        if np.abs(change).max() < tolerance:
            break
    else:
        if iterations > 1:
            raise NoEquilibrium(f"still moving by {np.abs(change).max():.1e} after {iterations}")
    standing = mechanism.stand(commanded, x, crank)
    return Rest(x, mechanism.generalised(standing, *load(standing)), standing)
