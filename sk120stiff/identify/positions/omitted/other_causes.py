"""What else may be at work beside a calibration: which causes, and how each would show."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import (
    Catalogue,
    Effect,
    Elastic,
    LinearElastic,
    LoadCases,
    LoadError,
)
from sk120stiff.effects.base import Moving
from sk120stiff.effects.gear import GearHardening, LostMotion
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.identify.positions.solve.start import options_of
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, Parameter
from sk120stiff.robot import Robot

WIDE = 40  # virtual joints in one mechanism: memory and time go with its square
_SHOWN_BY_WEIGHT = (LinearElastic, LostMotion, GearHardening)
_ONLY_LOADED = ("zero_offset", "link_length")
_BESIDE_FRAME = "reading_rotation"  # of displacements alone; positions have a frame for it


def causes_at(
    model_robot: Robot,
    load_cases: LoadCases,
    readings: Measurements,
    present: Sequence[str],
    catalogue: Catalogue,
) -> tuple[Effect, ...]:
    """Every effect at every place that could show in these positions and is not `present`.

    Errors of joint frames hold those of link lengths, and of zeros, which one number tells.
    """
    told = options_of(readings)
    loaded = bool(readings.wrench.any())
    said = readings.absolute
    hung = said is not None and said.payload_differs
    went = said is not None and said.channels.displacements_alone
    out = []
    for kind in catalogue:
        if kind.name in _ONLY_LOADED or (kind.name == _BESIDE_FRAME and not went):
            continue
        if issubclass(kind, LoadError) and not (
            loaded or kind.only_absolute or (kind.of_payload and hung)
        ):
            continue
        if issubclass(kind, Elastic) and not issubclass(kind, _SHOWN_BY_WEIGHT):
            continue
        for where in kind.places(model_robot):
            effect = kind.at(model_robot, where, told)
            if effect.id not in present and effect.parameters and effect.applies_to(load_cases):
                out.append(effect)
    return tuple(out)


def slopes(problem: PoseProblem, model: Model, effects: Sequence[Effect]) -> dict[Effect, Array]:
    """(M, p) derivatives of the readings by the parameters of effects that the model has not."""
    found = dict[Effect, Array]()
    first = len(model.parameters)
    for part in _parts(effects, model.robot):
        more = tuple(Parameter(effect, spec) for effect in part for spec in effect.parameters)
        wider = replace(model, parameters=model.parameters + more, uncertainty=None)
        slope = replace(problem, model=wider).channel_gap(wider.values, derivative=True)[1]
        ends = np.cumsum([first, *(len(effect.parameters) for effect in part)])
        for effect, a, b in zip(part, ends[:-1], ends[1:], strict=True):
            found[effect] = slope[:, a:b]
    return found


def _parts(effects: Sequence[Effect], robot: Robot) -> Iterator[list[Effect]]:
    """Effects in groups that make no mechanism too wide."""
    part: list[Effect] = []
    width = 0
    for effect in effects:
        own = 0
        if isinstance(effect, Moving):
            own = len(effect.virtual_joints(robot))
        if part and width + own > WIDE:
            yield part
            part, width = [], 0
        part.append(effect)
        width += own
    if part:
        yield part
