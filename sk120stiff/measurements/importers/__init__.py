"""Files of trackers, calibration programs and spreadsheets become measurements.

One format a file, one contract (`contract.Importer`): how sure it is that a file is its own, by
content alone, and how it reads it. ``FORMATS + (Mine(),)`` knows one more.
"""

from sk120stiff.measurements.importers.contract import Column, Formats, Guess, Sheet, Source
from sk120stiff.measurements.importers.formats.catalogue import FORMATS
from sk120stiff.measurements.importers.run import Imported, import_readings
from sk120stiff.measurements.importers.told import Told

__all__ = [
    "FORMATS",
    "Column",
    "Formats",
    "Guess",
    "Imported",
    "Sheet",
    "Source",
    "Told",
    "import_readings",
]
