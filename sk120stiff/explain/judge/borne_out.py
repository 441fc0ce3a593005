"""Do readings of a file that no fit saw bear out what was named?

Where the names hold, what is off without them goes there as what they add, Δ: the share
``Σ Δ·g / Σ Δ²`` of it is one. Where nothing of them is there it is zero, and below a half the names
foretell worse than none. How well it is known the poses tell, each of which has a say of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from sk120stiff.arrays import Array
from sk120stiff.errors import micro
from sk120stiff.identify import Fit, Problem
from sk120stiff.measurements import Measurements

SURE = 0.95  # that less is there than the names add, before it is told
FEWEST = 3  # poses that tell how well a share is known


@dataclass(frozen=True)
class BorneOut:
    """What the readings of a hold-out file show of what the names add there.

    Attributes:
        file: Its name.
        gap, without: With the names and without, rms per axis [m].
        share, std: Of what the names add, how much is there; 1: all of it.
        poses: How many poses tell.
    """

    file: str
    gap: float
    without: float
    share: float
    std: float
    poses: int

    @property
    def contradicted(self) -> bool:
        """Foretold no better with the names, where by the names it should be beyond chance."""
        if self.gap < self.without or self.poses < FEWEST:
            return False
        return bool(1.0 - self.share > student.ppf(SURE, self.poses - 1) * self.std)

    def sentence(self, unit: str = "µm rms per axis") -> str:
        """Both gaps, and what of the names is there."""
        gaps = f"{micro(self.gap, 4)} {unit}, without them by {micro(self.without, 4)}"
        return (
            f"At the readings of {self.file} the model with these names is off by {gaps}: of what "
            f"they add there {self.share:.2g} ± {self.std:.2g} is seen where it should be 1, so "
            "the names, or their sizes, do not hold there."
        )

    def advice(self, unit: str = "µm") -> str:
        """What to do about it."""
        gap, without = f"{micro(self.gap, 4)} {unit}", f"{micro(self.without, 4)}"
        return (
            f"At the readings of {self.file} the model is off by no less with these names ({gap}) "
            f"than without ({without}): the names, or their sizes, do not hold there. Use "
            "model.yaml at most where poses and loads are like those fitted; append "
            f"{self.file} to the readings and run this again."
        )


def borne_out(base: Fit, final: Fit, holdout: Measurements) -> BorneOut | None:
    """What a hold-out file shows of what joined the base model; None: it tells nothing."""
    other = Problem(base.model, holdout.masked(), base.problem.noise)
    cases = other.load_cases.of_another_file
    before = other.measured - base.model.predict(cases)
    after = other.measured - final.model.predict(cases)
    return shown(before, after, other.measurements.pose, name_of(holdout))


def shown(before: Array, after: Array, poses: Sequence[str], file: str) -> BorneOut | None:
    """The same of what is off without and with the names, (N, ...) [m], at N poses."""
    read = np.isfinite(before) & np.isfinite(after)
    before, after = np.where(read, before, 0.0), np.where(read, after, 0.0)
    added = before - after
    size = float((added**2).sum())
    labels, pose = np.unique(np.array(poses), return_inverse=True)
    if not size > 0.0 or len(labels) < 2:
        return None
    share = float((added * before).sum()) / size
    each = (added * (before - share * added)).reshape(len(added), -1).sum(axis=1)
    score = np.bincount(pose, each)
    count = int(read.sum())
    return BorneOut(
        file,
        gap=float(np.sqrt((after**2).sum() / count)),
        without=float(np.sqrt((before**2).sum() / count)),
        share=share,
        std=float(np.sqrt((score**2).sum() * len(labels) / (len(labels) - 1)) / size),
        poses=len(labels),
    )


def name_of(holdout: Measurements) -> str:
    """The file that readings come from, in a sentence."""
    return "the hold-out file" if holdout.path is None else holdout.path.name
