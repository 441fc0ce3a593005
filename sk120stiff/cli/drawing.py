"""Pictures that a command is asked for: is there what draws them?"""

from __future__ import annotations

from pathlib import Path

from sk120stiff.errors import InputError, require
from sk120stiff.files import will_write


def will_show(page: Path | None, option: str = "--page") -> None:
    """Declare a page before the work; None asks for nothing.

    Raises:
        InputError: Its name does not end in .html, or it cannot be written.
    """
    if page is not None and page.suffix.lower() not in (".html", ".htm"):
        raise InputError(
            f"a browser opens pages, and {page.name} does not end in .html",
            where=option,
            remedy=f"Name it like {page.stem}.html; a browser prints it as PDF.",
        )
    will_write(page, option)


def will_draw(*wanted: object) -> None:
    """Complain before the work, not after it; None asks for nothing.

    Raises:
        MissingPart: A library that draws is not installed.
    """
    if any(each is not None for each in wanted):
        for library in ("matplotlib", "meshcat", "tornado"):
            require(library, needed_for="drawing")
