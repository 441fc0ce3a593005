"""Tables II to IV against ours: deflections, works, and classes of K_C.

Table II: the printed signs are not one coherent frame; the bundled measurement files hold the same
digits in `base_link`, and which signs they changed is found here by comparing the two. Why these
signs and a straight wrist: SOURCES.md of the robot.

Table III: works by eq. (14) and (15), and what the load and the springs really do. The deflections
that the paper put into its works are not printed. Ours are those that its springs predict, so only
identities and the order of magnitude can be compared.

Table IV: definiteness of K_C over the motion range for eight directions of force.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from sk120stiff.arrays import Array, Index, rms
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements, read_measurements
from sk120stiff.paper.printed import (
    COMPONENT,
    PrintedLoads,
    data_folder,
    printed_counts,
    printed_loads,
)
from sk120stiff.paper.setting import Setting, motion_grid, straight, wrench_of
from sk120stiff.stiffness import CLASSES, PaperWork, loading_balance, paper_work

#: The formulas of `UnderLoad`, from crude to exact.
FORMULAS = ("conventional", "enhanced", "second_order", "equilibrium")


@dataclass(frozen=True)
class Variant:
    """Another reading of where the load acted, and its rms over all rows and axes [µm]."""

    name: str
    calculated_rms_um: float
    measured_rms_um: float


@dataclass(frozen=True, eq=False)
class Table2:
    """N rows of Table II in the frame `base_link`.

    `calculated` and `displacement` are the paper's two columns with their signs converted, (N, 3)
    [m]; `ours` are our deflections with the paper's springs by four formulas.
    """

    printed: PrintedLoads
    measured: Measurements
    calculated: Array
    displacement: Array
    ours: dict[str, Array]
    variants: tuple[Variant, ...]

    @cached_property
    def gap(self) -> Array:
        """(N, 3) measured minus predicted at exact equilibrium [m]."""
        return np.asarray(self.displacement - self.ours["equilibrium"])

    @cached_property
    def negated(self) -> dict[str, tuple[str, ...]]:
        """Columns whose printed sign was changed, by pose."""
        pairs = {
            **{f"f{x}": (self.printed.force[:, k], self.measured.wrench[:, k]) for k, x in _AXES},
            **{f"d{x}": (self.printed.columns[f"d{x}"], self.displacement[:, k]) for k, x in _AXES},
        }
        return {
            pose: tuple(
                name
                for name, (theirs, ours) in pairs.items()
                if np.allclose(theirs[rows], -ours[rows], rtol=1e-12, atol=0.0)
            )
            for pose in self.printed.poses
            for rows in [self.printed.rows(pose)]
        }

    def per_pose(self, gap: Array) -> dict[str, float]:
        """Root mean square of (N, 3) over the rows and axes of each pose [m]."""
        return {pose: rms(gap[self.printed.rows(pose)]) for pose in self.printed.poses}

    def calculated_rms(self, formula: str) -> dict[str, float]:
        """Ours minus the printed calculated column, by one of `FORMULAS`, per pose [m]."""
        return self.per_pose(self.ours[formula] - self.calculated)

    def measured_rms(self, formula: str = "equilibrium") -> dict[str, float]:
        """Measured minus predicted with the paper's springs, per pose [m]."""
        return self.per_pose(self.displacement - self.ours[formula])

    @cached_property
    def effect_of_K_C(self) -> dict[str, float]:
        """Difference that K_C makes to the paper's formula, per pose [m]."""
        return self.per_pose(self.ours["enhanced"] - self.ours["conventional"])


_AXES = tuple(enumerate("xyz"))


def table2(setting: Setting) -> Table2:
    """Recompute Table II with the paper's springs."""
    printed = printed_loads(2)
    measured, calculated = (
        read_measurements(data_folder() / f"table2_{column}.csv", setting.robot.actuated)
        for column in ("measured", "calculated")
    )
    if measured.displacement is None or calculated.displacement is None:
        raise InputError("Table II lacks displacements", remedy="Reinstall the package.")
    force, theirs = measured.wrench[:, :3], (calculated.displacement, measured.displacement)
    variants = tuple(
        Variant(f"wrist {wrist}, load at the {point}", *(1e6 * rms(moved - d) for d in theirs))
        for wrist, joints in (("straight", measured.joints), ("as printed", printed.joints))
        for frame, point in (("tool0", "flange"), ("reflector", "reflector on the fixture"))
        for moved in [setting.deflection(joints, force, frame=frame)]
    )
    quantity = {name: f"deflection_{name}" for name in FORMULAS}
    found = setting.under_load(measured.joints, force, *quantity.values(), point=measured.point)
    ours = {name: found.of(wanted) for name, wanted in quantity.items()}
    return Table2(printed, measured, *theirs, ours, variants)


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


@dataclass(frozen=True, eq=False)
class Table4:
    """Counts of configurations; columns of counts are PD, PSD, ND, NSD, ID, cases count from 1.

    Attributes:
        signs: (8, 3) signs of the force components.
        printed: (8, 5) the paper's counts.
        classes: (8, G) class of K_C at every configuration of the grid, as an index into `CLASSES`.
        determinant, difference_positive: (8,) configurations with det(K_C) > 0, and with K_θ − K_C
            positive definite.
    """

    signs: Array
    printed: Index
    classes: Index
    determinant: Index
    difference_positive: Index

    @property
    def configurations(self) -> int:
        """Size of the grid."""
        return int(self.classes.shape[1])

    @cached_property
    def counts(self) -> Index:
        """(8, 5) our counts by the definition of the classes."""
        return np.array([np.bincount(row, minlength=len(CLASSES)) for row in self.classes])

    @cached_property
    def determinant_counts(self) -> Index:
        """(8, 3) what the paper seems to have counted: det(K_C) > 0, ND, and the rest."""
        negative = self.counts[:, 2]
        rest = self.configurations - self.determinant - negative
        return np.stack([self.determinant, negative, rest], axis=1)

    @cached_property
    def reproduced(self) -> tuple[int, ...]:
        """Cases whose printed row equals `determinant_counts`."""
        same = (self.printed[:, [0, 2, 4]] == self.determinant_counts).all(axis=1)
        return tuple(int(k) + 1 for k in np.flatnonzero(same))

    @cached_property
    def reproduced_determinant(self) -> tuple[int, ...]:
        """Cases whose printed PD column equals the count of det(K_C) > 0."""
        return tuple(int(k) + 1 for k in np.flatnonzero(self.printed[:, 0] == self.determinant))

    @cached_property
    def opposites(self) -> tuple[tuple[int, int], ...]:
        """Pairs of cases with opposite forces."""
        pairs = combinations(range(len(self.signs)), 2)
        return tuple((i + 1, k + 1) for i, k in pairs if (self.signs[i] == -self.signs[k]).all())

    def mirrored(self, counts: Index) -> dict[tuple[int, int], bool]:
        """By pair of opposite forces: PD(F) = ND(−F) and ND(F) = PD(−F)? K_C is linear in F."""
        return {
            (i, k): bool((counts[i - 1, [0, 2]] == counts[k - 1, [2, 0]]).all())
            for i, k in self.opposites
        }

    @cached_property
    def printed_determinant_sums(self) -> dict[tuple[int, int], int]:
        """Printed "PD" counts of opposite forces, added.

        det(−K_C) = −det(K_C), so counts of det(K_C) > 0 must add up to the size of the grid.
        """
        return {(i, k): int(self.printed[[i - 1, k - 1], 0].sum()) for i, k in self.opposites}


def table4(setting: Setting) -> Table4:
    """Classes of K_C at the flange on the grid of section VI, for forces of ±100 N per axis."""
    signs, printed = printed_counts()
    wanted = ("K_C", "complementary_class", "stiffness_class")
    found = setting.under_load(motion_grid(), COMPONENT * signs[:, None], *wanted)
    return Table4(
        signs,
        printed,
        classes=found.of("complementary_class"),
        determinant=(np.linalg.det(found.of("K_C")) > 0.0).sum(axis=1),
        difference_positive=(found.of("stiffness_class") == 0).sum(axis=1),
    )
