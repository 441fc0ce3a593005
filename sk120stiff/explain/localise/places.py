"""Where do model and readings disagree: poses, loads, directions, joints, order; and how surely.

Everything is judged against the noise, after the model's own parameters have had their say: the
statistic of a suspect is T = ‖orth(M_B V^(-1/2) S)ᵀ r‖², with B the columns of the model's
parameters, S those of the suspect, r the whitened gap and M_B projecting out B. If the gap is noise
alone, T is χ² with rank(S) degrees of freedom (F where repeats or the scatter within poses tell the
noise). Probabilities are corrected for the number of looks by Holm's rule.

Shares are of what exceeds the noise. Where nothing tells the noise, or the noise makes most of the
gap, that is nothing to divide by: shares are of the gap itself then, and it is said.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array, Index, Mask, rms
from sk120stiff.explain.localise.localisation import (
    MOSTLY_NOISE,
    DirectionShare,
    LoadLevel,
    Localisation,
    PoseShare,
    PostureTrend,
    Suspicion,
    Whole,
)
from sk120stiff.explain.localise.random_effects import RandomEffects
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.explain.localise.suspects import axes_of, reach_of, suspects_of
from sk120stiff.explain.localise.within_poses import WithinPoses, within_poses
from sk120stiff.identify import Fit, Yardstick, lack_of_fit, yardstick
from sk120stiff.identify.checks.left_over import orthonormal

SHOWN = 8  # suspects that are worked out for figures
FEWEST_POSES = 8  # for a trend over poses
INDISTINCT = 0.02  # share of a direction below which a picture takes it for the springs' own
ROUNDING = 1e-9  # of a column, in units of the noise: what of it shows in the axes that were read
SEEN_AT_ALL = 1e-6  # share of a column that must remain, else the model's own parameters do it


def localise(fit: Fit, noise: Yardstick | None = None) -> Localisation:
    """Find where the gap of a fitted model lives.

    Args:
        fit: The fitted model, usually the base model.
        noise: What to hold the gap against; None: the fit's own `yardstick`.
    """
    look = look_at(fit, noise or yardstick(fit))
    test = lack_of_fit(fit)
    poses = _poses(look)
    suspects, beside = _suspicions(look)
    return Localisation(
        rms=fit.rms,
        noise=_noise(look, slice(None)),
        noise_from=look.noise.source,
        whole=look.whole,
        beyond=look.beyond if look.whole == "gap" and look.known else 1.0,
        probability=None if test is None else test.probability,
        poses=poses,
        levels=_levels(look),
        directions=_directions(look),
        orders=look.within.orders,
        postures=_postures(look, poses),
        own=look.within.own,
        suspects=suspects,
        beside=beside,
    )


@dataclass(frozen=True, eq=False)
class Look:
    """What every question needs: the gap raw and white, the model's columns, the noise."""

    fit: Fit
    gap: Array  # (N, 3) base axes [m]; what was not read has no part in it
    predicted: Array  # (N, 3) base axes [m]
    derivative: Array  # (N, 3, p) of the model's moving parameters, reading axes [m]
    whiten: Callable[[Array], Array]  # (N, 3, ...) reading axes [m] to (R, ...)
    inside: Array  # (R, rank) orthonormal basis of what the model's parameters can do, whitened
    white: Array  # (R,) whitened gap, `inside` projected out
    variance: Array  # (N, 3) noise variance of a displacement [m²], zero where it was not read
    noise: Yardstick
    within: WithinPoses

    @property
    def known(self) -> bool:
        """Something beside the gap tells the size of the noise."""
        return self.noise.freedom > 0.0

    @cached_property
    def beyond(self) -> float:
        """Share of the gap's square that exceeds the noise, of the raw or of the white gap."""
        white = float(self.white @ self.white) / self.noise.scale
        expected = len(self.white) - self.inside.shape[1]
        raw, noise = float((self.gap**2).sum()), float(self.variance.sum())
        shares = (1.0 - expected / max(white, 1e-300), 1.0 - noise / max(raw, 1e-300))
        return float(np.clip(min(shares), 0.0, 1.0)) if self.known else 0.0

    @cached_property
    def whole(self) -> Whole:
        """What shares are shares of."""
        return "excess" if self.beyond >= MOSTLY_NOISE else "gap"

    @cached_property
    def floor(self) -> Array:
        """(N, 3) variance that is no part of the whole [m²]."""
        return self.variance if self.whole == "excess" else np.zeros_like(self.variance)

    @cached_property
    def raw_whole(self) -> float:
        """The whole as a sum of squares of the gap [m²]."""
        return max(float((self.gap**2).sum() - self.floor.sum()), 1e-300)


def look_at(fit: Fit, noise: Yardstick) -> Look:
    """The gap of a fitted model, whitened, and all that its own parameters can do of it."""
    problem = fit.problem
    axes = problem.load_cases.reading_axes
    predicted, full = fit.model.predict_with_sensitivities(problem.load_cases)
    drawn = RandomEffects(fit, full)
    moving = ~fit.at_bound & ~drawn.columns[problem.free]
    derivative = full[:, :, problem.free[moving]] * problem.scale[moving]
    inside = orthonormal(drawn.whiten(derivative))
    predicted = predicted - drawn.covered()
    raw = np.where(problem.read, problem.measured - predicted, 0.0)
    white = drawn.whiten(raw)
    white = white - inside @ (inside.T @ white)
    variance = sum(problem.noise.variances(problem.measurements, problem.sizes))
    each = np.mean(variance, axis=1, where=problem.read, keepdims=True)
    return Look(
        fit=fit,
        gap=np.einsum("nij,nj->ni", axes, raw),
        predicted=np.einsum("nij,nj->ni", axes, predicted),
        derivative=derivative,
        whiten=drawn.whiten,
        inside=inside,
        white=white,
        variance=np.where(problem.read, each * noise.scale, 0.0),
        noise=noise,
        within=within_poses(fit, white, inside, drawn.whiten, noise),
    )


def _poses(look: Look) -> tuple[PoseShare, ...]:
    problem = look.fit.problem
    load_cases = problem.load_cases
    square = (look.gap**2).sum(1)
    rows = [np.flatnonzero(load_cases.pose == k) for k in range(len(load_cases.poses))]
    chance = [_chance_of_pose(look, problem.pose == k) for k in range(len(load_cases.poses))]
    found = []
    for label, r, p in zip(load_cases.poses, rows, holm(chance), strict=True):
        if not len(r):
            continue
        share = float(square[r].sum() - look.floor[r].sum()) / look.raw_whole
        rms = float(np.sqrt(square[r].sum() / problem.read[r].sum()))
        found.append(PoseShare(label, rms, _noise(look, r), share, p))
    return tuple(found)


def _chance_of_pose(look: Look, there: Mask) -> float:
    """Probability of such a gap at one pose: beside the noise, or beside the gaps of the others."""
    square = look.white**2
    own, count = float(square[there].sum()), int(there.sum())
    if look.known:
        return look.noise.tail(own, count)
    rest = float(square.sum()) - own
    freedom = len(look.white) - look.inside.shape[1] - count
    if freedom < 1 or not count or rest <= 0.0:
        return 1.0
    return float(stats.f.sf(own / count / (rest / freedom), count, freedom))


def _noise(look: Look, rows: Index | slice) -> float | None:
    """Rms per axis that noise alone leaves [m]; None where nothing tells."""
    if not look.known:
        return None
    return float(np.sqrt(look.variance[rows].sum() / look.fit.problem.read[rows].sum()))


def _levels(look: Look) -> tuple[LoadLevel, ...]:
    """The gap at the lower, the middle and the upper third of the loads."""
    size = np.linalg.norm(look.fit.problem.load_cases.wrench[:, :3], axis=1)
    edges = np.quantile(size, [1 / 3, 2 / 3])
    third = np.searchsorted(edges, size, side="left")
    square, read = (look.gap**2).sum(1), look.fit.problem.read.sum(1)
    return tuple(
        LoadLevel(
            low=float(size[part].min()),
            high=float(size[part].max()),
            count=int(part.sum()),
            rms=float(np.sqrt(square[part].sum() / read[part].sum())),
            noise=_noise(look, np.flatnonzero(part)),
        )
        for part in (third == k for k in range(3))
        if part.any()
    )


def _directions(look: Look) -> tuple[DirectionShare, ...]:
    out = []
    load_cases = look.fit.problem.load_cases
    for axes in axes_of(load_cases):
        along = np.einsum("nij,ni->nj", axes.directions, look.gap)
        seen = np.einsum("nki,nkj->nij", load_cases.reading_axes, axes.directions)
        parts = (along**2).sum(0) - (look.floor[:, :, None] * seen**2).sum((0, 1))
        for word, part in zip(axes.words, parts, strict=True):
            out.append(DirectionShare(axes.name, word, float(part) / look.raw_whole))
    return tuple(out)


def _postures(look: Look, poses: Sequence[PoseShare]) -> tuple[PostureTrend, ...]:
    """Does the gap grow with reach, height, or the position of a joint?"""
    load_cases = look.fit.problem.load_cases
    if len(poses) < FEWEST_POSES:
        return ()
    _, first = np.unique(load_cases.pose, return_index=True)
    variables = {
        "the reach": reach_of(load_cases)[first],
        "the height of the point": load_cases.nominal.position[first, 2],
    }
    for k, joint in enumerate(load_cases.robot.actuated):
        variables[f"the position of {joint}"] = load_cases.a[first, k]
    variables = {name: v for name, v in variables.items() if np.ptp(v) > 1e-6}
    left = np.array([pose.rms for pose in poses])
    if not np.ptp(left):
        return ()
    tests = [stats.spearmanr(values, left) for values in variables.values()]
    corrected = holm([float(test.pvalue) for test in tests])
    found = []
    for (name, values), test, p in zip(variables.items(), tests, corrected, strict=True):
        upper = values > np.median(values)
        low, high = (rms(left[part]) for part in (~upper, upper))
        found.append(PostureTrend(name, float(test.statistic), p, low, high))
    return tuple(sorted(found, key=lambda trend: trend.probability))


@dataclass(frozen=True, eq=False)
class Lineup:
    """All suspects, with their columns in reading axes and whitened."""

    suspects: tuple[Suspect, ...]
    reading: list[Array]  # (N, 3, k) each [m]
    white: Array  # (R, sum of k)
    parts: tuple[slice, ...]


def line_up(look: Look) -> Lineup:
    """Everything that the gap may go with."""
    load_cases = look.fit.problem.load_cases
    suspects = suspects_of(look.fit.model, load_cases, look.predicted)
    reading = [np.swapaxes(load_cases.reading_axes, 1, 2) @ s.columns for s in suspects]
    ends = np.cumsum([0, *(s.columns.shape[2] for s in suspects)])
    together = np.concatenate(reading, axis=2)
    white = look.whiten(together)
    white[:, ~_shown(look, together, white)] = 0.0
    return Lineup(
        suspects=suspects,
        reading=reading,
        white=white,
        parts=tuple(slice(int(a), int(b)) for a, b in pairwise(ends)),
    )


def _shown(look: Look, columns: Array, white: Array) -> Mask:
    """(k,) which of the columns (N, 3, k) [m], whitened (R, k), the axes that were read show."""
    whole = np.linalg.norm(columns.reshape(-1, columns.shape[2]), axis=0)
    sigma = look.fit.problem.noise.sigma
    return np.asarray(np.linalg.norm(white, axis=0) > ROUNDING * whole / sigma)


def ranked(look: Look, lineup: Lineup, known: Array) -> list[tuple[Suspicion, int]]:
    """Suspects with their places in the line-up, the strongest first.

    `known` (R, k) is an orthonormal basis of what is in the model already. Shares are of the whole
    when nothing is known but the model's own parameters.
    """
    beyond = lineup.white - known @ (known.T @ lineup.white)
    length, left = np.linalg.norm(lineup.white, axis=0), np.linalg.norm(beyond, axis=0)
    visible = left > SEEN_AT_ALL * np.maximum(length, 1e-300)
    white = look.white - known @ (known.T @ look.white)
    total = float(white @ white) / look.noise.scale
    freedom = len(white) - known.shape[1]
    found: list[tuple[Suspicion, int]] = []
    for k, (suspect, own) in enumerate(zip(lineup.suspects, lineup.parts, strict=True)):
        basis = orthonormal(beyond[:, own][:, visible[own]])
        rank = basis.shape[1]
        if 0 < rank < freedom:
            T = float(((basis.T @ white) ** 2).sum()) / look.noise.scale
            found.append((_suspicion(suspect, T, rank, total, freedom, look), k))
    corrected = holm([suspicion.probability for suspicion, _ in found])
    return sorted(
        ((replace(s, probability=p), k) for (s, k), p in zip(found, corrected, strict=True)),
        key=lambda pair: -pair[0].evidence,
    )


def _suspicions(look: Look) -> tuple[tuple[Suspicion, ...], tuple[Suspicion, ...]]:
    """All suspects, the strongest first; and the others once the strongest is in the model."""
    lineup = line_up(look)
    order = ranked(look, lineup, look.inside)
    shown = _to_show([suspicion for suspicion, _ in order])
    alone = tuple(
        _with_picture(s, lineup.suspects[k], lineup.reading[k], look) if number in shown else s
        for number, (s, k) in enumerate(order)
    )
    if not alone or not alone[0].seen:
        return alone, ()
    first = orthonormal(lineup.white[:, lineup.parts[order[0][1]]])
    known = orthonormal(np.hstack([look.inside, first]))
    return alone, tuple(suspicion for suspicion, _ in ranked(look, lineup, known))


def _suspicion(
    suspect: Suspect, T: float, rank: int, total: float, freedom: int, look: Look
) -> Suspicion:
    """The statistic with its probability, not yet corrected for the number of looks."""
    noise = look.noise
    unit = 1.0
    if look.known:
        p = noise.tail(T * noise.scale, rank)
    else:  # nothing tells the noise but what the suspect itself leaves
        unit = max(total - T, 1e-300) / (freedom - rank)
        p = float(stats.f.sf(T / rank / unit, rank, freedom - rank))
    whole = float(look.white @ look.white) / noise.scale
    if look.whole == "excess":
        whole -= len(look.white) - look.inside.shape[1]
    return Suspicion(
        family=suspect.family,
        name=suspect.name,
        label=suspect.label,
        statistic=T,
        freedom=rank,
        probability=p,
        explained=float(np.clip((T - rank * unit) / max(whole, 1e-300), 0.0, 1.0)),
        evidence=T - rank * float(np.log(max(freedom, 2))) - suspect.price_of_choice,
    )


def _to_show(ranked: Sequence[Suspicion]) -> set[int]:
    """The three strongest, and the strongest of every family."""
    shown = set(range(min(3, len(ranked))))
    for family in dict.fromkeys(s.family for s in ranked):
        shown.add(next(k for k, s in enumerate(ranked) if s.family == family))
    return set(sorted(shown)[:SHOWN])


def _with_picture(suspicion: Suspicion, suspect: Suspect, reading: Array, look: Look) -> Suspicion:
    """The gap along the suspect's direction, with the model's parameters refitted beside it."""
    problem = look.fit.problem
    both = np.concatenate([look.derivative, reading], axis=2)
    white = look.whiten(both)
    shown = _shown(look, both, white)
    norms = np.linalg.norm(white[:, shown], axis=0)
    values = np.zeros(len(shown))
    values[shown] = np.linalg.lstsq(white[:, shown] / norms, look.white, rcond=INDISTINCT)[0]
    values[shown] /= norms
    inside = look.derivative.shape[2]
    signature, covered = reading @ values[inside:], look.derivative @ values[:inside]
    raw = np.einsum("nji,nj->ni", problem.load_cases.reading_axes, look.gap)
    freed = np.where(problem.read, raw - covered, 0.0)
    if suspect.direction is None:
        size = np.linalg.norm(signature, axis=1, keepdims=True)
        along = signature / np.where(size > 0.0, size, 1.0)
    else:
        along = np.einsum("nji,nj->ni", problem.load_cases.reading_axes, suspect.direction)
    return replace(
        suspicion, abscissa=suspect.abscissa, partial=np.einsum("ni,ni->n", along, freed)
    )


def holm(probabilities: Sequence[float]) -> list[float]:
    """Probabilities corrected for the number of looks (Holm 1979)."""
    p = np.asarray(probabilities, dtype=float)
    order = np.argsort(p)
    stepped = np.maximum.accumulate(p[order] * (len(p) - np.arange(len(p))))
    out = np.empty_like(p)
    out[order] = np.minimum(stepped, 1.0)
    return [float(x) for x in out]
