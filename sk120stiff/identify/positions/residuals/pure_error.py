"""What repeats say of the noise where positions, distances or single gauges were read.

Readings of one pose under one load differ by the instrument alone, whatever the model lacks: their
means are free, so nothing of the model is in what is left (pure error).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem

ENOUGH = 10  # degrees of freedom; fewer leave σ open by a quarter or more


class PureError(NamedTuple):
    """Noise as repeats show it.

    Attributes:
        sigma: Standard uncertainty of one number [m, or rad where nothing else was read].
        freedom: Degrees of freedom behind it.
    """

    sigma: float
    freedom: int


def pure_error(found: Calibration) -> PureError | None:
    """Of the numbers whose gap is told as one size; None where too few were read again.

    The joints may tremble by what an encoder tells, so the gap at the reading's own joints counts.
    """
    problem = found.problem
    gap = problem.of_channels.undo(found.residual)[problem.counted]
    said, readings = problem.said, problem.measurements
    labels = [said.markers, said.groups, said.stations, readings.branch]
    load = [readings.pose_index, np.round(readings.wrench, 6), said.payload, said.point]
    load += [np.unique(each, return_inverse=True)[1] for each in labels if each is not None]
    cell = cells_of_numbers(problem, np.column_stack(load))[problem.counted]
    count = np.bincount(cell)
    mean = np.bincount(cell, gap) / np.maximum(count, 1)
    freedom = int(np.maximum(count - 1, 0).sum())
    if freedom < ENOUGH:
        return None
    return PureError(float(np.sqrt(((gap - mean[cell]) ** 2).sum() / freedom)), freedom)


def cells_of_numbers(problem: PoseProblem, of_row: Array | Index) -> Index:
    """(M,) equal for numbers that read one thing, whose rows have equal keys (N, k).

    One thing is an axis, a turn, a gauge's direction, the point that a distance is from, or the
    direction of the tool that a level lies along.
    """
    kinds, axes, aims = [], [], []
    for number, kind in enumerate(problem.channels.present):
        rows, axis = np.nonzero(problem.channels.held(kind))
        kinds.append(np.full(len(rows), number))
        axes.append(axis)
        aims.append(problem.channels.aim(kind)[rows])
    told = np.concatenate(kinds), np.concatenate(axes), np.concatenate(aims)
    keys = [of_row[problem.rows], *told]
    cells: Index = np.unique(np.column_stack(keys), axis=0, return_inverse=True)[1]
    return cells
