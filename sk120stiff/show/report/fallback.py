"""What cannot be drawn is said in its place; the rest of the report stands."""

from __future__ import annotations

import logging
from collections.abc import Callable

from sk120stiff.errors import MissingPart, warn
from sk120stiff.show.report.blocks import Note, Section

_LOG = logging.getLogger(__name__)


def section_or_note(title: str, build: Callable[[], Section | None]) -> Section | None:
    """The section, or a section of that title that says what went wrong.

    Warns:
        ToolkitWarning: It could not be made.
    """
    try:
        return build()
    except Exception as error:  # noqa: BLE001  (an answer is never lost to its page)
        return Section(title, [Note(failure(f"the section {title!r}", error), "problem")])


def failure(what: str, error: Exception) -> str:
    """Warn that `what` could not be made, and return the sentence; the traceback goes to the log.

    Warns:
        ToolkitWarning: Always.
    """
    if isinstance(error, MissingPart):
        warn(str(error), stacklevel=3)  # one sentence for all pictures
        return f"Left out: {what}. {error}"
    reason = " ".join(str(error).split()) or "no message"
    said = f"{what[0].upper()}{what[1:]} could not be made ({type(error).__name__}: {reason})."
    _LOG.debug("%s", said, exc_info=error)
    warn(f"{said} Everything else is as it should be.", stacklevel=3)
    return said
