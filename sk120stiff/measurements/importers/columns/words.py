"""What the header of a column means, in the words that metrology programs use."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sk120stiff import units
from sk120stiff.measurements.importers.columns.chinese import in_english
from sk120stiff.measurements.importers.columns.gauge_units import (
    GAUGE_WORDS,
    counted_unit,
    unit_behind,
)
from sk120stiff.measurements.importers.columns.label_words import label_of_word
from sk120stiff.measurements.importers.columns.load_states import state_of
from sk120stiff.measurements.importers.columns.masses import MASSES
from sk120stiff.measurements.importers.contract import Meanings

TS = ("tx", "ty", "tz")
_AXIS = r"(?P<a>[xyz])"
_MOVED = (
    "(?:measured |tracker )?(?:displacements?|deflections?|disp|verschiebung(?:en)?|"
    "verformung(?:en)?|auslenkung(?:en)?|durchbiegung(?:en)?|d[eé]placements?|d[eé]formations?|fl[eè]ches?|"
    "spostament[oi]|deformazion[ei]|desplazamientos?|deformaci[oó]n|flecha|deslocamentos?|"
    "deforma[cç][aã]o|verplaatsing|przemieszczenie)"
)
_FORCE = (
    "(?:applied |external )?"
    "(?:forces?|kraft|kr[aä]fte|forz[ae]|fuerzas?|for[cç]as?|kracht|si[lł]a|wrench)"
)
_AXES = {
    "": rf"(?:(?:p|pos(?:ition)?|[ck]oord(?:inate)?|point|marker|trans(?:lation)?) ?)?{_AXIS}"
    r"(?: (?:[ck]oord(?:inate)?|pos(?:ition)?|value|wert))?",
    "measured ": rf"(?:meas(?:ured)?|act(?:ual)?|ist|tracker) {_AXIS}"
    rf"|{_AXIS.replace('a>', 'b>')} (?:meas(?:ured)?|act(?:ual)?|ist|tracker)",
    "nominal ": rf"(?:nom(?:inal)?|target|soll|theo\w*|cmd|command(?:ed)?) {_AXIS}"
    rf"|{_AXIS.replace('a>', 'b>')} (?:nom(?:inal)?|t|target|soll|theo\w*|cmd)",
    "deviation ": rf"(?:dev(?:iation)?|dif{{1,2}}|difference|err(?:or)?|delta) {_AXIS}"
    rf"|{_AXIS.replace('a>', 'b>')} (?:dev(?:iation)?|dif{{1,2}}|difference|err(?:or)?|delta)",
    "d": rf"d ?{_AXIS}|(?:{_MOVED}) {_AXIS.replace('a>', 'b>')}"
    rf"|{_AXIS.replace('a>', 'c>')} (?:{_MOVED})"
    rf"|{GAUGE_WORDS} (?:reading )?{_AXIS.replace('a>', 'e>')}",
    "turn ": rf"(?:d|delta) ?(?:r|rot(?:ation)?|phi|theta|th) ?{_AXIS}"
    rf"|(?:turn|twist|verdrehung) {_AXIS.replace('a>', 'b>')}",
    "u95 ": rf"(?:u ?95|exp(?:anded)? unc(?:ertainty)?) ?{_AXIS}"
    rf"|{_AXIS.replace('a>', 'b>')} ?u ?95",
    "s": rf"(?:s|sd|std(?: dev)?|sigma|u|unc(?:ertainty)?) ?{_AXIS}"
    rf"|{_AXIS.replace('a>', 'b>')} (?:sigma|std|sd|unc(?:ertainty)?)",
    "f": rf"(?:f|{_FORCE}) ?{_AXIS}|{_AXIS.replace('a>', 'b>')} (?:{_FORCE})",
    "m": rf"(?:m|moment|torque) ?{_AXIS}",
    "t": rf"t ?{_AXIS}",  # a translation, or a torque: `with_torques` tells
    "tcp ": rf"(?:tcp|tool) ?{_AXIS}",
    "orientation ": rf"(?:phi|rot(?:ation)?|r) ?{_AXIS}\d?",
    "measured orientation ": rf"(?:meas(?:ured)?|act(?:ual)?|ist) (?:rot(?:ation)?|r) ?{_AXIS}",
    "q": r"(?:q|quat(?:ernion)?) ?(?P<a>[wxyz])",
}
_PATTERNS = {prefix: re.compile(pattern) for prefix, pattern in _AXES.items()}
_NAMES = {
    "name": "object|object name|feature|feature name|punktname|punktnummer",
    "group": "group|group name|point group|tag group",
    "collection": "collection|collection name",
    "order": "order|step order|seq|sequence|measurement order",
    "time": "time|timestamp|time stamp|time of day|clock|date time|date/time|date & time|"
    "date and time|datetime|zeit|uhrzeit|zeitstempel|datum uhrzeit|datum/uhrzeit|datum zeit|"
    "datum/zeit|datum und uhrzeit|heure|date heure|ora|hora|fecha hora",
    "date": "date|datum|fecha",
    "branch": "branch|load branch|ast|lastast|belastungsast",
    "repeat": "repeat|repetition|rep|wdh|wdh nr|wiederholung|wiederholung nr|run|run no|durchgang|"
    "durchlauf|répétition|ripetizione|repetición",
    "direction": "direction|dir|load direction|richtung|lastrichtung|belastungsrichtung|sens|"
    "direzione|dirección",
    "force direction": "force direction|direction of force|kraftrichtung",
    "reading direction": "reading direction|direction of reading|measuring direction|measurement "
    "direction|gauge direction|dial direction|messrichtung|tastrichtung|ableserichtung|"
    "sens de mesure|direzione di misura|dirección de medida",
    "marker": "marker|reflector|smr",
    "station": "station|station id|station no|station name|instrument station|tracker station|"
    "instrument id|instrument setup|tracker setup|tracker position|standpunkt|standort|stazione",
    "orientation roll": "roll",
    "orientation pitch": "pitch",
    "orientation yaw": "yaw",
    "control": "control|dimension",
    "measured": "meas|measured|actual|ist",
}
_OWN = ("payload", "load", "use", "series")  # mean themselves
_WORDS = {word: meaning for meaning, words in _NAMES.items() for word in words.split("|")} | {
    word: word for word in _OWN
}
_TEMPERATURE = re.compile(r"(?:\w+ )?temp(?:[eé]rature?|eratura)?(?: \w+)?")
JOINT = re.compile(
    r"(?:q|j|jt|jnt|joint|gelenk|axis|achse|axe|asse|eje|ax|rax|a|th|theta|θ)[ _]?(\d+)"
    r"(?: (?:angle|pos(?:ition)?|value))?"
)
_BRACKETS = re.compile(r"\s*[\[(]([^\[\]()]*)[\])]\s*")
_TAIL = re.compile(
    r"(.+?)(?:(?:\s*[/,]\s*|\s+in\s+|\s)(mm|um|µm|m|inch|in|deg|rad|°|N|kN|daN|kgf|kp|kg|s)"
    r"|_(mm|um|deg|rad|kg))"
)
_BEHIND = re.compile(r"(.+?)(?:\s*/\s*|\s+in\s+)([^\s/]+)")  # a unit in words, as Theta_1 / Grad
_DEGREES = {"°C", "degC", "C", "ºC"}
_COVERAGE = re.compile(r"k ?= ?([123](?:\.\d+)?)")
_FILE_UNITS = {
    "length": {"mm": "mm", "millimeters": "mm", "millimetres": "mm", "millimeter": "mm",
               "millimetre": "mm", "m": "m", "meters": "m", "metres": "m", "meter": "m",
               "metre": "m", "inches": "in", "inch": "in"},
    "angle": {"deg": "deg", "degrees": "deg", "degree": "deg", "rad": "rad", "radians": "rad",
              "radian": "rad"},
}  # fmt: skip

UNITS_IN_WORDS = {  # words of units, as headers and rows of units have them
    word: unit
    for known in (
        *_FILE_UNITS.values(),
        {
            "seconds": "s",
            "second": "s",
            "sec": "s",
            "newtons": "N",
            "newton": "N",
            "grad": "deg",
            "mikrometer": "um",
            "micrometers": "um",
            "micrometres": "um",
            "microns": "um",
        },
    )
    for word, unit in known.items()
    if len(word) > 2
}


def unit_of_header(header: str) -> tuple[str, str | None]:
    """Name and unit of a header as people write it: ``X (mm)``, ``X [Meters]``, ``x_mm``."""
    header = in_english(header)
    for match in _BRACKETS.finditer(plain := header.strip()):  # U(95) X [mm] has two
        unit = UNITS_IN_WORDS.get(match[1].strip().lower(), match[1].strip())
        if is_unit(unit):
            return f"{plain[: match.start()]} {plain[match.end() :]}".strip(), unit
    parts = unit_behind(header.strip())
    if parts:
        return parts
    tail = _TAIL.fullmatch(header.strip())
    if tail:
        return tail[1], tail[2] or tail[3]
    behind = _BEHIND.fullmatch(header.strip())
    unit = UNITS_IN_WORDS.get(behind[2].lower(), behind[2]) if behind else ""
    if behind and is_unit(unit):
        return behind[1], unit
    return header.strip(), None


def is_unit(text: str) -> bool:
    """Is this the name of a unit, that of a temperature, a mass or a dial gauge among them?

    A number alone is none: it counts, as in ``position[1]``.
    """
    if text.strip().isdigit():
        return False
    known = text.strip() in {*_DEGREES, "K", *MASSES} or units.is_unit(text)
    return known or counted_unit(text) is not None


def meaning_of(name: str, actuated: tuple[str, ...] = ()) -> tuple[str, float] | None:
    """Meaning of a column's name without its unit, and the factor of its numbers; None: unknown.

    ``x y z`` positions; ``measured x``, ``nominal x``, ``deviation x``; ``dx`` displacements;
    ``unloaded x``, ``loaded x`` both of a pose; ``sx`` standard uncertainties; ``fx mx payload
    load`` loads, ``direction`` of a force or branch; ``tcp x`` the marker in the tool frame;
    ``qw``, ``orientation ...`` axes, ``turn x`` how a load turned them; ``joint 3``; and labels.
    """
    if name in actuated:
        return f"joint {actuated.index(name) + 1}", 1.0
    plain = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", in_english(name)).lower()
    cover = _COVERAGE.search(plain)
    plain = _COVERAGE.sub("", plain) if cover else plain
    plain = re.sub("[\N{GREEK SMALL LETTER DELTA}\N{INCREMENT}]", "delta ", plain)
    plain = re.sub(r"[\s_.\-:()\[\],]+", " ", plain).strip()
    if plain in _WORDS:
        return _WORDS[plain], 1.0
    label = label_of_word(plain)
    if label:
        return label, 1.0
    joint = JOINT.fullmatch(plain)
    if joint:
        return f"joint {int(joint[1])}", 1.0
    for prefix, pattern in _PATTERNS.items():
        match = pattern.fullmatch(plain)
        if match:
            axis = next(found for found in match.groupdict().values() if found)
            if prefix == "u95 " or (prefix == "s" and cover):
                return f"s{axis}", 1.0 / (float(cover[1]) if cover else 2.0)
            return prefix + axis, 1.0
    said = state_of(plain)
    for prefix in ("", "measured ") if said else ():
        match = _PATTERNS[prefix].fullmatch(said[1]) if said else None
        if said and match:
            return f"{said[0]} {next(found for found in match.groupdict().values() if found)}", 1.0
    if _TEMPERATURE.fullmatch(plain):
        return "temperature", 1.0
    return None


def with_forces(
    names: Sequence[str], meanings: Meanings, units_of: Sequence[str | None]
) -> Meanings:
    """Meanings with what is counted in units of a force or a moment, and is called ``Load X``,
    ``Carga y`` or the like, as a force or moment along that axis, whatever the other words are."""
    out = list(meanings)
    for k, (name, unit) in enumerate(zip(names, units_of, strict=True)):
        known = out[k]
        words = re.sub(r"[\s_.\-:()\[\],]+", " ", name).strip().lower().split()
        axis = next((w for w in (words[-1:] + words[:1]) if w in ("x", "y", "z")), None)
        if axis is None or not unit or (known and kind_of(known[0]) != "length"):
            continue
        for kind, letter in (("force", "f"), ("moment", "m")):
            if units.is_kind(unit, kind):
                out[k] = f"{letter}{axis}", 1.0
    return out


def with_torques(
    meanings: Sequence[tuple[str, float] | None], units_of: Sequence[str | None]
) -> Meanings:
    """What tx, ty, tz mean: torques beside forces or in such a unit, else where the marker is."""
    torques = any(known and known[0] == "fx" for known in meanings) or any(
        known and known[0] == "tx" and unit and units.is_kind(unit, "moment")
        for known, unit in zip(meanings, units_of, strict=True)
    )
    return [
        ((known[0].replace("t", "m" if torques else ""), known[1]) if known[0] in TS else known)
        if known
        else None
        for known in meanings
    ]


def file_units(texts: list[str]) -> dict[str, str]:
    """Units that lines above a table state for all of it: ``length`` and ``angle``."""
    found: dict[str, str] = {}
    for text in texts:
        if re.search(r"unit|einheit", text, re.IGNORECASE):
            for word in re.findall(r"[A-Za-zµ]+", text):
                for kind, known in _FILE_UNITS.items():
                    if (unit := known.get(word.lower())) and (len(word) > 2 or word.islower()):
                        found.setdefault(kind, unit)
    return found


def kind_of(meaning: str) -> str | None:
    """Kind of the unit that a meaning has; None where it has none that could be told."""
    word = meaning.rpartition(" ")[2]
    if meaning.startswith("orientation r") and word[1:].isdigit():  # r11: a number of a matrix
        return None
    if meaning.startswith(("joint ", "orientation ", "turn ")):
        return "angle"
    if word in ("fx", "fy", "fz", "payload"):
        return "force"
    return (
        "length" if word in ("x", "y", "z", "dx", "dy", "dz", "sx", "sy", "sz", "gauge") else None
    )


def as_measured(
    meanings: Meanings,
) -> tuple[tuple[str, float] | None, ...]:
    """What is called measured is the position; what stands plainly beside it was nominal.

    So are angles called measured the orientation, and plain ones beside them nothing.
    """
    words = {known[0] for known in meanings if known}
    other: dict[str, str] = {}
    for of, beside in (("", "nominal {}"), ("orientation ", "")):
        if {f"measured {of}{axis}" for axis in "xyz"} <= words:
            other |= {f"{of}{axis}": beside.format(axis) for axis in "xyz"}
            other |= {f"measured {of}{axis}": f"{of}{axis}" for axis in "xyz"}
    named = [(other.get(known[0], known[0]), known[1]) if known else None for known in meanings]
    return tuple(known if known and known[0] else None for known in named)


def is_needed(meaning: str) -> bool:
    """Is a row without a number in such a column no reading?"""
    return meaning.startswith(
        ("joint ", "nominal ", "deviation ", "tcp ", "loaded ", "unloaded ")
    ) or meaning in {
        "x", "y", "z", "dx", "dy", "dz", "gauge", "ux", "uy", "uz",
        "fx", "fy", "fz", "mx", "my", "mz", "payload", "load",
    }  # fmt: skip
