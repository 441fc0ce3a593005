"""Numbers, units and lists as reports and figures write them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sk120stiff.errors import micro


def um(metres: float) -> str:
    """A length in micrometres: three digits, none after the point from 100 on; "?": not known."""
    return "?" if math.isnan(metres) else micro(metres)


def um_or_less(metres: float) -> str:
    """The same; below a nanometre it is zero for every purpose."""
    return "< 0.001" if metres < 1e-9 else um(metres)


def percent(share: float) -> str:
    """A share in per cent; small ones with a digit more."""
    value = 100.0 * share
    return f"{value:.0f} %" if abs(value) >= 9.95 else f"{value:.2g} %"


VAGUE = 0.1  # of its error, below which a value has digits of its own


def unit_of(written: str) -> str:
    """A unit as print has it: ``N*m**2/rad`` becomes N·m²/rad, and 1 is not written."""
    if written == "1":
        return ""
    return written.replace("**2", "²").replace("**3", "³").replace("*", "·")


def with_error(value: float, std: float | None, unit: str = "") -> str:
    """``(1.41 ± 0.11)·10⁷ N·m/rad``: a value to the digits that its standard error supports."""
    tail = f" {unit_of(unit)}" if unit_of(unit) else ""
    if not math.isfinite(value):
        return "rigid" if value > 0 else number(value)
    if std is None or not math.isfinite(std) or std <= 0.0:
        return f"{number(value)}{tail}"
    vague = 0.0 < abs(value) < VAGUE * std  # digits of such an error would hide the value
    exponent = math.floor(math.log10(abs(value) if vague else max(abs(value), std)))
    if -3 <= exponent <= 4:
        exponent = 0
    scale = 10.0**exponent
    places = min(max(0, 1 - math.floor(math.log10((abs(value) if vague else std) / scale))), 9)
    error = f"{float(f'{std / scale:.2g}'):.0f}" if vague else f"{std / scale:.{places}f}"
    text = f"{value / scale:.{places}f} ± {error}".replace("-", "−")
    return f"({text})·10{raised(exponent)}{tail}" if exponent else f"{text}{tail}"


def said_in(unit: str, size: float) -> tuple[float, str]:
    """The unit in which people say a size, and the factor to it from the unit of a file.

    Examples:
        >>> said_in("N*m/rad", 1.4e6)
        (0.001, 'kN·m/rad')
        >>> said_in("rad", 2e-4)
        (1000000.0, 'µrad')
    """
    known = {
        "N*m/rad": [(math.inf, 1e-3, "kN·m/rad")],
        "N/m": [(math.inf, 1e-6, "N/µm")],
        "rad": [(1e-3, 1e6, "µrad"), (2e-2, 1e3, "mrad"), (math.inf, 180.0 / math.pi, "°")],
        "m": [(1e-3, 1e6, "µm"), (math.inf, 1e3, "mm")],
        "rad/(N*m)": [(math.inf, 1e6, "µrad/(N·m)")],
        "m/N": [(math.inf, 1e6, "µm/N")],
    }
    for below, factor, name in known.get(unit.replace("·", "*"), []):
        if not abs(size) >= below or not math.isfinite(below):
            return factor, name
    return 1.0, unit_of(unit)


def said_as(value: float, std: float | None, unit: str) -> str:
    """A value with its error in the unit in which people say it: ``1357 ± 15 kN·m/rad``."""
    factor, name = said_in(unit, value)
    return with_error(factor * value, None if std is None else factor * std, name)


def number(value: float, digits: int = 4) -> str:
    """A number with a true minus sign and, where it helps, a power of ten."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else ("∞" if value > 0 else "−∞")
    if value and not 1e-3 <= abs(value) < 1e5:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        return f"{float(mantissa):g}·10{raised(int(exponent))}".replace("-", "−")
    if not value:
        return "0"
    places = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    text = f"{value:.{places}f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "−")


def raised(exponent: int) -> str:
    """Digits as superscripts."""
    return str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def chance(probability: float) -> str:
    """A probability as a cell."""
    return "<\u00a010⁻⁶" if probability < 1e-6 else number(probability, 2)


def load_in_words(wrench: Sequence[float]) -> str:
    """``load 0, 0, -490 N``: a wrench [N, N·m], its moment only where there is one."""
    if not any(wrench):
        return "no load"
    text = "load " + ", ".join(f"{component:g}" for component in wrench[:3]) + " N"
    if any(wrench[3:]):
        text += "; " + ", ".join(f"{component:g}" for component in wrench[3:]) + " N·m"
    return text


def counted(count: int, one: str) -> str:
    """``1 pose``, ``3 poses``."""
    return f"{count} {one}{'s' * (count != 1)}"
