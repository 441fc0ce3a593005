"""Physical causes by name: each says how it enters, what it is described by, where it can act."""

from sk120stiff.effects.base import (
    Effect,
    Elastic,
    Elongation,
    Geometric,
    LinearElastic,
    LoadError,
    Options,
    ParameterSpec,
    ReadingError,
    Switching,
)
from sk120stiff.effects.catalogue import BY_NAME, CATALOGUE, all_effects, effect
from sk120stiff.effects.situation import Situation, situation_of, situation_of_load

__all__ = [
    "BY_NAME",
    "CATALOGUE",
    "Effect",
    "Elastic",
    "Elongation",
    "Geometric",
    "LinearElastic",
    "LoadError",
    "Options",
    "ParameterSpec",
    "ReadingError",
    "Situation",
    "Switching",
    "all_effects",
    "effect",
    "situation_of",
    "situation_of_load",
]
