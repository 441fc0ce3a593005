"""Units of dial gauges, which count parts of a unit: 1/100 mm, 0,01 mm, hundredths of mm."""

from __future__ import annotations

import re
from decimal import Decimal

from sk120stiff import units
from sk120stiff.measurements.importers.grid import is_number

_WORDS = {  # the power of ten that each divides by
    "tenths?|zehntel": 1, "hundredths?|hundertstel": 2, "thousandths?|tausendstel": 3,
}  # fmt: skip
_COUNTED = re.compile(
    r"(?:1\s*/\s*(?P<parts>10{1,4})|(?P<decimal>[01][.,]?0{0,5}1?|10{0,2}))\s*[*·x]?\s*"
    r"(?P<unit>[^\W\d].*|°)"
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
    plain = text.strip()
    found = _COUNTED.fullmatch(plain)
    if found and found["parts"]:
        size = 1 / Decimal(found["parts"])
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
