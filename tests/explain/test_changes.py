"""An arm that became another one while it was measured: the pose from which on, and what."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.explain import localise
from sk120stiff.explain.answer.next_step import _of_a_change, next_step
from sk120stiff.explain.localise.changes import changed_at, changes
from sk120stiff.explain.localise.drives import drives
from sk120stiff.measurements import Measurements
from sk120stiff.show.stories.verdicts import lead_of
from tests.explain.readings import answered, base_fit, hidden

LOOSE = "joint_2_l"  # from the pose on at which it is softer
POSES = 14
WHAT = f"the torque of {LOOSE}, under which it yields otherwise from pose 9 on"


def loosened(share: float, first: int) -> Measurements:
    """Springs alone, and from some pose on the second drive is softer by a share."""
    readings = hidden(poses=POSES, loads=3)
    fit = base_fit(readings)
    cases = fit.problem.load_cases
    drive = next(each for each in drives(cases) if LOOSE in each.name)
    joint = cases.robot.actuated.index(LOOSE)
    softer = share / fit.model.joint_stiffness()[joint] * drive.columns[:, :, 0]
    later = np.array([int(pose) >= first for pose in readings.pose])
    assert readings.displacement is not None
    return replace(readings, displacement=readings.displacement + softer * later[:, None])


def test_what_came_loose_is_told_with_the_pose_at_which_it_did() -> None:
    strongest = localise(base_fit(loosened(0.3, 9))).strongest
    assert strongest is not None
    assert (
        strongest.name == f"the torque of {LOOSE}, under which it yields otherwise from pose 9 on"
    )


def test_no_change_is_found_where_there_is_none() -> None:
    found = localise(base_fit(hidden(poses=POSES, loads=3)))
    assert not any(each.seen for each in found.suspects if each.family == "change")


@pytest.mark.parametrize("order", [True, False])
def test_a_change_is_one_of_the_order_in_which_poses_were_read(*, order: bool) -> None:
    """Rows may stand in any order where the file says in which they were read."""
    readings = loosened(0.3, 9)
    mixed = readings.select(np.random.default_rng(3).permutation(readings.n_readings))
    if not order:
        mixed = replace(mixed, order=None, zero_order=None)
    strongest = localise(base_fit(mixed)).strongest
    assert strongest is not None
    assert (changed_at(strongest.name) == "9") == order


def test_both_parts_have_poses_enough_and_no_pose_is_in_both() -> None:
    cases = base_fit(hidden(poses=5, loads=3)).problem.load_cases
    found = [changed_at(each.name) for each in changes(cases, (), [*drives(cases)][:1])]
    assert found == ["3", "4"]
    back = replace(cases, pose=np.where(cases.pose == 4, 0, cases.pose), order=None, time=None)
    assert not [*changes(back, (), [*drives(cases)][:1])], (
        "the first pose was read again at the end"
    )


def test_many_poses_have_as_many_places_for_a_change_as_few() -> None:
    cases = base_fit(hidden(poses=60, loads=1)).problem.load_cases
    found = [*changes(cases, (), [*drives(cases)][:1])]
    assert len(found) == 24 and {each.alike for each in found} == {24}


def test_the_answer_says_to_explain_both_parts_each_by_itself() -> None:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    answer = answered(model, loosened(0.5, 9))
    assert answer.verdict == "outside"
    said = " ".join(answer.remainder.where)
    assert WHAT in said
    assert "before pose 9 was read" in next_step(answer)
    assert "readings of two arms" in next_step(answer)
    assert "Something is missing, and it came before pose 9: the gap goes with" in lead_of(answer)
    bare = replace(answer.final.problem.measurements, order=None, zero_order=None)
    problem = SimpleNamespace(measurements=bare, model=answer.final.problem.model)
    final = SimpleNamespace(problem=problem, model=answer.final.model)
    assert "In the order in which rows stand" in _of_a_change(SimpleNamespace(final=final), "9")
