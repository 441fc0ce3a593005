"""FANUC TP programs as text, `.ls`: P[1..N] are places, P[N+1..2N] the same points by joints.

The format is that of listings by R-30iA/iB controllers (/PROG, /ATTR, /MN, /POS). Speeds are whole
cm/min. A place carries its configuration, a setting; the first move, by joints, must match it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.programs.language import Language
from sk120stiff.programs.orientation import fixed_xyz, from_fixed_xyz
from sk120stiff.programs.program import Program, Setting, Targets, percent, whole_number

CM_PER_MIN = 0.01 / 60.0
MOST = 12000  # cm/min
_POINT = re.compile(r"P\[(\d+)[^]]*\]\{(.*?)\};", re.DOTALL)
_VALUE = re.compile(r"([A-Z]\d?) =\s*(\S+) (?:mm|deg)")
_MOVE = re.compile(r"[JL] P\[\d+\] (\d+)(cm/min|%) (?:FINE|CNT)")
_CONFIG = re.compile(r"[NF] [UD] [TB], -?\d, -?\d, -?\d")


class Fanuc(Language):
    """TP as LS."""

    name = "ls"
    ending = ".ls"
    title = "FANUC LS"
    template = "fanuc.ls.j2"
    settings: ClassVar[Mapping[str, Setting]] = {
        "tool": Setting("0", "number of the tool frame (UT)"),
        "frame": Setting("0", "number of the user frame; 0: the robot's base, else the part's"),
        "config": Setting("N U T, 0, 0, 0", "configuration of the places, as the pendant shows it"),
        "joint_speed": Setting("10", "speed of moves by joints [%]"),
        "termination": Setting("FINE", "how moves end: FINE, a stop, or CNT0 to CNT100"),
    }
    frame = "frame"
    axis_digit = 1e-4
    angle_digit = 1e-4 * np.pi / 180.0
    speed_digit = CM_PER_MIN
    width = 30
    longest_name = 32

    def content(self, program: Program) -> dict[str, object]:
        """Values of every point in millimetres and degrees."""
        if not _CONFIG.fullmatch(program.settings["config"]):
            raise InputError(
                f"{program.settings['config']!r} is no configuration",
                where="--set config",
                remedy="Write it like 'N U T, 0, 0, 0'.",
            )
        if not re.fullmatch(r"FINE|CNT(100|\d{1,2})", program.settings["termination"]):
            raise InputError(
                f"{program.settings['termination']!r} is no termination",
                where="--set termination",
                remedy="Write FINE, or CNT0 to CNT100.",
            )
        share = percent(program.settings, "joint_speed")
        speeds = np.round(program.speed / CM_PER_MIN).astype(int)
        for bad in program.speed[(speeds < 1) | (speeds > MOST)][:1]:
            raise InputError(
                f"a speed of {1e3 * bad:.4g} mm/s cannot be written: FANUC takes 1 to {MOST} "
                "cm/min",
                where=f"--to {self.name}",
            )
        angles = fixed_xyz(program.rotation)
        units = ["mm" if slides else "deg" for slides in program.slides]
        names = [f"J{k}" for k in range(1, 7)] + [f"E{k}" for k in range(1, 7)]
        points = []
        for k, axes in enumerate(self.axes(program)):
            place = zip("XYZWPR", [*(1e3 * program.position[k]), *angles[k]], strict=True)
            points.append(
                {
                    "place": [f"{c} = {x:.4f} {'mm' if c in 'XYZ' else 'deg'}" for c, x in place],
                    "joints": [
                        f"{a} = {x:.4f} {u}" for a, x, u in zip(names, axes, units, strict=False)
                    ],
                    "speed": speeds[k],
                    "line": program.lines[k],
                }
            )
        return {
            "points": points,
            "share": share,
            "tool": whole_number(program.settings, "tool"),
            "frame": whole_number(program.settings, "frame"),
            "day": program.date[2:10].replace("/", "-"),
            "time": f"{program.date[11:]}:00",
        }

    def remarks(self, settings: Mapping[str, str]) -> list[str]:
        """How its moves end."""
        if settings["termination"] == "FINE":
            return super().remarks(settings)
        return [f"Targets are passed with {settings['termination']}, the last one is FINE."]

    def read(self, text: str) -> Targets:
        """Places and joints from /POS, speeds from /MN."""
        places: list[list[float]] = []
        axes: list[list[float]] = []
        for _, body in _POINT.findall(text):
            values = {name: float(x) for name, x in _VALUE.findall(body)}
            if "X" in values:
                places.append([values[c] for c in "XYZWPR"])
            else:
                axes.append(list(values.values()))
        place = np.array(places)
        speeds = [
            float(x) * CM_PER_MIN if unit == "cm/min" else np.nan for x, unit in _MOVE.findall(text)
        ]
        return Targets(
            1e-3 * place[:, :3], from_fixed_xyz(place[:, 3:]), np.array(axes), np.array(speeds)
        )

    def identifier(self, name: str) -> str:
        """Capital letters."""
        return super().identifier(name).upper()
