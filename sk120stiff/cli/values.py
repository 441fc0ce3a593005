"""Values of parameters as `explain` prints them below the name of their effect."""

from __future__ import annotations

from collections.abc import Container, Sequence

from sk120stiff.model import Parameter
from sk120stiff.show.wording import with_error


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
