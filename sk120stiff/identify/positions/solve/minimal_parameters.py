"""Which small errors of joint frames can be told apart: a least set, and why the rest is not.

Columns of the derivative are taken one after the other, those first that the earlier ones hardly
share. One that the others make up, or that beside them would be known no better than what is
plausible anyway, is frozen at its value; what it is counted in is said. (Rank-revealing by Gram and
Schmidt with the order as preference; cf. Khalil & Dombre 2002, ch. 11, on minimal parameters of
calibration.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.effects.marker_shift import MarkerShift
from sk120stiff.effects.thermal_growth import ThermalGrowth
from sk120stiff.model import Model

KNOWN = 3.0  # standard errors that what is plausible must hold
#: Share of a column beside the earlier ones, from which on it is taken at once. A shift along the
#: axis of the last joint is one of the marker, but for the mrad by which that axis was found to
#: tilt; it must not stand for a shift across the axis, which would come after it.
AT_ONCE = 0.1
EXACT = 2e-3  # share of a column left beside the earlier ones that rounding brings: pi as 3.14
NAMED = 0.25  # share of a column that a parameter must carry to be named for it
MOST = 4  # names for one frozen parameter
MAY_FREEZE = (JointFrame, MarkerShift, ThermalGrowth)


@dataclass(frozen=True)
class Frozen:
    """A parameter that these readings cannot tell, kept at its value.

    Attributes:
        name: ``effect:where.parameter``.
        inside: Parameters that it is counted in; empty where it does not show at all.
        exact: No readings at these poses would tell it; else they would, were they far less noisy.
    """

    name: str
    inside: tuple[str, ...]
    exact: bool

    def sentence(self) -> str:
        """Why it is frozen."""
        if not self.inside:
            return f"{self.name} does not show in these readings; it is left as it is."
        how = "is one with" if self.exact else "is hardly told from"
        return f"{self.name} {how} {', '.join(self.inside)}: it is counted there."


def least_set(model: Model, jacobian: Array, span: Array) -> tuple[Model, tuple[Frozen, ...]]:
    """The model with what cannot be told frozen, and what that is.

    Args:
        model: Its free parameters are the columns.
        jacobian: (M, P_free) whitened derivative by scaled parameters.
        span: (P_free,) plausible sizes in scaled units.
    """
    free = model.free
    jacobian = np.asarray(
        np.linalg.qr(jacobian, mode="r")
    )  # lengths and angles of columns are those of R
    movable = np.array([isinstance(model.parameters[k].effect, MAY_FREEZE) for k in free])
    geometry = [k for k in range(len(free)) if _moves_geometry(model, int(free[k]))]
    order = [k for k in geometry if not movable[k]] + [k for k in geometry if movable[k]]
    norms = np.linalg.norm(jacobian, axis=0)
    basis = np.zeros((jacobian.shape[0], len(order)))
    kept: list[int] = []
    frozen: dict[int, bool] = {}
    for least in (AT_ONCE, 0.0):
        for k in [k for k in order if k not in kept and k not in frozen]:
            column = jacobian[:, k].copy()
            for _ in range(2):  # twice is enough (Kahan and Parlett)
                Q = basis[:, : len(kept)]
                column -= Q @ (Q.T @ column)
            left = float(np.linalg.norm(column))
            if movable[k] and left < least * norms[k]:
                continue
            exact = left <= EXACT * norms[k]
            if movable[k] and (exact or left * span[k] < KNOWN):
                frozen[k] = exact
            elif left > 0.0:
                basis[:, len(kept)] = column / left
                kept.append(k)
    reasons = tuple(
        Frozen(
            model.parameters[free[k]].name,
            _inside(model, jacobian, kept, k) if norms[k] * span[k] >= KNOWN else (),
            exact,
        )
        for k, exact in sorted(frozen.items())
    )
    parameters = list(model.parameters)
    for k in frozen:
        parameters[free[k]] = replace(parameters[free[k]], free=False)
    return replace(model, parameters=tuple(parameters)), reasons


def _moves_geometry(model: Model, index: int) -> bool:
    from sk120stiff.effects import Geometric, Imposed, Mounting, Viewpoint

    effect = model.parameters[index].effect
    return isinstance(effect, Geometric | Imposed | Mounting | Viewpoint)


def _inside(model: Model, jacobian: Array, kept: Sequence[int], k: int) -> tuple[str, ...]:
    """Parameters that make up a column."""
    A = jacobian[:, list(kept)]
    size = np.linalg.norm(A, axis=0)
    share = np.linalg.lstsq(A / size, jacobian[:, k], rcond=1e-10)[0]
    carried = np.abs(share) / np.linalg.norm(jacobian[:, k])
    top = np.argsort(-carried)[:MOST]
    free = model.free
    return tuple(
        model.parameters[free[kept[j]]].name for j in top if carried[j] > NAMED * carried[top[0]]
    )
