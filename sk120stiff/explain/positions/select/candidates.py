"""What may be missing where positions were read, and how it would show to first order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import (
    Catalogue,
    Effect,
    Elastic,
    Imposed,
    LoadCases,
    LoadError,
    ReadingError,
    Weighing,
    load_cases_of,
    referred,
)
from sk120stiff.effects.geometry import JointOffset
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.explain.options import Options
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify import pose_parts
from sk120stiff.identify.checks.left_over import beside
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.nuisances import frames_off
from sk120stiff.identify.positions.omitted.other_causes import causes_at, slopes
from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot

FOLDS = 5  # parts in which poses are left out, as is usual
LIKE = 1.5  # times the errors of frames that were told, to be expected of others
FAR = 5.0  # times the usual size of a frame's error or a zero's, beyond which it is as was found
ALIKE = 1.0 - 1e-6  # of the most that a law takes off, from where on the usual one does as well
COMPLIANCE = "compliance"  # the family of all that yields


def candidates_at(
    model_robot: Robot,
    load_cases: LoadCases,
    readings: Measurements,
    present: Sequence[str],
    options: Options,
    catalogue: Catalogue,
) -> tuple[Effect, ...]:
    """Those causes that may be at work beside those `present`, and that are wanted."""
    every = causes_at(model_robot, load_cases, readings, present, catalogue)
    return tuple(
        effect
        for effect in every
        if not {effect.id, effect.name} & set(options.exclude)
        and (not options.only or {effect.id, effect.name} & set(options.only))
    )


def linear_at(
    base: Calibration, options: Options, catalogue: Catalogue, at: Calibration | None = None
) -> tuple[Linear, tuple[Effect, ...]]:
    """Positions linearised, and candidates that do not show in them.

    Args:
        base: The calibration beside which candidates are judged.
        options: Which candidates are wanted.
        catalogue: Where they come from.
        at: A calibration with some of the candidates, about which to linearise: sag and errors of
            geometry together are more than their sum. None: about the base.
    """
    seen = at or base
    problem, model = seen.problem, seen.model
    readings = problem.measurements
    present = [effect.id for effect in base.model.effects]
    effects = candidates_at(model.robot, problem.load_cases, readings, present, options, catalogue)
    white = problem.of_channels.apply
    residual = seen.residual
    own = [k for k, p in enumerate(seen.parameters) if p.effect.id in present]
    Q = np.asarray(np.linalg.qr(seen.jacobian[:, own])[0])
    fitted = {effect.id: effect for effect in model.effects if effect.id not in present}
    references = base.problem.load_cases.references
    effects = tuple(  # by the law it was given
        fitted.get(effect.id, referred(effect, references)) for effect in effects
    )
    laws: dict[Effect, tuple[Effect, ...]] = {
        each: (each, *each.laws_at_positions(problem.load_cases))
        for each in effects if each.id not in fitted
    }  # fmt: skip
    apart = [law for each in effects if each.id not in fitted for law in laws[each]]
    found = slopes(problem, model, apart)
    effects = tuple(
        _likeliest(laws[each], found, seen) if each in laws else each for each in effects
    )
    if fitted:
        slope = problem.channel_gap(model.values, derivative=True)[1]
        for effect in fitted.values():
            columns = [k for k, p in enumerate(model.parameters) if p.effect == effect]
            found[effect] = slope[:, columns]
            residual = residual + white(found[effect] @ model.values[columns])
    off = frames_off(model)
    known = {p.name: p.internal for p in model.parameters}
    shown: list[Effect] = []
    sizes: list[Array] = []
    blocks: list[Array] = []
    positive: list[bool] = []
    hidden: list[Effect] = []
    for effect in effects:
        size = usual_sizes(effect, off)
        if isinstance(effect, JointFrame | JointOffset) and effect.id in fitted:
            far = np.abs([known[f"{effect.id}.{spec.name}"] for spec in effect.parameters])
            size = np.where(far > FAR * size, far, size)
        block = beside(Q, white(found[effect] * size))
        if not block.any():
            hidden.append(effect)
            continue
        shown.append(effect)
        sizes.append(size)
        blocks.append(block)
        positive += [spec.lower == 0.0 for spec in effect.parameters]
    ends = np.cumsum([0, *(block.shape[1] for block in blocks)])
    rows = problem.rows
    pose = load_cases_of(model.robot, readings).pose
    fold = pose_parts(readings, folds=FOLDS, seed=options.seed)[pose]
    linear = Linear(
        residual=residual - Q @ (Q.T @ residual),
        base=Q,
        columns=np.concatenate(blocks, axis=1) if blocks else np.zeros((len(residual), 0)),
        positive=np.array(positive, dtype=bool),
        candidates=tuple(shown),
        sizes=np.concatenate(sizes) if sizes else np.zeros(0),
        slices=tuple(slice(int(a), int(b)) for a, b in pairwise(ends)),
        row=rows,
        fold=fold[rows],
        stated=seen.sigma_known,
        seen=tuple(e for e, each in enumerate(shown) if each.id in fitted),
    )
    return linear, tuple(hidden)


def _likeliest(laws: Sequence[Effect], found: Mapping[Effect, Array], seen: Calibration) -> Effect:
    """The law that takes most off what is left beside all that was fitted; the first of equals.

    A load that is misread in axes of the base shows little of an error in axes of the tool.
    """
    if len(laws) == 1:
        return laws[0]
    Q = np.asarray(np.linalg.qr(seen.jacobian)[0])
    white = seen.problem.of_channels.apply

    def takes_off(law: Effect) -> float:
        own = beside(Q, white(found[law] * [s.usual for s in law.parameters]))
        shown = own[:, own.any(axis=0)]
        return float(np.sum((np.linalg.qr(shown)[0].T @ seen.residual) ** 2))

    taken = {law: takes_off(law) for law in laws}
    return next(law for law in laws if taken[law] >= ALIKE * max(taken.values()))


def usual_sizes(effect: Effect, frames: Mapping[str, float]) -> Array:
    """(p,) standard sizes that parameters have before anything is read.

    Frames of one arm are off by much the same: where some were told, by unit in `frames`, the
    others are expected to be as those.
    """
    usual = [s.usual for s in effect.parameters]
    if isinstance(effect, JointFrame):
        least = [s.typical for s in effect.parameters]
        usual = [
            min(size, max(LIKE * frames.get(s.unit, size), low))
            for size, low, s in zip(usual, least, effect.parameters, strict=True)
        ]
    return np.array(usual)


def family(effect: Effect) -> str:
    """What a cause belongs to, in one word."""
    if effect.of_transmission:
        return "transmission"
    if isinstance(effect, Elastic):
        return COMPLIANCE
    if isinstance(effect, ReadingError):
        return "instrument"
    if isinstance(effect, Imposed):
        return "warmth"
    return "load" if isinstance(effect, LoadError | Weighing) else "geometry"
