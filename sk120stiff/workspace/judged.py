"""A corrected path as a model judges it, beside the points that were measured afterwards."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.model import Model, Share
from sk120stiff.workspace.compensate import Standing
from sk120stiff.workspace.path import LoadedPath
from sk120stiff.workspace.returned import Returned, read_returned
from sk120stiff.workspace.standing_uncertainty import StandingUncertainty, standing_budgets


@dataclass(frozen=True, eq=False)
class Judged:
    """What is known of a corrected path.

    Attributes:
        path: The points, and the model that judges them.
        nominal: (N, n) joints without correction [rad or m].
        frame: The frame that is led along the path; None: the tool frame.
        part: (4, 4) the path's axes in the base.
        before, after, uncertainty: Where the tool stands, and ±.
        measured: The file of points that came back, if any.
    """

    path: LoadedPath
    model: Model
    nominal: Array
    frame: str | None
    part: Array
    before: Standing
    after: Standing
    uncertainty: StandingUncertainty | None
    measured: Path | None

    @property
    def meant(self) -> Array:
        """(N, 3) where the tool is meant to stand, axes of the path [m]."""
        place = self.model.robot.placement(self.nominal, self.frame)
        return np.asarray((place[:, :3, 3] - self.part[:3, 3]) @ self.part[:3, :3])

    def in_path(self, away: Array) -> Array:
        """Displacements (N, 3) of the base's axes in those of the path."""
        return np.asarray(away @ self.part[:3, :3])

    @cached_property
    def returned(self) -> tuple[Returned, ...]:
        """What was measured."""
        return () if self.measured is None else read_returned(self.measured, self.path, self.meant)

    def off_prediction(self, each: Returned) -> float:
        """How far measured points lie off where they were foretold, rms [m]."""
        return each.apart(self.in_path(getattr(self, each.run).away))

    @cached_property
    def budgets(self) -> tuple[tuple[Share, ...], tuple[Share, ...]]:
        """What each effect moves the uncorrected tool by, and all that yields at each joint."""
        return standing_budgets(self.model, self.nominal, self.path.wrench, frame=self.frame)
