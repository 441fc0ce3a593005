"""Springs from Table II's measured columns: the paper's two algorithms, from far starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.paper.setting import Setting

Method = Literal["trf", "lm"]
METHODS: tuple[Method, ...] = ("trf", "lm")
#: Starting values for all three springs [N·m/rad]: 1e5 to 1e10 N·mm/rad; the paper starts from 1e8.
STARTS = (1e2, 1e4, 1e5, 1e7)
#: Fits that `identify_springs` makes of three poses.
FITS = 3 + len(METHODS) * len(STARTS) + 3

# Scatter is not published: these have a scale to start from, and are compared with each other only.
SHARED_ZERO = NoiseModel(10e-6, zero="shared", freedom=0)
EQUAL_WEIGHTS = NoiseModel(10e-6, zero="separate", freedom=0)


@dataclass(frozen=True, eq=False)
class Run:
    """One run of one algorithm: the start of all three springs, and (3,) its end [N·m/rad]."""

    method: Method
    start: float
    springs: Array


@dataclass(frozen=True, eq=False)
class Identified:
    """What the three printed poses say of the springs.

    Attributes:
        fit: What ``sk120stiff identify`` finds: each pose's rows share one zero reading, and the
            covariance knows it.
        equal_weights: The paper's criterion, eq. (12): plain least squares.
        runs: Both algorithms from `STARTS`.
        by_pose: Pose → springs (3,) and their standard errors (3,), from that pose alone [N·m/rad].
        F, probability: Test of common springs against springs of each pose's own: F ratio, and how
            probable a larger one is if the springs are the same everywhere.
    """

    fit: Fit
    equal_weights: Fit
    runs: tuple[Run, ...]
    by_pose: dict[str, tuple[Array, Array]]
    F: float
    probability: float

    @cached_property
    def springs(self) -> Array:
        """(3,) [N·m/rad]."""
        return springs_of(self.fit)

    @cached_property
    def errors(self) -> Array:
        """(3,) standard errors [N·m/rad]."""
        return errors_of(self.fit)

    @cached_property
    def spread(self) -> float:
        """Largest relative difference between the runs."""
        found = np.array([run.springs for run in self.runs])
        return float(np.max(np.ptp(found, axis=0) / found.mean(axis=0)))


def identify_springs(
    setting: Setting, measured: Measurements, step: Callable[[], None] = lambda: None
) -> Identified:
    """Identify the three springs from the measured rows; `step` is called after each fit."""

    def one(
        data: Measurements = measured,
        noise: NoiseModel | None = SHARED_ZERO,
        method: Method = "trf",
        start: float | None = None,
    ) -> Fit:
        model = setting.model
        if start is not None:
            model = model.with_public(dict.fromkeys(model.names, start))
        found = fit(model, data, noise=noise, method=method)
        step()
        return found

    common, labels = one(), np.array(measured.pose)
    runs = tuple(
        Run(method, start, springs_of(one(method=method, start=start)))
        for method in METHODS
        for start in STARTS
    )
    alone = {pose: one(measured.select(np.flatnonzero(labels == pose))) for pose in measured.poses}
    # Fits of parts and of the whole have the same noise model up to its scale: their χ² compare.
    apart = sum(found.chi_square for found in alone.values())
    more = (len(alone) - 1) * len(common.parameters)
    left = common.degrees_of_freedom - more
    F = (common.chi_square - apart) / more / (apart / left)
    return Identified(
        fit=one(noise=None),
        equal_weights=one(noise=EQUAL_WEIGHTS),
        runs=runs,
        by_pose={pose: (springs_of(f), errors_of(f)) for pose, f in alone.items()},
        F=float(F),
        probability=float(stats.f.sf(F, more, left)),
    )


def springs_of(found: Fit) -> Array:
    """(P,) estimated springs [N·m/rad]."""
    return np.array([parameter.value for parameter in found.parameters])


def errors_of(found: Fit) -> Array:
    """(P,) standard errors [N·m/rad]; NaN where an estimate lies on a bound."""
    return np.array([parameter.std for parameter in found.parameters], dtype=float)
