"""Which mass hung on the tool, as names of files and comments above a table say it.

A number counts with its unit alone, where a word such as *payload* stands beside it, or where names
of files are alike but for it. What a robot may bear, what was taken off or weighs something else is
told by no list of words: a mass that is neither is pointed out, and nobody takes it for a load.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.masses import LOAD_WORDS, MASSES

ALONE = "no word such as payload stands beside it, and no other file differs from it by the mass"
DENIED = "its words deny or bound it"
PARTED = "a number before it may be its whole part"
MORE = "the line says more than what hung on the tool"

_NUMBER = r"\d+(?:[.,]\d+|p\d+)?"  # 2.5, 2,5 and 2p5
_UNIT = r"(?P<unit>[kK][gG]|g|lbs?)(?![^\W_])"  # G is no gram
_TOKEN = re.compile(rf"(?<![\d.,])(?P<number>{_NUMBER})[ _-]?{_UNIT}")
_FORCE = re.compile(r"(?<![\d.,])\d+(?:[.,]\d+)?[ _-]?(?:N|kN|daN)(?![^\W_])")
_WORDS = "|".join(sorted(LOAD_WORDS, key=len, reverse=True))
_BEFORE = re.compile(rf"(?<![^\W\d_])(?:{_WORDS}|with|mit|m|w)[\W_]*$", re.IGNORECASE)
_BEHIND = re.compile(rf"[\W_]+(?:{_WORDS})(?![^\W\d_]|[\W_]*\d)", re.IGNORECASE)  # not the next's
_PART = re.compile(r"(?<![\d.,])\d{1,2}[_-]$")  # 2_5kg may be 2.5: file names bear no point
_DENYING = re.compile(
    r"(?<![^\W\d_])(?:unloaded|unbelastet|without|no|not|non|minus|empty|off|removed|ohne|kein\w*|leer|sans|senza|"
    r"sin|max\w*|min|rated|nominal|class|limit|capacity)(?![^\W\d_])",
    re.IGNORECASE,
)
_WITHOUT = re.compile(
    r"(?<![^\W\d_])(?:unloaded|unbelastet|lastfrei|leer|empty|(?:no|without|zero|ohne|sans|senza|sin)"
    rf"[\W_]*(?:{_WORDS}))(?![^\W\d_])",
    re.IGNORECASE,
)
_SMALL = r"(?:with|a|an|the|of|is|was|mit|ist|von|der|die|avec|de|con|di)(?![^\W_])"
_STATED = re.compile(  # what is left of a line without the mass, if it says that alone
    rf"\W*(?:{_SMALL}\W*)*(?:{_WORDS}|m)(?![^\W_])(?:\W*{_SMALL})*(?:\W+(?:on|at|an|am)\W.*)?\W*",
    re.IGNORECASE,
)


class Words(NamedTuple):
    """Masses that words hold [kg], as they stand there; several of them are several.

    Attributes:
        masses, texts: Those that hung on the tool.
        left: Words and reason of those that may not have.
    """

    masses: tuple[float, ...] = ()
    texts: tuple[str, ...] = ()
    left: tuple[tuple[str, str], ...] = ()


def masses_of_name(stem: str, beside: Sequence[str] = ()) -> Words:
    """The masses in the name of a file without its ending.

    Args:
        stem: As ``UR10_payload_5kg``.
        beside: Names of all files of the campaign, without endings.

    Examples:
        >>> masses_of_name("UR10_payload_5kg").masses
        (5.0,)
        >>> masses_of_name("ur10_5kg", ["ur10_0kg", "ur10_5kg"]).masses
        (5.0,)
        >>> masses_of_name("IRB6700_155kg").masses
        ()
        >>> masses_of_name("run3_2.5kg", ["run1_0kg", "run3_2.5kg"]).masses
        (2.5,)
    """
    found: dict[float, str] = {}
    left = []
    for match in _TOKEN.finditer(stem):
        before, behind = stem[: match.start()], stem[match.end() :]
        called = bool(_BEFORE.search(before) or _BEHIND.match(behind))
        if not called and match["unit"] == "g":
            continue  # 5g is a network, 2g an acceleration
        told = _pointed(stem, *beside) or _counted(before, match, beside)
        if _DENYING.search(stem):
            left.append((match.group(), DENIED))
        elif _PART.search(before) and not told:
            left.append((match.group(), PARTED))
        elif not called and len(_alike(before, beside)) < 2:
            left.append((match.group(), ALONE))
        else:
            found.setdefault(_kilograms(match), match.group())
    return Words(tuple(found), tuple(found.values()), tuple(left))


def masses_of_comment(text: str) -> Words:
    """The mass of a line that says what hung on the tool and nothing else.

    Examples:
        >>> masses_of_comment("payload 10 kg").masses
        (10.0,)
        >>> masses_of_comment("UR10: payload 10 kg, reach 1300 mm").masses
        ()
    """
    tokens = list(_TOKEN.finditer(text))
    if len(tokens) == 1 and _STATED.fullmatch(_TOKEN.sub(" ", text)):
        return Words((_kilograms(tokens[0]),), (tokens[0].group(),))
    words = re.search(rf"(?<![^\W_])(?:{_WORDS})(?![^\W_])", text, re.IGNORECASE)
    return Words(left=((text, MORE),) if tokens and words else ())


def _alike(before: str, beside: Sequence[str]) -> set[str]:
    """Masses in names that are alike up to there, whatever is counted in them."""
    counted = re.sub(r"\d+", r"\\d+", re.escape(before))
    shape = re.compile(rf"{counted}(?P<number>{_NUMBER})[ _-]?{_UNIT}")
    return {m["number"] for name in beside if (m := shape.match(name)) if m["unit"] != "g"}


def _pointed(*names: str) -> bool:
    """Do these names write parts of a kilogram with a point?"""
    masses = (match["number"] for name in names for match in _TOKEN.finditer(name))
    return any(not number.isdigit() for number in masses)


def _counted(before: str, match: re.Match[str], beside: Sequence[str]) -> bool:
    """Does a number before the mass count the files? Then one of it goes with several masses."""
    shape = re.compile(rf"{re.escape(before)}(?P<number>{_NUMBER})[ _-]?{_UNIT}")
    masses = {m["number"] for name in beside if (m := shape.match(name))}
    return len(masses) > 1 and match["number"] in masses


def all_masses(text: str) -> set[float]:
    """Every mass that a text holds [kg], whatever it says of it."""
    return {_kilograms(match) for match in _TOKEN.finditer(text)}


def forces_of_name(stem: str) -> tuple[str, ...]:
    """Forces in the name of a file, which say no direction."""
    return tuple(match.group() for match in _FORCE.finditer(stem))


def says_without(stem: str) -> bool:
    """Does the name of a file say that nothing hung there?"""
    return _WITHOUT.search(stem) is not None


LIKE = "Write it with its unit, like '5 kg'; of one file of several 'a.csv=5 kg'."


def mass_told(text: str, where: str, remedy: str = LIKE) -> float:
    """Kilograms of ``5 kg``, ``500 g`` or ``10 lb``; a comma in the number is a decimal one.

    Raises:
        InputError: No mass with its unit; `remedy` says how to write it.
    """
    match = _TOKEN.fullmatch(text.strip())
    if match is None:
        raise InputError(f"{text.strip()!r} is no mass", where=where, remedy=remedy)
    return _kilograms(match)


def _kilograms(match: re.Match[str]) -> float:
    value = float(match["number"].replace(",", ".").replace("p", "."))
    return value * MASSES[match["unit"].lower()]
