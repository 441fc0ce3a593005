"""APT cutter locations (ISO 4343, `.apt`, `.cls`, `.cl`) as a tool path.

``GOTO/x,y,z[,i,j,k]``, ``GODLTA``, ``FROM``, ``RAPID``, ``FEDRAT``, ``MULTAX``, ``UNITS``, and
``CIRCLE/x,y,z,i,j,k,r,…`` before the GOTO of its end, as NX writes it: centre, axis, radius. Its
handbook says "axis vector (assuming a clockwise direction)", seen along the axis: right-handed
about it. ``i,j,k`` of a GOTO point from the tip to the shank.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.files import read_text
from sk120stiff.programs.toolpath import Course, ToolPath

_UNITS = {"MM": 1e-3, "INCHES": 0.0254, "INCH": 0.0254}
_FEEDS = {"MMPM": "MM", "IPM": "INCHES"}
_MOVING = {  # words that move the tool, or the axes, otherwise than this reader can follow
    "CYCLE", "GOBACK", "GODOWN", "GOFWD", "GOLFT", "GORGT", "GOUP", "TRANS", "COPY", "INDEX",
    "ROTATE", "CUTCOM", "ORIGIN", "HELIX", "TRACUT", "GOHOME",
}  # fmt: skip
_OFF_MOUNTED = 1e-3  # of the radius, or 5 µm: a start farther off it is not on the circle


@dataclass
class _Modes:
    scale: float
    feed: float = float("nan")
    rapid: bool = False
    circle: tuple[Array, Array, float, int, int] | None = None  # centre, axis, radius, turns, line
    axis: Array | None = None


def read_apt(path: Path, *, chord: float, step: float = np.inf) -> ToolPath:
    """Read an APT or CLS file; arguments and errors as those of `read_gcode`."""
    course = Course(path, chord, step)
    statements = list(_statements(read_text(path)))
    modes = _Modes(_scale(course, statements))
    for line, word, arguments in statements:
        _follow(course, modes, word, arguments, line)
    if modes.circle is not None:
        raise course.wrong("the CIRCLE has no GOTO after it", modes.circle[4])
    return course.path()


def _statements(text: str) -> Iterator[tuple[int, str, list[str]]]:
    """Line, major word and arguments; `$` continues a line, `$$` begins a comment."""
    held, begin = "", 0
    for number, raw in enumerate(text.splitlines(), start=1):
        bare = raw.partition("$$")[0].strip()
        if not held:
            begin = number
        if bare.endswith("$"):
            held += bare[:-1]
            continue
        statement, held = (held + bare).strip(), ""
        if statement:
            word, _, rest = statement.partition("/")
            arguments = [part.strip() for part in rest.split(",")] if rest.strip() else []
            yield begin, word.strip().upper(), arguments


def _scale(course: Course, statements: list[tuple[int, str, list[str]]]) -> float:
    """Metres in the file's unit: what UNITS says, else what the feeds are in."""
    for line, word, arguments in statements:
        if word == "UNITS":
            name = arguments[0].upper() if arguments else ""
            if name not in _UNITS:
                raise course.wrong(f"UNITS/{name} is unknown", line, "Write UNITS/MM or INCHES.")
            return _UNITS[name]
    for _, word, arguments in statements:
        if word == "FEDRAT":
            for part in arguments:
                if part.upper() in _FEEDS:
                    return _UNITS[_FEEDS[part.upper()]]
    raise course.wrong(
        "nothing says in which unit the lengths are",
        1,
        "Write UNITS/MM or UNITS/INCHES as the first line.",
    )


def _numbers(course: Course, arguments: list[str], line: int) -> Array:
    values = np.empty(len(arguments))
    for k, part in enumerate(arguments):
        try:
            values[k] = float(part)
        except ValueError:
            raise course.wrong(f"{part!r} is no number", line) from None
    if not np.isfinite(values).all():
        raise course.wrong("a coordinate is not a finite number", line)
    return values


def _follow(course: Course, modes: _Modes, word: str, arguments: list[str], line: int) -> None:
    if word in ("GOTO", "GODLTA", "FROM"):
        _go(course, modes, word, arguments, line)
    elif word == "RAPID":
        modes.rapid = True
    elif word == "FEDRAT":
        modes.feed = _feed(course, modes, arguments, line)
        modes.rapid = False
    elif word == "CIRCLE":
        modes.circle = _circle(course, modes, arguments, line)
    elif word in ("UNITS", "MULTAX"):
        return
    elif word in _MOVING and [part.upper() for part in arguments] != ["OFF"]:
        raise course.wrong(
            f"{word} is not followed", line, "Let the CAM system write plain GOTO moves."
        )
    elif word == "MSYS" and not _is_identity(arguments):
        course.leave_out(
            "MSYS (points are taken in its axes; say with --frame where it lies)", line
        )
    elif word not in ("FINI", "END-OF-PATH", "PAINT", "MSYS"):
        course.leave_out(word, line)


def _is_identity(arguments: list[str]) -> bool:
    try:
        return [float(part) for part in arguments] == [0, 0, 0, 1, 0, 0, 0, 1, 0]
    except ValueError:
        return False


def _go(course: Course, modes: _Modes, word: str, arguments: list[str], line: int) -> None:
    values = _numbers(course, arguments, line)
    if len(values) not in ((1, 3) if word == "GODLTA" else (3, 6)):
        raise course.wrong(
            f"{word} with {len(values)} numbers", line, "Write x,y,z or x,y,z,i,j,k."
        )
    place = values[:3] * modes.scale
    if word == "GODLTA":
        if not np.isfinite(course.here).all():
            raise course.wrong("GODLTA moves from a place that is not known", line)
        place = course.here + (place if len(values) == 3 else np.array([0.0, 0.0, place[0]]))
    if len(values) == 6:
        length = float(np.linalg.norm(values[3:]))
        if not 0.99 < length < 1.01:
            raise course.wrong(f"the tool's axis has the length {length:.4g}, not 1", line)
        if modes.axis is None and course.position:
            course.axes = [np.array([0.0, 0.0, 1.0])] * len(course.position)
        modes.axis = values[3:] / length
    if word == "FROM":
        course.here = place
        return
    if modes.circle is None:
        course.straight(place, line, feed=modes.feed, rapid=modes.rapid, axis=modes.axis)
    else:
        centre, normal, radius, turns, at = modes.circle
        away = course.here - centre
        away = away - (away @ normal) * normal
        if abs(np.linalg.norm(away) - radius) > max(5e-6, _OFF_MOUNTED * radius):
            raise course.wrong(
                f"the tool stands {1e3 * np.linalg.norm(away):.4f} mm from the circle's axis, "
                f"which has the radius {1e3 * radius:.4f} mm",
                at,
            )
        course.arc(place, centre, normal, line, feed=modes.feed, turns=turns, axis=modes.axis)
    modes.rapid, modes.circle = False, None


def _circle(
    course: Course, modes: _Modes, arguments: list[str], line: int
) -> tuple[Array, Array, float, int, int]:
    turns = 1
    if "TIMES" in (upper := [part.upper() for part in arguments]):
        k = upper.index("TIMES")
        turns = int(_numbers(course, arguments[k + 1 : k + 2] or ["0"], line)[0])
        arguments = arguments[:k]
    values = _numbers(course, arguments, line)
    if len(values) < 7 or turns < 1:
        raise course.wrong("CIRCLE needs centre, axis and radius: x,y,z,i,j,k,r", line)
    length = float(np.linalg.norm(values[3:6]))
    if not 0.99 < length < 1.01 or values[6] <= 0.0:
        raise course.wrong("the CIRCLE's axis is no unit vector, or its radius not positive", line)
    centre, radius = values[:3] * modes.scale, float(values[6]) * modes.scale
    return centre, values[3:6] / length, radius, turns, line


def _feed(course: Course, modes: _Modes, arguments: list[str], line: int) -> float:
    words = [part.upper() for part in arguments if re.match(r"[A-Za-z]", part)]
    values = _numbers(course, [part for part in arguments if part.upper() not in words], line)
    if len(values) != 1 or values[0] <= 0.0:
        raise course.wrong("FEDRAT needs one positive number", line)
    for word in words:
        if word not in _FEEDS:
            raise course.wrong(
                f"a feed in {word} is not followed", line, "Give it per minute: MMPM or IPM."
            )
    scale = _UNITS[_FEEDS[words[0]]] if words else modes.scale
    return float(values[0] * scale / 60.0)
