"""A path in a scene: where it lies, what was free to be chosen, and where it is weakest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError


@dataclass(frozen=True, eq=False)
class ScenePath:
    """N points that the tool passes, base axes [m].

    Attributes:
        before, after: (N, 3) as they were given, and as they were placed.
        worst: Number of the point that counts.
        said: What is told at that point.
        mark: What that point is, in the legend.
        stops: Numbers of the points that are marked; every so many where there are none.
        freedom: What was free, in words.
        middle, reach: (3,) middle of the path as given and the half widths by which the middle may
            be moved; None where it may not.
        turns: The tool may turn about its own z axis.
    """

    before: Array
    after: Array
    worst: int
    said: str
    freedom: str
    middle: Array | None = None
    reach: Array | None = None
    turns: bool = False
    mark: str = "its weakest point"
    stops: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        shapes = np.shape(self.before), np.shape(self.after)
        if len(set(shapes)) > 1 or shapes[0][1:] != (3,) or not 0 <= self.worst < shapes[0][0]:
            raise InputError(f"a path of shapes {shapes} with the worst point {self.worst}")

    def payload(self) -> dict[str, Any]:
        """The same in plain containers."""
        box = None
        if self.middle is not None and self.reach is not None and np.any(self.reach):
            box = {"middle": self.middle.tolist(), "reach": self.reach.tolist()}
        return {
            "before": self.before.tolist(),
            "after": self.after.tolist(),
            "moved": bool(np.abs(self.after - self.before).max() > 1e-6),
            "worst": self.worst,
            "said": self.said,
            "mark": self.mark,
            "stops": list(self.stops),
            "freedom": self.freedom,
            "box": box,
            "turns": self.turns,
        }
