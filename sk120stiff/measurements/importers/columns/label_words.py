"""Headers of columns that name points or poses, in the languages of laboratories.

A noun, a word for "number", or both in any order: ``Punto``, ``N°``, ``Point no.``, ``Nr. Pose``.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from sk120stiff.measurements.importers.contract import Meanings

_NUMBER = (
    r"no|nr|num|number|nummer|numero|n°|#|id|idx|index|name|nom|nome|nombre|bezeichnung|label|"
    r"cislo|numer|номер"
)
_POINT = (
    "point|points|pt|measur(?:ing|ement) point|target|tag|punkt|pkt|messpunkt|messstelle|"
    "punkt pomiarowy|point de mesure|punto|punto di misura|punto de medi(?:da|cion)|ponto|"
    "ponto de medi(?:da|cao)|punt|meetpunt|bod|merici bod|точка"
)
_POSE = (
    "pose|robot pose|posture|stellung|roboterstellung|messstellung|roboterpose|posa|postura|"
    "posture du robot|поза"
)
_MAYBE = (  # a label where no other column is one: each is a word for other things, too
    "position|positions|pos|posicao|posicion|posizione|pozice|pozycja|позиция|configuration|config|"
    "conf|konfiguration|configuracion|configurazione|configuracao|measurement|messung|mesure|"
    "misura|medida|medicion|medicao|test|versuch|essai|prova|ensayo|ensaio|trial|experiment|"
    "file|file ?name|datei|dateiname|fichier|archivo|arquivo|nome file|sheet|blatt"
)


def _named(nouns: str) -> re.Pattern[str]:
    of = r"(?: (?:of|de|du|di|do|da|del))?"
    return re.compile(rf"(?:(?:{_NUMBER}){of} ?)?(?:robot )?(?:{nouns})(?: ?(?:{_NUMBER}))?")


_SURE = {"pose": _named(_POSE), "name": re.compile(f"{_named(_POINT).pattern}|{_NUMBER}")}
_COUNT = re.compile(_NUMBER)
_OPEN = _named(_MAYBE)


def label_of_word(plain: str) -> str | None:
    """``name`` of a point or ``pose``, as a header in small letters says; None: neither."""
    word = _without_accents(plain)
    return next((meaning for meaning, each in _SURE.items() if each.fullmatch(word)), None)


def with_labels(names: Sequence[str], meanings: Meanings, units: Sequence[str | None]) -> Meanings:
    """Meanings with a column called Position, Configuration or Test as the names of rows, where no
    other column has these, and without a unit: what has one was measured. A column that counts
    alone (Nr) beside one that names points (Messpunkt) counts rows, and is no label."""
    out = list(meanings)
    named = [k for k, known in enumerate(out) if known and known[0] == "name"]
    counts = [k for k in named if _COUNT.fullmatch(_plain(names[k]))]
    if len(counts) < len(named):
        out = [None if k in counts else known for k, known in enumerate(out)]
    if any(known and known[0] in ("name", "pose") for known in out):
        return out
    for k, name in enumerate(names):
        if out[k] is None and units[k] is None and _OPEN.fullmatch(_plain(name)):
            out[k] = "name", 1.0
            break
    return out


def _plain(name: str) -> str:
    return _without_accents(re.sub(r"[\s_.\-:()\[\],]+", " ", name).strip().lower())


def _without_accents(plain: str) -> str:
    """Letters without accents, the sign of a number as ``n°`` whichever ring it is written with."""
    ring = plain.replace("º", "°").replace("ª", "")
    apart = unicodedata.normalize("NFKD", ring).lower()
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def says_pose(word: str) -> bool:
    """Does one word in small letters, before a number, call a pose or a point?"""
    plain = _without_accents(word)
    return plain == "p" or any(re.fullmatch(nouns, plain) for nouns in (_POSE, _POINT, _MAYBE))
