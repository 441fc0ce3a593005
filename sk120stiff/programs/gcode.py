"""G-code (ISO 6983, the words that RS274/NGC and FANUC controls share) as a tool path.

Moves: G0, G1, G2, G3 with I J K or R, planes G17 G18 G19, inches and millimetres G20 G21, absolute
and incremental G90 G91, centres G90.1 G91.1, feed F per minute (G94), turns P of an arc. What does
not move the tool (S, T, M, dwell, offsets' numbers) is left out and named; what would move it
otherwise than this reader can follow (cycles, cutter compensation, machine coordinates) stops it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.files import read_text
from sk120stiff.programs.toolpath import Course, ToolPath

_WORD = re.compile(r"\s*([A-Za-z])\s*([+-]?\s*(?:\d+\.?\d*|\.\d+))\s*")
_PLANES = {17.0: 2, 18.0: 1, 19.0: 0}  # G word → axis across the plane
_QUIET = {9.0, 40.0, 49.0, 61.0, 61.1, 64.0, 80.0, 94.0}  # what this reader does anyway
_NOTED = {4.0, 43.0, 8.0, 5.1, 96.0, 97.0, 98.0, 99.0}  # they change no place that was programmed
_OFFSETS = {54.0 + k for k in range(6)} | {59.1, 59.2, 59.3}
_OTHERS = "STMHDNOLQ"
_INCH = 0.0254


@dataclass
class _Modes:
    """What holds from line to line."""

    motion: int | None = None
    across: int = 2
    scale: float | None = None
    absolute: bool = True
    absolute_centres: bool = False
    feed: float = float("nan")
    offset: float | None = None
    given: set[str] = field(default_factory=set)

    def metres(self, course: Course, line: int) -> float:
        """Metres in the unit that holds; where none was stated that of most controls."""
        if self.scale is None:
            self.scale = 1e-3
            course.assumed = (
                f"Lengths: millimetres, since no G20 or G21 stands at or before line {line}.",
            )
        return self.scale


def read_gcode(path: Path, *, chord: float, step: float = np.inf) -> ToolPath:
    """Read G-code.

    Args:
        chord: How far a chord of an arc may be off it [m].
        step: Longest distance between points of a straight feed move [m].

    Raises:
        InputError: The file cannot be read, or a line means something that is not understood.
    """
    course = Course(path, chord, step)
    modes = _Modes()
    for line, text in enumerate(read_text(path).splitlines(), start=1):
        _read_line(course, modes, text, line)
    return course.path()


def _read_line(course: Course, modes: _Modes, text: str, line: int) -> None:
    bare = re.sub(r"\([^()]*\)", " ", text).partition(";")[0].strip()
    if not bare or bare.startswith("%"):
        return
    if bare.startswith("/"):
        course.leave_out("the mark of block skip", line)
        bare = bare[1:]
    if "(" in bare or ")" in bare:
        raise course.wrong("a comment is not closed", line, "Comments stand in ( ) on one line.")
    if set(bare) & set("#[]="):
        raise course.wrong(
            "variables and expressions are not worked out",
            line,
            "Let the CAM system or the control write plain numbers.",
        )
    codes, words = _words(course, bare, line)
    modes.given = set()
    for code in codes:
        _set(course, modes, code, line)
    dwells = 4.0 in codes
    for letter in _OTHERS:
        if letter in words and letter not in "NO":
            course.leave_out(f"{letter}{words[letter]:g}", line)
    for letter in "ABCUVW":
        if letter in words:
            raise course.wrong(
                f"the axis {letter} is not followed",
                line,
                "Write the tool's axis as I, J, K in an APT or CLS file.",
            )
    if "E" in words:
        course.leave_out("E (extruder)", line)
    if "F" in words:
        if words["F"] <= 0.0:
            raise course.wrong(f"a feed of {words['F']:g} moves nothing", line)
        modes.feed = words["F"] * modes.metres(course, line) / 60.0
    if not dwells and set(words) & set("XYZIJKR"):
        _move(course, modes, words, line)


def _words(course: Course, bare: str, line: int) -> tuple[list[float], dict[str, float]]:
    codes: list[float] = []
    words: dict[str, float] = {}
    at = 0
    while at < len(bare):
        match = _WORD.match(bare, at)
        if match is None:
            raise course.wrong(f"{bare[at:].strip()[:20]!r} is no word of G-code", line)
        letter, value = match[1].upper(), float(match[2].replace(" ", ""))
        at = match.end()
        if letter in "NO" and set(words) - {*"NO"} | set(codes):
            raise course.wrong(
                f"the number {letter}{match[2]} stands behind other words",
                line,
                "The letter O for the digit 0?" if letter == "O" else None,
            )
        if letter == "G":
            codes.append(value)
        elif letter == "M":
            if value in (98.0, 97.0):
                raise course.wrong(f"M{value:g} calls another program", line, "Write it out here.")
            course.leave_out(f"M{value:g}", line)
        elif letter in words:
            raise course.wrong(f"the word {letter} stands twice", line)
        else:
            words[letter] = value
    return codes, words


def _set(course: Course, modes: _Modes, code: float, line: int) -> None:
    if code in (0.0, 1.0, 2.0, 3.0):
        if "motion" in modes.given:
            raise course.wrong("two kinds of motion stand in one line", line)
        modes.given.add("motion")
        modes.motion = int(code)
    elif code in _PLANES:
        modes.across = _PLANES[code]
    elif code in (20.0, 21.0):
        modes.scale = _INCH if code == 20.0 else 1e-3
    elif code in (90.0, 91.0):
        modes.absolute = code == 90.0
    elif code in (90.1, 91.1):
        modes.absolute_centres = code == 90.1
    elif code in _OFFSETS:
        if modes.offset not in (None, code):
            raise course.wrong(
                f"a second part frame, G{code:g}, after G{modes.offset:g}",
                line,
                "Write one path per part frame, and say with --frame where each lies.",
            )
        modes.offset = code
    elif code in _NOTED:
        course.leave_out(f"G{code:g}", line)
    elif code not in _QUIET:
        raise course.wrong(
            f"G{code:g} is not followed",
            line,
            "Let the CAM system write plain moves: G0, G1, G2, G3, without cycles, cutter "
            "compensation and machine coordinates.",
        )


def _move(course: Course, modes: _Modes, words: dict[str, float], line: int) -> None:
    end = course.here.copy()
    for k, letter in enumerate("XYZ"):
        if letter in words:
            value = words[letter] * modes.metres(course, line)
            end[k] = value if modes.absolute else end[k] + value
            if np.isnan(end[k]):
                raise course.wrong(
                    f"G91 moves {letter} from a place that is not known",
                    line,
                    "Name X, Y and Z with G90 first.",
                )
    if modes.motion is None:
        raise course.wrong("the move has no G0, G1, G2 or G3 before it", line)
    if modes.motion < 2:
        if set(words) & set("IJKR"):
            raise course.wrong("I, J, K and R belong to arcs, G2 and G3", line)
        course.straight(end, line, feed=modes.feed, rapid=modes.motion == 0)
        return
    if not np.isfinite(course.here).all():
        raise course.wrong("an arc begins where the tool is not known to stand", line)
    turns = words.get("P", 1.0)
    if turns != int(turns) or turns < 1.0:
        raise course.wrong(f"P{turns:g} is no number of turns", line)
    normal = np.zeros(3)
    normal[modes.across] = 1.0 if modes.motion == 3 else -1.0
    centre = _centre(course, modes, words, end, normal, line)
    course.arc(end, centre, normal, line, feed=modes.feed, turns=int(turns))


def _centre(
    course: Course,
    modes: _Modes,
    words: dict[str, float],
    end: Array,
    normal: Array,
    line: int,
) -> Array:
    across, start, scale = modes.across, course.here, modes.metres(course, line)
    offsets = [letter for letter in "IJK" if letter in words]
    if "R" not in words:
        if not offsets:
            raise course.wrong("the arc has neither a centre (I, J, K) nor a radius R", line)
        if "IJK"[across] in words:
            raise course.wrong(f"{'IJK'[across]} lies across the plane of the arc", line)
        centre = start.copy()
        for k, letter in enumerate("IJK"):
            if k != across:
                value = words.get(letter, 0.0) * scale
                if modes.absolute_centres:
                    if letter not in words:
                        raise course.wrong(f"G90.1 needs the centre's {letter} too", line)
                    centre[k] = value
                else:
                    centre[k] += value
        return centre
    if offsets:
        raise course.wrong("the arc has both a centre and a radius", line)
    radius = words["R"] * scale
    way = end - start
    way[across] = 0.0
    length = float(np.linalg.norm(way))
    if length < 1e-9:
        raise course.wrong(
            "a whole circle by R has no certain centre", line, "Give its centre by I, J, K."
        )
    height = radius**2 - 0.25 * length**2
    if height < -1e-6 * radius**2:
        raise course.wrong(
            f"an arc of radius {abs(words['R']):g} does not span its ends, "
            f"{length / scale:.6g} apart",
            line,
        )
    left = np.cross(normal, way / length)  # towards the centre of an arc of less than half a turn
    return np.asarray(start + 0.5 * way + np.sign(radius) * np.sqrt(max(height, 0.0)) * left)
