"""A tracker that was pushed, a marker or a joint that slipped, in the middle of a campaign.

From every row on another place of each is tried beside all that the model has
(`change_points.py`). It counts where the square of what is left halves: no smooth error of a model
does that at one row, since poses before and behind it are alike. What creeps from row to row
instead is no push. Of several that do so `likeliest.py` takes one, and names the others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Viewpoint
from sk120stiff.effects.geometry import ToolOffset
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.change_points import CLEARER, Change, Steps
from sk120stiff.identify.positions.checks.likeliest import (
    Cause,
    Suspect,
    likeliest,
    rivals_of,
    variants,
)
from sk120stiff.identify.positions.checks.slips_in_words import looks_of, remedy_of, taken_of
from sk120stiff.identify.positions.residuals.pure_error import cells_of_numbers
from sk120stiff.identify.positions.solve.pose_errors import PoseWhitening
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements, MovedBetween
from sk120stiff.measurements.moved import clock_of, labelled, parts_of_all, turned_from

PUSHED = Cause("the tracker", "station", "a frame of its own")
SLIPPED = Cause("the marker", "series", "a place of its own on the tool")
OF = {PUSHED: 6, SLIPPED: 3}  # numbers of one place
ROUNDING = 1e-7  # m or rad; what no instrument reads, and no jump is told of


def refuse_pushed(
    found: Calibration, readings: Measurements, others: Array, prior: Array
) -> tuple[str, ...]:
    """Stop where tracker, marker or a joint moved between rows, and the file tells nothing of it.

    Where an error of the model might still be mistaken for it, a sentence says what it looks like.

    Args:
        found: A calibration whose tracker has a frame.
        readings: Where they come from.
        others: (M, P) whitened columns of all that may be at work.
        prior: (P,) inverse variances of their factors, in units of what is left.

    Raises:
        MovedBetween: One did, between lines that the message tells.
    """
    problem = found.problem
    if not isinstance(problem, PoseProblem) or "distance" in problem.channels.present:
        return ()
    if found.rms < ROUNDING:
        return ()
    told = {"station": problem.said.stated_stations, "series": problem.said.stated_series}
    suspects = list[Suspect]()
    for white in weighings(problem):
        here = _suspects(found, problem, white, others, prior)
        suspects = suspects or here
        if any(each.change.sure for each in here):
            suspects = here
            break
    if not suspects:
        return ()
    unsaid = {each.cause for each in suspects if told[each.cause.column] is None}
    sure = {each.cause for each in suspects if each.change.sure and each.cause in unsaid}
    best = likeliest([each for each in suspects if not sure or each.cause in unsaid])
    rivals = rivals_of(best, suspects)
    when = _when(problem.measurements)
    looks = looks_of(problem, when, best, rivals)
    remedy = remedy_of(problem, when, best, rivals, [*unsaid])
    moved = [each for each in (best, *rivals) if each.change.sure and each.cause in unsaid]
    if moved:
        least = min(moved, key=lambda each: each.left)
        raise MovedBetween(
            looks, where=readings.place, remedy=remedy, taken=taken_of(least, best),
            apart=_apart(readings, np.flatnonzero(readings.use & ~found.wild), least),
        )  # fmt: skip
    return (f"{looks[0].upper()}{looks[1:]}. {remedy}",)


def _apart(readings: Measurements, rows: Index, moved: Suspect) -> Measurements:
    """The readings with that told: labels of the parts, or values of the joint put right.

    Args:
        readings: All that were given.
        rows: Those of them that took part.
        moved: What moved among these.
    """
    own = np.searchsorted(moved.change.cuts, _ranks(clock_of(readings)[rows]), side="right")
    part = parts_of_all(readings, rows, own)
    if moved.cause.joint is None:
        return labelled(readings, moved.cause.column, part)
    by = np.concatenate([[0.0], np.cumsum(moved.sizes[:, 0])])
    return turned_from(readings, moved.cause.joint, by[part] - by[-1])


def weighings(problem: PoseProblem) -> Iterator[PoseWhitening]:
    """How numbers may count: each for itself, then those of a pose with what they share.

    What moved between rows moves all readings of a pose alike, and would be taken for what poses
    have of their own, were that held against it first.
    """
    if problem.common:
        yield PoseWhitening(problem.of_channels.sigma)
    yield problem.of_channels


def weighed(
    problem: PoseProblem, white: PoseWhitening, found: Fit, others: Array, prior: Array
) -> tuple[Array, Array, Array]:
    """What is left (M,), columns (M, P) and prior (P,) as another weighing has them."""
    if white is problem.of_channels:
        return found.residual, others, prior
    undo = problem.of_channels.undo
    left = white.apply(undo(found.residual))
    wider = float(left @ left) / max(float(found.residual @ found.residual), 1e-300)
    return left, white.apply(undo(others)), prior * wider


def _suspects(
    found: Fit, problem: PoseProblem, white: PoseWhitening, others: Array, prior: Array
) -> list[Suspect]:
    """All that may have moved, where it takes off enough, each at the times that were found."""
    when, a = _when(problem.measurements), problem.measurements.joints
    frames = {
        PUSHED: [k for k, p in enumerate(found.parameters) if isinstance(p.effect, Viewpoint)],
        SLIPPED: [k for k, p in enumerate(found.parameters) if isinstance(p.effect, ToolOffset)],
    }
    told = {PUSHED: problem.said.stated_stations, SLIPPED: problem.said.stated_series}
    pose = cells_of_numbers(problem, problem.measurements.pose_index[:, None])
    raw = problem.of_channels.undo(found.jacobian)
    moves = {cause: _of_one_place(raw[:, columns], OF[cause]) for cause, columns in frames.items()}
    away = white.apply(np.hstack([*moves.values()]))
    left, others, prior = weighed(problem, white, found, others, prior)
    nothing = Steps(others, prior, left, away, when[problem.rows], a[problem.rows], pose, away)
    suspects = list[Suspect]()
    for cause, columns in frames.items():
        if columns and told[cause] is None:
            own = white.apply(moves[cause])
            suspects += variants(cause, replace(nothing, frame=own, creeps=own), moves[cause])
    moved = any(each.change.sure for each in suspects)
    return suspects + _of_joints(problem, white, nothing, moved)


def _of_one_place(columns: Array, numbers: int) -> Array:
    """(M, p) how a place moves readings, wherever it was: those of several that were found."""
    if columns.shape[1] % numbers:
        return columns
    return np.asarray(columns.reshape(len(columns), -1, numbers).sum(axis=1))


def _of_joints(
    problem: PoseProblem, white: PoseWhitening, nothing: Steps, moved: bool
) -> list[Suspect]:
    """The joint that stands off from some row on, if any does: the likeliest of all.

    What creeps may be the tracker or the marker as well. A law of the joint, play say, makes it
    stand off alike beyond a border in its values, which a sorted plan crosses at one row.

    Args:
        problem, white, nothing: What was read.
        moved: Something moved at one row beyond doubt, be it this joint or not.
    """
    if "position" not in problem.channels.present:
        return []
    joints = [white.apply(column)[:, None] for column in problem.by_joints.T]
    k = nothing.of_most(joints)
    steps = replace(nothing, frame=joints[k], creeps=np.hstack([nothing.creeps, joints[k]]))
    if steps.found.fall <= CLEARER * steps.by_places and not moved:
        return []
    cause = Cause(problem.model.robot.actuated[k], "series", "", k)
    found = variants(cause, steps, problem.by_joints[:, [k]])
    once = steps.kept.once() if moved and not found else Change()
    return [Suspect(cause, steps, once, problem.by_joints[:, [k]])] if once.cuts else found


def _when(readings: Measurements) -> Index:
    """(N,) place of each row in the order in which they were read."""
    return _ranks(clock_of(readings))


def _ranks(clock: Array) -> Index:
    """(N,) place of each in their order; those that are alike keep theirs."""
    order = np.argsort(clock, kind="stable")
    return np.asarray(np.argsort(order, kind="stable"), dtype=np.intp)
