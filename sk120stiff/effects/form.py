"""A number of a law's form: how far below a base rocks, say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

Law = TypeVar("Law", covariant=True)


@dataclass(frozen=True)
class Form(Generic[Law]):
    """A number of a law that may lie anywhere, though a search tries few.

    Attributes:
        value: The number.
        law: The law with another one, as near to it as names of parameters tell.
        sentence: What it is, given its standard error.
    """

    value: float
    law: Callable[[float], Law]
    sentence: Callable[[float], str]
