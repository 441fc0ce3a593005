"""Headers of several words, read from behind: ``/vicon/tool/pose/position/x``, ``q1_meas_rad``.

A topic, an instrument or a carrier stands before what was read, a number of the joint or an axis
behind it, a qualifier (measured, target) and a unit somewhere between. Without these the rest is a
header as people write it, and `words.meaning_of` knows it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache

from sk120stiff import units
from sk120stiff.measurements.importers.clock import PARTS_OF_SECONDS
from sk120stiff.measurements.importers.columns.masses import MASSES
from sk120stiff.measurements.importers.columns.words import (
    UNITS_IN_WORDS,
    kind_of,
    meaning_of,
    unit_of_header,
)

MEASURED, COMMANDED = "measured", "commanded"


def _set(words: str) -> frozenset[str]:
    return frozenset(words.split())


_QUALIFIERS = {
    **dict.fromkeys(_set("meas measured actual act ist msr feedback fbk"), MEASURED),
    **dict.fromkeys(
        _set(
            "cmd command commanded target desired des ref reference nom nominal soll setpoint goal"
        ),
        COMMANDED,
    ),
}
# What stands before a reading: instruments of places, those of forces, and what carries them.
INSTRUMENTS = _set(
    "lt tracker lasertracker leica faro radian vicon optitrack mocap motive qualisys qtm cmm romer "
    "natnet vrpn"
)
_SEEN = INSTRUMENTS | _set("laser marker smr reflector")  # none of these is of the robot
_ROBOT = _set("robot arm rtde controller tcp ee eef effector flange tool fk")  # its own pose
_SENSOR = _set(  # what reads forces in axes of its own, or carries it
    "ft fts sensor netft ati wrench loadcell transducer tool flange tcp ee"
)
_BEFORE = INSTRUMENTS | _set(
    "ft fts sensor netft ati wrench loadcell robot arm rtde controller encoder enc laser tcp ee "
    "flange tool marker smr joint joints state states pose"
)
_BEHIND = INSTRUMENTS | _set("ft fts sensor robot tcp ee flange")  # may stand last
# Words of a rate, an effort or an uncertainty: a header that holds one is of no value named here.
_OTHER = _set(
    "vel velocity velocities speed acc accel acceleration effort efforts current currents voltage "
    "error err std sigma cov covariance twist gripper finger fingers bias offset limit qd qdd"
)
_QUANTITIES = _set(  # parts of a topic that begin what was read
    "position positions translation point orientation rotation quaternion force torque stamp "
    "timestamp"
)
_POSITION_OF = _set("position pos angle value")
_TAILS = _set("m mm um rad mrad deg N kN Nm Nmm s ms us ns kg C degC K")  # behind the last stroke
_CELSIUS = frozenset(("C", "degC", "°C", "ºC", "K"))
_WARMTH = re.compile(r"t|ta|t amb|t room|(?:.* )?(?:temp|amb|ambient|air)(?: .*)?")
_HUNG = re.compile(  # words of a mass on the tool, without a unit
    r"m (?:payload|load|nutzlast|traglast|tool)|(?:payload|load|hung|added|applied|test) mass|"
    r"mass (?:payload|load)"
)
_MASS = re.compile(r"mass|masse|massa|masa|weight|gewicht|last|tool mass|(?:load|m) ?\d?")
_NUMBERED = re.compile(r"(?:position|pos)s? (\d+)")
_SUBSCRIPT = re.compile(r"([xyz])(?P<said>[macntd])")  # Xm: measured; Xn, Xc, Xt, Xd: told to be
_SAID_BY = {"m": MEASURED, "a": MEASURED}


@dataclass(frozen=True)
class Compound:
    """What a composed header says.

    Args:
        meaning: As of `words.meaning_of`; a quaternion's axes are ``qw`` ... ``qz``.
        unit: As stated, or None.
        said: ``"measured"``, ``"commanded"`` or nothing.
        of: What stands before the reading, as it is written: a topic, an instrument.
        instrument: Is one that measures places among the words before?
        counted: Does a number alone behind ``position`` tell the joint? Then all of the robot's
            have to be there.
        own: Is the robot among the words, and nothing that measures places?
    """

    meaning: str
    unit: str | None
    said: str
    of: str
    instrument: bool
    counted: bool = False
    own: bool = False

    @property
    def family(self) -> str:
        """What has to come of one group of columns: ``joint``, ``place``, ``turn`` ..."""
        word = self.meaning.rpartition(" ")[2]
        if self.meaning.startswith("joint "):
            return "joint"
        if word in ("x", "y", "z"):
            return "place"
        if word in ("qw", "qx", "qy", "qz"):
            return "turn"
        return "load" if word in _LOADS else self.meaning


_LOADS = ("fx", "fy", "fz", "mx", "my", "mz", "tx", "ty", "tz")
_READ = re.compile(  # meanings that a composed header may have
    r"joint \d+|(?:(?:un)?loaded )?[xyz]|q[wxyz]|[fmt][xyz]|time|temperature"
)


@lru_cache(maxsize=4096)
def compound(header: str, actuated: tuple[str, ...] = ()) -> Compound | None:
    """What a header says that is composed of several words; None where that cannot be told.

    Args:
        header: As it stands in the file.
        actuated: The robot's joints, whose names may be among the words.
    """
    name, unit = unit_of_header(header)
    path = [part for part in re.split(r"[/.]+", name) if part.strip()]
    words = [word.lower() for part in path for word in _words(part)]
    if not words or _OTHER & set(words):
        return None
    if len(path) > 1:
        found = _of_topic(path, unit, actuated)
    else:
        found = _of_words(_words(name), name, unit, actuated)
    if found is None or _READ.fullmatch(found.meaning) is None or not _fits(found):
        return None
    return replace(found, own=bool(_ROBOT & set(words)) and not _SEEN & set(words))


def is_hung_mass(name: str) -> bool:
    """Is the column called as a mass on the tool, though it has no unit that tells it?"""
    return _HUNG.fullmatch(" ".join(_words(name)).lower()) is not None


def of_a_sensor(name: str) -> bool:
    """Do words of a force's column name a sensor, whose axes are its own?"""
    words = {word.lower() for part in re.split(r"[/.]+", name) for word in _words(part)}
    return bool(words & _SENSOR)


def may_be_mass(name: str) -> bool:
    """Is the column called as a mass may be, and much else, so that somebody has to say it?"""
    return _MASS.fullmatch(" ".join(_words(name)).lower()) is not None


def _words(text: str) -> list[str]:
    """Words of a header, units whole; a number behind a word is one of its own, but not in q1."""
    out: list[str] = []
    for word in re.split(r"[\s_\-:()\[\]{},]+", text):
        if word not in _TAILS:
            word = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Za-z]{4})(?=\d)", " ", word)
        out += word.split()
    return out


def _of_topic(path: list[str], unit: str | None, actuated: tuple[str, ...]) -> Compound | None:
    """The reading at the end of a topic: what it is called, with an axis or a number behind."""
    joint = meaning_of(path[-2].strip(), actuated)
    if path[-1].lower() in _POSITION_OF and joint and joint[0].startswith("joint "):
        return _behind(path[:-2], joint[0], unit)
    for k in range(max(len(path) - 2, 0), len(path)):
        words = [word.lower() for word in _words(" ".join(path[k:]))]
        if words[0] in _QUANTITIES and len(words) <= 2:
            break
    else:
        last = _of_words(_words(path[-1]), path[-1], unit, actuated)
        if last is None:
            return None
        above = [*path[:-1], *([last.of] if last.of else [])]
        found = _behind(above, last.meaning, last.unit)
        return replace(found, said=last.said or found.said, counted=last.counted)
    what, behind = words[0], words[1] if len(words) == 2 else ""
    if what in ("stamp", "timestamp") and behind in ("", "sec", "secs"):
        return _behind(path[:k], "time", unit)
    if what in ("position", "positions") and behind.isdigit():
        return replace(_behind(path[:k], f"joint {int(behind)}", unit), counted=True)
    prefix = {"orientation": "q", "rotation": "q", "quaternion": "q", "force": "f", "torque": "m"}
    if behind not in ("x", "y", "z", "w"):
        return None
    return _behind(path[:k], f"{prefix.get(what, '')}{behind}", unit)


def _behind(path: list[str], meaning: str, unit: str | None) -> Compound:
    """A reading behind such parts of a topic."""
    words = {word.lower() for part in path for word in _words(part)}
    said = {_QUALIFIERS[part.lower()] for part in path if part.lower() in _QUALIFIERS}
    if not meaning.startswith("joint ") and "target" in words:  # the object that was tracked
        said = set()
    stated = said.pop() if len(said) == 1 else ""
    return Compound(meaning, unit, stated, "/".join(path), bool(words & INSTRUMENTS))


def _of_words(
    words: list[str], name: str, unit: str | None, actuated: tuple[str, ...]
) -> Compound | None:
    """A reading in one word or several with strokes between: ``ft_fx_N``, ``q1_meas_rad``."""
    tail = words[-1] if words[-1] in _TAILS else UNITS_IN_WORDS.get(words[-1].lower())
    if unit is None and len(words) > 1 and tail is not None:
        whole = _of_words(words[:-1], re.sub(r"[\s_]+\w+$", "", name), tail, actuated)
        if whole is not None:
            return whole
    low = [word.lower() for word in words]
    said = {_QUALIFIERS[word] for word in low if word in _QUALIFIERS}
    if len(said) > 1:
        return None
    stated = next(iter(said), "")
    kept = [k for k, word in enumerate(low) if word not in _QUALIFIERS]
    for surplus in (_QUALIFIERS, {**_QUALIFIERS, **dict.fromkeys(_POSITION_OF)}):
        own = "_".join(w for w in re.split(r"[\s_]+", name) if w.lower() not in surplus)
        meant = meaning_of(own, actuated)  # the robot's own joints, or numbered ones
        if meant and meant[0].startswith("joint "):
            return Compound(meant[0], unit, stated, "", instrument=False)
    if unit in _CELSIUS and _WARMTH.fullmatch(" ".join(low)):
        return Compound("temperature", unit, "", "", instrument=False)
    if len(kept) > 1:  # x_leica, before_leica_x: as leica_x, leica_x_before
        last = kept[-1]
        kept = sorted(kept, key=lambda k: low[k] not in (_BEHIND if k == last else INSTRUMENTS))
    first = 0
    while first < len(kept) - 1 and _stands_before(low[kept[first]], first):
        first += 1
        rest = " ".join(low[k] for k in kept[first:])
        meant = meaning_of(rest)
        if meant and _READ.fullmatch(meant[0].removeprefix("measured ")):
            break
    before = [low[k] for k in kept[:first]]
    rest = " ".join(low[k] for k in kept[first:])
    meant = meaning_of(rest)
    number = _NUMBERED.fullmatch(rest)
    if number:
        of = "_".join(before)
        return Compound(f"joint {int(number[1])}", unit, stated, of, instrument=False, counted=True)
    if rest == "t" and unit in PARTS_OF_SECONDS:
        return Compound("time", unit, stated, "_".join(before), instrument=False)
    sub = _SUBSCRIPT.fullmatch(rest)
    if sub and meant is None:
        meant, stated = (sub[1], 1.0), _SAID_BY.get(sub["said"], COMMANDED)
    if meant is None or meant[1] != 1.0 or not (before or said or unit or sub):
        return None
    instrument = bool(set(before) & INSTRUMENTS)
    meaning = meant[0].removeprefix("measured ")
    return Compound(meaning, unit, stated, "_".join(before), instrument)


def _stands_before(word: str, place: int) -> bool:
    """Is it no part of the reading: an instrument, a carrier, or the number or type of one?"""
    return word in _BEFORE or (place > 0 and any(map(str.isdigit, word)))


def _fits(found: Compound) -> bool:
    """Is the unit one of what was read?"""
    if found.unit is None or found.family in ("joint", "load"):
        kinds = {"joint": ("angle", "length"), "load": ("force", "moment")}.get(found.family, ())
        unit = found.unit
        return unit is None or any(units.is_kind(unit, kind) for kind in kinds)
    if found.family == "temperature":
        return found.unit in _CELSIUS
    if found.family == "time":
        return found.unit in PARTS_OF_SECONDS
    kind = kind_of(found.meaning)
    return kind is not None and units.is_kind(found.unit, kind) and found.unit not in MASSES
