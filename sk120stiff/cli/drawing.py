"""Pictures that a command is asked for: is there what draws them?"""

from __future__ import annotations

from sk120stiff.errors import require


def will_draw(*wanted: object) -> None:
    """Complain before the work, not after it; None asks for nothing.

    Raises:
        MissingPart: A library that draws is not installed.
    """
    if any(each is not None for each in wanted):
        for library in ("matplotlib", "meshcat", "tornado"):
            require(library, needed_for="drawing")
