"""Text of others on a terminal: control characters are shown, not obeyed."""

from __future__ import annotations

from unicodedata import category

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
