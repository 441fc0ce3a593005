"""The last few predictions of the same readings, which are often asked for once more.

A fit ends where its solver ended; its gap, its errors under another noise and the start of the
next fit ask for the same effects at the same values again.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from threading import Lock

from sk120stiff.arrays import Array

KEPT = 4  # predictions of the same readings
LARGEST = 4_000_000  # numbers in one that is kept, 32 MB

Prediction = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Latest:
    """Predictions with their sensitivities, by effects and values, the oldest first."""

    known: dict[tuple[Hashable, bytes], Prediction] = field(default_factory=dict)
    lock: Lock = field(default_factory=Lock)

    def get(self, effects: Hashable, values: Array) -> Prediction | None:
        """(N, 3) and (N, 3, P) of these effects at these values (P,), if they are still known."""
        return self.known.get((effects, values.tobytes()))

    def keep(self, effects: Hashable, values: Array, found: Prediction) -> bool:
        """Keep a prediction in the place of the oldest, unless it takes too much room."""
        if found[1].size > LARGEST:
            return False
        with self.lock:
            self.known[effects, values.tobytes()] = found
            while len(self.known) > KEPT:
                del self.known[next(iter(self.known))]
        return True
