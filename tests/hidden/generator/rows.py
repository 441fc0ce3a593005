"""What was set and reported for every reading: poses, wrenches, the order of things."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .rotations import Array


@dataclass(frozen=True)
class Rows:
    """N readings. Forces and moments are the reported ones, in base axes, at the force point."""

    pose: NDArray[np.int64]  # (N,)
    coordinates: Mapping[str, Array]  # actuated name -> (N,) commanded [rad or m]
    force: Array  # (N, 3) [N]
    moment: Array  # (N, 3) [N m]
    order: Array  # (N,) place of the reading in the whole series
    zero_order: Array  # (N,) place of the zero reading that belongs to it
    branch: Array  # (N,) +1 loading, -1 unloading
    repeat: NDArray[np.int64]  # (N,)
    point: Array  # (3,) measured point in the tool frame [m]
    force_point: Array  # (3,)

    @property
    def count(self) -> int:
        return len(self.pose)

    def pick(self, index: NDArray[np.int64]) -> Rows:
        """Some of the rows."""
        return replace(
            self,
            pose=self.pose[index],
            coordinates={name: values[index] for name, values in self.coordinates.items()},
            force=self.force[index],
            moment=self.moment[index],
            order=self.order[index],
            zero_order=self.zero_order[index],
            branch=self.branch[index],
            repeat=self.repeat[index],
        )
