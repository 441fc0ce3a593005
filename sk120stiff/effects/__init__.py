"""Physical causes by name: each says how it enters, what it is described by, where it can act."""

from sk120stiff.effects.base import (
    AxisByAxis,
    Effect,
    Elastic,
    Geometric,
    Imposed,
    LinearElastic,
    LoadError,
    Mounting,
    ReadingError,
    Viewpoint,
    Weighing,
)
from sk120stiff.effects.catalogue import CATALOGUE, Catalogue, all_effects, effect
from sk120stiff.effects.counting import Counting, Sequential, referred
from sk120stiff.effects.elongation import Elongation
from sk120stiff.effects.load_cases import LoadCases, load_case, load_cases_of
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.effects.reference import Reference, references_of
from sk120stiff.effects.switching import Switching
from sk120stiff.effects.words import catalogue_words, comment_lines, words_of

__all__ = [
    "CATALOGUE",
    "AxisByAxis",
    "Catalogue",
    "Counting",
    "Effect",
    "Elastic",
    "Elongation",
    "Geometric",
    "Imposed",
    "LinearElastic",
    "LoadCases",
    "LoadError",
    "Mounting",
    "Options",
    "ParameterSpec",
    "ReadingError",
    "Reference",
    "Sequential",
    "Switching",
    "Viewpoint",
    "Weighing",
    "all_effects",
    "catalogue_words",
    "comment_lines",
    "effect",
    "load_case",
    "load_cases_of",
    "references_of",
    "referred",
    "words_of",
]
