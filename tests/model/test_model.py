"""Models as values: composed without clashes, changed by copies, predicting in blocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import all_effects, effect, load_case
from sk120stiff.errors import InputError, Refusal
from sk120stiff.model import Model, Parameter, joint_spring_model
from sk120stiff.model.model import BLOCK
from sk120stiff.robot import load_robot
from tests.stiffness.arms import deflection

SPRINGS = np.array([1.4098e6, 4.0076e5, 9.3528e5, np.inf, np.inf, np.inf])
POSE = np.radians([10.0, 20.0, -30.0, 40.0, 50.0, 60.0])
WRENCH = np.array([300.0, -400.0, 500.0, 80.0, -60.0, 40.0])


@pytest.fixture(scope="module")
def robot():
    return load_robot("motoman_sk120")


@pytest.fixture(scope="module")
def model(robot):
    return joint_spring_model(robot, SPRINGS)


def test_the_base_model_has_no_spring_where_nothing_yields(model):
    assert model.names == tuple(
        f"joint_springs:{joint}.stiffness" for joint in ("joint_1_s", "joint_2_l", "joint_3_u")
    )
    assert np.allclose(model.joint_stiffness(), SPRINGS, rtol=4e-16)
    assert np.allclose(model.values * SPRINGS[:3], 1.0)


def test_springs_alone_deflect_as_the_stiffness_layer_says(robot, model):
    point = [0.1, 0.05, -0.2]
    ours = model.deflect(POSE, WRENCH, point=point)[0]
    theirs = deflection(robot.mechanism(), POSE, WRENCH, SPRINGS, np.array(point)).equilibrium
    assert np.linalg.norm(theirs) > 1e-4 and np.allclose(ours, theirs, rtol=0, atol=1e-15)


def test_adding_makes_a_new_model_and_refuses_clashes(robot, model):
    rocking = effect(robot, "base_rocking")
    larger = model + rocking
    assert len(model.parameters) == 3 and larger.names[3:] == (
        "base_rocking:base_link.stiffness_x",
        "base_rocking:base_link.stiffness_y",
    )
    assert [parameter.internal for parameter in larger.parameters[3:]] == [0.0, 0.0]
    assert larger.parameters[3].value == np.inf
    with pytest.raises(InputError, match="'base_rocking:base_link' is already in the model"):
        larger + rocking
    with pytest.raises(InputError, match="already in the model"):
        model + effect(robot, "joint_springs", "joint_1_s")
    with pytest.raises(InputError, match="already in the model"):
        larger + [Parameter(rocking, rocking.parameters[0], 1e-7)]
    elsewhere = model + effect(robot, "joint_springs", "joint_5_b")
    assert elsewhere.effects[-1].where == "joint_5_b"
    back = larger.without("base_rocking:base_link")
    assert back.names == model.names
    with pytest.raises(InputError, match="is not in the model"):
        model.without("base_rocking:base_link")


def test_values_are_changed_by_name_in_public_units(robot, model):
    changed = (model + effect(robot, "base_rocking")).with_public(
        **{"base_rocking:base_link.stiffness_y": 2e7, "joint_springs:joint_2_l.stiffness": np.inf}
    )
    assert changed.parameter("base_rocking:base_link.stiffness_y").internal == 5e-8
    assert changed.parameter("joint_springs:joint_2_l.stiffness").internal == 0.0
    with pytest.raises(InputError, match="no parameter 'joint_2'"):
        changed.parameter("joint_2")
    with pytest.raises(ValueError, match="2 values for"):
        changed.with_values(np.zeros(2))


def test_origin_is_noted_where_a_value_was_free(model):
    from dataclasses import replace

    held = replace(model.parameters[0], free=False, origin="data sheet")
    mixed = replace(model, parameters=(held, *model.parameters[1:]))
    fitted = mixed.with_values(mixed.values, [None, 1e-8, 1e-8], origin="fitted")
    assert [p.origin for p in fitted.parameters] == ["data sheet", "fitted", "fitted"]
    assert list(fitted.free) == [1, 2]
    error = fitted.parameters[1].std
    assert np.isclose(error, 1e-8 * SPRINGS[1] ** 2)


def test_blocks_are_seamless(robot, model):
    count = BLOCK + 7
    rng = np.random.default_rng(0)
    poses = rng.uniform(-1, 1, (count, 6))
    wrench = 300 * rng.normal(size=(count, 6)) * [1, 1, 1, 0.1, 0.1, 0.1]
    load_cases = load_case(robot, poses, wrench)
    predicted, slope = model.predict_with_sensitivities(load_cases)
    assert predicted.shape == (count, 3) and slope.shape == (count, 3, 3)
    tail, tail_slope = model.predict_with_sensitivities(load_cases.rows(slice(BLOCK - 3, None)))
    assert np.allclose(predicted[BLOCK - 3 :], tail, rtol=0, atol=1e-15)
    assert np.allclose(slope[BLOCK - 3 :], tail_slope, rtol=1e-9)
    assert model.predict(load_cases.rows(slice(0, 0))).shape == (0, 3)


@pytest.mark.parametrize("per_marker", [False, True])
def test_loads_of_one_pose_begin_from_one_arm_at_rest(per_marker):
    """The arm before the load is worked out once a pose; each reading alone says the same."""
    robot = load_robot("ur5e")  # it has masses, so it sags
    model = joint_spring_model(robot, np.full(robot.n, 3e4)) + effect(robot, "base_rocking")
    rng = np.random.default_rng(5)
    poses = np.repeat(rng.uniform(-1, 1, (4, robot.n)), 3, axis=0)
    wrench = 100 * rng.normal(size=(12, 6)) * [1, 1, 1, 0.1, 0.1, 0.1]
    points = np.tile(rng.normal(size=(3, 3)) * 0.1, (4, 1))  # three markers, each at every pose
    every = load_case(robot, poses, wrench)
    every = replace(every, point=points if per_marker else points[0])
    begin = model.solve(every).begin
    assert len(np.unique(np.arange(12)[begin])) == (12 if per_marker else 4)
    predicted, slope = model.predict_with_sensitivities(every)
    for k in range(12):
        alone, own = model.predict_with_sensitivities(every.rows(slice(k, k + 1)))
        assert np.allclose(alone[0], predicted[k], rtol=0, atol=1e-14)
        assert np.allclose(own[0], slope[k], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["motoman_sk120", "ur5e"])
def test_what_is_rigid_changes_nothing(name):
    """Absent effects beside springs predict what the springs do, with its slopes."""
    robot = load_robot(name)
    few = joint_spring_model(robot, np.full(robot.n, 3e4))
    many = few
    for absent in all_effects(robot):
        if absent.id not in {each.id for each in few.effects}:
            many = many + absent
    assert many.assembly.mechanism.n > 2 * few.assembly.mechanism.n
    rng = np.random.default_rng(3)
    wrench = 100 * rng.normal(size=(20, 6)) * [1, 1, 1, 0.1, 0.1, 0.1]
    load_cases = load_case(robot, rng.uniform(-1, 1, (20, robot.n)), wrench)
    alone, slope = few.predict_with_sensitivities(load_cases)
    beside, slopes = many.predict_with_sensitivities(load_cases)
    assert np.abs(alone).max() > 1e-4 and np.allclose(beside, alone, rtol=0, atol=1e-14)
    assert np.allclose(slopes[:, :, : slope.shape[2]], slope, rtol=1e-9, atol=1e-12)


def test_instruments_have_no_say_in_what_really_moves(robot, model):
    whole = model + effect(robot, "reading_scale") + effect(robot, "force_bias")
    whole = whole.with_public(
        **{"reading_scale:tracker.scale": 0.5, "force_bias:sensor.offset_x": 100.0}
    )
    assert np.allclose(whole.deflect(POSE, WRENCH), model.deflect(POSE, WRENCH), rtol=0, atol=1e-16)
    read = whole.predict(load_case(robot, POSE, WRENCH))
    assert np.abs(read - model.deflect(POSE, WRENCH)).max() > 1e-4


def test_a_robot_without_effects_does_not_move(robot):
    assert not Model(robot).deflect(POSE, WRENCH).any()
    exact = Model(robot).predict_with_sensitivities(load_case(robot, POSE, WRENCH))[1]
    assert exact.shape == (1, 3, 0)


def test_a_load_beyond_the_springs_is_refused_also_within_a_batch(robot):
    """No row comes back with a number that is no equilibrium."""
    soft = joint_spring_model(robot, np.full(6, 500.0))
    rng = np.random.default_rng(1)
    poses, wrench = rng.uniform(-1, 1, (20, 6)), 3000.0 * rng.normal(size=(20, 6))
    assert np.isfinite(soft.deflect(poses, 1e-3 * wrench)).all()
    bad = []
    for k in range(20):
        try:
            soft.deflect(poses[k], wrench[k])
        except Refusal:
            bad.append(k)
    assert bad
    one = 1e-3 * wrench
    one[bad[0]] = wrench[bad[0]]
    with pytest.raises(Refusal, match="beyond what these springs can hold"):
        soft.deflect(poses, one)


def test_effects_of_the_catalogue_have_one_name_and_place_each(robot):
    names = [found.id for found in all_effects(robot)]
    assert len(set(names)) == len(names) > 50


@pytest.mark.parametrize(
    ("name", "where", "message"),
    [
        ("base_rockin", None, "no effect 'base_rockin' .did you mean 'base_rocking'"),
        ("joint_tilt", "joint_9", "cannot act at 'joint_9'"),
        (
            "joint_tilt",
            None,
            "at which place is the effect 'joint_tilt' meant.*joint_tilt:joint_1_s",
        ),
        ("gravity_compensator", "joint_1_s", "cannot act at 'joint_1_s'"),
    ],
)
def test_unknown_effects_and_places_are_refused(robot, name, where, message):
    with pytest.raises(InputError, match=message) as caught:
        effect(robot, name, where)
    assert caught.value.remedy
