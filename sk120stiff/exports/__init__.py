"""Models in other programs' words: robot descriptions, tables, and models that move.

`geometry` folds what is rigidly wrong into the joints' origins; `building` makes bodies, servos and
springs of the rest. Each format is one file, listed in `formats`.
"""

from sk120stiff.exports.contract import Exported, Format, Request, Told
from sk120stiff.exports.formats import FORMATS, export, exported, format_of, write_exported
from sk120stiff.exports.geometry import Geometry, geometry_of
from sk120stiff.exports.moving import MovingArm

__all__ = [
    "FORMATS",
    "Exported",
    "Format",
    "Geometry",
    "MovingArm",
    "Request",
    "Told",
    "export",
    "exported",
    "format_of",
    "geometry_of",
    "write_exported",
]
