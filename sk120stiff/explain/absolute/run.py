"""Positions explained: register, choose among all that may be missing, fit exactly, say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array
from sk120stiff.effects import CATALOGUE, Catalogue, Effect
from sk120stiff.errors import InputError
from sk120stiff.explain.absolute.advice import (
    NextPoses,
    detectable,
    next_poses,
    open_pair,
    probabilities,
)
from sk120stiff.explain.absolute.candidates import family, linear_at
from sk120stiff.explain.absolute.choose import (
    Chosen,
    Gain,
    alternatives,
    choose,
    gain,
    lengths,
)
from sk120stiff.explain.absolute.laws import Laws, beside_laws, by_best_laws, laws_at
from sk120stiff.explain.absolute.linear import Linear
from sk120stiff.explain.findings import Detectable
from sk120stiff.explain.options import Options
from sk120stiff.identify.absolute.calibrate import (
    Calibration,
    calibrate,
    refined,
    with_values_of,
)
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model

FEWEST = 10  # poses below which no other pose can confirm a name
LEVEL = 0.01  # probability of noise alone below which something is missing
LARGEST = 5  # places told
MORE = 1.2  # times as much left as to first order: the fit went another way
ROUNDS = 3  # of choosing anew about what was fitted


@dataclass(frozen=True)
class Named:
    """One named cause: the effect, what cannot be told from it, its probability and gain."""

    effect: Effect
    alternatives: tuple[str, ...]
    probability: float
    gain: Gain


@dataclass(frozen=True)
class GapStep:
    """The gap with one cause more: rms per axis, fitted and held out, and mean distance [m]."""

    label: str
    fit_rms: float
    heldout_rms: float
    heldout_distance: float


@dataclass(frozen=True, eq=False)
class Explained:
    """What is missing where positions were read.

    Attributes:
        verdict: none, named, ambiguous or outside.
        named: Causes in the order in which they joined.
        base, final: Calibrations without them and with them.
        linear: The positions linearised at the last fit but one, the base beside which all others
            are judged.
        steps: The gap step by step.
        families: Family → rms per axis that its causes take off the held-out gap together [m].
        springs: What springs in all joints would take off the held-out gap beside the named causes,
            as a share of it; None where they are named, or nothing bends the arm.
        dropped: What fitted and is not named, in sentences.
        hidden: Candidates that do not show in these positions at all.
        remainder: Rms per axis that is left beyond the stated noise, and its 95 % interval [m];
            None: no noise is stated.
        chance: Probability of as large a misfit if the noise were all; None where none is stated.
        where: Where what is left lives, in sentences.
        smallest: Sizes that would have been named beside the named causes.
        probabilities: Name → probability of its being at work, of all that have one worth telling.
        following: Readings that would tell the first open pair of names apart, or None.
    """

    verdict: str
    named: tuple[Named, ...]
    base: Calibration
    final: Calibration
    linear: Linear
    steps: tuple[GapStep, ...]
    families: dict[str, float]
    springs: float | None
    dropped: tuple[str, ...]
    hidden: tuple[str, ...]
    remainder: tuple[float, float, float] | None
    chance: float | None
    where: tuple[str, ...]
    smallest: tuple[Detectable, ...]
    probabilities: dict[str, float]
    following: NextPoses | None

    def weight(self) -> tuple[str, ...]:
        """What the arm's weight would explain where no spring is named, in a sentence."""
        if self.springs is None:
            return ()
        more = f"{100 * self.springs:.2g} % more" if self.springs > 0.0 else "nothing more"
        return (
            f"Springs in all joints under the arm's weight would take {more} off the gap at poses "
            "left out: they are not named.",
        )

    def left_over(self) -> tuple[str, ...]:
        """What is left beyond the stated noise and where it lives, in sentences."""
        if self.remainder is None:
            return self.where
        rms, low, high = (1e6 * size for size in self.remainder)
        unit = self.final.problem.unit
        told = f"Left beyond the stated noise are {rms:.3g} {unit} rms per axis"
        return (f"{told} (95 %: {low:.3g} to {high:.3g}).", *self.where)


def explain_positions(
    model: Model,
    readings: Measurements,
    *,
    options: Options | None = None,
    catalogue: Catalogue = CATALOGUE,
    progress: Callable[[str, float], None] | None = None,
) -> Explained:
    """Find what is missing where readings say where markers stand.

    Args:
        model: Effects that are taken for granted; a rigid arm otherwise.
        readings: Rows of positions and what goes with them.
        options: How the search is steered.
        catalogue: The effects that may be missing.
        progress: Called with a phrase and a share of the work done.

    Raises:
        InputError: No such robot gave these positions, or too few poses.
        Refusal: The fit did not converge.
    """
    options = options or Options()
    tell = progress or (lambda _phrase, _share: None)
    if len(readings.masked().poses) < FEWEST:
        raise InputError(
            f"{len(readings.masked().poses)} poses: no other pose can confirm a name",
            where=str(readings.path or "measurements"),
            remedy=f"Measure at {FEWEST} poses or more; geometry alone comes from "
            "'sk120stiff identify'.",
        )
    tell("registering the tracker", 0.05)
    base = calibrate(model, readings, geometry=False, waves=False, catalogue=catalogue)
    tell("searching the catalogue", 0.2)
    seen = base
    linear, found, laws, hidden = _selected(base, seen, options, catalogue)
    tell("fitting exactly", 0.5)
    final = _exactly(base, seen, linear, found, readings, catalogue)
    for _ in range(ROUNDS):
        before, seen = _picked(linear, found), final
        linear, found, laws, hidden = _selected(base, seen, options, catalogue)
        again = _picked(linear, found)
        if set(again) == set(before):
            break
        final = _exactly(base, seen, linear, found, readings, catalogue)
    final = beside_laws(final, linear, found.order, laws)
    tell("what is left", 0.85)
    noise = linear.noise(found.order)
    named = tuple(_named(linear, found, e) for e in found.order)
    gap = linear.gap(found.order, noise, held_out=True)
    remainder = chance = None
    if final.fit.sigma_known and final.fit.misfit is not None:
        chance = final.fit.misfit[2]
        sigma = final.problem.stated_sigma
        remainder = None if sigma is None else _beyond(final, sigma)
    lacking = chance is not None and chance < LEVEL
    verdict = "outside" if lacking else "none"
    pair = open_pair([(item.effect, item.alternatives) for item in named], linear)
    if named:
        verdict = "ambiguous" if any(item.alternatives for item in named) else "named"
    return Explained(
        verdict=verdict,
        named=named,
        base=base,
        final=final,
        linear=linear,
        steps=_steps(linear, found, base, seen),
        families=_families(linear, found, seen),
        springs=_springs(linear, found),
        dropped=tuple(found.dropped.values()),
        hidden=tuple(effect.id for effect in hidden),
        remainder=remainder,
        chance=chance,
        where=_where(linear, gap, seen, readings),
        smallest=detectable(linear, found),
        probabilities=probabilities(linear, found),
        following=None
        if pair is None
        else next_poses(final, *pair, seed=options.seed, cell=options.cell),
    )


def _selected(
    base: Calibration, seen: Calibration, options: Options, catalogue: Catalogue
) -> tuple[Linear, Chosen, Laws, tuple[Effect, ...]]:
    """Names about a calibration, each by its best law; all their laws, and what does not show."""
    linear, hidden = linear_at(base, options, catalogue, seen)
    found = choose(linear)
    laws = laws_at(linear, found.order, seen)
    return by_best_laws(linear, found.order, laws), found, laws, hidden


def _exactly(
    base: Calibration,
    seen: Calibration,
    linear: Linear,
    found: Chosen,
    readings: Measurements,
    catalogue: Catalogue,
) -> Calibration:
    """The chosen fitted at equilibrium, from where they were seen.

    A load on springs is a product of two unknowns, and the way to it is curved: where more is left
    than to first order, the values found so are another start.
    """
    picked = _picked(linear, found)
    final = refined(base, picked, readings, seen.fit.model, catalogue)
    noise = linear.noise(found.order)
    foretold = linear.gap(found.order, noise, held_out=False) * seen.problem.of_channels.sigma
    if _left(final) <= MORE * _rms(foretold):
        return final
    known = linear.values(found.order, noise)
    wide = final.fit.model
    values = [
        known.get(p.name, p.internal) for p in with_values_of(wide, seen.fit.model).parameters
    ]
    again = refined(base, picked, readings, wide.with_values(np.array(values)), catalogue)
    return min(final, again, key=_left)


def _left(found: Calibration) -> float:
    return _rms(found.fit.residual * found.problem.of_channels.sigma)


def _picked(linear: Linear, found: Chosen) -> list[Effect]:
    return [linear.candidates[e] for e in found.order]


def _named(linear: Linear, found: Chosen, e: int) -> Named:
    rivals, probability = alternatives(linear, found.order, e)
    return Named(
        linear.candidates[e],
        tuple(linear.candidates[c].id for c in rivals),
        probability,
        gain(linear, found.order, e),
    )


def _whole(linear: Linear, seen: Calibration) -> Array:
    """(M,) numbers that are coordinates of positions."""
    part = np.zeros(len(linear.residual), dtype=bool)
    for kind, own in zip(seen.problem.channels.present, seen.problem.channels.kinds, strict=True):
        part[own] = kind == "position"
    return part


def _steps(
    linear: Linear, found: Chosen, base: Calibration, seen: Calibration
) -> tuple[GapStep, ...]:
    sigma, whole = seen.problem.of_channels.sigma, _whole(linear, seen)
    first = " + ".join(effect.id for effect in base.fit.model.effects) or "rigid"
    labels = [first, *(f"+ {linear.candidates[e].id}" for e in found.order)]
    steps = []
    for k, label in enumerate(labels):
        chosen = found.order[:k]
        noise = linear.noise(chosen)
        fitted = linear.gap(chosen, noise, held_out=False)
        held = linear.gap(chosen, noise, held_out=True)
        distance = lengths(held, linear, sigma, whole)
        inside = seen.problem.counted
        steps.append(
            GapStep(
                label,
                _rms((fitted * sigma)[inside]),
                _rms((held * sigma)[inside]),
                float(distance.mean()) if len(distance) else np.nan,
            )
        )
    return tuple(steps)


def _families(linear: Linear, found: Chosen, seen: Calibration) -> dict[str, float]:
    sigma, counted = seen.problem.of_channels.sigma, seen.problem.counted
    groups: dict[str, list[int]] = {}
    for e in found.order:
        groups.setdefault(family(linear.candidates[e]), []).append(e)
    noise = linear.noise(found.order)
    left = _rms((linear.gap(found.order, noise, held_out=True) * sigma)[counted])
    out = {}
    for name, members in groups.items():
        rest = tuple(e for e in found.order if e not in members)
        out[name] = _rms((linear.gap(rest, noise, held_out=True) * sigma)[counted]) - left
    return out


def _beyond(final: Calibration, sigma: float) -> tuple[float, float, float]:
    """Rms per axis beyond the stated noise and its 95 % interval [m]."""
    square, freedom = final.fit.judged
    freedom = max(freedom, 1)
    shares = [freedom, *(float(stats.chi2.ppf(level, freedom)) for level in (0.975, 0.025))]
    best, low, high = (sigma * max(square / s - 1.0, 0.0) ** 0.5 for s in shares)
    return best, low, high


def _springs(linear: Linear, found: Chosen) -> float | None:
    springs = [e for e, effect in enumerate(linear.candidates) if effect.joint_spring]
    if not springs or set(springs) & set(found.order):
        return None
    noise = linear.noise(found.order)
    before = _rms(linear.gap(found.order, noise, held_out=True))
    return 1.0 - _rms(linear.gap((*found.order, *springs), noise, held_out=True)) / before


def _where(
    linear: Linear, gap: Array, seen: Calibration, readings: Measurements
) -> tuple[str, ...]:
    """Rows with the largest gaps left, and joints whose angle it goes with most."""
    rows = np.flatnonzero(readings.use & ~seen.wild)
    counted, unit = seen.problem.counted, seen.problem.unit
    square = (gap * seen.problem.of_channels.sigma)[counted] ** 2
    size = np.sqrt(np.bincount(linear.row[counted], square, minlength=len(rows)))
    worst = np.argsort(-size)[:LARGEST]
    places = ", ".join(f"{readings.pose[rows[k]]} ({1e6 * size[k]:.0f} {unit})" for k in worst)
    said = [f"The largest gaps left at poses left out: {places}."]
    a = readings.joints[rows]
    strength = {}
    for k, name in enumerate(readings.joint_names):
        if np.ptp(a[:, k]) > 1e-3:
            order = stats.spearmanr(np.abs(a[:, k] - np.median(a[:, k])), size)
            strength[name] = abs(float(order.statistic))
    if strength and max(strength.values()) > 4.0 / np.sqrt(len(rows)):
        joint = max(strength, key=lambda name: strength[name])
        said.append(f"What is left grows most as {joint} leaves the middle of its range.")
    return tuple(said)


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2))) if len(x) else 0.0


def heldout_on(final: Calibration, others: Measurements) -> tuple[float, float]:
    """Rms per axis and mean distance [m] of a calibration at readings it never saw."""
    problem = replace(final.problem, measurements=others.masked(), model=final.fit.model)
    gap = problem.channel_gap(final.fit.model.values)[0]
    if "position" not in problem.channels.present:
        return _rms(gap[problem.lengths]), np.nan
    held = problem.channels.held("position")
    first = np.flatnonzero(held.all(axis=1))
    full = np.full(held.shape, np.nan)
    full[held] = gap[problem.channels.kinds[0]]
    return _rms(gap[problem.lengths]), float(np.linalg.norm(full[first], axis=1).mean())
