"""The order in which a gear meets its torques, for laws that remember them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .rotations import Array
from .rows import Rows

IDLE = -1  # no load: a zero reading, or taken off before a repeat

# (state, torque (P,)) -> twist (P,) and the next state; the state None is a gear not yet loaded
Advance = Callable[[Any, Array], tuple[Array, Any]]


@dataclass(frozen=True)
class History:
    """What the poses (P) see one after the other. Between poses the arm travels, and every gear
    comes to the next pose fresh."""

    steps: NDArray[np.int64]  # (S, P) row of the load, or IDLE
    zero: NDArray[np.int64]  # (N,) step at which the row's zero was read
    step: NDArray[np.int64]  # (N,) step at which the row itself was read
    pose: NDArray[np.int64]  # (N,) column of its pose

    @staticmethod
    def of(rows: Rows) -> History:
        labels, pose = np.unique(rows.pose, return_inverse=True)
        series: list[list[int]] = [[] for _ in labels]
        zero, step = np.zeros(rows.count, int), np.zeros(rows.count, int)
        last: dict[int, tuple[float, int, int]] = {}  # pose -> zero_order, repeat, its zero's step
        for row in np.argsort(rows.order, kind="stable"):
            own = series[pose[row]]
            before = last.get(pose[row])
            at = before[2] if before else 0
            if before is None or before[0] != rows.zero_order[row]:
                at = len(own)
                own.append(IDLE)
            elif before[1] != rows.repeat[row]:
                own.append(IDLE)
            zero[row], step[row] = at, len(own)
            own.append(int(row))
            last[pose[row]] = (float(rows.zero_order[row]), int(rows.repeat[row]), at)
        most = max(len(own) for own in series)
        padded = [own + [IDLE] * (most - len(own)) for own in series]
        return History(np.array(padded).T, zero, step, pose)

    def walk(self, torque: Array, advance: Advance) -> Array:
        """Twist (N,) of every row beyond that of its zero reading, under the load's own torque."""
        state: Any = None
        twists = []
        for rows in self.steps:
            twist, state = advance(state, np.where(rows == IDLE, 0.0, torque[rows]))
            twists.append(twist)
        seen = np.array(twists)
        return seen[self.step, self.pose] - seen[self.zero, self.pose]
