"""Effects that count a temperature or a clock, and from where they do."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Self

from sk120stiff.effects.base import Effect
from sk120stiff.effects.reference import Reference


class Sequential(Effect):
    """What a reading has may be of those before it, as what moved in between is."""

    @property
    def over_time(self) -> bool:
        """Goes from reading to reading, whatever the pose is."""
        return True


@dataclass(frozen=True)
class Counting(Sequential):
    """An effect that goes with the temperature, the time or the order of positions.

    Displacements have a zero reading, which is their reference.

    Attributes:
        reference: From where it counts, which is where it does nothing: a fit takes that of its
            readings, and a model's file keeps it. None: from the readings at hand.
    """

    reference: Reference | None = field(default=None, kw_only=True)

    @property
    @abstractmethod
    def goes_with(self) -> str:
        """What it counts: ``temperature``, ``time`` or ``order``."""

    @property
    def over_time(self) -> bool:
        """See `Sequential.over_time`: the temperature is that of the reading itself."""
        return self.goes_with != "temperature"

    def referred(self, references: Iterable[Reference]) -> Self:
        """The effect as it is fitted to readings that have these references; see `beside`."""
        own = next((known for known in references if known.of == self.goes_with), None)
        if own is None:
            return self
        return replace(self, reference=self.reference.beside(own) if self.reference else own)


def referred(effect: Effect, references: Iterable[Reference]) -> Effect:
    """An effect as it is fitted to readings that have these references."""
    return effect.referred(references) if isinstance(effect, Counting) else effect
