"""Directions of the parameters that readings say nothing or little about, in words."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse.csgraph import connected_components

from sk120stiff.arrays import Array, Index, Mask, rms
from sk120stiff.effects.base import SPRINGS
from sk120stiff.errors import listed, short, two_digits
from sk120stiff.identify.checks.unseen import why_unseen
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.covariance import covariance_of
from sk120stiff.identify.solve.overlaid import Overlay, separating
from sk120stiff.identify.solve.polish import seen_directions
from sk120stiff.identify.written import MOSTLY
from sk120stiff.model import CALIBRATED, Parameter

VAGUE = 0.5  # relative standard error beyond which a value is no knowledge
TOGETHER = 0.95  # correlation beyond which two estimates are said to move together
LINKED = 0.1  # cosine of their parts in null directions that ties two parameters


def weak_directions(fit: Fit) -> tuple[str, ...]:
    """Sentences on what a fit cannot tell apart, hardly knows, or found on a physical bound.

    Parameters that lie on one another while a bound holds some come first, then those that no
    reading shows, those of which only combinations are known,
    those that are strongly correlated, those on a bound, those that are larger than is plausible,
    and single values that are vague.
    """
    said = [sentence for _, sentence in _together(fit)]
    told = {k for overlay in fit.overlays for k in overlay.members}
    told |= {k for group, _ in _null_groups(fit) for k in group}
    said += [_bound(fit, int(k)) for k in np.flatnonzero(fit.at_bound & fit.held)]
    far = (np.abs(fit.x) > fit.problem.plausible) & fit.identifiable
    said += [_implausible(fit.parameters[k]) for k in np.flatnonzero(far)]
    if fit.degrees_of_freedom < 1 and not fit.sigma_known:
        said.append(
            "As many values were estimated as were read, and no uncertainty is stated: "
            "nothing is left to tell how well they are known."
        )
        return tuple(said)
    for k, parameter in enumerate(fit.parameters):
        std = parameter.internal_std
        if std and k not in told and std > VAGUE * abs(parameter.internal):
            share = 100.0 * std / max(abs(parameter.internal), 1e-300)
            low, high = (f"{end:.3g}" for end in fit.intervals()[k])
            said.append(
                f"{parameter.name} is hardly known: its 95 % interval reaches from {low} to {high} "
                f"{parameter.spec.unit} (standard error {share:.0f} %)."
            )
    return tuple(said)


def known_together(fit: Fit, effects: Collection[str]) -> tuple[str, ...]:
    """Sentences on values of some effects that the readings tell together with others alone.

    By the noise of the readings: what other models would make of single values is left out.

    Args:
        fit: A fit of a model with these effects.
        effects: Their ids.
    """
    fit = replace(
        fit, selection_uncertainty=None, left_out=None, omitted=None, foreign=None, parts=None,
        by_form=None,
    )  # fmt: skip
    own = {k for k, each in enumerate(fit.parameters) if each.effect.id in effects}
    return tuple(said for members, said in _together(fit) if len(members) > 1 and members & own)


def _together(fit: Fit) -> Iterator[tuple[set[int], str]]:
    """Parameters of which only combinations are known, or that no reading shows, and sentences."""
    told: set[int] = set()
    for overlay in fit.overlays:
        yield set(overlay.members), overlaid_sentence(fit, overlay)
        told.update(overlay.members)
    for group, size in _null_groups(fit):
        if not told.issuperset(group):
            yield set(group), _unseen(fit, group, size)
            told.update(group)
    for members, sentence in _by_chance(fit):
        yield members, sentence
        told.update(members)
    for own in _correlated(fit):
        if not told.issuperset(own):
            yield set(own), _correlation(fit, *own) if len(own) == 2 else _correlations(fit, own)


def overlaid_sentence(fit: Fit, group: Overlay) -> str:
    """Which parameters lie on one another, what of them is known, and what would separate them."""
    members = [fit.parameters[k] for k in group.members]
    held = [fit.parameters[k] for k in group.held]
    if {p.effect.name for p in members} == {SPRINGS}:
        names = f"the springs of {listed([p.effect.where for p in members])}"
        bound = f"that {listed([p.effect.where for p in held])} came out rigid"
    else:
        names = listed([words_for(p) for p in members])
        bound = f"that {listed([words_for(p) for p in held])} lies on a physical bound"
    low = 100.0 * group.likeness
    return (
        f"In these readings {names} lie on one another (they move the point alike by {low:.3f} % "
        f"or more): {_known_of(fit, group)}, and how it is shared among them is not. The fit gave "
        f"it where the misfit is least by a hair; {bound} is no finding. {_cure(fit, group)}"
    )


def _known_of(fit: Fit, group: Overlay) -> str:
    """The one combination of overlaid parameters that the readings tell, with its uncertainty."""
    own = list(group.members)
    members = [fit.parameters[k] for k in own]
    size = np.linalg.norm(fit.jacobian[:, own], axis=0) / fit.problem.scale[own]
    first = next(i for i, k in enumerate(own) if k not in group.held)
    sign = np.sign(fit.jacobian[:, own].T @ fit.jacobian[:, own[first]])
    ratio = sign * size / size[first]
    weights = np.zeros(len(fit.parameters))
    weights[own] = ratio
    value = float(ratio @ np.array([p.internal for p in members]))
    share = 100.0 * _std_of(fit, weights * fit.problem.scale) / max(abs(value), 1e-300)
    kind = "compliances" if all(p.spec.reciprocal for p in members) else "values"
    terms = [f"{words_for(members[first])}"]
    terms += [
        f"{'+' if r > 0 else '-'} {abs(r):.3g} x {words_for(p)}"
        for i, (p, r) in enumerate(zip(members, ratio, strict=True))
        if i != first
    ]
    return f"one sum of their {kind} is known to {two_digits(share)} % ({' '.join(terms)})"


def _cure(fit: Fit, group: Overlay) -> str:
    """The pose to measure."""
    found = separating(fit.problem, group, fit.jacobian)
    if found is None:
        return (
            "No measured pose with one joint turned separates them; let 'sk120stiff plan' choose."
        )
    robot = fit.problem.model.robot
    slides = robot.prismatic[found.joint]
    position = f"{found.position:.3g} m" if slides else f"{np.degrees(found.position):.0f} deg"
    return (
        f"A pose that separates them: as {found.pose}, with {robot.actuated[found.joint]} at "
        f"{position} and the same load (one such reading makes the largest of their standard "
        f"errors {found.gain:.0f} times smaller)."
    )


def words_for(parameter: Parameter) -> str:
    """A parameter in plain words, e.g. ``base rocking z (base_link)``."""
    what = parameter.effect.name.replace("_", " ")
    detail = parameter.spec.name.removeprefix("stiffness").strip("_").replace("_", " ")
    detail = detail.removeprefix(what.rpartition(" ")[2]).strip()  # force scale y, said once
    return f"{what} {detail} ({parameter.effect.where})".replace("  ", " ")


def _by_chance(fit: Fit) -> Iterator[tuple[set[int], str]]:
    """What draws could take over, were they no draws."""
    if not fit.beforehand.draws.sizes.size:
        return
    alone, known = (
        np.diag(covariance_of(each, fit.held, fit.problem.span))
        for each in (fit.jacobian, _read(fit))
    )
    drawn = {int(k) for group in fit.problem.draws for k in group}
    others = [int(k) for k in np.flatnonzero(alone > MOSTLY * known) if k not in drawn]
    if others:
        sizes = listed([_drawn_size(fit, group) for group in fit.problem.draws])
        names = listed([words_for(fit.parameters[k]) for k in others])
        yield (
            {*drawn, *others},
            f"Each pose's {sizes} could take over what {names} do alike to its readings. Offsets "
            "are taken for chance, about zero and of one size, and the ± of each holds that.",
        )


def _drawn_size(fit: Fit, group: Index) -> str:
    """Draws in words, with their root mean square."""
    parameter = fit.parameters[group[0]]
    size = rms((fit.x * fit.problem.scale)[group])
    unit = parameter.spec.internal_unit
    told = f"{short(1e6 * size)} µm" if unit == "m" else f"{size:.3g} {unit}"
    return f"{parameter.effect.name.replace('_', ' ')} ({told} rms)"


def _read(fit: Fit) -> Array:
    """(R + k, P) the derivative over the noise assumed, and what draws' being draws adds."""
    return np.vstack([fit.jacobian, fit.beforehand.draws.rows()])


def _open_directions(fit: Fit) -> Array:
    """(P, b) orthonormal, parameters over their span: what readings hardly tell, or not at all.

    Hardly is where most of what is known is of calibrations.
    """
    moving = np.flatnonzero(~fit.held)
    span, told, jacobian = fit.problem.span, fit.beforehand.calibrations, _read(fit)
    unseen = seen_directions(jacobian[:, moving], span[moving])[3]
    null = np.zeros((len(span), unseen.shape[1]))
    null[moving] = unseen
    read = np.linalg.norm(jacobian @ (span[:, None] * told.ways), axis=0)
    ways = told.ways[:, (MOSTLY - 1.0) * read**2 < told.sizes**2]
    U, size, _ = np.linalg.svd(ways - null @ (null.T @ ways), full_matrices=False)
    return np.hstack([null, U[:, size > LINKED]])


def _null_groups(fit: Fit) -> Iterator[tuple[list[int], int]]:
    """Sets of parameters that open directions tie, and how many of these each has."""
    moving = np.flatnonzero(~fit.held)
    null = _open_directions(fit)[moving]
    variance = np.diag(covariance_of(_read(fit), fit.held, fit.problem.span))
    shared = np.array([p.origin == CALIBRATED for p in fit.parameters], dtype=bool)
    left = [int(k) for k in np.flatnonzero((np.isinf(variance) | shared)[moving])]
    part = null / np.maximum(np.linalg.norm(null, axis=1, keepdims=True), 1e-300)
    tied = np.abs(part @ part.T) > LINKED
    while left:
        group = [left.pop(0)]
        for member in group:
            joined = [k for k in left if tied[member, k]]
            group += joined
            left = [k for k in left if k not in joined]
        size = int(np.linalg.matrix_rank(part[group], tol=LINKED)) if null.size else 0
        yield [int(moving[k]) for k in sorted(group)], max(size, 1)


def _unseen(fit: Fit, group: Sequence[int], size: int) -> str:
    parameters = [fit.parameters[k] for k in group]
    if len(group) == 1:
        why = why_unseen(fit.problem.load_cases, parameters[0])
        if not why and parameters[0].effect.joint_spring:
            why = "however soft it was, no load turns it by as much as their noise"
        return f"{parameters[0].name} does not show in these readings: " + (
            f"{why}." if why else "no plausible value would change them by a tenth of their noise."
        )
    if size >= len(group):
        return f"{listed([p.name for p in parameters])} cannot be told from the others."
    if len(group) == 2:
        return _pair(fit, group)
    known = len(group) - size
    some = "one combination" if known == 1 else f"{known} of {len(group)} combinations"
    return (
        f"{listed([words_for(p) for p in parameters])} move together: only {some} of their values "
        f"{'is' if known == 1 else 'are'} known." + _of_calibrations(fit, group)
    )


def _of_calibrations(fit: Fit, group: Sequence[int]) -> str:
    """What stands for the open direction of a group that instruments belong to."""
    known = {}
    for k in group if np.any(fit.beforehand.calibrations.ways[list(group)]) else ():
        effect, spec = fit.parameters[k].effect, fit.parameters[k].spec
        if effect.calibrated and fit.identifiable[k]:
            share = spec.unit == "1"
            size = (
                f"{two_digits(100 * spec.usual)} %"
                if share
                else f"{two_digits(spec.usual)} {spec.unit}"
            )
            known[effect.name] = f"{effect.name.replace('_', ' ')} {size}"
    if not known:
        return ""
    return (
        f" The ± of each holds the usual error of a calibration ({listed(list(known.values()))})."
    )


def _pair(fit: Fit, group: Sequence[int]) -> str:
    part = (
        _open_directions(fit)[list(group)]
        * (fit.problem.span * fit.problem.scale)[list(group)][:, None]
    )
    strongest = part[:, int(np.argmax(np.linalg.norm(part, axis=0)))]
    known, value, std = _combination(fit, group, strongest)
    first, second = (fit.parameters[k] for k in group)
    return (
        f"{words_for(first)} and {words_for(second)} move together: only {known} is known, "
        f"{value:.4g} ± {two_digits(std)} {first.spec.internal_unit}."
        + _of_calibrations(fit, group)
    )


def _combination(fit: Fit, group: Sequence[int], null: Array) -> tuple[str, float, float]:
    """What stays the same along a null direction (2,) of two internal values, in words."""
    first, second = (fit.parameters[k] for k in group)
    ratio = float(-null[0] / null[1])  # first + ratio · second is invariant
    kind = "compliances" if first.spec.reciprocal and second.spec.reciprocal else "values"
    if abs(ratio - 1.0) < 0.05:
        known, ratio = f"the sum of their {kind}", 1.0
    elif abs(ratio + 1.0) < 0.05:
        known, ratio = f"the difference of their {kind}", -1.0
    else:
        known = f"the first of their {kind} {'+' if ratio > 0 else '-'} {abs(ratio):.3g} times"
        known += " the second"
    weights = np.zeros(len(fit.parameters))
    weights[list(group)] = (1.0, ratio)
    values = np.array([p.internal for p in fit.parameters])
    return known, float(weights @ values), _std_of(fit, weights * fit.problem.scale)


def _std_of(fit: Fit, weights: Array) -> float:
    """Standard error of a combination (P,) of scaled parameters, along what is seen."""
    moving = np.flatnonzero(~fit.held)
    span = fit.problem.span[moving]
    _, singular, V, _ = seen_directions(_read(fit)[:, moving], span)
    return float(np.linalg.norm((V.T @ (weights[moving] * span)) / singular)) * fit.unit


def _correlated(fit: Fit) -> list[tuple[int, ...]]:
    """Sets of estimates that strong correlations tie."""
    known = np.isfinite(np.diag(fit.covariance)) & ~fit.held
    tied: Mask = (np.abs(fit.correlation) > TOGETHER) & np.outer(known, known)
    count, member = connected_components(tied, directed=False)
    groups = (np.flatnonzero(member == number) for number in range(count))
    return [tuple(map(int, own)) for own in groups if len(own) > 1]


def _correlations(fit: Fit, group: Sequence[int]) -> str:
    """One common factor, as a rule: every pair of many would say the same."""
    names = listed([words_for(fit.parameters[k]) for k in group])
    return (
        f"{names} move together (correlations beyond {TOGETHER:g}): combinations of them are known "
        "far better than each alone." + _of_calibrations(fit, group)
    )


def _correlation(fit: Fit, first: int, second: int) -> str:
    covariance = fit.covariance[np.ix_([first, second], [first, second])]
    scale = fit.problem.scale[[first, second]]
    weakest = np.linalg.eigh(fit.correlation[np.ix_([first, second], [first, second])])[1][:, 1]
    direction = weakest * np.sqrt(np.diag(covariance)) * scale
    known, value, std = _combination(fit, (first, second), direction)
    share = 100.0 * std / max(abs(value), 1e-300)
    return (
        f"{words_for(fit.parameters[first])} and {words_for(fit.parameters[second])} move together "
        f"(correlation {fit.correlation[first, second]:.3f}): {known} is known to "
        f"{two_digits(share)} %, each alone much less."
    )


def _bound(fit: Fit, k: int) -> str:
    parameter = fit.parameters[k]
    low, high = fit.intervals()[k]
    unit = parameter.spec.unit
    if parameter.spec.reciprocal:
        return (
            f"{parameter.name} lies on its physical bound: rigid fits best; with 95 % it is "
            f"stiffer than {low:.3g} {unit}."
        )
    return (
        f"{parameter.name} lies on its physical bound; its 95 % interval reaches from {low:.3g} to "
        f"{high:.3g} {unit}."
    )


def _implausible(parameter: Parameter) -> str:
    spec = parameter.spec
    limit = abs(spec.public(spec.plausible))
    than = "softer" if spec.reciprocal else "larger"
    return (
        f"{parameter.name} is {than} than is plausible ({parameter.value:.3g}, limit "
        f"{limit:.3g} {spec.unit}): it fits, but it explains nothing."
    )
