"""Words that say of a position whether it was read without the load or with it."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sk120stiff.measurements.importers.contract import Meanings

WITHOUT, WITH = "unloaded", "loaded"
_WITHOUT = (
    "unloaded|no load|without(?: the)?(?: load)?|zero load|load free|free|undeformed|"
    "before(?: the)?(?: load(?:ing)?)?|initial|start|zero|"
    "unbelastet|lastfrei|unverformt|ohne(?: last| belastung| kraft)?|"
    "vor(?: der)?(?: last| belastung)?|vorher|davor|anfangs?|null|leer|"
    "sans(?: charge)?|avant(?: la)?(?: charge)?|à vide|senza carico|prima|sin carga|antes"
)
_WITH = (
    "loaded|(?:with|under)(?: the)? load|with|deformed|after(?: the)?(?: load(?:ing)?)?|final|end|"
    "belastet|verformt|(?:mit|unter)(?: last| belastung| kraft)|mit|"
    "nach(?: der)?(?: last| belastung)?|nachher|danach|ende|"
    "(?:avec|sous) charge|avec|après(?: la)?(?: charge)?|(?:con|sotto) carico|dopo|"
    "(?:con|bajo) carga|después"
)
_BESIDE = "load|last|belastung|charge|carico|carga"  # a force, unless `unloaded` stands beside it
_COMPOUND = re.compile(
    r"(?<!\w)(anfangs|start|end|null|leer|last)(?=position|lage|messung|ablesung|punkt|koordinate|wert)"
)
_NOUNS = re.compile(  # what was read, which says nothing of the load
    r"(?<!\w)(?:measurements?|meas|readings?|data|marker|tracker|smr|reflector|reflektor|"
    r"messung|ablesung|lage|messpunkt|punkt|werte?|mesure|mis[eu]ra)(?!\w)"
)
_DIFFERENCE = "(?:delta|\N{GREEK SMALL LETTER DELTA}|\N{INCREMENT})"
_DELTA = re.compile(rf"{_DIFFERENCE} ?[xyz](?![a-z])|[xyz] ?{_DIFFERENCE}(?![a-z])")
_PLACES = ("", "measured ", "nominal ", f"{WITHOUT} ", f"{WITH} ")


def _longest_first(words: str) -> re.Pattern[str]:
    parts = sorted(re.split(r"\|(?![^()]*\))", words), key=len, reverse=True)
    return re.compile(rf"(?P<before>.*?)(?<!\w)(?:{'|'.join(parts)})(?!\w)(?P<behind>.*)")


_STATES = {WITHOUT: _longest_first(_WITHOUT), WITH: _longest_first(_WITH)}
_MAY_BE = _longest_first(_BESIDE)


def state_of(plain: str) -> tuple[str, str] | None:
    """``unloaded`` or ``loaded``, and the name without that word; None where no word says it.

    Of the rest, words for what was read (measurement, marker, Lage) are left out, too.
    """
    for state, pattern in _STATES.items():
        found = pattern.fullmatch(_COMPOUND.sub(r"\1 ", plain))
        if found:
            return state, _rest(found)
    return None


def with_states(names: Sequence[str], meanings: Meanings) -> Meanings:
    """Meanings with what the columns beside tell.

    ``x load`` is a position where ``x zero`` stands beside it, and ``delta x`` is a displacement
    where no position does that it could be a deviation from.
    """
    out = list(meanings)
    words = {known[0] for known in out if known}
    free = any(f"{WITHOUT} {axis}" in words for axis in "xyz")
    placed = words & {f"{kind}{axis}" for kind in _PLACES for axis in "xyz"}
    for k, name in enumerate(names):
        plain = re.sub(r"[\s_.\-]+", " ", name).strip().lower()
        load = _MAY_BE.fullmatch(_COMPOUND.sub(r"\1 ", plain)) if free and out[k] is None else None
        if load and (axis := _rest(load)) in ("x", "y", "z"):
            out[k] = f"{WITH} {axis}", 1.0
        known = out[k]
        if known and known[0] in _deviations() and not placed and _DELTA.search(plain):
            out[k] = f"d{known[0][-1]}", known[1]
    return out


def _deviations() -> set[str]:
    return {f"deviation {axis}" for axis in "xyz"}


def _rest(found: re.Match[str]) -> str:
    return " ".join(_NOUNS.sub("", f"{found['before']} {found['behind']}").split())
