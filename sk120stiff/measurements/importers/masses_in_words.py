"""Which mass hung on the tool, as names of files and comments above a table say it.

A number counts with its unit alone: the 10 of a UR10 and the 210 of a KR210 are no masses.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.masses import LOAD_WORDS, MASSES
from sk120stiff.measurements.importers.masses_not_hung import (
    COUNTING,
    DENIED,
    GRAMS,
    TYPE,
    why_not_in_line,
    why_not_in_name,
)

_NUMBER = r"\d+(?:[.,]\d+|p\d+)?"  # 2.5, 2,5 and 2p5
_UNIT = r"(?P<unit>[kK][gG]|g|lbs?)(?![^\W_])"  # G is no gram
_TOKEN = re.compile(rf"(?<![\d.,])(?P<number>{_NUMBER})[ _-]?{_UNIT}")
_FORCE = re.compile(r"(?<![\d.,])\d+(?:[.,]\d+)?[ _-]?(?:N|kN|daN)(?![^\W_])")
_WORDS = "|".join(sorted(LOAD_WORDS, key=len, reverse=True))
_LOAD = frozenset(word for word in LOAD_WORDS if " " not in word) | {"m", "w", "with", "mit"}
# Before two numbers the first of which counts something: pose_2_5kg is pose 2, with 5 kg.
_COUNTED = re.compile(COUNTING)
_PARTS = re.compile(
    r"(?:(?P<word>[^\W\d_]+)(?P<gap>[ _=-]?)|(?P<date>\d[ _.-]))?(?<!\d)(?P<whole>0|[1-9]\d?)"
    r"(?P<line>[_-])$"
)
MANY = 10  # files with other numbers before the mass: no series of masses has so many
_STATED = re.compile(
    rf"(?<![^\W_])(?:{_WORDS})(?![^\W_])[^\d,;|]{{0,30}}(?:{_NUMBER})\s*{_UNIT}"
    rf"|(?<![^\W_])m\s*[=:]\s*(?:{_NUMBER})\s*{_UNIT.replace('<unit>', '<mass>')}"
    rf"|(?<![\d.,])(?:{_NUMBER})\s*{_UNIT.replace('<unit>', '<before>')}\s+(?:{_WORDS})(?![^\W_])",
    re.IGNORECASE,
)
_BESIDE = r"load(?:ed)?|payload|last|belast(?:et|ung)|charge|carico|carga"
_UNLOADED = (
    rf"(?:un|no|without|zero|ohne|sans|senza|sin)[ _-]?(?:{_NUMBER}[ _-]?(?:kg|g|lbs?)[ _-]?)?"
    rf"(?:{_BESIDE})|unbelastet|lastfrei"
)
_LOAD_BEHIND = re.compile(rf"[ _-](?:{_BESIDE})(?![^\W\d_])", re.IGNORECASE)
_NOTHING = re.compile(rf"(?<![^\W\d_])(?:{_UNLOADED})(?![^\W\d_])", re.IGNORECASE)
_WITHOUT = re.compile(rf"(?<![^\W\d_])(?:{_UNLOADED}|leer|empty|free)(?![^\W\d_])", re.IGNORECASE)
_ALSO = re.compile(  # the name speaks of something under load, too
    r"(?<![^\W\d_])(?:loaded|with|belastet|mit|avec|con|vs|versus|gegen|and|und|then|to|bis|minus)"
    r"(?![^\W\d_])",
    re.IGNORECASE,
)
GRAM_DIGITS = 2  # of grams that count: 5g is a network, 2g an acceleration


class Words(NamedTuple):
    """Masses that words hold [kg], as they stand there; several readings of one are several.

    Attributes:
        masses, texts: Those that hung on the tool.
        left: Words and reason of those that may not have.
    """

    masses: tuple[float, ...] = ()
    texts: tuple[str, ...] = ()
    left: tuple[tuple[str, str], ...] = ()


def masses_of_name(stem: str, robot: str = "", beside: Sequence[str] = ()) -> Words:
    """The masses in the name of a file without its ending, of which one alone counts.

    Args:
        stem: As ``UR10_payload_5kg``.
        robot: The robot's own name: what stands there is the robot's (``iiwa_14kg``).
        beside: Names of the other files, which tell whether a number before counts the files.

    A mass behind a word such as *payload* goes before one that stood there alone. Of ``2_5kg``
    both 5 kg and 2.5 kg are given, unless the word before tells. What the name denies
    (``no_5kg_load``) is 0 kg; what may be no load (``IRB6700_155kg``) is left, with the reason.
    """
    called: list[tuple[float, str]] = []
    alone: list[tuple[float, str]] = []
    left: list[tuple[str, str]] = []
    own, nothing = _plain(robot), _NOTHING.search(stem)
    for match in _TOKEN.finditer(stem):
        before, behind = stem[: match.start()], stem[match.end() :]
        word = re.search(r"([^\W\d_]+)[\W_]*$", before)
        called_so = word is not None and word[1] != "M" and word[1].lower() in _LOAD
        load = called_so or _LOAD_BEHIND.match(behind) is not None
        if _few_grams(match) and not load:
            continue
        if nothing and not _ALSO.search(_NOTHING.sub("", stem)):
            return Words((0.0,), (nothing[0],))
        if own and _plain(match.group()) in own:
            continue
        glued = re.search(r"[^\W\d_]$", before) and not called_so
        why = why_not_in_name(stem, *match.span(), beside, called=load)
        if why is None and match["unit"] == "g" and (not load or _few_grams(match)):
            why = GRAMS
        if why is None and glued:
            why = TYPE  # KR16kg
        if why is None and says_without(stem):
            why = DENIED
        values, text, split = _with_a_part_before(before, match, beside)
        if why is not None:
            left.append((text, why))
            continue
        taken = called if called_so or split or called else alone
        taken += [(value, text) for value in values]
    found = called or alone
    if called:
        left = [item for item in left if item[1] != TYPE]  # UR10_payload_5kg says which is which
    return Words(
        tuple(dict.fromkeys(value for value, _ in found)),
        tuple(dict.fromkeys(text for _, text in found)),
        tuple(left),
    )


def masses_of_comment(text: str) -> Words:
    """The masses of a line that says what hung on the tool; none where it says anything else.

    Where one of them may be no load, or not hang any more, none of the line is taken.
    """
    if not _STATED.search(text):
        return Words()
    tokens = [match for match in _TOKEN.finditer(text) if not _few_grams(match)]
    for match in tokens:
        why = why_not_in_line(text, *match.span())
        if why is not None:
            return Words(left=((text, why),))
    found = {_kilograms(m["number"], m["unit"]): m.group() for m in tokens}
    return Words(tuple(found), tuple(found.values()))


def _few_grams(match: re.Match[str]) -> bool:
    return match["unit"] == "g" and len(re.sub(r"\D", "", match["number"])) < GRAM_DIGITS


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
        raise InputError(
            f"{text.strip()!r} is no mass",
            where=where,
            remedy=remedy,
        )
    return _kilograms(match["number"], match["unit"])


def _with_a_part_before(
    before: str, match: re.Match[str], beside: Sequence[str]
) -> tuple[list[float], str, bool]:
    """The mass, its text, and whether a word of loads stands before a number in two parts.

    A number and a line before the mass may be its whole part, as file names bear no point. It is
    none behind a word that counts, in a type (UR10), in a date, before 10 (nobody writes 1.10), or
    where it counts the files.
    """
    plain = [_kilograms(match["number"], match["unit"])]
    parts = _PARTS.search(before)
    if parts is None or not match["number"].isdigit() or re.fullmatch(r"\d+0", match["number"]):
        return plain, match.group(), False
    word, called = (parts["word"] or "").lower(), (parts["word"] or "").lower() in _LOAD
    named = bool(word) and not called and not parts["gap"]
    if named or _COUNTED.fullmatch(word) or parts["date"] or _counts(before, parts, beside):
        return plain, match.group(), False
    whole = [_kilograms(f"{parts['whole']}.{match['number']}", match["unit"])]
    text = f"{parts['whole']}{parts['line']}{match.group()}"
    if called and parts["line"] == "_":
        return whole, text, True
    return [*plain, *whole], text, called


def _counts(before: str, parts: re.Match[str], beside: Sequence[str]) -> bool:
    """Does this number count the files? Some have a zero before it, or there are many of them."""
    shape = re.compile(rf"{re.escape(before[: parts.start('whole')])}(\d+){parts['line']}\d")
    numbers = {found[1] for name in beside if (found := shape.match(name))}
    return len(numbers) >= MANY or any(n[0] == "0" and len(n) > 1 for n in numbers)


def _kilograms(number: str, unit: str) -> float:
    value = float(number.replace(",", ".").replace("p", "."))
    return value * MASSES[unit.lower()]


def _plain(text: str) -> str:
    return re.sub(r"[\W_]+", "", text).lower()
