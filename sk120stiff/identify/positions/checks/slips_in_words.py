"""What a tracker, a marker or a joint that moved looks like, in words, and what mends it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.arrays import Array, Index, rms
from sk120stiff.errors import listed, two_digits
from sk120stiff.identify.positions.checks.likeliest import Cause, Suspect
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem

LABELS = "with a label for each time between, as a and b"


def looks_of(problem: PoseProblem, when: Index, best: Suspect, rivals: Sequence[Suspect]) -> str:
    """What moved most likely, when and by how much, and what explains nearly as much."""
    share = f"the gap falls to {_percent(best)} % of what all else leaves"
    between, by = _between(problem, when, best), _by(problem, best)
    if best.cause.joint is not None:
        said = f"{best.cause.what} looks slipped{by} between lines {between}: with another zero"
        return f"{said} from there on {share}{_beside(problem, when, best, rivals)}"
    said = f"{best.cause.what} looks moved between lines {between}: with another place from there"
    aside = f", off{by} in the mean," if by else ""
    return f"{said} on{aside} {share}{_beside(problem, when, best, rivals)}"


def remedy_of(
    problem: PoseProblem,
    when: Index,
    best: Suspect,
    rivals: Sequence[Suspect],
    unsaid: Sequence[Cause],
) -> str:
    """What to do for the likeliest, for each of its rivals, and where nothing moved.

    Args:
        problem, when, best, rivals: What moved.
        unsaid: Causes of which the file does not say whether they moved.
    """
    others = " ".join(_instead(problem, when, rival) for rival in rivals)
    others = f"{others} " if others else ""
    mentioned = [best.cause, *(rival.cause for rival in rivals)]
    columns = list(dict.fromkeys(each.column for each in mentioned if each in unsaid))
    columns = columns or [best.cause.column]
    label = f"column{'s' if len(columns) > 1 else ''} {listed(columns)} with one label for all"
    if best.cause.joint is None:
        nothing = "one label for all" if columns == [best.cause.column] else label
        return (
            f"Add a column {best.cause.column} {LABELS}: each has {best.cause.own} then, and the "
            f"arm is one. {others}Or {nothing}, if nothing was moved."
        )
    robot, k = problem.model.robot, best.cause.joint
    ends = {
        0: "the tracker or the base turned about its axis",
        robot.n - 1: "the tool turned on it",
    }
    also = f" Or {ends[k]} by as much." if k in ends and not robot.prismatic[k] else ""
    article = "a " if len(columns) == 1 else ""
    return (
        f"Look for what slipped there (a clamp, a belt, a coupling, a lost mastering).{also} If it "
        f"did, add to values of {best.cause.what} {_added(problem, when, best)}; or leave out "
        f"(column use: 0) what was read before it, or after it. {others}Or write {article}{label}, "
        "if nothing slipped."
    )


def taken_of(taken: Suspect, best: Suspect) -> str:
    """How the readings are taken from here on.

    Args:
        taken: What moved as they are taken.
        best: What moved most likely.
    """
    if taken.cause.joint is not None:
        return (
            f"Taken so here: values of {taken.cause.what} that were read before are put right by "
            "as much, so that the model is of the arm as it stands since."
        )
    own = f"{taken.cause.own} for each part of the campaign"
    if taken.cause == best.cause:
        return f"Taken so here: {own}."
    return f"Taken here as if {taken.cause.what} had moved, which leaves least: {own}."


def _beside(problem: PoseProblem, when: Index, best: Suspect, rivals: Sequence[Suspect]) -> str:
    """How much the rivals leave, and with how many numbers."""
    said = []
    for rival in rivals:
        between = _between(problem, when, rival)
        there = "there" if between == _between(problem, when, best) else f"between lines {between}"
        verb = "moved" if rival.cause.joint is None else "slipped"
        said.append(
            f"that {rival.cause.what} {verb} {there}{_by(problem, rival)} "
            f"({_numbers(rival.numbers)}) leaves {_percent(rival)} %"
        )
    if not said:
        return ""
    return (
        f" ({_numbers(best.numbers)}). As likely, as far as these readings tell: {listed(said)}; "
        "more numbers take off more, as they do of any error of the model"
    )


def _numbers(count: int) -> str:
    return "one number" if count == 1 else f"{count} numbers"


def _percent(suspect: Suspect) -> str:
    return two_digits(100.0 * suspect.change.share)


def _between(problem: PoseProblem, when: Index, suspect: Suspect) -> str:
    line, order = problem.measurements.line, np.argsort(when)
    return listed([f"{line[order[k - 1]]} and {line[order[k]]}" for k in suspect.change.cuts])


def _by(problem: PoseProblem, suspect: Suspect) -> str:
    """By how much it moved each time; nothing where no position tells."""
    if suspect.cause.joint is not None:
        unit = "mm" if problem.model.robot.prismatic[suspect.cause.joint] else "mrad"
        return f" by {listed([f'{1e3 * size:+.3g} {unit}' for size in suspect.sizes[:, 0]])}"
    moves = [_distance(problem, suspect.raw @ size) for size in suspect.sizes]
    return f" by {listed([f'{1e3 * m:.2g} mm' for m in moves])}" if np.isfinite(moves).all() else ""


def _distance(problem: PoseProblem, moved: Array) -> float:
    """By how much positions differ, rms [m]; NaN where none is whole."""
    away = problem.distances(moved)
    away = away[np.isfinite(away)]
    return rms(away)


def _instead(problem: PoseProblem, when: Index, rival: Suspect) -> str:
    if rival.cause.joint is None:
        return f"If {rival.cause.what} moved instead, add a column {rival.cause.column} {LABELS}."
    added = _added(problem, when, rival)
    return f"If {rival.cause.what} slipped instead, add to its values {added}."


def _added(problem: PoseProblem, when: Index, suspect: Suspect) -> str:
    """What to add to values of a joint, and from which lines on."""
    slides = problem.model.robot.prismatic[suspect.cause.joint or 0]
    line, order = problem.measurements.line, np.argsort(when)
    return listed(
        [
            (f"{1e3 * v:+.3g} mm" if slides else f"{np.degrees(v):+.3g} deg")
            + f" to all that were read from line {line[order[cut]]} on"
            for v, cut in zip(suspect.sizes[:, 0], suspect.change.cuts, strict=True)
        ]
    )
