"""Table IV: definiteness of K_C over the motion range for eight directions of force."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.paper.printed import COMPONENT, printed_counts
from sk120stiff.paper.setting import Setting, motion_grid
from sk120stiff.stiffness import CLASSES


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
