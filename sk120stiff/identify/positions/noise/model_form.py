"""What a calibration leaves: noise, or an error of the model, told apart without a stated noise.

An error of the model is smooth over the joints: every joint stands off by an unknown function of
all their angles, of waves and their products (a Gaussian process of finite rank). Repeats of a pose
have it in common, noise has nothing in common. Its size, joint by joint, and that of the noise
maximise the restricted likelihood (Patterson & Thompson 1971; model error as a process beside the
noise: Kennedy & O'Hagan 2001).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy import linalg, stats
from scipy.optimize import minimize

from sk120stiff.arrays import Array, Index, Mask, lengths_of
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.identify.written import AnyFit, leaving_out

MOST = 480  # numbers that sizes are estimated from: time goes with the cube
FEWEST = 12  # numbers left over, below which no error of the model can be told from noise
CHEAP = 150  # numbers up to which the search begins in any case
STARTS = 2.0  # standard errors of a joint's score from which on it begins with more of them
LEVEL = 1e-3  # probability of as large a gain in likelihood by noise alone
SECOND = 0.7  # size of second waves and products beside that of first waves
UNIT = 1e-4  # rad or m; what sizes are told in
MOVES = 1e-6  # rad or m; a joint that moves less makes no wave
STOP = {"ftol": 1e-5, "maxiter": 60}  # of the logarithm of the likelihood
BEYOND = 1.2  # logarithm by which sizes may exceed what the gap asks for


@dataclass(frozen=True, eq=False)
class ModelForm:
    """The smooth error in what a fit leaves.

    Attributes:
        share: Its part of the variance that is left, 0 to 1.
        independent: How many independent numbers of one size say as much as what is left does.
        smooth: The same of the smooth error alone.
        chance: Probability of as much smoothness if all were noise.
        sizes: (n + 1,) variance of the error of each actuated joint per `UNIT`², and of that which
            each pose has of its own [whitened].
        by_joint: (n,) share of each joint in the smooth error.
        noise: Variance of the noise beside it [whitened].
    """

    share: float
    independent: float
    smooth: float
    chance: float
    sizes: Array
    by_joint: Array
    noise: float

    def in_units(self, ratio: float) -> ModelForm:
        """Of numbers whose unit of noise is so many times smaller."""
        sizes = np.append(self.sizes[:-1], ratio**2 * self.sizes[-1])
        return replace(self, noise=ratio**2 * self.noise, sizes=sizes)


def model_form(found: Fit) -> ModelForm | None:
    """The smooth error that a fit leaves; None where noise alone may have left it."""
    problem = found.problem
    if not isinstance(problem, PoseProblem) or not found.degrees_of_freedom:
        return None
    if found.misfit is not None and not found.exceeds:
        return None
    part = some_rows(problem)
    rows = np.flatnonzero(np.isin(problem.rows, part))
    blind = _complement(found.jacobian[rows][:, ~found.at_bound])
    y = blind.T @ found.residual[rows]
    if len(y) < FEWEST:
        return None
    here = replace(problem, measurements=problem.measurements.select(part))
    ways = [blind.T @ block for block in smooth_ways(here)]
    cell = cells_of(here)
    same = np.equal.outer(cell, cell)
    products = {k: way @ way.T for k, way in enumerate(ways) if way.any()}
    if len(np.unique(cell)) < len(cell):
        products[len(ways)] = blind.T @ same @ blind
    if not products:  # nothing yields that a smooth error could be of
        return None
    if len(y) > CHEAP and not _shows([*products.values()], y):
        return None
    logs, gained = _likeliest([*products.values()], y, stated=found.sigma_known)
    chance = float(stats.chi2.sf(2.0 * gained, len(products)))
    if chance > LEVEL:
        return None
    sizes, carried = np.zeros(len(ways) + 1), np.zeros(len(ways) + 1)
    smooth = np.zeros((len(y), len(y)))
    for (k, each), size in zip(products.items(), np.exp(2.0 * logs[1:]), strict=True):
        sizes[k], carried[k] = size, size * float(np.trace(each))
        smooth += size * each
    error = blind @ smooth @ blind.T
    white = np.exp(2.0 * logs[0]) * (blind @ blind.T)
    count = found.degrees_of_freedom
    return ModelForm(
        share=float(np.trace(error) / (np.trace(error) + np.trace(white))),
        independent=min(_independent(error + white, same, len(found.residual)), count),
        smooth=min(_independent(error, same, len(found.residual)), count),
        chance=chance,
        sizes=sizes,
        by_joint=carried[:-1] / carried.sum(),
        noise=float(np.exp(2.0 * logs[0])),
    )


def widened(found: AnyFit, form: ModelForm | None) -> AnyFit:
    """The fit with standard errors that hold the smooth error: what it moves the estimates by."""
    problem = found.problem
    if form is None or not isinstance(problem, PoseProblem):
        return found
    moving = ~found.at_bound
    inverse = np.linalg.pinv(found.jacobian[:, moving], rcond=1e-10)
    moved = np.zeros((len(inverse), len(inverse)))
    for size, block in zip(form.sizes, smooth_ways(problem), strict=False):
        taken = inverse @ block
        moved += size * taken @ taken.T
    if form.sizes[-1] > 0.0:
        cell = cells_of(problem)
        order = np.argsort(cell, kind="stable")
        first = np.flatnonzero(np.diff(cell[order], prepend=-1))
        together = np.add.reduceat(inverse[:, order], first, axis=1)
        moved += form.sizes[-1] * together @ together.T
    whole = np.maximum(np.diag(moved), 1e-300)
    # less the part of it that counts as noise already
    rest = whole - form.share * found.unit**2 * (inverse**2).sum(axis=1)
    less = np.sqrt(np.maximum(rest, 0.0) / whole)
    told = np.ones(len(found.x), dtype=bool)
    return leaving_out(found, moved * np.outer(less, less), told)


def some_rows(problem: PoseProblem) -> Index:
    """Rows of as many whole poses as sizes are estimated from."""
    pose = problem.load_cases.pose
    order = np.random.default_rng(0).permutation(np.unique(pose))
    numbers = np.bincount(pose[problem.rows], minlength=int(pose.max()) + 1)[order]
    kept = order[np.cumsum(numbers) <= max(MOST, int(numbers[0]))]
    return np.flatnonzero(np.isin(pose, kept)).astype(np.intp)


def _complement(columns: Array) -> Array:
    """(M, M - rank) orthonormal directions that no estimated parameter moves."""
    size = lengths_of(columns)
    U, told, _ = np.linalg.svd(columns / np.where(size > 0.0, size, 1.0), full_matrices=True)
    return np.asarray(U[:, int((told > 1e-9 * told.max(initial=1e-300)).sum()) :])


def smooth_ways(problem: PoseProblem) -> Iterator[Array]:
    """(M, r) whitened: what waves and their products in the error of each joint do."""
    basis = UNIT * waves(problem.load_cases.a)[problem.rows]
    for column in problem.by_joints.T:
        yield problem.of_channels.apply(column[:, None] * basis)


def waves(a: Array) -> Array:
    """(N, r) a constant, waves of every joint (N, n) that moves, and products of two joints'."""
    a = a[:, np.ptp(a, axis=0) > MOVES]
    first = [np.sin(a), np.cos(a)]
    pairs = [
        one[:, [i]] * other[:, [j]]
        for i, j in combinations(range(a.shape[1]), 2) for one in first for other in first
    ]  # fmt: skip
    more = [np.sin(2.0 * a), np.cos(2.0 * a), *pairs]
    return np.concatenate([np.ones((len(a), 1)), *first, *(SECOND * x for x in more)], axis=1)


def cells_of(problem: PoseProblem) -> Index:
    """(M,) equal numbers for numbers of one axis, of poses and loads that were read again."""
    said, readings = problem.said, problem.measurements
    key = [problem.load_cases.pose, said.payload, *readings.wrench.T]
    labels = (
        w for w in (said.markers, said.series, said.stations, readings.branch) if w is not None
    )
    key += [np.unique(np.array(words), return_inverse=True)[1] for words in labels]
    for ways in (said.channels.anchor, said.channels.along, said.channels.level):
        if ways is not None:
            key += list(np.nan_to_num(ways).round(6).T)
    row = np.unique(np.column_stack(key), axis=0, return_inverse=True)[1].ravel()
    held = [np.nonzero(said.channels.held(kind)) for kind in said.channels.present]
    kind = np.repeat(np.arange(len(held)), [len(at) for at, _ in held])
    axis = np.concatenate([axis for _, axis in held])
    numbers = np.column_stack([row[problem.rows], kind, axis])
    return np.asarray(np.unique(numbers, axis=0, return_inverse=True)[1].ravel(), dtype=np.intp)


def _shows(products: list[Array], y: Array) -> bool:
    """Does the score of any size stand out where all is noise?"""
    count = len(y)
    noise = float(y @ y) / count
    for each in products:
        usual = float(np.trace(each)) / count
        spread = 2.0 * (float((each**2).sum()) / count - usual**2) / count
        score = float(y @ each @ y) / (noise * count) - usual
        if spread > 0.0 and score > STARTS * np.sqrt(spread):
            return True
    return False


def _likeliest(products: list[Array], y: Array, *, stated: bool) -> tuple[Array, float]:
    """Logarithms of the noise and of each size, and the gain in likelihood over noise alone."""
    count = len(y)
    level = 0.5 * np.log(float(y @ y) / count)
    usual = [0.5 * np.log(max(float(np.trace(each)) / count, 1e-300)) for each in products]

    def cost(x: Array) -> tuple[float, Array]:
        variance = np.exp(2.0 * x)
        V = sum((size * each for size, each in zip(variance[1:], products, strict=True)), 0.0)
        V = V + variance[0] * np.eye(count)
        L = linalg.cholesky(V, lower=True)
        inverse = linalg.cho_solve((L, True), np.eye(count))
        z = inverse @ y
        slope = [
            size * (float((inverse * each).sum()) - float(z @ each @ z))
            for size, each in zip(variance[1:], products, strict=True)
        ]
        own = variance[0] * (float(np.trace(inverse)) - float(z @ z))
        return float(np.log(np.diag(L)).sum() + 0.5 * (y @ z)), np.array([own, *slope])

    bounds = [(0.0 if stated else level - 8.0, max(level, 0.0) + BEYOND)]
    bounds += [(level - each - 8.0, level - each + 2.0 * BEYOND) for each in usual]
    start = np.array([level - 0.7, *(level - each - 1.5 for each in usual)])
    start = np.clip(start, *np.array(bounds).T)
    found = minimize(cost, start, jac=True, method="L-BFGS-B", bounds=bounds, options=STOP)
    noise = 0.5 * count * (2.0 * max(level, 0.0) if stated else 2.0 * level)
    noise += 0.5 * float(y @ y) / np.exp(2.0 * max(level, 0.0) if stated else 2.0 * level)
    return np.asarray(found.x), max(noise - float(found.fun), 0.0)


def _independent(V: Array, same: Mask, whole: int) -> float:
    """Independent numbers of one size that carry as much as numbers of covariance V (m, m) do.

    (tr V)² / tr V² (Satterthwaite), from m numbers to `whole` ones of the same kind: what poses
    have in common grows with the square of their count.
    """
    count = len(V)
    alone = float((V[same] ** 2).sum()) / count
    shared = float((V[~same] ** 2).sum()) / max(count * (count - 1), 1)
    return float((np.trace(V) / count) ** 2 * whole / (alone + (whole - 1) * shared))
