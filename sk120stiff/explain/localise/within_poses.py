"""How the gap goes with the load at single poses: in proportion to it, constant, curved, or not.

At one pose all that yields displaces the point in proportion to the load, whatever it is. So the
gap is laid out, pose by pose, over the load (linear), a constant, and the cube of the load
(curved), each held against the noise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.explain.localise.localisation import OrderShare, OwnAtPoses
from sk120stiff.identify import Fit, Yardstick
from sk120stiff.identify.checks.left_over import left_over
from sk120stiff.identify.noise.saturated import load_basis, pose_columns

_LOOKS = 3  # orders in the load that are looked at, for Holm
Own = Literal["constant", "drift", "branches"]


@dataclass(frozen=True)
class WithinPoses:
    """What single poses tell of a whitened gap.

    Attributes:
        orders: Linear, constant and curved parts, each beyond the ones before it.
        own: What poses may have of their own, each beyond the model alone; empty where nothing
            tells the noise.
    """

    orders: tuple[OrderShare, ...]
    own: tuple[OwnAtPoses, ...]


def within_poses(
    fit: Fit, white: Array, inside: Array, whiten: Callable[[Array], Array], noise: Yardstick
) -> WithinPoses:
    """Lay out a whitened gap over the loads of every pose.

    Args:
        fit: The fitted model.
        white: (R,) its whitened gap, the model's columns projected out.
        inside: (R, k) orthonormal basis of those columns.
        whiten: Whitens (N, 3, ...) in reading axes, noise and draws together.
        noise: What to hold it against.
    """
    load_cases, scale = fit.problem.load_cases, noise.scale
    group = fit.problem.pose
    left = [float(white @ white)]
    rank = [inside.shape[1]]
    for options in ({}, {"jump": True}, {"jump": True, "cubic": True}):
        basis = whiten(pose_columns(load_basis(load_cases, **options)))
        square, used = left_over(white, inside, basis, group)
        left.append(square)
        rank.append(used)
    steps = [(left[k] - left[k + 1], rank[k + 1] - rank[k]) for k in range(3)]
    excess = [max(square / scale - used, 0.0) for square, used in steps]
    total = max(left[0] / scale - (len(white) - rank[0]), sum(excess), 1e-300)
    names: tuple[Literal["linear", "constant", "curved"], ...] = ("linear", "constant", "curved")
    orders = tuple(
        OrderShare(
            name, part / total, part, min(1.0, _LOOKS * noise.tail(square, used)) if used else None
        )
        for name, part, (square, used) in zip(names, excess, steps, strict=True)
    )
    own: list[OwnAtPoses] = []
    if noise.freedom:
        taken, more = steps[0]
        own.append(OwnAtPoses("proportional", taken / scale, more, noise.tail(taken, more)))
        drawn = any(effect.random_effects for effect in fit.model.effects)
        for name, basis in _of_own(load_cases, drawn=drawn):
            square, used = left_over(white, inside, whiten(pose_columns(basis)), group)
            taken, more = left[0] - square, used - rank[0]
            own.append(OwnAtPoses(name, taken / scale, more, noise.tail(taken, more)))
    return WithinPoses(orders, tuple(own))


def _of_own(load_cases: LoadCases, *, drawn: bool) -> Iterator[tuple[Own, Array]]:
    """(N, k) what a pose may have of its own; `drawn` constants are noise already."""
    if not drawn:
        yield "constant", np.ones((load_cases.count, 1))
    clock = load_cases.order if load_cases.order is not None else load_cases.time
    if clock is not None and np.ptp(clock) > 0.0:
        yield "drift", clock[:, None] / np.abs(clock).max()
    turned = load_cases.branch[:, None] < 0.0
    if turned.any() and not turned.all():
        size = np.linalg.norm(load_cases.wrench[:, :3], axis=1, keepdims=True)
        yield "branches", np.hstack([turned, turned * size / max(float(size.max()), 1e-300)])
