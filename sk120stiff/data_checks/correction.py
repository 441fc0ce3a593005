"""One thing that may have been written down wrongly, and what mends it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sk120stiff.data_checks.sheet import Sheet


@dataclass(frozen=True)
class Correction:
    """A slip of the pen as a change of the sheet.

    Attributes:
        said: What looks wrong, in words, without a full stop.
        remedy: The edit that mends it, as a sentence.
        mend: The sheet without the slip.
    """

    said: str
    remedy: str
    mend: Callable[[Sheet], Sheet]


def half_turn(corrections: Sequence[Correction]) -> str:
    """What two wrong signs of one vector may be, too, with a blank before it; else empty."""
    remedies = {correction.remedy for correction in corrections}
    for kind in ("f", "d"):
        right = [axis for axis in "xyz" if f"Negate the column {kind}{axis}." not in remedies]
        if len(right) == 1:
            return (
                f" Two wrong signs are half a turn about {right[0]}: if no sign is wrong, axes are "
                "turned, as where the base was placed upside down because the first two joints are "
                "another controller's (one of the other sign, one half a turn on)."
            )
    return ""
