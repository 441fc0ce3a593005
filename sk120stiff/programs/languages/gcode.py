"""G-code, for arms that a CNC control moves: corrected places of the tool's tip in the part's axes.

It holds no orientation: the control keeps the one that the path has. Joint values stand as
comments.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from sk120stiff.programs.language import Language
from sk120stiff.programs.program import Program, Targets

_MOVE = re.compile(r"G([01]) X(\S+) Y(\S+) Z(\S+)(?: F(\S+))? \(J ([^)]*)\)")


class GCode(Language):
    """Plain G0 and G1."""

    name = "gcode"
    ending = ".nc"
    title = "G-code"
    template = "gcode.nc.j2"
    axis_digit = 1e-6
    angle_digit = 1.0  # none is written
    speed_digit = 1e-3 / 60e3
    longest_name = 60
    most_axes = 64
    joint_moves = False

    def in_part_frame(self, settings: Mapping[str, str]) -> bool:
        """Always."""
        del settings
        return True

    def remarks(self, settings: Mapping[str, str]) -> list[str]:
        """What it leaves to the control."""
        del settings
        return ["The tool keeps the orientation of the path."]

    def content(self, program: Program) -> dict[str, object]:
        """Places and joints of every point."""
        points = []
        for k, axes in enumerate(self.axes(program)):
            rapid = bool(program.rapid[k]) or k == 0
            place = zip("XYZ", 1e3 * program.position[k], strict=True)
            points.append(
                {
                    "move": "G0" if rapid else "G1",
                    "place": " ".join(f"{c}{x:.5f}" for c, x in place),
                    "feed": "" if rapid else f" F{60e3 * program.speed[k]:.3f}",
                    "joints": " ".join(f"{x:.6f}" for x in axes),
                    "line": program.lines[k],
                }
            )
        return {"points": points}

    def read(self, text: str) -> Targets:
        """The moves."""
        moves = [match.groups() for match in _MOVE.finditer(text)]
        return Targets(
            1e-3 * np.array([[float(x) for x in move[1:4]] for move in moves]),
            None,
            np.array([[float(x) for x in move[5].split()] for move in moves]),
            np.array([np.nan if move[4] is None else float(move[4]) / 60e3 for move in moves]),
        )
