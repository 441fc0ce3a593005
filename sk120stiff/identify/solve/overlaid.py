"""Parameters on a bound that lie on others: what the fit gave to the one, the other may hold.

A bound (a joint that is "rigid") counts as known only where the readings put the parameter there.
Where another parameter moves the readings alike, the fit gives everything to one of the two and
leaves the other on its bound; the standard error of the first then knows nothing of the second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import load_case
from sk120stiff.identify.solve.covariance import covariance_of
from sk120stiff.identify.solve.polish import seen_directions
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.identify.solve.profile_likelihood import linear_valley

INFLATED = 3.0  # growth of an interval; a correlation of 0.95 makes as much
READINGS = 24  # measured readings of which one joint is turned in thought
STATIONS = 7  # positions tried for every joint
WORTHWHILE = 2.0  # least fall of the largest standard error for which a pose is proposed


@dataclass(frozen=True)
class Overlay:
    """Parameters that lie on one another, one at least on its bound and one off it.

    Attributes:
        members: Indices of the estimated parameters, ascending.
        held: Those of them that lie on their bound.
        likeness: Least cosine between two of their columns.
    """

    members: tuple[int, ...]
    held: tuple[int, ...]
    likeness: float


@dataclass(frozen=True)
class Separating:
    """A measured reading with one joint turned, which tells overlaid parameters apart.

    Attributes:
        pose: Label of the measured pose.
        joint: Index of the joint that stands elsewhere.
        position: Where it stands [rad or m].
        gain: By how much the largest standard error of the overlaid parameters falls.
    """

    pose: str
    joint: int
    position: float
    gain: float


def overlays(
    x: Array,
    jacobian: Array,
    residual: Array,
    at_bound: Mask,
    bounds: tuple[Array, Array],
    plausible: Array,
    reach: float,
) -> tuple[Overlay, ...]:
    """Sets of parameters of which the bounds alone decide who carries what.

    A moving parameter lies on held ones where its likelihood interval, with these free to leave
    their bounds, is `INFLATED` times what it is with these nailed to them.

    Args:
        x, jacobian, residual, at_bound, bounds, plausible: Of the fit, in scaled parameters.
        reach: Square root of the rise of the misfit at the interval's ends, in units of the assumed
            noise.
    """
    held, moving = np.flatnonzero(at_bound), np.flatnonzero(~at_bound)
    if not len(held) or not len(moving) or not np.isfinite(reach):
        return ()
    std = np.sqrt(np.diag(covariance_of(jacobian, at_bound, plausible)))
    answer = _answers(jacobian, residual, held, moving, plausible, reach)
    nailed = INFLATED * reach * std[moving]
    known = np.isfinite(nailed) & (nailed > 0.0)
    makes_room = known & (np.minimum(answer, np.abs(x[moving])) > nailed)  # (held, moving)
    valley = None
    groups: list[set[int]] = []
    for place in np.flatnonzero(makes_room.any(axis=0)):
        k = int(moving[place])
        if valley is None:
            own = np.where(np.isfinite(std), std, 0.0)
            valley = linear_valley(x, residual, jacobian, bounds, plausible, plausible, own)
        if max(abs(valley.end(k, side, reach) - x[k]) for side in (-1.0, 1.0)) > nailed[place]:
            group = {k, *(int(h) for h in held[makes_room[:, place]])}
            touching = [g for g in groups if g & group]
            groups = [g for g in groups if not g & group] + [group.union(*touching)]
    return tuple(_overlay(jacobian, at_bound, sorted(group)) for group in groups)


def _answers(
    jacobian: Array,
    residual: Array,
    held: Index,
    moving: Index,
    plausible: Array,
    reach: float,
) -> Array:
    """(held, moving) how far each moving parameter follows as one held leaves its bound.

    It leaves it as far as the misfit allows, the moving ones refitted without regard to bounds.
    """
    U, singular, V, _ = seen_directions(jacobian[:, moving], plausible[moving])
    out = np.zeros((len(held), len(moving)))
    for row, one in enumerate(held):
        column = jacobian[:, one]
        beyond = float(np.linalg.norm(column - U @ (U.T @ column)))
        slope = abs(float(column @ residual))  # the misfit rises with it, else it were no bound
        room = float(plausible[one])
        if beyond > 0.0:
            room = min(room, (np.hypot(slope / beyond, reach) - slope / beyond) / beyond)
        out[row] = np.abs(plausible[moving] * (V @ ((U.T @ column) / singular))) * room
    return out


def separating(problem: Problem, group: Overlay, jacobian: Array) -> Separating | None:
    """The measured reading that tells overlaid parameters apart best once one joint is turned.

    Only the joint limits are kept; whether the arm gets there is for the user to see. None where no
    such reading helps.

    Args:
        problem: What was fitted.
        group: Parameters that lie on one another.
        jacobian: (R, P) whitened derivative at the fit.
    """
    rigid, load_cases = problem.model, problem.load_cases
    robot = rigid.robot
    rows = np.unique(np.linspace(0, load_cases.count - 1, READINGS).astype(int))
    choice = [
        (row, joint, position)
        for row in rows
        for joint in range(robot.n)
        for position in _stations(robot.lower[joint], robot.upper[joint])
    ]
    a = np.array([load_cases.a[row] for row, _, _ in choice])
    a[np.arange(len(choice)), [joint for _, joint, _ in choice]] = [c[2] for c in choice]
    wrench = load_cases.wrench[[row for row, _, _ in choice]]
    there = load_case(robot, a, wrench, point=load_cases.point, force_point=load_cases.force_point)
    _, derivative = rigid.predict_with_sensitivities(there, np.zeros_like(rigid.values))
    own = list(group.members)
    columns = derivative[:, :, problem.free[own]] * problem.scale[own] / problem.noise.sigma
    others = np.setdiff1d(np.arange(jacobian.shape[1]), own)
    inside, _ = np.linalg.qr(jacobian[:, others])
    left = jacobian[:, own] - inside @ (inside.T @ jacobian[:, own])
    known = left.T @ left + np.diag(problem.plausible[own] ** -2.0)  # no value is beyond plausible
    size = np.diag(known)
    before = _worst(known[None], size)[0]
    after = _worst(known + np.einsum("nia,nib->nab", columns, columns), size)
    best = int(np.argmin(after))
    gain = float(np.sqrt(before / after[best]))
    if gain < WORTHWHILE:
        return None
    row, joint, position = choice[best]
    return Separating(load_cases.poses[load_cases.pose[row]], joint, float(position), gain)


def _overlay(jacobian: Array, at_bound: Mask, group: list[int]) -> Overlay:
    columns = jacobian[:, group] / np.maximum(np.linalg.norm(jacobian[:, group], axis=0), 1e-300)
    return Overlay(
        members=tuple(group),
        held=tuple(k for k in group if at_bound[k]),
        likeness=float(np.abs(columns.T @ columns).min()),
    )


def _stations(low: float, high: float) -> Array:
    """Positions of a joint well within its limits; a turn either way where it has none."""
    low, high = max(low, -np.pi), min(high, np.pi)
    return np.linspace(low, high, STATIONS + 2)[1:-1]


def _worst(information: Array, size: Array) -> Array:
    """(n,) largest variance for each information matrix (n, g, g), in units of 1 / size (g,)."""
    variances = np.diagonal(np.linalg.inv(information), axis1=1, axis2=2)
    return np.asarray((variances * size).max(axis=1))
