"""Paths in, robot programs out: G-code and APT become points, corrected points become programs."""

from sk120stiff.programs.catalogue import LANGUAGES, READERS, language_of
from sk120stiff.programs.gcode import read_gcode
from sk120stiff.programs.language import Language

__all__ = [
    "LANGUAGES",
    "READERS",
    "Language",
    "language_of",
    "read_gcode",
]
