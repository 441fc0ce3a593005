"""What each effect moves the marker by at the readings: springs by sag and load, frames, gears."""

from __future__ import annotations

import numpy as np

from sk120stiff.effects import Mounting, Viewpoint
from sk120stiff.effects.base import Geometric
from sk120stiff.explain.judge.budget import internal_covariance, within_joints
from sk120stiff.identify import Calibration
from sk120stiff.model import Model, Share, joint_shares, shares, with_own_errors
from sk120stiff.model.pose_reading import move_by_load, read_poses


def budget_of(found: Calibration) -> tuple[tuple[Share, ...], tuple[Share, ...]]:
    """Shares of all effects of a calibrated arm, and of what yields at each joint; largest first.

    Where only what a load does was read, of that; else of where the marker stands. Where the
    instrument and the marker are is no error of the arm, and nothing where no length was read.
    """
    problem, model = found.problem, found.model
    if not len(problem.lengths):
        return (), ()
    if problem.channels.displacements_alone:
        columns = move_by_load(model, problem.load_cases, derivative=True).columns
    else:
        columns = read_poses(model, problem.load_cases, derivative=True).columns
    derivative = columns[:, :3]
    own = np.array([_of_the_arm(model, k) for k in range(len(model.parameters))], dtype=bool)
    derivative = derivative * own
    whole, inner = (internal_covariance(each) for each in (found, within_joints(found)))
    joints = with_own_errors(
        joint_shares(model, derivative, whole), joint_shares(model, derivative, inner)
    )
    every = shares(model, derivative, whole)
    return tuple(s for s in every if s.rms > 0.0), tuple(s for s in joints if s.rms > 0.0)


def _of_the_arm(model: Model, k: int) -> bool:
    effect = model.parameters[k].effect
    marks = isinstance(effect, Geometric) and effect.of_marker
    return not (isinstance(effect, Viewpoint | Mounting) or marks)
