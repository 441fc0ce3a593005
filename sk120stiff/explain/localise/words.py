"""Where a gap lives, in plain sentences with numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sk120stiff.errors import listed, micro
from sk120stiff.explain.localise.localisation import LEVEL, Localisation, Suspicion
from sk120stiff.explain.localise.suspects import CLOCKS, comes_and_goes
from sk120stiff.identify.checks.lack_of_fit import chance

CLOSE = 6.0  # evidence by which a suspect must lead, or others are named beside it
WHOLE = 0.9  # share of the excess that leaves nothing worth a search
LITTLE = 0.3  # share of the excess below which the strongest suspect is no explanation
HARDLY = 0.02  # share of the excess that higher orders of the strongest suspect may leave
WORTH_SAYING = 0.1  # share of the gap below which a place is not worth a sentence
ORIGINS = {
    "scatter": ", as found from the scatter within poses",
    "computed": ", the finest that instruments read",
    "repeats": ", as found from repeats",
}
TWICE = 2.0  # times the noise, beyond which a gap is not called as large as it
MANY_POSES = 5  # more than this carry no longer a short list


def where_sentences(found: Localisation) -> tuple[str, ...]:
    """What a localisation says, most important first."""
    if not found.real:
        return (_size(found), *_nothing(found))
    return (
        _size(found),
        *_strongest(found),
        *_poses(found),
        *_loads(found),
        *_directions(found),
        *_postures(found),
        *_series(found),
    )


def _size(found: Localisation) -> str:
    gap = f"The base model misses the readings by {microns(found.rms)} rms per axis"
    if found.noise is None or found.probability is None:
        return (
            f"{gap}. Nothing tells how large the noise is, so its size alone proves nothing, and "
            "shares are of the gap itself, noise included."
        )
    noise = microns(found.noise)
    origin = ORIGINS.get(found.noise_from, "")
    if found.probability >= LEVEL:
        also = ", yet part of it goes with something" if found.strongest else ""
        if found.rms > TWICE * found.noise:
            return (
                f"{gap}; the noise alone makes about {noise}{origin}, and what it is more may all "
                f"be chance from pose to pose ({chance(found.probability)}){also}."
            )
        return (
            f"{gap}; the noise alone makes about {noise}{origin}, so as a whole it is no more than "
            f"noise ({chance(found.probability)}){also}."
        )
    times = found.rms / found.noise
    return (
        f"{gap}, {times:.1f} times what the noise alone makes ({noise}{origin}; "
        f"{chance(found.probability)})."
    )


def _nothing(found: Localisation) -> Iterator[str]:
    if found.suspects:
        best = found.suspects[0]
        yield (
            f"Nothing stands out among {len(found.suspects)} suspects: even the strongest, "
            f"{best.name}, is what chance brings in so many looks ({chance(best.probability)})."
        )


def _strongest(found: Localisation) -> Iterator[str]:
    best = found.strongest
    if best is None:
        yield (
            f"It goes with none of {len(found.suspects)} suspects: joints, links, base, tool, "
            "axes, instruments, order."
        )
        return
    of = _whole(found)
    if best.explained < LITTLE * found.beyond:
        yield (
            f"It goes closely with none of {len(found.suspects)} suspects: the strongest, "
            f"{best.name}, takes away {_percent(best.explained)} of {of} "
            f"({chance(best.probability)})."
        )
        return
    degrees = "degree" if best.freedom == 1 else "degrees"
    yield (
        f"It goes most closely with {best.name}: that takes away {_percent(best.explained)} of "
        f"{of} (T = {best.statistic:.0f} on {best.freedom} {degrees} of freedom, "
        f"{chance(best.probability)} after {len(found.suspects)} looks)."
    )
    rest = [s for s in found.suspects[1:] if s.seen]
    close = [s for s in rest if best.evidence - s.evidence < CLOSE]
    if close:
        yield f"As well as that fits {listed([s.name for s in close[:3]], 'or')}."
    elif rest:
        share = _percent(rest[0].explained)
        yield f"The next best in its place, {rest[0].name}, takes away {share}."
    yield from _as_place(found, [best, *close, *rest[:1]])
    second = found.beside[0] if found.beside else None
    if second is not None and second.seen and second.explained > HARDLY:
        yield (
            f"That is not all: what remains goes with {second.name}, which takes away another "
            f"{_percent(second.explained)}."
        )
    elif best.explained > WHOLE * found.beyond:
        yield "Of the rest nothing goes with a single suspect as closely."


def _whole(found: Localisation) -> str:
    """What shares are shares of, in words."""
    if found.whole == "excess":
        return "what exceeds the noise"
    return "the gap" if found.noise is None else "the gap, which is mostly noise"


def _as_place(found: Localisation, named: Sequence[Suspicion]) -> Iterator[str]:
    """If it is something that yields, where it would sit best."""
    place = found.best_of("place")
    if place is None or not place.seen or place.explained < WORTH_SAYING:
        return
    if any(s.family == "place" for s in named):
        return
    yield (
        f"Were it something that yields, it would fit best with {place.name} "
        f"({_percent(place.explained)})."
    )


def _poses(found: Localisation) -> Iterator[str]:
    if found.whole == "gap":
        yield from _poses_of_the_gap(found)
        return
    seen = [pose for pose in found.poses if pose.probability < LEVEL]
    ranked = sorted(seen, key=lambda pose: -pose.share)
    if not ranked:
        if len(found.poses) > 1:
            yield "No single pose shows it beyond doubt; it shows only in all of them together."
        return
    top, carried = 0, 0.0
    while top < len(ranked) and carried < 0.5:
        carried += ranked[top].share
        top += 1
    worst = f"a gap of {microns(ranked[0].rms)} rms"
    if carried < 0.5 or top > min(MANY_POSES, len(found.poses) // 2):
        lead = f"It shows at {len(ranked)} of {len(found.poses)} poses"
        yield f"{lead}; the worst, {ranked[0].label}, has {worst}."
    elif top == 1:
        share = _percent(min(carried, 1.0))
        yield f"Pose {ranked[0].label} alone carries {share} of it, with {worst}."
    else:
        named = listed([pose.label for pose in ranked[:top]])
        yield (
            f"Poses {named} carry {_percent(carried)} of it; the worst, {ranked[0].label}, has "
            f"{worst}."
        )


def _poses_of_the_gap(found: Localisation) -> Iterator[str]:
    """The same where shares are of the gap itself: poses that stand out from the others."""
    if len(found.poses) < 2:
        return
    ranked = sorted(found.poses, key=lambda pose: -pose.share)
    out = [pose for pose in ranked if pose.probability < LEVEL]
    worst = out[0] if out else ranked[0]
    carries = (
        f"carries {_percent(worst.share)} of the gap's square with {microns(worst.rms)} rms; "
        f"an even share of {len(ranked)} poses is {_percent(1.0 / len(ranked))}"
    )
    if not out:
        yield f"No pose stands out from the others: the worst, {worst.label}, {carries}."
    elif len(out) == 1:
        yield f"Pose {worst.label} stands out from the others: it {carries}."
    else:
        yield f"{len(out)} poses stand out from the others; the worst, {worst.label}, {carries}."


def _loads(found: Localisation) -> Iterator[str]:
    if len(found.levels) == 3:
        low, _, high = found.levels
        grows = high.rms > 1.25 * low.rms
        how = "It grows with the load" if grows else "It hardly grows with the load"
        yield (
            f"{how}: {microns(low.rms)} rms at loads up to {low.high:.0f} N, "
            f"{microns(high.rms)} from {high.low:.0f} N on."
        )
    if found.whole == "gap":
        yield "What of it is in proportion to the load and what is not, these readings do not tell."
        return
    tested = {o.name: o for o in found.orders if o.probability is not None}
    seen = {name: o for name, o in tested.items() if (o.probability or 0.0) < LEVEL}
    if "linear" in seen and set(tested) == {"linear"}:
        yield "No pose has readings enough to tell what is linear in the load from what is not."
        return
    if "linear" in seen:
        line = f"Within a pose {_percent(seen['linear'].share)} of it is in proportion to the load"
        others = [o for o in (seen.get("constant"), seen.get("curved")) if o is not None]
        if not others:
            yield f"{line}, as with anything that yields like a spring."
            return
        bent = listed([f"{_percent(o.share)} is {o.name}" for o in others])
        yield f"{line}; {bent}, which no plain spring makes."
    elif seen:
        bent = listed([f"{_percent(o.share)} of it is {o.name}" for o in seen.values()])
        yield f"Within a pose {bent}, which no plain spring makes."
    elif found.orders:
        yield "Within a pose it is neither linear nor constant nor curved in the load beyond doubt."


def _directions(found: Localisation) -> Iterator[str]:
    # where two axes say the same, the plainer one speaks
    order = {"arm plane": 0, "world": 1, "forearm": 2, "tool": 3}
    ranked = sorted(found.directions, key=lambda d: (-round(d.share, 1), order.get(d.axes, 9)))
    if not ranked:
        return
    best = ranked[0]
    if best.share < 0.5:
        yield "It has no single direction in axes of base, arm's plane, forearm or tool."
        return
    plain = {
        "outwards": "outwards, away from the first axis",
        "sideways": "sideways, out of the arm's plane",
    }
    word = best.word if best.word.startswith(("along", "across")) else f"along {best.word}"
    yield f"{_percent(best.share)} of it points {plain.get(best.word, word)}."


def _postures(found: Localisation) -> Iterator[str]:
    for trend in found.postures[:1]:
        if trend.probability < LEVEL:
            yield (
                f"It goes with {trend.name}: {microns(trend.low)} rms at the lower half of the "
                f"poses, {microns(trend.high)} at the upper ({chance(trend.probability)})."
            )


def _series(found: Localisation) -> Iterator[str]:
    """Order, time and branch: what a sceptic asks first, so their absence is told too."""
    series = [s for s in (found.beside or found.suspects) if s.family == "series"]
    wander = any(s.seen and comes_and_goes(s.name) for s in (*found.suspects[:1], *series))
    clear = [
        s.name
        for s in series
        if not s.seen
        and not s.name.startswith("a constant")
        and not comes_and_goes(s.name)
        and not (wander and s.name in CLOCKS)
    ]
    if clear:
        beside = " beside that" if found.beside else ""
        yield f"It does not go with {listed(clear, 'or')}{beside}."


def microns(metres: float) -> str:
    """A length in micrometres with its unit: three digits, none after the point from 100 on."""
    return f"{micro(metres)} µm"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"
