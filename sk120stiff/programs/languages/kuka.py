"""KUKA Robot Language: E6AXIS and E6POS in a `.src` file.

Status and turn are left out: the first move is by axes, and "in LIN motions the programmed status
and turn are ignored" (KSS 8.3 programming manual). Speeds are $VEL.CP [m/s].
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from sk120stiff.programs.language import Language
from sk120stiff.programs.orientation import from_kuka_abc, kuka_abc
from sk120stiff.programs.program import (
    BLEND,
    Program,
    Setting,
    Targets,
    positive,
    whole_number,
)

AXES = [f"A{k}" for k in range(1, 7)] + [f"E{k}" for k in range(1, 7)]
_AGGREGATE = re.compile(r"\{(E6AXIS|E6POS): ([^}]*)\}")
_SPEED = re.compile(r"\$VEL\.CP = (\S+)")


class Kuka(Language):
    """KRL."""

    name = "krl"
    ending = ".src"
    title = "KUKA KRL"
    template = "kuka.src.j2"
    settings: ClassVar[Mapping[str, Setting]] = {
        "tool": Setting("0", "number of TOOL_DATA; 0: the flange"),
        "base": Setting("0", "number of BASE_DATA; 0: the robot's base, else the part's frame"),
        "blend": BLEND,
    }
    frame = "base"
    axis_digit = 1e-6
    angle_digit = 1e-6 * np.pi / 180.0
    speed_digit = 1e-7
    longest_name = 24

    def content(self, program: Program) -> dict[str, object]:
        """Aggregates of every point, and the speed where it changes."""
        tool, base = (whole_number(program.settings, key) for key in ("tool", "base"))
        points, speed = [], np.nan
        angles = kuka_abc(program.rotation)
        for k, axes in enumerate(self.axes(program)):
            at = ", ".join(f"{a} {x:.6f}" for a, x in zip(AXES, axes, strict=False))
            place = zip("XYZABC", [*(1e3 * program.position[k]), *angles[k]], strict=True)
            points.append(
                {
                    "axes": at,
                    "place": ", ".join(f"{c} {x:.6f}" for c, x in place),
                    "line": program.lines[k],
                    "speed": None if program.speed[k] == speed else f"{program.speed[k]:.7f}",
                }
            )
            speed = program.speed[k]
        return {
            "points": points,
            "blend": positive(program.settings, "blend", zero=True),
            "tool": f"TOOL_DATA[{tool}]" if tool else "$NULLFRAME",
            "base": f"BASE_DATA[{base}]" if base else "$NULLFRAME",
        }

    def read(self, text: str) -> Targets:
        """Of each move, the aggregate that it goes by and the one in its comment."""
        axes, places, speeds, speed = [], [], [], np.nan
        for line in text.splitlines():
            if match := _SPEED.match(line.strip()):
                speed = float(match[1])
            if not line.strip().startswith(("PTP ", "LIN ")):
                continue
            found = {kind: _components(body) for kind, body in _AGGREGATE.findall(line)}
            axes.append([found["E6AXIS"][a] for a in AXES if a in found["E6AXIS"]])
            places.append([found["E6POS"][c] for c in "XYZABC"])
            speeds.append(speed)
        place = np.array(places)
        return Targets(
            1e-3 * place[:, :3], from_kuka_abc(place[:, 3:]), np.array(axes), np.array(speeds)
        )


def _components(body: str) -> dict[str, float]:
    return {name: float(value) for name, value in (part.split() for part in body.split(","))}
