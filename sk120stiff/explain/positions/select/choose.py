"""Which causes positions ask for: in and out one by one by evidence, confirmed at other poses."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import Effect, Elastic
from sk120stiff.effects.geometry import JointOffset
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.explain.positions.select.linear import Linear

CLEAR = 3.0  # logarithm of odds beyond those of one among all candidates
USUAL = 2.0  # logarithm of odds of what every arm has: frames a little off, joints that yield
MENTION = (
    1.1  # logarithm of odds (3) up to which evidence is worth a mention alone, Kass & Raftery 1995
)
RIVAL = 3.0  # loss of evidence at which another cause explains as much
SHARE = 0.003  # of the held-out gap that a cause must take off to be named on top of others
SURE = 2.5  # standard errors of the held-out gain over poses
SURE_OF_USUAL = 1.0  # the same of what every arm has, and of what is beyond doubt
BEYOND_DOUBT = 20.0  # logarithm of the evidence
MOST = 40  # causes of one answer, where the poses do not stop it before


@dataclass(frozen=True)
class Chosen:
    """A set of candidates and how it came about.

    Attributes:
        order: Candidates in the order in which they joined.
        dropped: Candidate → why it fitted and is not named.
    """

    order: tuple[int, ...]
    dropped: dict[int, str]


@dataclass(frozen=True)
class Gain:
    """What a cause takes off the held-out squares beside the others, per pose.

    Attributes:
        share: Relative fall of the rms gap.
        errors: The gain in its standard errors over poses.
        folds: Parts in which the gap falls.
        evidence: Logarithm of the evidence that it brings, at the poses that were fitted.
        expected: Every arm has it.
    """

    share: float
    errors: float
    folds: int
    evidence: float = 0.0
    expected: bool = False


def choose(linear: Linear) -> Chosen:
    """Forward by evidence, backward as the picture changes, then confirmed at poses left out.

    Each is confirmed as it joins. What only others yet to come would confirm, for they hide it at
    poses left out, is confirmed among all of them in a second search, whose answer counts where it
    explains more.
    """
    chosen, dropped = _searched(linear, at_once=True)
    if dropped:
        others, fallen = _searched(linear, at_once=False)
        before, after = linear.noise(chosen), linear.noise(others)
        noise = min(before, after)
        gained = linear.score(others, noise) - linear.score(chosen, noise)
        left = linear.left_out(chosen, before)
        if gained > threshold(linear) and linear.left_out(others, after) < left:
            chosen, dropped = others, fallen
    return Chosen(_beside_frames(linear, _zeros(linear, chosen, dropped.keys()), dropped), dropped)


def by_likeliest(linear: Linear, found: Chosen) -> Chosen:
    """Each name by the likeliest in its place, where poses left out agree.

    What took most off the large gap at the start may be the less likely one in the end.
    """
    frames, chosen = set(frames_of(linear)), found.order
    for e in [e for e in chosen if e not in frames]:
        noise, rest = linear.noise(chosen), linear.less(chosen, e)
        if len(rest) < len(chosen) - 1:
            continue  # others rest on it
        others = {e, *(set(linear.may_join(rest)) - {*rest, *found.dropped})}
        odds = {c: linear.score((*rest, c), noise) + usual(linear.candidates[c]) for c in others}
        best = max(others, key=lambda c: odds[c])
        other = tuple(best if c == e else c for c in chosen)
        if odds[best] > odds[e] + MENTION and confirmed(gain(linear, other, best), linear):
            chosen = other
    return Chosen(chosen, found.dropped)


def nothing_named(linear: Linear, found: Chosen) -> Chosen:
    """No name, and why: what is left is no noise, and as likely brings all of it."""
    dropped = dict(found.dropped)
    for e in found.order:
        dropped[e] = (
            f"{linear.candidates[e].id} fits, and at poses left out takes off "
            f"{100 * gain(linear, found.order, e).share:.1f} % of the gap; but what is left is no "
            "noise, and an unknown cause of that size may bring as much."
        )
    return Chosen((), dropped)


def _searched(linear: Linear, *, at_once: bool) -> tuple[tuple[int, ...], dict[int, str]]:
    """Candidates that joined and were confirmed, as they joined or all at the end; the others."""
    chosen: tuple[int, ...] = ()
    dropped: dict[int, str] = {}
    least = threshold(linear)
    seen: set[frozenset[int]] = set()
    stuck = False  # what joins one by one is given up again
    while len(chosen) < MOST:
        best = _next(linear, chosen, dropped.keys(), at_once=stuck)
        if not best:
            break
        before = chosen
        chosen = _backward(linear, _plainer(linear, (*chosen, *best)), least)
        if frozenset(chosen) in seen:
            if stuck:
                break
            chosen, stuck = before, True
            continue
        stuck = False
        seen.add(frozenset(chosen))
        for e in best if at_once else ():
            gained = gain(linear, chosen, e) if e in chosen else None
            if gained is not None and not confirmed(gained, linear):
                why = (
                    f"fits, but at poses left out it takes off no more than "
                    f"{100 * gained.share:.1f} % of the gap ({gained.errors:.1f} standard errors)."
                )
                chosen = _without(linear, chosen, e, why, dropped)
    for e in list(chosen):
        if e in chosen and not confirmed(gain(linear, chosen, e), linear):
            chosen = _without(linear, chosen, e, "is not confirmed by poses left out.", dropped)
    return chosen, dropped


def _next(
    linear: Linear, chosen: tuple[int, ...], dropped: Set[int], *, at_once: bool
) -> tuple[int, ...]:
    """What joins best, one by one where that explains more, or all of a kind; nothing: ()."""
    before = linear.noise(chosen)
    now, least = linear.score(chosen, before), threshold(linear)

    def best(steps: list[tuple[int, ...]], noise: float | None) -> tuple[int, ...]:
        tried = {}
        for step in steps:
            if not dropped & set(step):
                own = noise or linear.noise((*chosen, *step))
                likely = sum(usual(linear.candidates[e]) for e in step)
                tried[step] = linear.score((*chosen, *step), own) + likely - least * len(step)
        found = max(tried, key=lambda step: tried[step], default=())
        return found if found and tried[found] >= now else ()

    alone = () if at_once else best(_steps(linear, chosen), before)
    return alone or best(_together(linear, chosen), None)


def _without(
    linear: Linear, chosen: tuple[int, ...], e: int, why: str, dropped: dict[int, str]
) -> tuple[int, ...]:
    """The chosen without one and what bends it, the reasons told."""
    rest = linear.less(chosen, e)
    own = linear.candidates[e].id
    for gone in set(chosen) - set(rest):
        bends = f"bends {own}, which is not confirmed by poses left out."
        dropped[gone] = f"{linear.candidates[gone].id} {why if gone == e else bends}"
    return rest


def _steps(linear: Linear, chosen: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Candidates that may join next: one by one, and what bends a spring together with it."""
    pairs = ((s, e) for e, s in linear.bent.items() if not {s, e} & set(chosen))
    return [*((e,) for e in linear.may_join(chosen)), *pairs]


def _together(linear: Linear, chosen: tuple[int, ...]) -> list[tuple[int, ...]]:
    """What every arm has, all at once: of few numbers each alone explains too little to join."""
    frames = tuple(f for f in frames_of(linear) if f not in chosen)
    every = enumerate(linear.candidates)
    springs = tuple(e for e, effect in every if effect.joint_spring and e not in chosen)
    return [step for step in (frames, springs, (*frames, *springs)) if len(step) > 1]


def _zeros(linear: Linear, chosen: tuple[int, ...], dropped: Set[int]) -> tuple[int, ...]:
    """A joint's zero in the place of a frame, where it is the likelier and poses left out agree.

    Beside the large gap at the start six numbers may take off more than one; in the end one tells.
    """
    zeros = [e for e, effect in enumerate(linear.candidates) if isinstance(effect, JointOffset)]
    for e in [frame for frame in frames_of(linear) if frame in chosen]:
        noise, rest = linear.noise(chosen), linear.less(chosen, e)
        others = {z: linear.score((*rest, z), noise) for z in zeros if z not in {*chosen, *dropped}}
        best = max(others, key=lambda z: others[z], default=e)
        if best == e or others[best] < linear.score(chosen, noise):
            continue
        other = tuple(best if c == e else c for c in chosen)
        if confirmed(gain(linear, other, best), linear):
            chosen = other
    return chosen


def _beside_frames(
    linear: Linear, chosen: tuple[int, ...], dropped: dict[int, str]
) -> tuple[int, ...]:
    """Without causes that explain nothing beside errors of all joint frames.

    Where one frame is off, so are the others, each by too little to ask for six parameters of its
    own; a single one elsewhere may then stand for several of them, as a tracker that misreads the
    scale does for an arm that is longer in every link. A joint's zero all frames together explain
    whatever it is: one that is larger than frames are off as a rule is a cause of its own.
    """
    frames = frames_of(linear)
    if not set(frames) & set(chosen):
        return chosen
    for e in [e for e in chosen if usual(linear.candidates[e]) <= 0.0]:
        if _larger_than_of_a_frame(linear, chosen, e):
            continue
        noise = linear.noise(chosen)
        rest = linear.less(chosen, e)
        wide = tuple(dict.fromkeys((*rest, *frames)))
        if linear.score((*wide, e), noise) - linear.score(wide, noise) >= CLEAR:
            continue
        dropped[e] = (
            f"{linear.candidates[e].id} fits, but explains nothing that small errors of the other "
            "joints' frames do not explain as well."
        )
        chosen, now = rest, linear.score(rest, noise)
        while more := [f for f in frames if f not in chosen]:
            score, best = max((linear.score((*chosen, f), noise), f) for f in more)
            if score <= now:
                break
            chosen, now = (*chosen, best), score
    return chosen


def _larger_than_of_a_frame(linear: Linear, chosen: tuple[int, ...], e: int) -> bool:
    """Is a cause the zero of a joint, and off by more than what is typical of a frame?"""
    zero = linear.candidates[e]
    if not isinstance(zero, JointOffset):
        return False
    (spec,) = zero.parameters
    frames = (linear.candidates[f] for f in frames_of(linear))
    typical = [s.typical for frame in frames for s in frame.parameters if s.unit == spec.unit]
    value = linear.values(chosen, linear.noise(chosen))[f"{zero.id}.{spec.name}"]
    return abs(value) > max(typical)


def frames_of(linear: Linear) -> list[int]:
    """Candidates that are frames of joints."""
    return [e for e, effect in enumerate(linear.candidates) if isinstance(effect, JointFrame)]


def threshold(linear: Linear) -> float:
    """Logarithm of the odds that a name must bring, one among all candidates."""
    return CLEAR + float(np.log(max(len(linear.candidates), 1)))


def entry_price(linear: Linear, e: int) -> float:
    """Evidence that a candidate must bring to join."""
    return threshold(linear) - usual(linear.candidates[e])


def usual(effect: Effect) -> float:
    """Logarithm of the odds of meeting a cause, over those of one as good as any."""
    if effect.joint_spring or isinstance(effect, JointFrame):
        return USUAL
    return -USUAL if effect.rare else 0.0


def _plainer(linear: Linear, chosen: tuple[int, ...]) -> tuple[int, ...]:
    """Springs of joints in the place of other parts that yield, where they explain as much.

    Under weight alone a bearing that tilts, a bent link and the spring of the next joint are often
    one; the spring is there in any case.
    """
    springs = [e for e, effect in enumerate(linear.candidates) if effect.joint_spring]
    for e in chosen:
        effect = linear.candidates[e]
        if effect.joint_spring or not isinstance(effect, Elastic):
            continue
        noise = linear.noise(chosen)
        aim = linear.score(chosen, noise) - RIVAL
        tried = linear.less(chosen, e)
        while rest := [s for s in springs if s not in tried]:
            score, best = max((linear.score((*tried, s), noise), s) for s in rest)
            tried = (*tried, best)
            if score >= aim:
                chosen = tried
                break
    return chosen


def confirmed(gained: Gain, linear: Linear) -> bool:
    """Do poses left out bear a name out?

    Less is asked of what every arm has, and of what is beyond doubt otherwise: a wave of a joint
    that few poses turn is all in these, and a few gaps tell little of their scatter.
    """
    sure = SURE_OF_USUAL if gained.expected or gained.evidence > BEYOND_DOUBT else SURE
    folds = 3 if gained.expected else 4
    return (
        gained.share > SHARE and gained.errors > sure and gained.folds >= min(folds, linear.folds)
    )


def _backward(linear: Linear, chosen: tuple[int, ...], least: float) -> tuple[int, ...]:
    """Without what the others make needless, and without parts that had to be rigid."""
    while len(chosen) > 1:
        noise = linear.noise(chosen)
        whole = linear.score(chosen, noise)
        lost = {
            e: whole - linear.score(linear.less(chosen, e), noise) + usual(linear.candidates[e])
            for e in chosen
        }
        weakest = min(lost, key=lambda e: lost[e])
        if lost[weakest] >= least:
            return chosen
        chosen = linear.less(chosen, weakest)
    return chosen


def gain(linear: Linear, chosen: tuple[int, ...], e: int) -> Gain:
    """What one of the chosen takes off at poses left out.

    Squares fall by 2 a d + d², where a is left and d was taken off; the error is that of the first
    term. That d differs from pose to pose, with some that show the cause best, is no doubt of it.
    """
    after, before = (
        linear.gap(each, linear.noise(each), held_out=True)
        for each in (chosen, linear.less(chosen, e))
    )
    taken = before - after
    saved = (2.0 * after + taken) * taken
    error = 2.0 * float(np.linalg.norm(np.bincount(linear.row, after * taken)))
    per_fold = [float(saved[linear.fold == f].sum()) for f in range(linear.folds)]
    left, noise = float(after @ after), linear.noise(chosen)
    return Gain(
        share=1.0 - float(np.sqrt(left / (left + saved.sum()))),
        errors=float(saved.sum()) / max(error, 1e-300),
        folds=sum(saved_there > 0.0 for saved_there in per_fold),
        evidence=linear.score(chosen, noise) - linear.score(linear.less(chosen, e), noise),
        expected=usual(linear.candidates[e]) > 0.0,
    )


def lengths(gap: Array, linear: Linear, whole: Mask) -> Array:
    """(K,) distances [m] of rows whose three coordinates were read, from the gap (M,) [m]."""
    square = np.bincount(linear.row[whole], gap[whole] ** 2)
    count = np.bincount(linear.row[whole])
    return np.asarray(np.sqrt(square[count == 3]))
