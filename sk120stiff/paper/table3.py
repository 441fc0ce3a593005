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
from sk120stiff.paper.setting import Setting, wrench_of
from sk120stiff.stiffness import (
    PaperWork,
    cartesian_compliance,
    deflection,
    loading_balance,
    paper_work,
    principal_stiffness,
)


@dataclass(frozen=True, eq=False)
class Table3:
    """N loads of Table III.

    Attributes
    ----------
    printed
        The table as printed; its works are in the unit of the file, which says "as printed".
    displacement
        (N, 3) predicted by the paper's springs at exact equilibrium [m].
    works
        Eq. (14) and (15) for these displacements [J].
    any_displacement
        The same formulas for displacements drawn at random, 0.1 to 1 mm: the identity of the
        enhanced works does not ask what was displaced [J].
    work, energy
        (N,) ∫ F · dX along the loading path, and energy in the springs at its end [J].
    largest
        (N,) the most that eq. (14) can give for a force of this size in any direction [J].
    """

    printed: PrintedLoads
    displacement: Array
    works: PaperWork
    any_displacement: PaperWork
    work: Array
    energy: Array
    largest: Array

    @cached_property
    def printed_cartesian(self) -> Array:
        """(N,) as printed, read as N·mm [J]."""
        return 1e-3 * self.printed.columns["work_cartesian"]

    @cached_property
    def printed_conventional(self) -> Array:
        """(N,) as printed, read as N·mm [J]."""
        return 1e-3 * self.printed.columns["work_joint_conventional"]

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
        F, pose = self.printed.force, self.printed.pose
        return tuple(
            (k, k + 1)
            for k in range(len(pose) - 1)
            if pose[k] == pose[k + 1] and (F[k, 1:] == F[k + 1, 1:]).all()
        )

    @cached_property
    def work_per_force_squared(self) -> Array:
        """(N,) printed work over the square of the force [J/N²]: nearly constant in a pose."""
        return np.asarray(self.printed_cartesian / (self.printed.force**2).sum(axis=1))


def table3(setting: Setting, *, seed: int = 0) -> Table3:
    """Recompute Table III at the flange with a straight wrist, as Table II comes out."""
    printed = printed_loads(3)
    wrench = wrench_of(printed.force)
    joints = printed.joints.copy()
    joints[:, 3:] = 0.0
    moved = deflection(setting.mechanism, joints, wrench, setting.springs).equilibrium
    screws = setting.arm(joints)
    rng = np.random.default_rng(seed)
    drawn = rng.uniform(1e-4, 1e-3, moved.shape) * rng.choice([-1.0, 1.0], moved.shape)
    work, energy = loading_balance(setting.mechanism, joints, wrench, setting.springs)
    softest = principal_stiffness(
        cartesian_compliance(screws.linear_jacobian, setting.K_theta)
    ).values[:, 0]
    return Table3(
        printed=printed,
        displacement=moved,
        works=paper_work(screws, setting.arm_springs, printed.force, moved),
        any_displacement=paper_work(screws, setting.arm_springs, printed.force, drawn),
        work=work,
        energy=energy,
        largest=1.5 * (printed.force**2).sum(axis=1) / softest,
    )
