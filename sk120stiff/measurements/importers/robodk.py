"""Measurements as RoboDK's calibration exports them: joints, tracker position, marker place.

One line of headers, then the joints [deg], X Y Z of the tracker [mm] and X Y Z of the marker in the
flange frame (TCP) [mm], as the macros that RoboDK ships read it.
"""

from __future__ import annotations

from dataclasses import dataclass

from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.layout import layout_of, shaped, sheet_by_order

_TAIL = ("x", "y", "z", "tcp x", "tcp y", "tcp z")


@dataclass(frozen=True)
class RoboDK:
    """Joints, positions and marker places in one row."""

    name: str = "robodk"
    title: str = "RoboDK's calibration measurements"

    def sniff(self, source: Source) -> Guess:
        """Columns of joints, positions and TCP; without headers, as many numbers in a row."""
        if source.role != "points":
            return NO
        layout = layout_of(source)
        if layout is not None:
            joints = [f"joint {k + 1}" for k in range(len(source.actuated))]
            return Guess(0.9, "joints, X Y Z and TCP X Y Z") if layout.has(*joints, *_TAIL) else NO
        count, named, _ = shaped(source)
        if named or count != len(source.actuated) + 6:
            return NO
        return Guess(0.5, f"{count} numbers in a row: joints, position, marker place")

    def read(self, source: Source) -> Sheet:
        """The readings; RoboDK writes mm and degrees, which counts where headers show its table."""
        joints = (f"q{k + 1}" for k in range(len(source.actuated)))
        units = {"length": "mm", "angle": "deg"}
        return sheet_by_order(source, (*joints, *_TAIL), self.title, self.sniff(source).why, units)
