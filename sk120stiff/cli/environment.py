"""What the surroundings of a process may break: closed or narrow streams, variables of others.

Text of others on a terminal counts too: control characters are shown, not obeyed.
"""

from __future__ import annotations

import codecs
import os
import sys
import warnings
from unicodedata import category

MOST_THREADS = 4096

# What a terminal writes where its encoding has no such sign.
_PLAIN = str.maketrans({
    "±": "+/-", "µ": "u", "μ": "u", "·": "*", "×": "x", "°": " deg", "−": "-", "–": "-", "—": "-",
    "²": "^2", "³": "^3", "⁻": "-", "¹": "^1", "→": "->", "←": "<-", "…": "...", "≤": "<=",
    "≥": ">=", "≈": "~", "√": "sqrt", "σ": "sigma", "θ": "theta", "χ": "chi", "Δ": "delta",
    "─": "-", "━": "-", "│": "|", "┃": "|", "═": "=", "╸": "-", "╺": "-", "’": "'", "“": '"',
    "”": '"', "•": "-",
})  # fmt: skip


def prepare() -> None:
    """Make this process fit to print and to compute, whatever it was started from."""
    _open_the_closed()
    codecs.register_error("sk120stiff", _in_plain_letters)
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="sk120stiff")
    # A warning is a message here, also where the surroundings make errors of them.
    warnings.filters = [each for each in warnings.filters if each[0] != "error"]
    os.environ["MPLBACKEND"] = "agg"  # figures go to files; no other backend is ever needed
    if not os.environ.get("SOURCE_DATE_EPOCH", "0").strip().isdecimal():
        del os.environ["SOURCE_DATE_EPOCH"]  # libraries read it as a number while they are imported
    text = os.environ.get("NUMBA_NUM_THREADS")
    if text is not None and not (text.strip().isdecimal() and 0 < int(text) <= MOST_THREADS):
        del os.environ["NUMBA_NUM_THREADS"]  # numba could not be imported
        print(f"NUMBA_NUM_THREADS={text[:40]!r} is no count; it is ignored.", file=sys.stderr)


def _open_the_closed() -> None:
    """Put /dev/null where a standard stream is closed: the next file must not get its number."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one
    if sys.stderr is None:
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - for good


def _in_plain_letters(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    said = error.object[error.start : error.end].translate(_PLAIN)
    return said.encode("ascii", "backslashreplace").decode("ascii"), error.end


_OBEYED = ("Cc", "Cf", "Cs")  # control, format (such as right-to-left override), half of a pair


def visible(text: str) -> str:
    """`text` with its control characters written as escapes; line ends and tabs stay."""
    if text.isascii() and text.replace("\n", "").replace("\t", "").isprintable():
        return text
    return "".join(
        char.encode("unicode_escape").decode("ascii")
        if category(char) in _OBEYED and char not in "\n\t"
        else char
        for char in text
    )
