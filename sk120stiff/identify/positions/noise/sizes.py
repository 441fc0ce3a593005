"""How large the noise is, and what lies far beyond it, from what a fit of positions leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array, Integers, Mask
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.solve.pose_errors import Common, PoseWhitening, common_error
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements

START = {  # m or rad
    "position": 3e-5, "distance": 3e-5, "shift": 1e-5, "rotation": 1e-4, "inclination": 1e-4,
    "displacement": 3e-5, "turn": 1e-4,
}  # fmt: skip
SAME = 0.2  # change of the logarithm of a noise that is none
TWICE = 5  # poses that must have been read more than once, to tell what poses have of their own
TAIL = 0.95  # share of rows below those few that tell whether all are of one size
FAR = 4.6  # standard sizes, rms over the numbers of a row, beyond which it is wild


def of_poses(found: Fit) -> PoseProblem:
    """The problem of a fit of poses."""
    if not isinstance(found.problem, PoseProblem):
        raise TypeError("a fit of poses")
    return found.problem


def learned(found: Fit) -> dict[str, float]:
    """Standard size of what is left in each kind of channel, over what it states of itself."""
    problem = of_poses(found)
    gap = found.residual * problem.of_channels.sigma
    out = dict(START)
    share = len(gap) / max(found.degrees_of_freedom, 1)
    for kind, part in zip(problem.channels.present, problem.channels.kinds, strict=True):
        unit = problem.channels.scale(kind)
        size = float(np.sqrt(np.mean((gap[part] / unit) ** 2) * share))
        out[kind] = max(size, 1e-9)
    return out


def common_of(found: Fit, *, anew: bool = True) -> Common:
    """What a pose has of its own, in what a fit leaves.

    Args:
        found: The fit.
        anew: Look for how far the tool turns beside its shift; else it is as the fit has it.
    """
    problem = of_poses(found)
    times = np.bincount(problem.load_cases.pose)
    if (times > 1).sum() < TWICE:
        return Common(0.0, 1.0, 0.0)
    white = problem.of_channels
    return common_error(
        white.undo(found.residual),
        white.undo(found.jacobian[:, ~found.at_bound]),
        PoseWhitening(
            white.sigma, problem.by_pose if anew else problem.own_ways, problem.pose_of_channels
        ),
        stated=found.sigma_known,
        turns=problem.turns if anew else None,
    )


def wild_beside(found: Fit, readings: Measurements, wild: Mask) -> Mask:
    """(N,) rows whose gap no normal noise of the size of the others gives; others come back.

    Args:
        found: The fit.
        readings: Those of the fit, or others.
        wild: (N,) rows that were set aside before.
    """
    whole = readings.masked()
    problem = replace(of_poses(found), measurements=whole, model=found.model)
    gap = problem.channel_gap(found.model.values)[0] / problem.sigma_of_channels
    count = np.bincount(problem.rows, minlength=whole.n_readings)
    square = np.asarray(np.bincount(problem.rows, gap**2, whole.n_readings), dtype=np.float64)
    far = _far_off(square, count, ~wild[readings.use] & (count > 0))
    out = wild.copy()
    if far is not None and far.mean() < 0.1:
        out[np.flatnonzero(readings.use)] = far
    return out


def _far_off(square: Array, count: Integers, kept: Mask) -> Mask | None:
    """(N,) rows that are far off the size that the others have; None where they have none.

    That size is what the median tells, and what the largest few do where they are larger than noise
    of it has them: a cause that the model lacks shows in some rows more than in others, and those
    in which it shows most are no slips.
    """
    number = np.maximum(count, 1)
    middle, high = (np.sqrt(stats.chi2.ppf(share, number)) for share in (0.5, TAIL))
    size = float(np.median((np.sqrt(square) / middle)[kept]))
    if size <= 0.0:
        return None
    off, ends = np.sqrt(square / number), np.sqrt(square) / high
    far = off > FAR * size
    for row in sorted(np.flatnonzero(far), key=lambda k: off[k]):
        if off[row] > FAR * max(size, float(np.quantile(ends[~far & (count > 0)], TAIL))):
            break
        far[row] = False
    return np.asarray(far)


def alike(size: float, before: float) -> bool:
    """Are two sizes one, as far as a fit needs to know?"""
    if size == 0.0 or before == 0.0:
        return size == before
    return bool(abs(np.log(size / before)) < SAME)
