"""The notebook of one reading: what was repaired, and how places and names are written down."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from difflib import get_close_matches
from typing import NoReturn

from sk120stiff.errors import InputError
from sk120stiff.robot.urdf.document import Finding


class Notebook:
    """Collects findings and raises refusals that carry the file and the line.

    Args:
        source: What the user gave, as it shall stand in messages.
    """

    def __init__(self, source: str) -> None:
        self.source = source
        self.findings: list[Finding] = []

    def warn(self, code: str, where: str, message: str) -> None:
        """Write down a repair or an oddity."""
        self.findings.append(Finding(code, where, message))

    def refuse(self, what: str, *, where: str = "", remedy: str) -> NoReturn:
        """Stop reading.

        Raises:
            InputError: Always.
        """
        place = f"{self.source}, {where}" if where else self.source
        raise InputError(what, where=place, remedy=remedy)


def at(line: int, kind: str = "", name: str = "") -> str:
    """A place in the text, e.g. ``line 12, joint 'elbow'``."""
    thing = f"{kind} {shown(name)}" if name else kind
    if line <= 0:
        return thing
    return f"line {line}, {thing}" if thing else f"line {line}"


def shown(text: str, limit: int = 60) -> str:
    """`text` in quotes, safe for a terminal: control characters escaped, long text cut."""
    cut = text if len(text) <= limit else text[: limit - 1] + "…"
    return repr(cut)


def listed(names: Sequence[str], limit: int = 8) -> str:
    """Names for a message, the first few of them."""
    head = ", ".join(shown(name) for name in names[:limit])
    rest = len(names) - limit
    return f"{head} and {rest} more" if rest > 0 else head


def close_name(name: str, known: Collection[str]) -> str | None:
    """The known name that `name` may have meant; None among too many or too long names."""
    if len(known) > 500 or len(name) > 100:
        return None
    close = get_close_matches(name, [other for other in known if len(other) <= 100], n=1)
    return close[0] if close else None


def did_you_mean(name: str, known: Collection[str]) -> str:
    """A question before a remedy; nothing where no known name is near."""
    close = close_name(name, known)
    return f"Did you mean {close!r}? " if close else ""
