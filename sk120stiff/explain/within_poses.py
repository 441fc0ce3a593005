"""How the gap goes with the load at single poses: in proportion to it, constant, curved, or not.

At one pose all that yields displaces the point in proportion to the load, whatever it is. So the
gap is laid out, pose by pose, over the load (linear), a constant, and the cube of the load
(curved). What all three leave is noise, and tells its size where nobody stated it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import stats

from sk120stiff.effects import Situation
from sk120stiff.explain.localisation import OrderShare, OwnAtPoses
from sk120stiff.identify import Fit
from sk120stiff.identify.left_over import left_over
from sk120stiff.identify.saturated import load_basis, pose_columns
from sk120stiff.robot.coupling import Array

FEWEST = 10  # degrees of freedom below which a scatter tells no size of the noise
_LOOKS = 3


@dataclass(frozen=True)
class WithinPoses:
    """What single poses tell of a whitened gap.

    Attributes
    ----------
    scale
        Noise variance seen over noise variance assumed; 1 where it was stated.
    freedom
        Degrees of freedom behind `scale`; infinite where it was stated, 0 where nothing tells.
    misfit
        Probability that noise alone makes such a gap; None where nothing tells.
    orders
        Linear, constant and curved parts, each beyond the ones before it.
    own
        What poses may have of their own, each beyond the model alone.
    """

    scale: float
    freedom: float
    misfit: float | None
    orders: tuple[OrderShare, ...]
    own: tuple[OwnAtPoses, ...]

    @property
    def noise_from(self) -> Literal["stated", "scatter", "gap"]:
        """Where the size of the noise comes from."""
        if np.isinf(self.freedom):
            return "stated"
        return "scatter" if self.freedom else "gap"

    def tail(self, statistic: float, freedom: int) -> float:
        """Probability that chance makes a sum of squares as large, for that many freedoms."""
        if freedom < 1:
            return 1.0
        if np.isinf(self.freedom):
            return float(stats.chi2.sf(statistic, freedom))
        ratio = statistic / freedom / self.scale
        return float(stats.f.sf(ratio, freedom, self.freedom or np.inf))


def within_poses(
    fit: Fit, white: Array, inside: Array, whiten: Callable[[Array], Array]
) -> WithinPoses:
    """Lay out a whitened gap over the loads of every pose.

    Parameters
    ----------
    fit
        The fitted model.
    white
        (3N,) its whitened gap, the model's columns projected out.
    inside
        (3N, k) orthonormal basis of those columns.
    whiten
        Whitens (N, 3, ...) in reading axes, noise and draws together.
    """
    situation = fit.problem.situation
    group = np.repeat(situation.pose, 3)
    left = [float(white @ white)]
    rank = [inside.shape[1]]
    for options in ({}, {"jump": True}, {"jump": True, "cubic": True}):
        basis = whiten(pose_columns(load_basis(situation, **options)))
        square, used = left_over(white, inside, basis, group)
        left.append(square)
        rank.append(used)
    freedom = len(white) - rank[-1]
    stated = fit.sigma_stated
    if stated:
        scale, known = 1.0, float(np.inf)
    elif freedom >= FEWEST:
        scale, known = left[-1] / freedom, float(freedom)
    else:
        scale, known = left[0] / max(len(white) - rank[0], 1), 0.0
    bare = WithinPoses(scale, known, None, (), ())
    steps = [(left[k] - left[k + 1], rank[k + 1] - rank[k]) for k in range(3)]
    excess = [max(square / scale - used, 0.0) for square, used in steps]
    total = max(left[0] / scale - (len(white) - rank[0]), sum(excess), 1e-300)
    names: tuple[Literal["linear", "constant", "curved"], ...] = ("linear", "constant", "curved")
    orders = tuple(
        OrderShare(
            name, part / total, part, min(1.0, _LOOKS * bare.tail(square, used)) if used else None
        )
        for name, part, (square, used) in zip(names, excess, steps, strict=True)
    )
    misfit = None
    if stated:
        whole = bare.tail(left[0], len(white) - rank[0])
        misfit = min(1.0, 2.0 * min(whole, bare.tail(*steps[0])))
    elif known and steps[0][1]:
        misfit = bare.tail(*steps[0])
    drawn = any(effect.exchangeable for effect in fit.model.effects)
    own: list[OwnAtPoses] = []
    if known:
        taken, more = steps[0]
        own.append(OwnAtPoses("proportional", taken / scale, more, bare.tail(taken, more)))
        for name, basis in _of_own(situation, drawn=drawn):
            square, used = left_over(white, inside, whiten(pose_columns(basis)), group)
            taken, more = left[0] - square, used - rank[0]
            own.append(OwnAtPoses(name, taken / scale, more, bare.tail(taken, more)))
    return WithinPoses(scale, known, misfit, orders, tuple(own))


def _of_own(
    situation: Situation, *, drawn: bool
) -> Iterator[tuple[Literal["constant", "drift"], Array]]:
    """(N, 1) what a pose may have of its own; `drawn` constants are noise already."""
    if not drawn:
        yield "constant", np.ones((situation.count, 1))
    clock = situation.order if situation.order is not None else situation.time
    if clock is not None and np.ptp(clock) > 0.0:
        yield "drift", clock[:, None] / np.abs(clock).max()
