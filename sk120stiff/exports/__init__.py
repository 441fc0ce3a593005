"""Models in other programs' words: robot descriptions, tables, and models that move.

`geometry` folds what is rigidly wrong into the joints' origins; `building` makes bodies, servos and
springs of the rest. Each format is one file, listed in `formats`.
"""

from sk120stiff.exports.contract import Exported, Request, Told
from sk120stiff.exports.formats import FORMATS, export, exported, format_of, write_exported

__all__ = [
    "FORMATS",
    "Exported",
    "Request",
    "Told",
    "export",
    "exported",
    "format_of",
    "write_exported",
]
