"""The languages that robot programs are written in, and the kinds of files that paths come in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from sk120stiff.errors import InputError
from sk120stiff.programs.apt import read_apt
from sk120stiff.programs.gcode import read_gcode
from sk120stiff.programs.language import Language
from sk120stiff.programs.languages.fanuc import Fanuc
from sk120stiff.programs.languages.gcode import GCode
from sk120stiff.programs.languages.inform import Inform
from sk120stiff.programs.languages.kuka import Kuka
from sk120stiff.programs.languages.rapid import Rapid
from sk120stiff.programs.languages.urscript import UrScript
from sk120stiff.programs.toolpath import ToolPath

LANGUAGES: dict[str, Language] = {
    language.name: language
    for language in (GCode(), Kuka(), Rapid(), Fanuc(), Inform(), UrScript())
}
READERS: dict[str, Callable[..., ToolPath]] = {
    **dict.fromkeys((".nc", ".ngc", ".gcode", ".tap", ".cnc", ".mpf", ".eia"), read_gcode),
    **dict.fromkeys((".apt", ".cls", ".cl", ".clsf", ".cldata"), read_apt),
}
TABLE = "csv"


def language_of(out: Path, named: str | None) -> Language | None:
    """The language of a file's ending, or the one that was named; None: a CSV file.

    Raises:
        InputError: There is no such language, or the ending names none.
    """
    choices = {TABLE: None, **LANGUAGES}
    if named is not None:
        if named not in choices:
            raise InputError(
                f"there is no language {named!r}",
                where="--to",
                remedy=f"Languages are: {', '.join(choices)}.",
            )
        return choices[named]
    endings = {f".{TABLE}": None, **{each.ending: each for each in LANGUAGES.values()}}
    gcode = [ending for ending, reader in READERS.items() if reader is read_gcode]
    endings |= dict.fromkeys(gcode, LANGUAGES["gcode"])
    if out.suffix.lower() not in endings:
        raise InputError(
            f"the ending '{out.suffix}' names no language",
            where=str(out),
            remedy=f"Endings are {', '.join(endings)}; or give --to.",
        )
    return endings[out.suffix.lower()]
