"""Numbers of a law's form: how far below a base rocks, say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

Law = TypeVar("Law", covariant=True)


@dataclass(frozen=True)
class Form(Generic[Law]):
    """Numbers of a law that may lie anywhere, though a search tries few.

    Attributes:
        values: The numbers; there may be none yet.
        law: The law with others, as near to them as names of parameters tell.
        sentence: What they are, given their standard errors; empty where there are none.
        wider: The law with more such numbers, which then have to earn their place; None: no other.
    """

    values: tuple[float, ...]
    law: Callable[[Sequence[float]], Law]
    sentence: Callable[[Sequence[float]], str]
    wider: Law | None = None
