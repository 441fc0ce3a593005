"""What to do now: one paragraph for every verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.data_checks import place_of
from sk120stiff.effects.gravity_compensator import GravityCompensator
from sk120stiff.errors import listed
from sk120stiff.explain.answer.drifting import steady_offsets
from sk120stiff.explain.answer.probabilities import EVEN, nothing, unsettled
from sk120stiff.explain.answer.words import accounted, mostly_accounted, worse_elsewhere
from sk120stiff.explain.localise.changes import changed_at
from sk120stiff.explain.localise.suspects import comes_and_goes
from sk120stiff.explain.localise.words import microns

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation
    from sk120stiff.explain.judge.goes_with import GoesWith

CHECKED = {
    "sensor": "no fault of the arm; check how the force sensor was calibrated and mounted",
    "tracker": "no fault of the arm; check how the tracker stood and was aligned",
}
STATED = {
    "force_point": "measure where the load acts and write force: {point: ...} into the YAML file",
}
BY_NATURE = "that is how such gears are, no fault of the arm"
REPEATS = "repeat a few readings (same pose and load), so that the noise is known from them"
LARGE = 2.0  # times what noise alone makes
FAR_OFF_TOLD = 5  # readings that are listed
VAGUE = 0.5  # of its size, by which it is known, from where on a share is no advice


def next_step(answer: Explanation) -> str:
    """Plain sentences: what the model may be used for, and what to measure or to mend."""
    said = {"none": _none, "named": _named, "ambiguous": _ambiguous, "outside": _outside}
    return " ".join(
        [
            *_of_the_units(answer),
            *_of_the_file(answer),
            *_of_rows_far_off(answer),
            *said[answer.verdict](answer),
            *filter(None, [steady_offsets(answer)]),
            *_of_a_balancer(answer),
            *_of_the_beyond(answer),
            *_of_the_slips(answer),
        ]
    )


def _of_the_units(answer: Explanation) -> list[str]:
    """That everything yields too much or too little, before any name or value is believed."""
    if answer.units is None:
        return []
    return [
        "Make sure of the units before anything else: a wrong one makes names and values. "
        f"{answer.units[0].upper()}{answer.units[1:]}. If they are right:"
    ]


def _of_rows_far_off(answer: Explanation) -> list[str]:
    """Which readings lie far off the model, and were not set aside, before it is believed."""
    far = answer.far_off
    if not far:
        return []
    places = listed([f"{place} by {microns(size)}" for place, size in far[:FAR_OFF_TOLD]])
    more = f", the worst {places}" if len(far) > FAR_OFF_TOLD else f": {places}"
    one = len(far) == 1
    return [
        f"{len(far)} reading{' lies' if one else 's lie'} far off what the model makes of the "
        f"others{more}. A cause that is not in the catalogue may have made "
        f"{'it' if one else 'them'}; if {'it is a slip' if one else 'they are slips'}, a 0 in a "
        f"column use leaves {'it' if one else 'them'} out: run this again without, and see."
    ]


def _of_the_file(answer: Explanation) -> list[str]:
    """That a hold-out file contradicts the names, before what else is to be done."""
    return [answer.borne_out.advice()] if contradicted(answer) and answer.borne_out else []


def contradicted(answer: Explanation) -> bool:
    """Are readings that no fit saw foretold no better with the names, where they should be?"""
    return answer.borne_out is not None and answer.borne_out.contradicted


def _of_the_beyond(answer: Explanation) -> list[str]:
    """What would explain by far the most of the rest, at a size beyond belief."""
    name = answer.beyond
    if name is None:
        return []
    how = STATED.get(name.partition(":")[0], "check units and what was stated of arm and tool")
    return [
        f"Of all that could be added {name} would explain the most, at a size beyond belief: "
        f"{how}. If it is so, run this again with --assume {name}."
    ]


def _of_the_slips(answer: Explanation) -> list[str]:
    slips = answer.slips
    if not slips:
        return []
    places = listed([place_of(answer.readings, row) for row in slips])
    reads = "it reads" if len(slips) == 1 else "they read"
    return [
        f"Compare {places} with the sheet: {reads} like a slip of the pen. What is mended there "
        "counts when this is run again."
    ]


def _none(answer: Explanation) -> list[str]:
    left = answer.adequacy
    if left.chance is None:
        return [f"Before anything is concluded, state the noise or {REPEATS}, and run this again."]
    if left.understated is not None and not worse_elsewhere(answer):
        return [*_of_the_noise(answer), "The model itself may be used as it is."]
    if nothing(answer) < EVEN:
        return [
            f"That nothing is missing is not sure ({unsettled(answer)}): measure at more poses, or "
            "with larger loads, append the readings to the file and run this again."
        ]
    if worse_elsewhere(answer):
        last = answer.steps[-1]
        fitted, foretold = microns(last.fit_rms), microns(last.heldout_rms)
        return [
            *_of_the_noise(answer),
            f"Use model.yaml at poses like those measured: it fits them to {fitted} rms per axis, "
            f"but without one of them it foretells it to {foretold}, so they are too few, or too "
            "unlike, to say much of others. Measure at more poses, append the readings to the file "
            "and run this again.",
        ]
    return [
        "Use model.yaml as it is.",
        "What could still hide, and how large it would have to be, stands in the report and in "
        "verdict.json; poses farther apart and larger loads show smaller effects.",
    ]


def _named(answer: Explanation) -> list[str]:
    said = [] if contradicted(answer) else [_gain(answer), *_largest(answer)]
    return [*said, *_of_noise_and_rest(answer)]


def _ambiguous(answer: Explanation) -> list[str]:
    if answer.next_poses is None:
        said = [] if contradicted(answer) else [_gain(answer)]
        return [*said, *_of_noise_and_rest(answer)]
    return [
        f"Measure the {len(answer.next_poses[0])} readings of next_poses.csv, append them to the "
        f"file and run this again: {told_apart(answer)}.",
        "Until then the model foretells such poses alike under either name.",
        *_of_noise_and_rest(answer),
    ]


def _of_noise_and_rest(answer: Explanation) -> list[str]:
    left = [_of_the_remainder(answer)] if answer.remainder.significant else []
    return [*_of_the_noise(answer), *left]


def told_apart(answer: Explanation) -> str:
    """Which names the proposed readings tell apart, and which they hardly do."""
    pairs = answer.next_pairs
    settled = [f"{pair.name} from {pair.rival}" for pair in pairs if pair.settled]
    weak = [f"{pair.name} from {pair.rival}" for pair in pairs if not pair.settled]
    open_ = {
        (finding.effect.id, name) for finding in answer.findings for name in finding.others
    } - {(pair.name, pair.rival) for pair in pairs}
    if not pairs or not (weak or open_):
        return "they tell the open names apart"
    said = [f"they tell {listed(settled)}"] if settled else []
    if weak:
        said.append(f"they are too few to be sure of {listed(weak)}")
    if open_:
        pairs_left = "another pair" if len(open_) == 1 else f"{len(open_)} further pairs"
        said.append(f"for {pairs_left} of names run it again afterwards")
    return "; ".join(said)


def _outside(answer: Explanation) -> list[str]:
    said = ["Trust the springs no farther than the gap that is left."]
    if answer.adequacy.undecided:
        return [
            *said,
            f"{REPEATS[0].upper()}{REPEATS[1:]}: if they scatter as much, σ was stated too small, "
            "and the model may be used as it is.",
        ]
    if answer.guess is not None:
        said.append(
            "best_guess.yaml foretells other poses best; use it at most where poses and loads are "
            "like those measured."
        )
    return [*said, _of_the_remainder(answer), *_of_the_weight(answer)]


def _of_the_weight(answer: Explanation) -> list[str]:
    """Masses of URDF files are often invented, and gears and bolts are preloaded by them."""
    robot = answer.final.model.robot
    if not robot.gravity.any():
        return []
    if not robot.total_mass:
        return [
            "The robot file states no masses. An arm's own weight preloads its gears and bolts, "
            "and what play, friction or a gear that stiffens does cannot be told without it: use a "
            "URDF that has the masses and their centres, or write gravity: 0 into the YAML file if "
            "the arm is balanced, and run this again."
        ]
    return [
        f"What is not in proportion to the load was sought about the preload by the arm's own "
        f"weight, {robot.total_mass:.3g} kg by the URDF: where these masses are not the arm's, "
        "write gravity: 0 into the YAML file and run this again."
    ]


def _of_a_balancer(answer: Explanation) -> list[str]:
    """Without masses a balancer may be the arm's own weight on a gear that is not linear."""
    if answer.final.model.robot.total_mass:
        return []
    names = (finding.effect.id for finding in answer.findings)
    return [
        f"{name} stands for a stiffness that goes with the posture. The robot file states no "
        f"masses, and the arm's own weight on a gear of {name.partition(':')[2]} that is not "
        "linear brings the same: write masses and their centres into it and run this again, or "
        "see whether there is a balancer at all."
        for name in names
        if name.startswith(f"{GravityCompensator.name}:")
    ]


def _of_the_noise(answer: Explanation) -> list[str]:
    """That a stated σ looks too small, whatever else was found."""
    if answer.adequacy.understated is None:
        return []
    sigma = (answer.yardstick.sigma or 0.0) * answer.adequacy.understated
    return [
        f"Correct the stated σ to about {microns(sigma)}, or look for what disturbs single "
        "readings."
    ]


def _gain(answer: Explanation) -> str:
    first, last = (answer.steps[k].heldout_rms for k in (0, -1))
    if not (np.isfinite(first) and np.isfinite(last) and last < first):
        return "Use model.yaml where poses and loads are like those measured."
    return (
        f"Use model.yaml: at poses that no fit saw it is off by {microns(last)} rms per axis where "
        f"springs alone were off by {microns(first)}."
    )


def _largest(answer: Explanation) -> list[str]:
    named = {finding.effect.id: finding for finding in answer.findings}
    mine = [share for share in answer.budget if share.name in named]
    if not mine:
        return []
    known = [share for share in mine if share.std is None or share.std < VAGUE * share.rms]
    if not known:
        return [
            "How much each of what was named brings by itself these readings do not tell: before "
            "the arm is mended, read at poses that tell them apart."
        ]
    first = known[0]
    error = "" if first.std is None else f" (± {microns(first.std)})"
    names = (first.name, *named[first.name].alternatives)
    most = "what was named" if first is mine[0] else "what is well known"
    places = {name.partition(":")[2] for name in names}
    advice = CHECKED.get(places.pop()) if len(places) == 1 else None
    if len(names) == 1 and named[first.name].effect.bends_a_spring:
        advice = BY_NATURE
    if first.name in answer.softer:
        advice = "before you look there, make sure that what was put on is not as soft as told"
    return [
        f"At the measured loads {' or '.join(names)} brings the most of {most}, "
        f"{microns(first.rms)}{error} rms per axis: "
        f"{advice or 'look there first if the arm is to be mended'}."
    ]


def _in_doubt(place: GoesWith) -> str:
    if place.foretold is None:
        return "too few poses are left to bear that out"
    return "poses left out are foretold hardly better with it"


def _of_a_change(answer: Explanation, pose: str) -> str:
    readings = answer.final.problem.measurements
    if readings.order is None and readings.time is None:
        return (
            f"In the order in which rows stand something changed before pose {pose}. If they were "
            "read in that order, find out what came loose, was tightened or let go there, or "
            f"whether readings of two arms stand in one file, and run this on the poses before "
            f"{pose} and on those from {pose} on, each by themselves (column use: 0 leaves a row "
            "out). If not, write the column order, and run this again."
        )
    return (
        f"Find out what changed before pose {pose} was read: what came loose there, was tightened "
        "or let go, or whether readings of two arms stand in one file. Then run this on the poses "
        f"before {pose} and on those from {pose} on, each by themselves (column use: 0 leaves a "
        "row out)."
    )


def _of_the_remainder(answer: Explanation) -> str:
    """What would tell more of what is left."""
    left, place = answer.remainder, accounted(answer)
    closest = left.closest if left.goes_with is None else left.goes_with.suspect
    if comes_and_goes(closest or ""):
        return (
            "The rest comes and goes with the time: read the zero again before every load, and "
            "keep sun, draughts and air conditioning from arm and instrument."
        )
    most = mostly_accounted(answer)
    if (shows := place or most) and left.goes_with is not None and not left.goes_with.borne_out:
        return (
            f"The rest shows most with {shows}, but {_in_doubt(left.goes_with)}: read at more "
            "poses and loads that change it, before anything is mended there."
        )
    if place is not None and (since := changed_at(place)):
        return _of_a_change(answer, since)
    if place is not None:
        return (
            f"The rest goes with {place}, and beside that only noise is left: look there, and read "
            "at more poses and loads that change it, so that its law shows."
        )
    if most is not None and (since := changed_at(most)):
        return _of_a_change(answer, since)
    if most is not None:
        return (
            f"Most of the rest goes with {most}: look there first, and read at more poses and "
            "loads that change it, so that its law shows."
        )
    readings = answer.final.problem.measurements
    wishes = []
    if readings.repeat is None:
        wishes.append(REPEATS)
    if readings.order is None and readings.time is None:
        wishes.append(
            "note the order of the readings (column order), without which no drift is sought"
        )
    if readings.branch is None:
        wishes.append("take loads off in steps as they were put on, with a column branch")
    per_pose = readings.n_readings / max(len(readings.poses), 1)
    if per_pose < LARGE:
        wishes.append("put several loads on at every pose")
    wishes.append("push in other directions at the poses that fit worst")
    return f"To learn what the rest is: {'; '.join(wishes[:3])}."
