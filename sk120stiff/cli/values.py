"""Values of parameters as `explain` prints them below the name of their effect."""

from __future__ import annotations

from collections.abc import Container, Sequence

from sk120stiff.model import Parameter
from sk120stiff.show.wording import said_in, with_error

SURE = 3.0  # standard errors by which a value of many is told from nothing


def sure_values(own: Sequence[Parameter], unseen: Container[str]) -> list[str]:
    """Those of many values that are surely not zero, in one line; the report has all."""
    told = [p for p in own if p.name not in unseen and p.std and abs(p.value) > SURE * p.std]
    return [f"  {', '.join(_readable(p, _largest(told, p)) for p in told)}"] if told else []


def _largest(told: Sequence[Parameter], like: Parameter) -> float:
    """The largest value of the same unit: all of them are said in the unit that suits it."""
    return max((p.value for p in told if p.spec.unit == like.spec.unit), key=abs)


def _readable(p: Parameter, largest: float) -> str:
    factor, unit = said_in(p.spec.unit, largest)
    std = None if p.std is None else factor * p.std
    return f"{p.spec.name} {with_error(factor * p.value, std, unit)}"


def value_lines(own: Sequence[Parameter], unseen: Container[str]) -> list[str]:
    """Every parameter of an effect with its error and what it says."""
    lines = []
    for p in own:
        hidden = p.name in unseen
        value = "cannot be seen" if hidden else with_error(p.value, p.std, p.spec.unit)
        if p.value == 0.0 and p.spec.lower == 0.0 and not p.std and not hidden:
            value = "none found"
        lines.append(f"  {p.spec.name} {value} ({p.spec.meaning})")
    return lines
