"""Lengths within names of parameters: whole millimetres, as 225 or minus_20."""

from __future__ import annotations

MINUS = "minus_"
MM = rf"((?:{MINUS})?\d+)"  # one of them, in a regular expression


def in_name(length: float) -> str:
    """A length [m] as it stands in a name.

    Examples:
        >>> in_name(0.225), in_name(-0.02)
        ('225', 'minus_20')
    """
    return f"{1e3 * length:.0f}".replace("-", MINUS)


def from_name(told: str) -> float:
    """The length [m] that part of a name tells.

    Examples:
        >>> from_name("minus_20")
        -0.02
    """
    return float(told.replace(MINUS, "-")) / 1e3
