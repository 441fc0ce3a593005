"""What explain refuses before it computes, and what it may call the same thing."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import InputError, Model, Refusal, ToolkitWarning, base_model, load_robot
from sk120stiff.effects import CATALOGUE, effect, load_cases_of
from sk120stiff.explain.advise import consequences
from sk120stiff.explain.candidates.aliases import exact_aliases
from sk120stiff.explain.judge import steps
from sk120stiff.explain.judge.steps import gap_steps
from sk120stiff.explain.localise.suspects import suspects_of
from sk120stiff.explain.options import Options, candidates_for, with_assumed
from sk120stiff.explain.select import stepwise
from sk120stiff.explain.select.stepwise import Selection, refit, select
from sk120stiff.plan import random_pool
from tests.explain.readings import NOISE, POINT, answered, base_fit, hidden
from tests.hidden.generator.causes_elastic import BaseRocking, ToolCompliance


@pytest.fixture(scope="module")
def springs() -> Model:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return model


def test_outliers_are_told_by_their_row_in_the_file_whatever_is_masked(springs):
    """Row 0 is masked, row 2 is a copy of row 1; row 40 stays row 40."""
    clean = hidden()
    order = [0, 1, 1, *range(2, clean.n_readings)]
    readings = clean.select(np.array(order))
    moved = np.array(readings.displacement)
    moved[40] += [0.0, 400e-6, 0.0]
    use = np.array(readings.use)
    use[0] = False
    with pytest.warns(ToolkitWarning, match="repeats an earlier one"):
        answer = answered(springs, replace(readings, displacement=moved, use=use))
    assert answer.set_aside == (40,)


def test_a_plan_is_refused_as_bad_input(springs):
    with pytest.raises(InputError, match="no measured displacements"):
        answered(springs, replace(hidden(), displacement=None))


def test_one_pose_is_refused_before_the_search(springs):
    readings = hidden()
    with pytest.raises(InputError, match="one pose alone"):
        answered(springs, readings.select(readings.rows_of("1")))


def test_a_gain_of_the_force_sensor_is_no_other_name_for_rocking(springs):
    """All gains together scale the whole displacement, that of the rocking base among it."""
    robot = springs.robot
    rocking = effect(robot, "base_rocking", "base_link")
    model = (springs + rocking).with_public(
        **{"base_rocking:base_link.stiffness_x": 6e6, "base_rocking:base_link.stiffness_y": 7e6}
    )
    rivals = [effect(robot, "force_scale", "sensor"), effect(robot, "reading_scale", "tracker")]
    assert exact_aliases(model, rocking, rivals, point=POINT) == ()


def test_the_twist_of_the_forearm_is_another_name_for_the_spring_of_joint_4(springs):
    robot = springs.robot
    wrist = effect(robot, "joint_springs", "joint_4_r")
    model = (springs + wrist).with_public(**{"joint_springs:joint_4_r.stiffness": 3e5})
    rivals = [effect(robot, "link_torsion", "link_3_u"), effect(robot, "force_scale", "sensor")]
    assert exact_aliases(model, wrist, rivals, point=POINT) == ("link_torsion:link_3_u",)


def test_another_name_is_asked_for_under_a_load_that_the_model_holds(springs):
    robot, names = springs.robot, ("joint_springs:joint_2_l.stiffness",)
    wrist = effect(robot, "joint_springs", "joint_4_r")
    rivals = [effect(robot, "link_torsion", "link_3_u")]
    pool = random_pool(robot, poses=150, directions=3, force=300.0, point=POINT, seed=1)
    for stiffness, told in ((1.0, ("link_torsion:link_3_u",)), (1e-3, ())):
        soft = (springs + wrist).with_public(**dict.fromkeys(names, stiffness))
        soft = soft.with_public(**{"joint_springs:joint_4_r.stiffness": 3e5})
        with pytest.raises(Refusal):
            soft.predict(pool.load_cases)
        assert exact_aliases(soft, wrist, rivals, point=POINT) == told


def test_two_effects_that_undo_each_other_are_no_model(springs):
    """While loads only grow, friction is lost motion with the other sign."""
    base = base_fit(hidden())
    play, rubs = (
        effect(springs.robot, name, "joint_6_t") for name in ("lost_motion", "friction_hysteresis")
    )
    assert max(abs(p.internal) for p in refit(base, [play]).parameters) < 1e-3
    with pytest.raises(Refusal, match="undone by another effect"):
        refit(base, [play, rubs])


def test_drift_taken_for_granted_goes_by_the_clock_where_there_is_one(springs):
    readings = hidden()
    timed = replace(readings, time=60.0 * np.asarray(readings.order))
    units = {
        p.spec.unit
        for p in with_assumed(springs, timed, ["reading_drift"]).parameters
        if p.effect.name == "reading_drift"
    }
    assert units == {"m/s"}


def searched(model, readings, *candidates) -> Selection:
    """A selection that was offered these effects and took none."""
    return select(model, readings, NOISE, candidates, max_effects=0, alpha=0.01)


def test_the_first_step_is_called_by_all_effects_of_the_base_model(springs):
    readings = hidden(poses=5)
    assert [step.label for step in gap_steps(searched(springs, readings), (), None, seed=0)] == [
        "joint_springs"
    ]
    more = springs + effect(springs.robot, "base_rocking", "base_link")
    (step,) = gap_steps(searched(more, readings), (), None, seed=0)
    assert step.label == "joint_springs + base_rocking"
    assert 0.0 < step.fit_rms < step.heldout_rms


def test_a_step_that_has_no_answer_is_told_together_with_the_next(springs, monkeypatch):
    """Halfway, where an effect is still missing, a fit may not converge."""
    readings = hidden(poses=6)
    more = [effect(springs.robot, name, where) for name, where in
            (("base_rocking", "base_link"), ("joint_tilt", "joint_2_l"))]  # fmt: skip

    def stubborn(base, effects, near=None):
        if len(effects) == 1:
            raise Refusal("the least-squares fit did not converge")
        return refit(base, effects, near)

    monkeypatch.setattr(steps, "refit", stubborn)
    told = gap_steps(searched(springs, readings, *more), more, None, seed=0)
    assert [step.label for step in told] == [
        "joint_springs", "+ base_rocking:base_link + joint_tilt:joint_2_l",
    ]  # fmt: skip


def test_rounding_of_the_first_order_is_no_size(springs, monkeypatch):
    """A tracker that is turned shows nothing while nothing yields: its angle starts at zero."""
    readings = hidden(poses=8, loads=3)
    base = select(springs, readings, NOISE, [], max_effects=0, alpha=0.01).base
    turned = effect(springs.robot, "reading_rotation")
    plain = refit(base, [turned])
    solver = stepwise.lsq_linear

    def rounded(*given, **more):
        found = solver(*given, **more)
        found.x = found.x + 1e-17
        return found

    monkeypatch.setattr(stepwise, "lsq_linear", rounded)
    again = refit(base, [turned])
    assert np.isfinite(again.model.values).all()
    assert again.chi_square == pytest.approx(plain.chi_square, rel=1e-6)


def test_loads_that_the_found_curve_does_not_hold_are_taken_smaller(springs, monkeypatch):
    """What to measure next is asked again at a part of the load; the answer is not lost."""
    rocking = BaseRocking("base_link", {"x": 1 / 4e6, "y": 1 / 4e6})
    answer = answered(springs, hidden(rocking, poses=10, loads=2))
    (finding,) = answer.findings
    open_question = replace(finding, alternatives=("joint_tilt:joint_1_s",), exact=())
    asked = []
    choose = consequences.signature_columns

    def choosy(model, effect, rival, pool):
        asked.append(np.abs(pool.load_cases.wrench).max())
        if len(asked) < 3:
            raise Refusal("the arm gives way")
        return choose(model, effect, rival, pool)

    monkeypatch.setattr(consequences, "signature_columns", choosy)
    found = consequences.next_poses(replace(answer, findings=(open_question,)), seed=0)
    assert np.array(asked) == pytest.approx(asked[0] * np.array([1.0, 0.5, 0.25]))
    assert np.abs(found.wrench).max() <= asked[2]
    asked.clear()
    monkeypatch.setattr(consequences, "SHARES_OF_LOAD", (1.0, 0.5))
    with pytest.raises(Refusal, match=r"tells base_rocking:base_link from joint_tilt:joint_1_s"):
        consequences.next_poses(replace(answer, findings=(open_question,)), seed=0)


def test_what_bends_behind_the_last_joint_is_looked_for_as_the_tool(springs):
    """A beam there has one number where the fixture has six: it would win by being simpler."""
    readings = hidden()

    def looked_for(**more: object) -> set[str]:
        return {each.id for each in candidates_for(springs, readings, Options(**more))}

    beam, tool = "link_bending:link_6_t", "tool_compliance:tool0"
    usual = looked_for()
    assert tool in usual
    assert beam not in usual
    assert "link_bending:link_3_u" in usual
    assert beam in looked_for(exclude=(tool,))
    assert beam in looked_for(only=("link_bending",))
    load_cases = load_cases_of(springs.robot, readings)
    every = suspects_of(springs, load_cases, springs.predict(load_cases))
    behind = [each for each in every if "link_6_t" in each.name]
    assert behind
    assert all(tool in each.frees for each in behind)  # none speaks against it


def test_a_beam_that_ends_before_the_last_joint_is_its_own_name_wherever_the_tool_is():
    """With the tool frame in the last joint there is no beam behind it, and none before is lost."""
    robot = load_robot("motoman_sk120", tool="link_6_t")
    beams = CATALOGUE["link_bending"].places(robot)
    assert "link_6_t" not in beams
    assert [effect(robot, "link_bending", link).special_case_of(robot) for link in beams] == [
        None
    ] * len(beams)


@pytest.mark.parametrize("where", [1, 2])
def test_a_fixture_that_tilts_is_named_as_such(springs, where):
    """Made by the blind benchmark's generator: equally soft about both axes across the flange."""
    readings = hidden(ToolCompliance("tool0", {"rx": 6e-6, "ry": 6e-6}), seed=where)
    answer = answered(springs, readings)
    assert [(each.effect.id, each.alternatives) for each in answer.findings] == [
        ("tool_compliance:tool0", ())
    ]
