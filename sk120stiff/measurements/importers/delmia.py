"""Tag tables as DELMIA's calibration takes them: tag, X Y Z, Roll Pitch Yaw, joint values.

Columns: tag name (a tag group may stand before it), X Y Z [mm], Roll Pitch Yaw [deg] as measured,
then the joints [deg, mm]; separated by tabs or blanks, or a spreadsheet; headers are optional.
"""

from __future__ import annotations

from dataclasses import dataclass

from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.layout import layout_of, shaped, sheet_by_order

_POSE = ("x", "y", "z", "orientation roll", "orientation pitch", "orientation yaw")


@dataclass(frozen=True)
class Delmia:
    """Named tags with orientation and joints."""

    name: str = "delmia"
    title: str = "a DELMIA tag table"

    def sniff(self, source: Source) -> Guess:
        """A name, position and roll, pitch, yaw; without headers, as many numbers in a row."""
        if source.role != "points":
            return NO
        layout = layout_of(source)
        if layout is not None:
            return Guess(0.9, "Roll, Pitch and Yaw beside X, Y, Z") if layout.has(*_POSE) else NO
        count, named, _ = shaped(source)
        if not named or count != len(source.actuated) + 6:
            return NO
        return Guess(0.5, f"a tag and {count} numbers in a row: position, roll pitch yaw, joints")

    def read(self, source: Source) -> Sheet:
        """The readings; DELMIA prescribes mm and degrees, which counts where headers show it."""
        joints = (f"q{k + 1}" for k in range(len(source.actuated)))
        pose = (word.removeprefix("orientation ") for word in _POSE)
        units = {"length": "mm", "angle": "deg"}
        return sheet_by_order(
            source, ("tag", *pose, *joints), self.title, self.sniff(source).why, units
        )
