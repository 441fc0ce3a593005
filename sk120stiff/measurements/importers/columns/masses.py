"""Which column holds the mass on the tool: its unit tells it, by whatever word it is called."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sk120stiff.measurements.importers.contract import Meanings

MASSES = {"kg": 1.0, "g": 1e-3, "lb": 0.45359237, "lbs": 0.45359237}  # kg
_PAYLOAD = "payload|nutzlast|traglast|zuladung|charge utile|carga util|carga útil|carico utile"
_LOAD = (
    "load|last|belastung|gewicht|masse|mass|weight|charge|poids|carga|peso|carico|massa|masa|"
    "tool mass|hung mass|added mass|applied mass|load mass|payload mass|test mass"
)
_UNMISTAKEN = frozenset(_PAYLOAD.split("|"))
_KNOWN = frozenset((*_UNMISTAKEN, *_LOAD.split("|")))
LOAD_WORDS = _KNOWN  # in small letters, for a mass on the tool wherever its unit is one


def with_masses(
    names: Sequence[str], meanings: Meanings, units: Sequence[str | None]
) -> tuple[Meanings, list[str | None]]:
    """Meanings and units with that column as ``payload`` in kg, where there is one alone.

    Words that may mean something else, as *load* or *weight*, mean a mass where their unit is one.
    """
    out, units = list(meanings), list(units)
    free = [known is None or known[0] in ("payload", "load") for known in out]
    heavy = [k for k, unit in enumerate(units) if unit in MASSES and free[k]]
    called = [k for k in heavy if _plain(names[k]) in _KNOWN]
    if not heavy:
        called = [k for k, name in enumerate(names) if _plain(name) in _UNMISTAKEN]
    elif len(heavy) == 1:
        called = heavy
    loads = [k for k, known in enumerate(out) if known and known[0] in ("fx", "load", "payload")]
    if len(called) == 1 and set(loads) <= set(called):
        (k,) = called
        out[k] = "payload", MASSES.get(units[k] or "", 1.0)
        units[k] = "kg" if units[k] in MASSES else units[k]
    return out, units


def _plain(name: str) -> str:
    return re.sub(r"[\s_.\-:]+", " ", name).strip().lower()
