"""Positions explained: register, choose among all that may be missing, fit exactly, say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.effects import CATALOGUE, Catalogue, Effect
from sk120stiff.errors import InputError
from sk120stiff.explain.absolute.accounts import (
    GapStep,
    families_of,
    rms,
    springs_of,
    steps_of,
    suspects_of,
)
from sk120stiff.explain.absolute.advice import (
    NextPoses,
    detectable,
    next_poses,
    open_pair,
    probabilities,
)
from sk120stiff.explain.absolute.candidates import linear_at
from sk120stiff.explain.absolute.choose import (
    Chosen,
    Gain,
    alternatives,
    choose,
    gain,
    nothing_named,
)
from sk120stiff.explain.absolute.laws import Laws, beside_laws, by_best_laws, laws_at
from sk120stiff.explain.absolute.linear import Linear
from sk120stiff.explain.absolute.remainder import where_it_lives
from sk120stiff.explain.findings import Contender, Detectable
from sk120stiff.explain.options import Options
from sk120stiff.identify.absolute.calibrate import (
    Calibration,
    calibrate,
    refined,
    with_model_form,
    with_values_of,
)
from sk120stiff.identify.absolute.remainder import (
    LEVEL,
    Size,
    chance_of_noise,
    left_beyond_noise,
    remainder_sentences,
)
from sk120stiff.identify.absolute.weighing import pounds
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model

FEWEST = 10  # poses below which no other pose can confirm a name
SURE = 0.95  # probability of a name that is settled
EVEN = 0.5  # probability that one name at least must have to be confirmed
MORE = 1.2  # times as much left as to first order: the fit went another way
ROUNDS = 3  # of choosing anew about what was fitted


@dataclass(frozen=True)
class Named:
    """One named cause: the effect, what cannot be told from it, its probability and gain."""

    effect: Effect
    alternatives: tuple[str, ...]
    probability: float
    gain: Gain

    @property
    def settled(self) -> bool:
        """Nothing else explains as much, and it is sure."""
        return not self.alternatives and self.probability >= SURE


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
        remainder: Rms per axis that is left beyond the noise, and its 95 % interval [m]; None: no
            noise is stated, and what is left may be noise.
        chance: Probability of as large a misfit if the noise were all; None as before.
        suspects: Where nothing is confirmed: names that fit, and what they take off the held-out
            rms [m].
        guess: The calibration with these.
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
    remainder: Size | None
    chance: float | None
    suspects: tuple[Contender, ...]
    guess: Calibration | None
    where: tuple[str, ...]
    smallest: tuple[Detectable, ...]
    probabilities: dict[str, float]
    following: NextPoses | None

    @property
    def lacking(self) -> bool:
        """More is left than the noise makes."""
        return self.chance is not None and self.chance < LEVEL

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
        return (*remainder_sentences(self.final), *self.where)


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
    tell("what is left", 0.85)
    final, guess = with_model_form(final), None
    suspects: tuple[Contender, ...] = ()
    if final.form is not None:
        linear = replace(linear, independent=final.form.independent, smooth=final.form.share)
        likely = [alternatives(linear, found.order, e)[1] for e in found.order]
        if likely and max(likely) < EVEN:
            guess, suspects = final, suspects_of(linear, found, seen)
            found, laws = nothing_named(linear, found), {}
            final = with_model_form(_exactly(base, seen, linear, found, readings, catalogue))
    final = beside_laws(final, linear, found.order, laws)
    final = replace(final, notes=(*final.notes, *pounds(final)))
    noise = linear.noise(found.order)
    named = tuple(_named(linear, found, e) for e in found.order)
    gap = linear.gap(found.order, noise, held_out=True)
    chance = chance_of_noise(final)
    lacking = chance is not None and chance < LEVEL
    verdict = "outside" if lacking else "none"
    pair = open_pair([(item.effect, item.alternatives) for item in named], linear)
    if named:
        verdict = "named" if all(item.settled for item in named) else "ambiguous"
    return Explained(
        verdict=verdict,
        named=named,
        base=base,
        final=final,
        linear=linear,
        steps=steps_of(linear, found, base, seen),
        families=families_of(linear, found, seen),
        springs=springs_of(linear, found),
        dropped=tuple(found.dropped.values()),
        hidden=tuple(effect.id for effect in hidden),
        remainder=left_beyond_noise(final),
        chance=chance,
        suspects=suspects,
        guess=guess,
        where=where_it_lives(linear, gap, replace(seen, form=final.form), readings),
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
    if _left(final) <= MORE * rms(foretold):
        return final
    known = linear.values(found.order, noise)
    wide = final.fit.model
    values = [
        known.get(p.name, p.internal) for p in with_values_of(wide, seen.fit.model).parameters
    ]
    again = refined(base, picked, readings, wide.with_values(np.array(values)), catalogue)
    return min(final, again, key=_left)


def _left(found: Calibration) -> float:
    return rms(found.fit.residual * found.problem.of_channels.sigma)


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
