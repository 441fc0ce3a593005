"""One thing that may have been written down wrongly, and what mends it."""

from __future__ import annotations

from collections.abc import Callable
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
