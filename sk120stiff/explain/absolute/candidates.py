"""What may be missing where positions were read, and how it would show to first order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import (
    Catalogue,
    Effect,
    Elastic,
    Geometric,
    Imposed,
    LinearElastic,
    LoadError,
    ReadingError,
    Situation,
    situation_of,
)
from sk120stiff.explain.absolute.linear import FAINT, Linear
from sk120stiff.explain.options import Options
from sk120stiff.identify import pose_parts
from sk120stiff.identify.absolute.calibrate import Calibration, options_of
from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot

FOLDS = 5
WIDE = 40  # virtual joints in one mechanism: memory and time go with its square
_ONLY_LOADED = ("reading_rotation", "zero_offset", "joint_offset", "link_length")


def candidates_at(
    model_robot: Robot,
    situation: Situation,
    readings: Measurements,
    present: Sequence[str],
    wish: Options,
    catalogue: Catalogue,
) -> tuple[Effect, ...]:
    """Every effect at every place that could show in these positions and is not in the model.

    Errors of joint frames hold those of joint offsets and link lengths.
    """
    told = options_of(readings)
    loaded = bool(readings.wrench.any())
    out = []
    for kind in catalogue:
        if kind.name in _ONLY_LOADED or kind.bends_a_spring:
            continue
        if issubclass(kind, LoadError) and not (loaded or kind.only_absolute):
            continue
        if issubclass(kind, Elastic) and not issubclass(kind, LinearElastic):
            continue
        for where in kind.places(model_robot):
            effect = kind.at(model_robot, where, told)
            named = {effect.id, effect.name}
            if effect.id in present or named & set(wish.exclude):
                continue
            if wish.only and not named & set(wish.only):
                continue
            if effect.parameters and effect.applies_to(situation):
                out.append(effect)
    return tuple(out)


def linear_at(
    found: Calibration, wish: Options, catalogue: Catalogue
) -> tuple[Linear, tuple[Effect, ...]]:
    """Positions linearised at a fitted model, and candidates that do not show in them."""
    problem, model = found.problem, found.fit.model
    readings = problem.measurements
    present = [effect.id for effect in model.effects]
    effects = candidates_at(model.robot, problem.situation, readings, present, wish, catalogue)
    sigma = problem.of_channels.sigma
    Q = np.asarray(np.linalg.qr(found.fit.jacobian)[0])
    shown: list[Effect] = []
    blocks: list[Array] = []
    positive: list[bool] = []
    hidden: list[Effect] = []
    for part in _parts(effects, model.robot):
        wider = model
        for effect in part:
            wider = wider + effect
        slope = replace(problem, model=wider).channel_gap(wider.values, derivative=True)[1]
        first = len(model.parameters)
        for effect in part:
            size = np.array([np.sqrt(s.typical * s.plausible) for s in effect.parameters])
            own = slope[:, first : first + len(size)] * size / sigma[:, None]
            first += len(size)
            before = np.linalg.norm(own, axis=0)
            own = own - Q @ (Q.T @ own)
            own = own - Q @ (Q.T @ own)
            own[:, np.linalg.norm(own, axis=0) <= FAINT * before] = 0.0
            if not own.any():
                hidden.append(effect)
                continue
            shown.append(effect)
            blocks.append(own)
            positive += [spec.lower == 0.0 for spec in effect.parameters]
    ends = np.cumsum([0, *(block.shape[1] for block in blocks)])
    rows = problem.rows
    pose = situation_of(model.robot, readings).pose
    fold = pose_parts(readings, folds=FOLDS, seed=wish.seed)[pose]
    count = len(found.fit.residual)
    linear = Linear(
        residual=found.fit.residual - Q @ (Q.T @ found.fit.residual),
        base=Q,
        columns=np.concatenate(blocks, axis=1) if blocks else np.zeros((count, 0)),
        positive=np.array(positive, dtype=bool),
        candidates=tuple(shown),
        slices=tuple(slice(int(a), int(b)) for a, b in pairwise(ends)),
        row=rows,
        fold=fold[rows],
        stated=found.fit.sigma_known,
    )
    return linear, tuple(hidden)


def _parts(effects: Sequence[Effect], robot: Robot) -> Iterator[list[Effect]]:
    """Effects in groups that make no mechanism too wide."""
    part: list[Effect] = []
    width = 0
    for effect in effects:
        own = 0
        if isinstance(effect, Elastic | Geometric | Imposed):
            own = len(effect.virtual_joints(robot))
        if part and width + own > WIDE:
            yield part
            part, width = [], 0
        part.append(effect)
        width += own
    if part:
        yield part


def family(effect: Effect) -> str:
    """What a cause belongs to, in one word."""
    if isinstance(effect, Elastic):
        return "sag"
    if effect.name in ("transmission_error", "joint_coupling", "approach_side"):
        return "transmission"
    if isinstance(effect, ReadingError):
        return "instrument"
    if isinstance(effect, Imposed):
        return "warmth"
    return "load" if isinstance(effect, LoadError) else "geometry"
