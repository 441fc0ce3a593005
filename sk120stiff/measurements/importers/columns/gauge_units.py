"""Names of dial gauges, and their units, which count parts of a unit: 1/100 mm, 0,01 mm, 10^-2 mm,
hundredths of mm, thou."""

from __future__ import annotations

import re
from decimal import Decimal

from sk120stiff import units
from sk120stiff.measurements.importers.grid import is_number

_WORDS = {  # the power of ten that each divides by
    "tenths?|zehntel": 1, "hundredths?|hundertstel": 2, "thousandths?|tausendstel": 3,
}  # fmt: skip
_COUNTED = re.compile(
    r"(?:1\s*/\s*(?P<parts>10{1,4})|(?:1\s*[*·x×]\s*)?10\s*(?:\^|\*\*)?\s*(?P<power>-[1-6])"
    r"|1[eE](?P<exponent>-0?[1-6])|(?P<decimal>[01][.,]?0{0,5}1?|10{0,2}))\s*[*·x×]?\s*"
    r"(?P<unit>[^\W\d].*|°)"
)
_BEFORE = re.compile(  # what stands before such a text and tells nothing: [x 0.01 mm], [Skt. = ...]
    r"(?:[x×*]|(?:1\s*)?(?:div(?:isions?)?|skt|skalenteile?|teilstriche?|graduations?|ticks?|counts?)"
    r"\.?(?:\s*(?:=|of|à|zu|von|de))?)\s*(?=\d)",
    re.IGNORECASE,
)
_MILS = (
    "mil",
    "mils",
    "thou",
    "thous",
    "tenth thou",
)  # thousandths of an inch, the last 1/10 of it
_POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
GAUGE_WORDS = (  # as regular expressions, in small letters
    "(?:dial|d|gauge|gage|dial ?gauge|dial ?gage|(?:dial ?|test ?)?indicator|dti|lvdt|messuhr|"
    "messtaster|f[üu]hlhebel(?:messger[äa]t)?|comparateur|comparatore|(?:reloj )?comparador|"
    "rel[óo]gio comparador)"
)
_IN_WORDS = [
    (power, re.compile(rf"(?:{word})(?: of)?(?: an?)?[ -]*(?P<unit>[^\W\d].*|)"))
    for word, power in _WORDS.items()
]
LARGEST = 1e-3  # m or rad, of several units that a gauge counts at once: 10 µm
_MICROMETRES = Decimal(1000)  # in a millimetre


def counted_unit(text: str) -> tuple[str, Decimal] | None:
    """The unit of such a text, and what one count is in it; None where it is no such unit.

    Parts of a millimetre come as micrometres, so that digits stay as they were read.
    """
    plain = _BEFORE.sub("", text.strip().translate(_POWERS), count=1)
    if plain.lower() in _MILS:
        return "in", Decimal("0.0001" if "tenth" in plain.lower() else "0.001")
    found = _COUNTED.fullmatch(plain)
    if found and found["parts"]:
        size = 1 / Decimal(found["parts"])
    elif found and (power := found["power"] or found["exponent"]):
        size = Decimal(10) ** int(power)
    elif found:
        size = Decimal(found["decimal"].replace(",", "."))
    else:
        words = ((power, each.fullmatch(plain.lower())) for power, each in _IN_WORDS)
        power, found = next(((p, m) for p, m in words if m), (0, None))
        size = Decimal(10) ** -power
    if found is None or size == 0:
        return None
    unit = found["unit"].strip() or "mm"  # hundredths without a word more are those of a dial gauge
    kind = next((k for k in ("length", "angle") if units.is_kind(unit, k)), None)
    if kind is None or (size > 1 and units.to_si(float(size), unit, kind) > LARGEST):
        return None  # (100 mm) behind a header is a place
    size = size.normalize()
    return ("um", (size * _MICROMETRES).normalize()) if unit == "mm" else (unit, size)


def multiplied(cell: str, size: Decimal) -> str:
    """The number of a cell in the unit that `counted_unit` names; a text stays what it is."""
    if not is_number(cell) or size == 1:
        return cell
    return f"{Decimal(cell) * size:f}"


def unit_behind(header: str) -> tuple[str, str] | None:
    """Name and unit of a header such as ``Messuhr in 1/100 mm``; None where none ends so.

    A whole number before a unit counts columns, as in ``Marker 1 mm``.
    """
    for gap in re.finditer(r"(?:\s+in)?[\s,]+", header):
        unit = header[gap.end() :]
        counted = counted_unit(unit) if gap.start() and unit[:1].isdigit() else None
        if counted and not unit.partition(" ")[0].isdigit():
            return header[: gap.start()], unit
    return None
