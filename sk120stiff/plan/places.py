"""Poses that stand at places which somebody named, and which of them a plan takes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.measurements import Measurements
from sk120stiff.plan.design import determinant_worth
from sk120stiff.plan.pool import Pool


@dataclass(frozen=True, eq=False)
class Places:
    """Poses that can be, and at which of the places each stands.

    Attributes:
        a: (K, n) poses [rad or m].
        names: (K,) label of each one's place.
        remarks: Which places no pose reaches, and why, in sentences.
    """

    a: Array
    names: tuple[str, ...]
    remarks: tuple[str, ...]

    def one_each(self, pool: Pool, gains: Array) -> Index:
        """Of a pool's readings those of one pose for each place: by whose loads most is learnt.

        Args:
            pool: M candidates at these poses.
            gains: (M, P, P) information of each on what is to be known.
        """
        size = gains.shape[-1]
        gains = gains / (np.trace(gains, axis1=1, axis2=2).mean() or 1.0)
        worth, total = determinant_worth(np.arange(size)), 1e-6 * np.eye(size)
        standing: dict[str, dict[int, list[int]]] = {}
        for row, (pose, a) in enumerate(zip(pool.pose, pool.load_cases.a, strict=True)):
            standing.setdefault(self.place_of(a), {}).setdefault(int(pose), []).append(row)
        kept: list[int] = []
        for poses in standing.values():
            rows = list(poses.values())
            sums = np.array([gains[each].sum(axis=0) for each in rows])
            best = int(np.argmax(worth(total + sums)))
            total = total + sums[best]
            kept += rows[best]
        return np.array(sorted(kept), dtype=np.intp)

    def lost(self, pool: Pool) -> tuple[str, ...]:
        """Places of which a pool has no pose any more."""
        left = {self.place_of(a) for a in pool.load_cases.a}
        return tuple(name for name in dict.fromkeys(self.names) if name not in left)

    def place_of(self, a: Array) -> str:
        """Label of the place at which a pose (n,) stands."""
        return self.names[int(np.argmin(np.abs(self.a - a).max(axis=1)))]

    def named(self, plan: Measurements) -> Measurements:
        """The plan with its poses called by their places; a second one there gets a number."""
        labels: dict[str, str] = {}
        taken: dict[str, int] = {}
        for pose, joints in zip(plan.pose, plan.joints, strict=True):
            if pose in labels:
                continue
            name = self.place_of(joints)
            taken[name] = taken.get(name, 0) + 1
            labels[pose] = name if taken[name] == 1 else f"{name}/{taken[name]}"
        return replace(plan, pose=tuple(labels[pose] for pose in plan.pose))
