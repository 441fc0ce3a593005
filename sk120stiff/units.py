"""Units at the edges of the program: numbers as people write them become SI arrays, and back.

Inside everything is SI (m, rad, N, N·m, s). A number without a unit is never guessed at.
A *kind* says what a number is. It is one of `KINDS`, or the SI unit itself (``"N*m**2"``) where a
parameter of an effect needs something rarer. Angles are a dimension of their own here, so a
rotational stiffness (N·m/rad) is not taken for a moment (N·m), nor an angle for a plain number.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import get_close_matches
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, meant

if TYPE_CHECKING:
    import pint

# Kind → the SI units that it may be reduced to, and the spellings that a message offers.
KINDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "angle": (("rad",), ("deg", "rad", "mrad", "urad")),
    "length": (("m",), ("mm", "um", "m", "in")),
    "force": (("N",), ("N", "kN", "lbf", "kgf")),
    "moment": (("N*m",), ("N*m", "N*mm", "kN*m")),
    "time": (("s",), ("s", "ms", "min", "h")),
    "stiffness_linear": (("N/m",), ("N/m", "N/mm", "N/um")),
    "stiffness_angular": (("N*m/rad",), ("N*m/rad", "N*mm/rad")),
    "stiffness": (("N*m/rad", "N/m"), ("N*m/rad", "N*mm/rad", "N/m", "N/um")),
    "compliance_linear": (("m/N",), ("m/N", "um/N")),
    "compliance_angular": (("rad/(N*m)",), ("rad/(N*m)", "urad/(N*m)")),
    "compliance": (("rad/(N*m)", "m/N"), ("rad/(N*m)", "urad/(N*m)", "m/N", "um/N")),
    "dimensionless": (("1",), ("1", "%", "ppm")),
}

# Force stands as a base dimension: no mass is ever converted, and "kg" stays an error.
_DEFINITIONS = """
nano- = 1e-9 = n-
micro- = 1e-6 = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
deca- = 1e1 = da-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
meter = [length] = m = metre
second = [time] = s = sec
newton = [force] = N
radian = [angle] = rad
degree = 0.017453292519943295 * radian = deg = Grad
arcminute = 0.0002908882086657216 * radian = arcmin
arcsecond = 4.84813681109536e-06 * radian = arcsec
minute = 60 * second = min
hour = 3600 * second = h
micron = 1e-6 * meter
inch = 0.0254 * meter = in = _ = inches
foot = 0.3048 * meter = ft = _ = feet
pound_force = 4.4482216152605 * newton = lbf
kilogram_force = 9.80665 * newton = kgf = kp
joule = newton * meter = J
pascal = newton / meter ** 2 = Pa
percent = 0.01
ppm = 1e-6
"""
_SPELLINGS = {
    "·": "*", "⋅": "*", "∙": "*", "×": "*", "^": "**", "²": "**2", "³": "**3",
    "°": "deg", "µ": "u", "μ": "u", "−": "-", "%": "percent",
}  # fmt: skip
# A unit is a product of powers. Anything else is refused before pint could try to compute it.
_FACTOR = r"(?:[A-Za-z]+|1)(?:\*\*-?[1-9])?"
_PRODUCT = rf"{_FACTOR}(?:[*/]{_FACTOR})*"
# A moment in one word: newton-metre, never nanometre; the brackets keep "rad/Nm" what it says.
_JOINED_MOMENT = re.compile(r"\b([kMmu]?N)([mcu]?m)\b")
_HYPHEN = re.compile(r"(?<=[A-Za-z])-(?=[A-Za-z])")  # N-m, lbf-in
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?=$|[^\d.])")
LARGEST = 1e15  # of a number as written; squares and products of such still are finite
_NOT_FINITE = re.compile(r"\s*[+-]?(nan|inf|infinity)\b", re.IGNORECASE)


def split_header(header: str, *, where: str | None = None) -> tuple[str, str | None]:
    """Name and unit of a column header: ``"fx[N]"`` gives ``("fx", "N")``, ``"pose"`` no unit.

    Raises:
        InputError: The square brackets are not one pair at the end.
    """
    text = header.strip()
    name, opening, rest = text.partition("[")
    if not opening and "]" not in text:
        return text, None
    if not rest.endswith("]") or "[" in rest or "]" in rest[:-1] or not name.strip():
        raise InputError(
            f"the header {text!r} is not a name with its unit in square brackets",
            where=where,
            remedy="Write it like fx[N].",
        )
    return name.strip(), rest[:-1].strip() or None


def to_si(values: ArrayLike, unit: str | None, kind: str, *, where: str | None = None) -> Array:
    """Numbers with a unit as SI numbers of the same shape.

    Args:
        values: Any shape, finite.
        unit: As written by a person: ``deg``, ``°``, ``µm``, ``Nm`` (newton-metre), ``N·mm/rad``
            ...
        kind: What the numbers are: a key of `KINDS` or an SI unit.
        where: Place for the message: a file with line and column, or an option.

    Raises:
        InputError: No unit, an unknown unit, a unit of another kind, or a number beyond `LARGEST`.
    """
    array = _finite(values, where)
    if np.any(np.abs(array) > LARGEST):
        raise InputError(f"{np.abs(array).max():g} is beyond all that is measured", where=where)
    scale, divide = _conversion(unit, kind, where)
    return array / scale if divide else array * scale


def from_si(values: ArrayLike, unit: str | None, kind: str, *, where: str | None = None) -> Array:
    """SI numbers in the given unit; the inverse of `to_si`, with the same errors."""
    array = _finite(values, where)
    scale, divide = _conversion(unit, kind, where)
    return array * scale if divide else array / scale


def is_kind(unit: str, kind: str) -> bool:
    """Whether `unit` is known and belongs to `kind`."""
    try:
        _conversion(unit, kind, None)
    except InputError:
        return False
    return True


def is_unit(unit: str) -> bool:
    """Whether `unit` is known at all."""
    return _quantity(unit) is not None


def parse_values(
    text: str, kind: str, *, where: str | None = None, like: str | None = None
) -> Array:
    """SI numbers (k,) from text like ``"10,20,-30 deg"``.

    A unit holds for the numbers before it that have none. Numbers are separated by commas,
    semicolons or blanks. `like` is an example with as many numbers as there must be.

    Raises:
        InputError: No number, a word that is no number, a missing, unknown or unfit unit, or
            another count than that of `like`.
    """
    numbers, units, spare = _numbers_with_units(text, where, like or f"10,20,-30 {_usual(kind)[0]}")
    if spare:
        raise InputError(f"the unit {spare[0]!r} follows no number", where=where)
    if like is not None and len(numbers) != (count := len(_numbers_with_units(like, where, "")[0])):
        raise InputError(
            f"{text!r} holds {len(numbers)} numbers, not {count}",
            where=where,
            remedy=f"Write it like {like!r}.",
        )
    return np.array([to_si(x, u, kind, where=where) for x, u in zip(numbers, units, strict=True)])


def parse_size(text: str, kind: str, *, where: str, like: str) -> float:
    """One positive SI number from text like ``"10 um"``; errors as those of `parse_values`."""
    (value,) = parse_values(text, kind, where=where, like=like)
    if value <= 0.0:
        raise InputError(
            f"{text!r} is not positive", where=where, remedy=f"Write it like {like!r}."
        )
    return float(value)


def parse_pose(
    text: str,
    names: Sequence[str],
    kinds: Sequence[str] | str = "angle",
    *,
    where: str | None = None,
) -> Array:
    """Actuated coordinates (n,) in rad or m, from one number per joint or from named joints.

    ``"10,20,-30,0,0,0 deg"`` gives every joint in the order of `names`; ``"joint_2_l=20 deg"``
    names some, and the rest are zero. A robot with slides mixes units: ``"10,20 deg, 100 mm"``.

    Args:
        names: The n actuated joints.
        kinds: ``"angle"`` or ``"length"`` per joint, or one for all.

    Raises:
        InputError: Wrong count, unknown or repeated joint, or what `to_si` refuses.
    """
    each = [kinds] * len(names) if isinstance(kinds, str) else list(kinds)
    if len(each) != len(names):
        raise InputError(f"{len(each)} kinds for {len(names)} joints", where=where)
    chosen, rest = _joint_names(text, names, where) if "=" in text else (list(names), text)
    example = ", ".join(f"0 {_usual(kind)[0]}" for kind in each)
    numbers, units, spare = _numbers_with_units(rest, where, example)
    if spare or len(numbers) != len(chosen):
        raise InputError(
            f"{len(numbers)} values for {len(chosen)} joints" if not spare
            else f"the unit {spare[0]!r} follows no number",
            where=where,
            remedy=f"Give one value per joint in the order {', '.join(names)}, "
            f"or name some: '{names[0]}=20 {_usual(each[0])[0]}'.",
        )  # fmt: skip
    pose = np.zeros(len(names))
    for name, number, unit in zip(chosen, numbers, units, strict=True):
        k = list(names).index(name)
        place = f"{where}, joint {name}" if where else f"joint {name}"
        pose[k] = to_si(number, unit, each[k], where=place)
    return pose


def parse_wrench(text: str, *, where: str | None = None) -> Array:
    """Force and moment (6,) in N and N·m: ``"100,0,-200 N"`` or ``"100,0,-200,0,0,5 N, N*m"``.

    Raises:
        InputError: Neither three nor six numbers, six with one unit only, or what `to_si` refuses.
    """
    remedy = "Write three forces, '100,0,-200 N', or forces and moments, '100,0,-200,0,0,5 N, N*m'."
    numbers, units, spare = _numbers_with_units(text, where, "100,0,-200 N")
    if len(spare) == 1 and len(numbers) == 6 and len(set(units)) == 1:
        units, spare = [*units[:3], *(spare * 3)], []
    if spare or len(numbers) not in (3, 6):
        raise InputError(
            f"{len(numbers)} numbers and {len(set(units)) + len(spare)} units are no wrench",
            where=where,
            remedy=remedy,
        )
    if len(numbers) == 6 and len(set(units)) == 1:
        raise InputError(
            f"six numbers with the one unit {units[0]!r}: the moments have none of their own",
            where=where,
            remedy=remedy,
        )
    wrench = np.zeros(6)
    for i, (number, unit) in enumerate(zip(numbers, units, strict=True)):
        wrench[i] = to_si(number, unit, "force" if i < 3 else "moment", where=where)
    return wrench


def _finite(values: ArrayLike, where: str | None) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if not np.all(np.isfinite(array)):
        bad = array[~np.isfinite(array)].flat[0]
        raise InputError(f"{bad} is not a finite number", where=where, remedy="Write a number.")
    return array


def _usual(kind: str) -> tuple[str, ...]:
    return KINDS[kind][1] if kind in KINDS else (kind,)


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[float]:
    import pint

    registry: pint.UnitRegistry[float] = pint.UnitRegistry(None)
    registry.load_definitions(_DEFINITIONS.strip().splitlines())
    return registry


@lru_cache(maxsize=1024)
def _quantity(text: str) -> tuple[float, tuple[str, ...]] | None:
    """Size in base units and dimensions of a unit as written; None where it is unknown."""
    plain = text.strip()
    for spelling, meaning in _SPELLINGS.items():
        plain = plain.replace(spelling, meaning)
    plain = _HYPHEN.sub("*", _JOINED_MOMENT.sub(r"(\1*\2)", plain))
    plain = re.sub(r"\s+", "*", re.sub(r"\s*(\*\*|[*/()])\s*", r"\1", plain))
    if not _is_product_of_powers(plain):
        return None
    import pint

    registry = _registry()
    try:
        size = registry.Quantity(1.0, registry.parse_units(plain)).to_root_units()
    except (pint.UndefinedUnitError, ValueError, OverflowError):
        return None
    dimensions = tuple(sorted(f"{name}:{power:g}" for name, power in size.dimensionality.items()))
    return float(np.asarray(size.magnitude)), dimensions


def _is_product_of_powers(plain: str) -> bool:
    if len(plain) > 60 or re.search(r"\w\(|\)[\w(]", plain):
        return False
    shorter = re.sub(rf"\({_PRODUCT}\)", "u", plain)
    while shorter != plain:
        plain, shorter = shorter, re.sub(rf"\({_PRODUCT}\)", "u", shorter)
    return re.fullmatch(_PRODUCT, plain) is not None


@lru_cache(maxsize=1024)
def _factor(unit: str, kind: str) -> tuple[float, bool] | None:
    """Factor to SI, as a divisor where that is the round number; None where the kind differs."""
    here = _quantity(unit)
    for si in KINDS[kind][0] if kind in KINDS else (kind,):
        there = _quantity(si)
        if there is None:
            raise ValueError(f"{kind!r} is neither a kind nor an SI unit")
        if here is not None and here[1] == there[1]:
            scale = here[0] / there[0]
            inverse = there[0] / here[0]
            # 55 mm / 1000 is the float nearest to 0.055; 55 * 0.001 need not be.
            if scale < 1.0 and abs(inverse - round(inverse)) < 1e-9 * inverse:
                return float(round(inverse)), True
            return scale, False
    return None


def _conversion(unit: str | None, kind: str, where: str | None) -> tuple[float, bool]:
    usual = _usual(kind)
    label = kind.replace("_", " ")
    if unit is None or not unit.strip():
        raise InputError(
            f"the unit is missing ({label})",
            where=where,
            remedy=f"Write the unit, for example {' or '.join(usual[:4])}.",
        )
    found = _factor(unit, kind)
    if found is not None:
        return found
    if _quantity(unit) is None:
        lowered = {name.lower(): name for name in usual}
        close = get_close_matches(unit.strip().lower(), list(lowered), n=1)
        hint = f" (did you mean {lowered[close[0]]}?)" if close else ""
        what = f"the unit {unit!r} is not known{hint}"
    else:
        what = f"the unit {unit!r} is not a unit of {label}"
    raise InputError(what, where=where, remedy=f"Usual units here: {', '.join(usual)}.")


def _numbers_with_units(
    text: str, where: str | None, example: str
) -> tuple[list[float], list[str | None], list[str]]:
    """Numbers, the unit of each, and units at the end that follow no number."""
    numbers: list[float] = []
    units: list[str | None] = []
    spare: list[str] = []
    for piece in re.split(r"[,;]", text):
        rest, fresh = piece, 0
        while match := _NUMBER.match(rest):
            numbers.append(float(match.group(1)))
            units.append(None)
            rest, fresh = rest[match.end() :], fresh + 1
        unit = rest.strip()
        if _NOT_FINITE.match(unit) or not np.all(np.isfinite(numbers)):
            raise InputError(f"{piece.strip()!r} is not a finite number", where=where)
        if not fresh and not (unit and numbers):
            raise InputError(
                f"{unit!r} is not a number" if unit else f"{text!r} has an empty place",
                where=where,
                remedy=f"Write numbers with a unit: '{example}'.",
            )
        if unit and fresh:
            units = [unit if u is None else u for u in units]
        elif unit:
            spare.append(unit)
    if any(u is None for u in units):
        raise InputError(
            f"{text.strip()!r} has no unit",
            where=where,
            remedy=f"Write the unit after the numbers: '{example}'.",
        )
    return numbers, units, spare


def _joint_names(text: str, names: Sequence[str], where: str | None) -> tuple[list[str], str]:
    """Names left of the equals signs, and the text of their values in the same order."""
    chosen: list[str] = []
    values: list[str] = []
    for piece in re.split(r"[,;]", text):
        name, equals, value = (part.strip() for part in piece.partition("="))
        if not equals:
            raise InputError(
                f"{piece.strip()!r} names no joint",
                where=where,
                remedy=f"Write '{names[0]}=20 deg, ...' for every value, or names for none.",
            )
        if name not in names:
            raise InputError(
                f"no actuated joint is called {name!r}{meant(name, names)}",
                where=where,
                remedy=f"The actuated joints are {', '.join(names)}.",
            )
        if name in chosen:
            raise InputError(f"the joint {name!r} is given twice", where=where)
        chosen.append(name)
        values.append(value)
    return chosen, ", ".join(values)
