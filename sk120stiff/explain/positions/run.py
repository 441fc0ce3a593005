"""Positions explained: register, choose among all that may be missing, fit exactly, say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sk120stiff.effects import Catalogue, Effect, all_effects
from sk120stiff.effects.geometry import JointOffset
from sk120stiff.effects.options import Options as EffectOptions
from sk120stiff.errors import InputError
from sk120stiff.explain.answer.verdict import Outcome
from sk120stiff.explain.findings import Contender
from sk120stiff.explain.options import Options, refuse_unknown
from sk120stiff.explain.positions.advise.detectable import detectable, probabilities
from sk120stiff.explain.positions.advise.other_poses import (
    NextPoses,
    elsewhere,
    never_told,
    next_poses,
)
from sk120stiff.explain.positions.answer.balancer import balancing, or_balancer, shared
from sk120stiff.explain.positions.answer.explained import Explained, Named
from sk120stiff.explain.positions.judge.accounts import Account, heldout_on, numbers_told
from sk120stiff.explain.positions.judge.changed import changed
from sk120stiff.explain.positions.judge.fallen import (
    EVEN,
    TOGETHER,
    with_own_values,
)
from sk120stiff.explain.positions.judge.laws import (
    Laws,
    beside_laws,
    by_best_laws,
    laws_at,
    with_fewer,
)
from sk120stiff.explain.positions.judge.posterior import Posterior, borne_out, of_all
from sk120stiff.explain.positions.judge.remainder import where_it_lives
from sk120stiff.explain.positions.judge.settled import Campaign, left, less_likely, picked
from sk120stiff.explain.positions.select.candidates import linear_at
from sk120stiff.explain.positions.select.choose import (
    Chosen,
    by_likeliest,
    choose,
    gain,
    nothing_named,
    threshold,
)
from sk120stiff.explain.positions.select.linear import Linear, everything
from sk120stiff.explain.select.form import beside_form, forms
from sk120stiff.identify import refuse_for_positions, refuse_plan
from sk120stiff.identify.positions.calibrate import (
    Calibration,
    calibrate,
    refined,
)
from sk120stiff.identify.positions.checks.computed import computed
from sk120stiff.identify.positions.checks.drift import creeping
from sk120stiff.identify.positions.checks.force_axes import refuse_other_forces
from sk120stiff.identify.positions.checks.gravity_direction import refuse_another_gravity
from sk120stiff.identify.positions.checks.payload_unit import pounds
from sk120stiff.identify.positions.checks.remounted import refuse_remounted
from sk120stiff.identify.positions.checks.slips import refuse_pushed
from sk120stiff.identify.positions.residuals.remainder import (
    LEVEL,
    chance_of_noise,
    left_beyond_noise,
)
from sk120stiff.identify.positions.uncertainty.compliant_parts import beside_parts
from sk120stiff.measurements import Measurements, taken_as_moved
from sk120stiff.model import Model

FEWEST = 10  # poses below which no other pose can confirm a name
FEWEST_LOADED = 6  # the same where each is read by what loads do, several numbers to a pose
ROUNDS = 3  # of choosing anew about what was fitted


def explain_positions(
    model: Model,
    readings: Measurements,
    *,
    holdout: Measurements | None = None,
    options: Options | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Explained:
    """See `sk120stiff.explain.run.explain`.

    Effects of the model are taken for granted; what else yields or is off is looked for.
    """
    options, usual = options or Options(), Options()
    refuse_for_positions(
        readings,
        assume=options.assume,
        max_effects=options.max_effects != usual.max_effects,
        alpha=options.alpha != usual.alpha,
        prior=options.prior,
    )
    refuse_plan(readings)
    every = all_effects(model.robot, absolute=True, catalogue=model.catalogue)
    refuse_unknown(every, options, model)
    if holdout is not None and (holdout.absolute is None or holdout.is_plan):
        raise InputError(
            "the held-out readings are no positions", remedy="Hold out readings of the same kind."
        )
    joints = model.robot.actuated, model.robot.kinds
    readings = readings.with_joints(*joints)
    holdout = None if holdout is None else holdout.with_joints(*joints)
    _refuse_few_poses(readings)

    def work(taken: Measurements) -> Explained:
        return _explained(model, taken, holdout, options, progress or (lambda _what, _share: None))

    found, moved = taken_as_moved(readings, work)
    final = replace(found.final, notes=(*moved, *found.final.notes))
    return replace(found, final=final, moved=moved)


def _explained(
    model: Model,
    readings: Measurements,
    holdout: Measurements | None,
    options: Options,
    tell: Callable[[str, float], None],
) -> Explained:
    """See `explain_positions`.

    Raises:
        MovedBetween: Something moved among the readings.
    """
    catalogue = model.catalogue
    tell("registering the tracker", 0.05)
    base = calibrate(
        model, readings, geometry=False, waves=False, shared=False, catalogue=catalogue
    )
    refuse_other_forces(base, readings)
    hangs = refuse_another_gravity(base, readings)
    tell("searching the catalogue", 0.2)
    seen = _about(base, readings, catalogue)
    linear, found, laws, hidden = _selected(base, seen, options, catalogue)
    beside = everything(linear)
    pushed = refuse_pushed(seen, readings, *beside) or refuse_remounted(seen, readings, *beside)
    tell("fitting exactly", 0.5)
    final = Campaign(base, seen, readings, catalogue).exactly(linear, found)
    for _ in range(ROUNDS):
        about = _selected(base, final, options, catalogue)
        if set(picked(*about[:2])) == set(picked(linear, found)):
            seen, (linear, found, laws, hidden) = final, about
            break
        again = Campaign(base, final, readings, catalogue).exactly(*about[:2])
        if less_likely(again, final, 2.0 * threshold(linear)):  # what says the same takes turns
            break
        seen, (linear, found, laws, hidden), final = final, about, again
    campaign = Campaign(base, seen, readings, catalogue)
    if (apart := with_own_values(linear, found, final)) != found:
        found, final = apart, campaign.exactly(linear, apart)
    if found.order and left(final) > left(base):  # first order led astray
        found, laws = nothing_named(linear, found), {}
        final = campaign.exactly(linear, found)
    tell("what is left", 0.85)
    first = campaign.standing(linear, found, laws, final)
    now = campaign.settled(first)
    guess, guessed = None, np.nan
    suspects, jointly = tuple[Contender, ...](), tuple[str, ...]()
    if now.final.form is not None:
        likely = [probability for _, probability in now.posterior.names.values()]
        alone = len(likely) == 1 and not borne_out(now.linear, now.found.order)
        if likely and (alone or max(likely) < EVEN):
            if alone or (together := of_all(now.linear, now.found.order)) < TOGETHER:
                inside = numbers_told(seen, first.final, readings)  # with all that fell
                guess = beside_laws(first.final, first.posterior, first.laws)
                guess = beside_parts(guess, catalogue, options.exclude)
                account = Account(first.linear, first.found, seen, inside)
                suspects, guessed = account.suspects(), account.left
                nothing = nothing_named(now.linear, now.found)
                bare = campaign.exactly(now.linear, nothing)
                now = campaign.standing(now.linear, nothing, {}, bare)
            else:
                jointly = (
                    "None of these names is likely by itself, since each may stand for the others; "
                    "that what they take off together is theirs, and no part of an unknown cause, "
                    f"has P = {together:.2f}.",
                )
    linear, found = now.linear, now.found
    final = beside_laws(now.final, now.posterior, now.laws)
    final = beside_parts(final, catalogue, options.exclude)
    final = replace(
        beside_form(final, now.picked),
        notes=(
            *hangs,
            *pushed,
            *jointly,
            *final.notes,
            *forms(final, now.picked),
            *pounds(final),
            *computed(final),
            *([] if pushed else creeping(final, readings)),
            *balancing(final),
            *changed(final, options.seed),
        ),
    )
    noise, inside = linear.noise(found.order), numbers_told(seen, final, readings)
    account = Account(linear, found, seen, inside)
    named, following = _named(now.posterior, final, account, options)
    gap = linear.gap(found.order, noise, held_out=True)
    chance = chance_of_noise(final)
    lacking = chance is not None and chance < LEVEL
    verdict: Outcome = "outside" if lacking else "none"
    if named:
        verdict = "named" if all(item.settled for item in named) else "ambiguous"
    return Explained(
        verdict=verdict,
        findings=named,
        base=base,
        final=final,
        linear=linear,
        steps=account.steps(base),
        families=account.families(),
        springs=account.springs(),
        whole=None if options.only or options.exclude else account.nearer_as_a_whole(),
        dropped=tuple(found.dropped.values()),
        hidden=tuple(effect.id for effect in hidden),
        rigid=tuple(
            effect
            for effect in (*linear.candidates, *hidden)
            if effect.joint_spring and effect.id not in {each.id for each in final.model.effects}
        ),
        remainder=left_beyond_noise(final),
        chance=chance,
        suspects=suspects,
        guess=guess,
        guess_heldout=guessed,
        where=where_it_lives(linear, gap, replace(seen, form=final.form), readings, inside),
        smallest=detectable(linear, found),
        limits=options.limits,
        off_level=hangs,
        probabilities=shared(probabilities(now.posterior, found), named, final),
        following=following,
        readings=readings,
        heldout=None if holdout is None else heldout_on(final, base, holdout),
    )


def _selected(
    base: Calibration, seen: Calibration, options: Options, catalogue: Catalogue
) -> tuple[Linear, Chosen, Laws, tuple[Effect, ...]]:
    """Names about a calibration, each by its best law; all their laws, and what does not show."""
    linear, hidden = linear_at(base, options, catalogue, seen)
    found = choose(linear)
    if seen is not base:  # about the rigid arm near ties are not told
        found = by_likeliest(linear, found)
    laws = laws_at(linear, found.order, seen)
    linear, found = with_fewer(linear, found, laws)
    laws = {e: own for e, own in laws.items() if e in found.order}
    return by_best_laws(linear, found.order, laws), found, laws, hidden


def _about(base: Calibration, readings: Measurements, catalogue: Catalogue) -> Calibration:
    """What causes are first looked for about: the arm with other zeros, where it is far off."""
    if base.placed is None or not base.placed.far_off:
        return base
    robot = base.model.robot
    present = {effect.id for effect in base.model.effects}
    zeros = (JointOffset.at(robot, joint, EffectOptions()) for joint in robot.actuated)
    return refined(base, [e for e in zeros if e.id not in present], readings, None, catalogue)


def _refuse_few_poses(readings: Measurements) -> None:
    """Stop where no other pose can confirm a name.

    Raises:
        InputError: There are too few.
    """
    said, count = readings.absolute, len(readings.masked().poses)
    displaced = said is not None and said.channels.displacements_alone
    fewest = FEWEST_LOADED if displaced else FEWEST
    if count >= fewest:
        return
    alone = "geometry alone comes from 'sk120stiff identify'"
    if displaced:
        alone = "displacements of one point, without turns, are explained from two poses on"
    raise InputError(
        f"{count} poses: no other pose can confirm a name",
        where=readings.place,
        remedy=f"Measure at {fewest} poses or more; {alone}.",
    )


def _named(
    posterior: Posterior, final: Calibration, account: Account, options: Options
) -> tuple[tuple[Named, ...], NextPoses | None]:
    """Every name with what explains as much, and the poses that would tell them apart."""
    linear, rivals = posterior.linear, posterior.names
    candidates = linear.candidates
    there = elsewhere(final, options) if any(own for own, _ in rivals.values()) else None
    named, pairs = [], []
    for e, (own, probability) in rivals.items():
        others = [candidates[c] for c in own]
        exact = never_told(final, there, candidates[e], others) if there and others else ()
        ids = tuple(other.id for other in others)
        gained, share = gain(linear, posterior.chosen, e), account.share(e)
        item = Named(candidates[e], ids, exact, probability, gained, share)
        named.append(or_balancer(item, final))
        pairs += [(candidates[e], other) for other in others if other.id not in exact][:1]
    following = None if there is None else next_poses(final, there, pairs)
    return tuple(named), following
