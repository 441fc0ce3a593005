"""A tracker that was pushed, a marker or a joint that slipped, in the middle of a campaign.

From every row on another place of each is tried beside all that the model has
(`change_points.py`). It counts where the square of what is left halves: no smooth error of a model
does that at one row, since poses before and behind it are alike. What creeps from row to row
instead is no push.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Viewpoint
from sk120stiff.effects.geometry import ToolOffset
from sk120stiff.errors import InputError, listed, two_digits
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.checks.change_points import CLEARER, Change, Steps
from sk120stiff.identify.positions.residuals.pure_error import cells_of_numbers
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements


@dataclass(frozen=True, eq=False)
class _Cause:
    """What was moved.

    Attributes:
        what: It.
        column: The column that tells when.
        own: What each of its labels has.
        joint: Which actuated joint slipped; None: none did.
    """

    what: str
    column: str
    own: str
    joint: int | None = None


PUSHED = _Cause("the tracker", "station", "a frame of its own")
SLIPPED = _Cause("the marker", "series", "a place of its own on the tool")


def refuse_pushed(
    found: Fit, readings: Measurements, others: Array, prior: Array
) -> tuple[str, ...]:
    """Stop where tracker, marker or a joint moved between rows, and the file tells nothing of it.

    Where an error of the model might still be mistaken for it, a sentence says what it looks like.

    Args:
        found: A fit whose tracker has a frame.
        readings: Where they come from.
        others: (M, P) whitened columns of all that may be at work.
        prior: (P,) inverse variances of their factors, in units of what is left.

    Raises:
        InputError: One did, between lines that the message tells.
    """
    problem = found.problem
    if not isinstance(problem, PoseProblem) or "distance" in problem.channels.present:
        return ()
    when, a = _when(problem.measurements), problem.measurements.joints
    frames = {
        PUSHED: [k for k, p in enumerate(found.parameters) if isinstance(p.effect, Viewpoint)],
        SLIPPED: [k for k, p in enumerate(found.parameters) if isinstance(p.effect, ToolOffset)],
    }
    pose = cells_of_numbers(problem, problem.measurements.pose_index[:, None])
    told = {PUSHED: problem.said.stations, SLIPPED: problem.said.series}
    away = found.jacobian[:, [k for columns in frames.values() for k in columns]]
    nothing = Steps(
        others, prior, found.residual, away, when[problem.rows], a[problem.rows], pose, away
    )
    steps = _of_joints(problem, nothing)
    for cause, columns in frames.items():
        if columns and told[cause] is None:
            own = found.jacobian[:, columns]
            steps[cause] = replace(nothing, frame=own, creeps=own)
    tried = {cause: own.found for cause, own in steps.items()}
    cause = max(tried, key=lambda each: tried[each].odds, default=PUSHED)
    change = tried.get(cause, Change())
    if not change.cuts:
        return ()
    order, line = np.argsort(when), problem.measurements.line
    between = [f"{line[order[k - 1]]} and {line[order[k]]}" for k in change.cuts]
    share = f"the gap falls to {two_digits(100.0 * change.share)} % of what all else leaves"
    if cause.joint is not None:
        sizes = steps[cause].sizes(change.cuts)[:, 0]
        looks, remedy = _slipped_joint(problem, cause, sizes, between, share)
    else:
        looks = (
            f"{cause.what} looks moved between lines {listed(between)}: with another place from "
            f"there on {share}"
        )
        remedy = (
            f"Add a column {cause.column} with a label for each time between, as a and b: each has "
            f"{cause.own} then, and the arm is one. Or one label for all, if nothing was moved."
        )
    if change.sure and (cause.joint is None or problem.said.series is None):
        raise InputError(looks, where=readings.place, remedy=remedy)
    return (f"{looks[0].upper()}{looks[1:]}. {remedy}",)


def _of_joints(problem: PoseProblem, nothing: Steps) -> dict[_Cause, Steps]:
    """The joint that stands off from some row on, if any does: the likeliest of all.

    What creeps may be the tracker or the marker as well. A law of the joint, play say, makes it
    stand off alike beyond a border in its values, which a sorted plan crosses at one row.
    """
    if "position" not in problem.channels.present:
        return {}
    columns = problem.of_channels.apply(problem.by_joints)
    joints = [column[:, None] for column in columns.T]
    k = nothing.of_most(joints)
    steps = replace(nothing, frame=joints[k], creeps=np.hstack([nothing.creeps, joints[k]]))
    if steps.found.fall <= CLEARER * steps.by_places:
        return {}
    return {_Cause(problem.model.robot.actuated[k], "series", "", k): steps}


def _slipped_joint(
    problem: PoseProblem, cause: _Cause, sizes: Array, between: list[str], share: str
) -> tuple[str, str]:
    """What a joint that slipped looks like, and what mends it."""
    robot, k = problem.model.robot, cause.joint or 0
    slides = robot.prismatic[k]
    by = [f"{1e3 * size:+.3g} {'mm' if slides else 'mrad'}" for size in sizes]
    add = [f"{1e3 * v:+.3g} mm" if slides else f"{np.degrees(v):+.3g} deg" for v in sizes]
    since = [
        f"{one} to all that were read from line {lines.split()[-1]} on"
        for one, lines in zip(add, between, strict=True)
    ]
    looks = (
        f"{cause.what} looks slipped by {listed(by)} between lines {listed(between)}: with another "
        f"zero from there on {share}"
    )
    ends = {
        0: "the tracker or the base turned about its axis",
        robot.n - 1: "the tool turned on it",
    }
    also = f" Or {ends[k]} by as much." if k in ends and not slides else ""
    return looks, (
        f"Look for what slipped there (a clamp, a belt, a coupling, a lost mastering).{also} If it "
        f"did, add to values of {cause.what} {listed(since)}; or leave out (column use: 0) what "
        "was read before it, or after it. Or write a column series with one label for all, if "
        "nothing slipped."
    )


def _when(readings: Measurements) -> Index:
    """(N,) place of each row in the order in which they were read, which is that of the file."""
    clock = readings.order if readings.order is not None else readings.time
    rows = np.arange(readings.n_readings) if clock is None else clock
    return np.asarray(np.argsort(np.argsort(rows, kind="stable"), kind="stable"), dtype=np.intp)
