"""Yaskawa Motoman INFORM: a `.jbi` job, the SK120's own language.

The format is that of the NX100 and DX100 manuals (HW0481924, HW0482494, §4.1 "Job Data Format"):
positions as pulses of the motors where pulses per degree are known, and as places (RECTAN) with the
arm's form (RCONF). Without pulse factors the joint values stand as comments. V is in mm/s, which is
the controller's usual unit.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.programs.language import Language, numbers
from sk120stiff.programs.orientation import fixed_xyz, from_fixed_xyz
from sk120stiff.programs.program import Program, Setting, Targets, percent, whole_number

_TYPE = re.compile(r"///(PULSE|RECTAN)\b")
_POINT = re.compile(r"C\d{5}=(.*)")
_MOVE = re.compile(r"MOV[JL] C\d{5} (V|VJ)=(\S+)")
_FORM = re.compile(r"[01](,[01]){5}")
_GROUP = re.compile(r"[A-Z]{2}[0-9]{1,2}(,[A-Z]{2}[0-9]{1,2})*")
MOST = 1500.0  # mm/s
MOST_POINTS = 99999


class Inform(Language):
    """INFORM II and III."""

    name = "jbi"
    ending = ".jbi"
    title = "Motoman JBI"
    template = "inform.jbi.j2"
    settings: ClassVar[Mapping[str, Setting]] = {
        "tool": Setting("0", "number of the tool file"),
        "user": Setting("0", "number of the user frame; 0: the robot's base, else the part's"),
        "pulses": Setting("", "pulses per degree, or mm, of every axis; empty: unknown"),
        "rconf": Setting("0,0,0,0,0,0", "form: no-flip, lower arm, rear, R, T, S over 180 deg"),
        "joint_speed": Setting("10", "speed of moves by joints [%]"),
        "pl": Setting("0", "position level of moves: 0, a stop, to 8"),
        "group": Setting("RB1", "control group"),
    }
    frame = "user"
    axis_digit = 1e-4
    angle_digit = 1e-4 * np.pi / 180.0
    speed_digit = 1e-4
    width = 31
    longest_name = 8
    most_axes = 8

    def pulses(self, program: Program) -> Array | None:
        """(n,) counts per degree or millimetre, where they are known."""
        text = program.settings["pulses"].strip()
        if not text:
            return None
        try:
            found = np.array(numbers(text))
        except ValueError:
            found = np.zeros(0)
        if found.shape != (len(program.axes),) or not np.isfinite(found).all() or not found.all():
            raise InputError(
                f"{text!r} are no pulses per degree of {len(program.axes)} axes",
                where="--set pulses",
                remedy=f"Write one number per axis, in the order {', '.join(program.axes)}.",
            )
        return found

    def axes(self, program: Program) -> Array:
        """(N, n) motor pulses where the factors are known, else degrees and millimetres."""
        factors = self.pulses(program)
        return program.shown_joints if factors is None else program.shown_joints * factors

    def axis_step(self, program: Program) -> float:
        """One pulse, or the last digit of the comments."""
        return self.axis_digit if self.pulses(program) is None else 1.0

    def content(self, program: Program) -> dict[str, object]:
        """Pulses, places and joint values of every point."""
        if not _FORM.fullmatch(form := program.settings["rconf"].replace(" ", "")):
            raise InputError(
                f"{form!r} is no form of the arm",
                where="--set rconf",
                remedy="Write six times 0 or 1: '0,0,0,0,0,0'.",
            )
        if not _GROUP.fullmatch(group := program.settings["group"]):
            raise InputError(f"{group!r} is no control group", where="--set group", remedy="RB1.")
        share = percent(program.settings, "joint_speed")
        if (level := whole_number(program.settings, "pl")) > 8:
            raise InputError(f"{level} is no position level", where="--set pl", remedy="0 to 8.")
        speeds = np.round(1e3 * program.speed, 1)
        for bad in speeds[(speeds < 0.1) | (speeds > MOST)][:1]:
            raise InputError(
                f"a speed of {bad:g} mm/s cannot be written: INFORM takes 0.1 to {MOST:g} mm/s",
                where=f"--to {self.name}",
            )
        pulsed = self.pulses(program) is not None
        if program.count * (1 + pulsed) > MOST_POINTS:
            raise InputError(
                f"{program.count} points are more than a job holds",
                where=f"--to {self.name}",
                remedy="Allow a larger --chord or --step, or cut the path into parts.",
            )
        axes, angles = self.axes(program), fixed_xyz(program.rotation)
        points = []
        for k in range(program.count):
            shown = [f"{x:.4f}" for x in axes[k]]
            values = [f"{x:.4f}" for x in [*(1e3 * program.position[k]), *angles[k]]]
            points.append(
                {
                    "pulse": ",".join(str(round(x)) for x in axes[k]),
                    "place": ",".join(values),
                    "joints": [" ".join(shown[i : i + 3]) for i in range(0, len(shown), 3)],
                    "speed": f"{speeds[k]:.1f}",
                    "line": program.lines[k],
                }
            )
        user = whole_number(program.settings, "user")
        return {
            "points": points,
            "pulsed": pulsed,
            "form": form,
            "share": share,
            "tool": whole_number(program.settings, "tool"),
            "user": user,
        }

    def remarks(self, settings: Mapping[str, str]) -> list[str]:
        """How its moves end, and what fixes the branch."""
        ends = super().remarks(settings)
        if settings["pl"] != "0":
            ends = [f"Targets are passed with position level {settings['pl']}, the last with 0."]
        if not settings["pulses"].strip():
            ends.append("Pulses are unknown: rconf alone fixes the branch of the first move.")
        return ends

    def read(self, text: str) -> Targets:
        """Positions by their type, speeds of the moves, joints of the comments."""
        kind = ""
        found: dict[str, list[list[float]]] = {"PULSE": [], "RECTAN": []}
        speeds, said, joints = [], [], []
        for line in text.splitlines():
            if match := _TYPE.match(line):
                kind = match[1]
            elif match := _POINT.match(line):
                found[kind].append(numbers(match[1]))
            elif line.startswith("'J "):
                said += [float(x) for x in line[3:].split()]
            elif match := _MOVE.match(line):
                speeds.append(1e-3 * float(match[2]) if match[1] == "V" else np.nan)
                joints.append(said)
                said = []
        place = np.array(found["RECTAN"])
        return Targets(
            1e-3 * place[:, :3],
            from_fixed_xyz(place[:, 3:]),
            np.array(found["PULSE"] or joints),
            np.array(speeds),
        )

    def identifier(self, name: str) -> str:
        """Capital letters and digits, eight at most."""
        return super().identifier(name).upper().replace("_", "-")
