"""ABB RAPID: a jointtarget and a robtarget of every point in a `.mod` file.

Axis configurations are written as 0 and not watched (``ConfL \\Off``): the first move is by joints,
and the straight ones after it keep to its branch. Reference: 3HAC16581-1, data types `robtarget`,
`jointtarget`, `speeddata`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.programs.language import Language, numbers
from sk120stiff.programs.orientation import from_quaternion, quaternion
from sk120stiff.programs.program import BLEND, Program, Setting, Targets, positive

_JOINTS = re.compile(r"CONST jointtarget j\d+ := \[\[([^]]*)\],\[([^]]*)\]\];")
_PLACE = re.compile(r"CONST robtarget p\d+ := \[\[([^]]*)\],\[([^]]*)\],")
_SPEED = re.compile(r"CONST speeddata (v_\d+) := \[([^,]*),")
_MOVE = re.compile(r"Move(?:AbsJ|L) [jp]\d+, (v_\d+),")
_NONE = "9E9"
_WORD = re.compile(r"[A-Za-z]\w{0,31}")


class Rapid(Language):
    """RAPID."""

    name = "rapid"
    ending = ".mod"
    title = "ABB RAPID"
    template = "rapid.mod.j2"
    settings: ClassVar[Mapping[str, Setting]] = {
        "tool": Setting("tool0", "name of the tooldata; tool0: the flange"),
        "wobj": Setting("wobj0", "name of the wobjdata; wobj0: the robot's base, else the part's"),
        "blend": BLEND,
    }
    frame = "wobj"
    axis_digit = 1e-6
    angle_digit = 2e-9
    speed_digit = 1e-7

    def content(self, program: Program) -> dict[str, object]:
        """Data of every point; axes beyond the sixth are external ones."""
        for key in ("tool", "wobj"):
            if not _WORD.fullmatch(word := program.settings[key]):
                raise InputError(f"{word!r} is no RAPID name", where=f"--set {key}")
        q = quaternion(program.rotation)
        points = []
        speeds = {speed: f"v_{k + 1}" for k, speed in enumerate(dict.fromkeys(program.speed))}
        for k, axes in enumerate(self.axes(program)):
            values = [f"{x:.6f}" for x in axes]
            robot = [*values[:6], *["0"] * (6 - len(values[:6]))]
            external = [*values[6:], *[_NONE] * (6 - len(values[6:]))]
            points.append(
                {
                    "joints": f"[{','.join(robot)}],[{','.join(external)}]",
                    "place": f"[{','.join(f'{1e3 * x:.6f}' for x in program.position[k])}],"
                    f"[{','.join(f'{x:.9f}' for x in q[k])}],[0,0,0,0],[{','.join(external)}]",
                    "line": program.lines[k],
                    "speed": speeds[program.speed[k]],
                }
            )
        named = {name: f"{1e3 * speed:.4f}" for speed, name in speeds.items()}
        return {"points": points, "speeds": named, "dof": len(program.axes),
                "blend": positive(program.settings, "blend", zero=True)}  # fmt: skip

    def read(self, text: str) -> Targets:
        """The data of the points, and the speeds of the moves."""
        axes = []
        match = re.search(r"! Axes: (\d+)", text)
        count = int(match[1]) if match else 6
        for robot, external in _JOINTS.findall(text):
            axes.append([*numbers(robot), *numbers(external)][:count])
        places = _PLACE.findall(text)
        named = {name: 1e-3 * float(value) for name, value in _SPEED.findall(text)}
        return Targets(
            1e-3 * np.array([numbers(place) for place, _ in places]),
            from_quaternion(np.array([numbers(q) for _, q in places])),
            np.array(axes),
            np.array([named[name] for name in _MOVE.findall(text)]),
        )
