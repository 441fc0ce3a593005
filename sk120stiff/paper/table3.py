"""Table III: works by eq. (14) and (15), and what the load and the springs really do.

The deflections that the paper put into its works are not printed. Ours are those that its springs
predict, so only identities and the order of magnitude can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import PrintedLoads, printed_loads
from sk120stiff.paper.setting import Setting, straight, wrench_of
from sk120stiff.stiffness import PaperWork, loading_balance, paper_work


@dataclass(frozen=True, eq=False)
class Table3:
    """N loads of Table III, all works in J; `printed` has the unit of the file, "as printed".

    Attributes:
        printed_cartesian, printed_conventional: (N,) as printed, read as N·mm [J].
        works: Eq. (14) and (15) for the displacements that the paper's springs predict.
        any_displacement: The same for displacements drawn at random, 0.1 to 1 mm: the identity of
            the enhanced works does not ask what was displaced.
        work, energy: (N,) ∫ F · dX along the loading path, and energy in the springs at its end.
        largest: (N,) the most that eq. (14) can give for a force of this size in any direction.
    """

    printed: PrintedLoads
    printed_cartesian: Array
    printed_conventional: Array
    works: PaperWork
    any_displacement: PaperWork
    work: Array
    energy: Array
    largest: Array

    @cached_property
    def differences(self) -> tuple[Array, Array]:
        """(N,) conventional joint work minus Cartesian work: theirs, ours [J]."""
        ours = self.works.joint_conventional - self.works.cartesian
        return self.printed_conventional - self.printed_cartesian, ours

    @cached_property
    def ratio(self) -> Array:
        """(N,) printed Cartesian work, read as N·mm, over ours."""
        return self.printed_cartesian / self.works.cartesian

    @cached_property
    def identity_error(self) -> float:
        """Largest relative difference of the enhanced works, for any displacement at all."""
        found = (self.works, self.any_displacement)
        return max(float(np.max(np.abs(w.joint_enhanced / w.cartesian - 1.0))) for w in found)

    @cached_property
    def balance_error(self) -> float:
        """Largest relative difference of work and stored energy along the loading path."""
        return float(np.max(np.abs(self.work / self.energy - 1.0)))

    @cached_property
    def overcount(self) -> Array:
        """(N,) eq. (14) over the work that the load does while it grows."""
        return self.works.cartesian / self.work

    @cached_property
    def repeated(self) -> tuple[tuple[int, int], ...]:
        """Pairs of neighbouring rows of one pose that print the same Fy and Fz."""
        F, pose = self.printed.force, np.array(self.printed.pose)
        same = (pose[1:] == pose[:-1]) & (F[1:, 1:] == F[:-1, 1:]).all(axis=1)
        return tuple((int(k), int(k) + 1) for k in np.flatnonzero(same))

    @cached_property
    def work_per_force_squared(self) -> Array:
        """(N,) printed work over the square of the force [J/N²]: nearly constant in a pose."""
        return np.asarray(self.printed_cartesian / (self.printed.force**2).sum(axis=1))


def table3(setting: Setting, *, seed: int = 0) -> Table3:
    """Recompute Table III at the flange with a straight wrist, as Table II comes out."""
    printed = printed_loads(3)
    force, joints = printed.force, straight(printed.joints[:, :3])
    moved = setting.deflection(joints, force)
    softest = setting.under_load(joints, np.zeros(3), "values").of("values")[:, 0]
    screws = setting.arm(joints)
    rng = np.random.default_rng(seed)
    drawn = rng.uniform(1e-4, 1e-3, moved.shape) * rng.choice([-1.0, 1.0], moved.shape)
    work, energy = loading_balance(
        setting.robot.mechanism(), joints, wrench_of(force), setting.springs
    )
    return Table3(
        printed,
        1e-3 * printed.columns["work_cartesian"],
        1e-3 * printed.columns["work_joint_conventional"],
        paper_work(screws, setting.arm_springs, force, moved),
        paper_work(screws, setting.arm_springs, force, drawn),
        work,
        energy,
        1.5 * (force**2).sum(axis=1) / softest,
    )
