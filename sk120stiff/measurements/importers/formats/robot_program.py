"""Joint values as controllers keep them: the targets of a robot's program or list of points.

A calibration moves to joint targets, and what the robot was told is what a tracker's file lacks.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import Grid, decoded

_N = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_LIST = rf"{_N}(?:\s*,\s*{_N})+"
_AXES = re.compile(rf"\b[AJE](\d)\s*[=\s]\s*\"?({_N})", re.IGNORECASE)
_ABSENT = 9e9  # RAPID's value of an axis that is not there
FEWEST = 2  # targets that make a program


def _in_order(text: str) -> list[str]:
    """All that are there, behind RAPID's own axes its external ones."""
    cells = [cell for cell in re.split(r"[,\s\[\]]+", text) if cell]
    return [cell for cell in cells if float(cell) != _ABSENT]


def _by_name(text: str) -> list[str]:
    """``A1 .., A2 .., E1 ..``: the robot's own axes, then the external ones."""
    found = [(m[0].upper().startswith("E"), int(m[1]), m[2]) for m in _AXES.finditer(text)]
    return [value for _, _, value in sorted(found, key=lambda axis: axis[:2])]


@dataclass(frozen=True)
class _Dialect:
    """How one controller writes a joint target.

    Attributes:
        title: Controller and language, for people.
        marks: What stands in every such text, in small letters.
        target: What stands around the values of one; its groups are name (if any) and values.
        unit: Of its angles.
        cells: The values, as written.
        within: What encloses all targets; None: the file.
    """

    title: str
    marks: tuple[str, ...]
    target: re.Pattern[str]
    unit: str = "deg"
    cells: Callable[[str], list[str]] = _in_order
    within: re.Pattern[str] | None = None

    def found(self, text: str) -> list[tuple[int, str, list[str]]]:
        """Line, name and values of each target, in the order in which they stand."""
        parts = [(0, len(text))]
        if self.within is not None:
            parts = [m.span() for m in self.within.finditer(text)]
        out = []
        for begin, end in parts:
            for match in self.target.finditer(text, begin, end):
                values = self.cells(match["values"])
                line = text.count("\n", 0, match.start()) + 1
                if len(values) > 1:
                    out.append((line, match.groupdict().get("name") or "", values))
        return out


_IGNORE = re.IGNORECASE
_DIALECTS = (
    _Dialect(
        "RAPID (jointtarget, as ABB and ROKAE write it)",
        ("j",),
        re.compile(
            rf"(?:\bjointtarget\s+(?P<name>\w+)\s*:?=\s*(?:\w+\s*:\s*)?|MoveAbsJ\s*)"
            rf"[\[{{]\s*\[?\s*(?P<values>{_LIST}(?:\s*\]\s*,\s*\[\s*{_LIST})?)", _IGNORE,
        ),
    ),
    _Dialect(
        "KRL (E6AXIS, as KUKA writes it)",
        ("{", "a1"),
        re.compile(
            rf"(?:\bX?(?P<name>\w+)\s*=\s*)?\{{\s*(?:(?:E6)?AXIS\s*:\s*)?"
            rf"(?P<values>A1\s+{_N}[^}}]*)\}}", _IGNORE,
        ),
        cells=_by_name,
    ),
    _Dialect(
        "a TP program (J1= ... deg, as FANUC lists it)",
        ("p[", "j1"),
        re.compile(rf"\bP\s*\[(?P<name>\d+)[^\]]*\]\s*\{{(?P<values>[^}}]*?\bJ1\s*=\s*{_N}[^}}]*)\}}"),
        cells=_by_name,
    ),
    _Dialect(
        "URScript (movej([...]) or ..._q = [...])",
        ("movej",),
        re.compile(rf"(?:\bmovej\s*\(|\b(?P<name>\w+)_q\s*=)\s*\[\s*(?P<values>{_LIST})\s*\]"),
        unit="rad",
    ),
    _Dialect(
        "DRL (posj(...), as Doosan writes it)",
        ("posj",),
        re.compile(rf"(?:\b(?P<name>\w+)\s*=\s*)?\bposj\s*\(\s*\[?\s*(?P<values>{_LIST})"),
    ),
    _Dialect(
        "AS (.JOINTS, as Kawasaki writes it)",
        (".joints",),
        re.compile(rf"^[ \t]*#(?P<name>[\w\[\]]+)[ \t]+(?P<values>{_N}(?:[ \t]+{_N})+)", re.M),
        within=re.compile(r"^\.JOINTS\b.*?^\.END\b", re.M | re.S),
    ),
    _Dialect(
        "VAL3 (a joint's j1=\"...\", as Staubli writes it)",
        ("<value", "j1"),
        re.compile(rf"<Value\b(?P<values>[^>]*\bj1\s*=\s*\"{_N}\"[^>]*)>"),
        cells=_by_name,
    ),
    _Dialect(
        "INFORM (///POSTYPE ANGLE, as Yaskawa writes it)",
        ("///postype",),
        re.compile(rf"^(?P<name>[A-Z]{{1,2}}\d+)=(?P<values>{_LIST})", re.M),
        within=re.compile(r"^///POSTYPE ANGLE\b.*?(?=^///POSTYPE|^//INST|\Z)", re.M | re.S),
    ),
)  # fmt: skip
_PLACE = re.compile(r"\brobtarget\s+\w+\s*:?=|\{\s*(?:E6POS\s*:\s*)?X\s[^}]*\bC\s", _IGNORE)
_PULSES = re.compile(r"^/JOB\b.*?^///(?:POSTYPE )?PULSE\b", re.M | re.S)


def is_program(source: Source) -> bool:
    """Is this the text of a program with joint targets, or with those that counts stand for?"""
    text = _text(source)
    return bool(text) and (bool(_PULSES.search(text)) or bool(_of(text)[1]))


def program_grid(source: Source) -> Grid:
    """A row for each joint target, in the order in which they stand.

    Raises:
        InputError: Counts of encoders, or targets of different numbers of axes.
    """
    dialect, targets = _of(text := _text(source))
    if not targets:
        raise InputError(
            "this program holds counts of the encoders (PULSE), and how many make a degree is the "
            "controller's secret",
            where=str(source.path),
            remedy="Convert it to ANGLE on the controller, or give the angles as a table.",
        )
    n = len(source.actuated)
    for line, name, values in targets:
        if len(values) < n:
            raise InputError(
                f"the target {name} has {len(values)} axes, but the robot has {n} joints",
                where=f"{source.path}, line {line}",
                remedy="Choose the robot that was moved, or another end of its chain with --tool.",
            )
    more = [[float(v) for v in values[n:]] for _, _, values in targets]
    moved = any(v != 0.0 for row in more for v in row)
    names = [name for _, name, _ in targets]
    named = all(names) and len(set(names)) == len(names)
    headers = (*(["name"] if named else []), *(f"q{k + 1}[{dialect.unit}]" for k in range(n)))
    rows = [(*([name] if named else []), *values[:n]) for _, name, values in targets]
    left = [f"values of axes behind the joint {n} of each target"] if moved else []
    return Grid(
        source.path,
        (headers, *rows),
        (targets[0][0], *(line for line, _, _ in targets)),
        how=f"{len(rows)} joint targets in {dialect.title}, in the order in which they stand",
        left=(*left, *_in_space(text)),
    )


def _text(source: Source) -> str:
    if source.given is not None or source.columns is not None or source.path.is_dir():
        return ""
    try:
        return decoded(source.path, source.data)[0].replace("\r\n", "\n").replace("\r", "\n")
    except InputError:  # no text: its own reader tells
        return ""


def _of(text: str) -> tuple[_Dialect, list[tuple[int, str, list[str]]]]:
    """The dialect of most targets, and these; none where there are too few."""
    small = text.lower()
    each = [(d, d.found(text) if all(mark in small for mark in d.marks) else []) for d in _DIALECTS]
    dialect, targets = max(each, key=lambda pair: len(pair[1]))
    return dialect, targets if len(targets) >= FEWEST else []


def _in_space(text: str) -> list[str]:
    """How many places the program moves to without saying joint values."""
    places = len(_PLACE.findall(text))
    return [f"{places} targets in space, which hold no joint values"] if places else []
