"""Every number says what it means: law, axes, sign, unit; and its sign is the one it says."""

import re
from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import CATALOGUE, all_effects, catalogue_words, effect, words_of
from sk120stiff.effects.options import Options
from sk120stiff.identify import fit
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import joint_spring_model
from sk120stiff.plan import random_poses
from sk120stiff.robot import load_robot
from tests.effects.arms import readings

STIFF = [1.4e6, 4e5, 9e5, 1e6, 3e5, 2e5]


def test_every_parameter_of_every_effect_has_a_meaning() -> None:
    robot = load_robot("motoman_sk120")
    effects = [*all_effects(robot, poses=("A",)), *(kind.sample() for kind in CATALOGUE)]
    effects.append(effect(robot, "gear_hardening", "joint_2_l", breaks=(150.0, 300.0)))
    for each in effects:
        words = words_of(each)
        assert words["equation"] and words["axes"] and words["where"]
        meanings = [item["meaning"] for item in words["parameters"]]
        assert all(meanings), each.id
        assert len(set(meanings)) == len(meanings), f"{each.id}: two values that mean the same"


@pytest.mark.parametrize("kind", CATALOGUE, ids=lambda kind: kind.name)
def test_the_names_of_every_other_law_are_told(kind) -> None:
    found = readings(robot := load_robot("motoman_sk120"), 6, seed=2)
    found = replace(found, time_at_zero=np.arange(6.0))
    usual = kind.at(
        robot, [*kind.places(robot), robot.base_frame][0], Options(timed=True, masses=(40.0, 80.0))
    )
    laws = usual.other_laws(found)
    own = " ".join(spec.name for spec in usual.parameters)
    others = " ".join(spec.name for law in laws for spec in law.parameters)
    told = set(re.findall("[a-z]+", kind.also.lower()))
    assert set(re.findall("[a-z]+", others.lower())) - set(re.findall("[a-z]+", own)) <= told
    assert bool(laws) == bool(kind.also)


def test_the_words_list_the_catalogue() -> None:
    told = catalogue_words()
    assert [words["name"] for words in told] == [kind.name for kind in CATALOGUE]
    for words in told:
        assert words["sentence"][0].isupper() and "a link a" not in words["sentence"].lower()


@pytest.mark.parametrize(
    ("name", "reported", "expected"),
    [
        ("force_bias", lambda f: f + [-29.0, 0.0, 12.0], {"offset_x": -29.0, "offset_z": 12.0}),
        # 4 % too much: (reported - true) / reported
        ("force_scale", lambda f: f * [1.04, 1.0, 1.0], {"scale_x": 0.04 / 1.04, "scale_y": 0.0}),
        # the sensor shows 3 % of the force along x on z as well
        ("force_crosstalk", lambda f: f + 0.03 * f[:, [0]] * [0, 0, 1], {"x_on_z": 0.03}),
        # mounted turned by 0.02 about z of the tool: it reads true components in turned axes
        ("force_rotation", lambda f: f - 0.02 * np.cross([0, 0, 1.0], f), {"angle_z": 0.02}),
    ],
)
def test_what_a_sensor_adds_comes_out_with_the_sign_that_is_told(name, reported, expected) -> None:
    """The readings are made by hand: true loads bend the arm, a wrong sensor reports them."""
    robot, joints, force = _loaded()
    turn = robot.screws(joints).rotation
    seen = np.einsum("nji,nj->ni", turn, force)  # tool axes
    told = np.einsum("nij,nj->ni", turn, np.asarray(reported(seen)))
    _recovered(robot, joints, told, np.zeros((30, 3)), force, name, expected)


@pytest.mark.parametrize(
    ("name", "reported", "expected"),
    [
        # nobody weighed the hook: 20 N more pull down than were told
        ("force_bias", lambda f: f + [0.0, 0.0, 20.0], {"offset_base_z": 20.0}),
        ("force_scale", lambda f: f * [1.04, 1.0, 1.0], {"scale_base_x": 0.04 / 1.04}),
        ("force_rotation", lambda f: f - 0.02 * np.cross([0, 0, 1.0], f), {"angle_base_z": 0.02}),
    ],
)
def test_what_a_rig_of_weights_and_cables_gets_wrong_lies_in_axes_of_the_base(
    name, reported, expected
) -> None:
    robot, joints, force = _loaded()
    told = np.asarray(reported(force))
    _recovered(robot, joints, told, np.zeros((30, 3)), force, name, expected)


def test_where_the_load_acts_comes_out() -> None:
    """It acts 30 mm beside and 20 mm before the stated point: its moment bends the arm too."""
    robot, joints, force = _loaded()
    beside = robot.screws(joints).rotation @ np.array([0.03, 0.0, 0.02])
    expected = {"offset_x": 0.03, "offset_y": 0.0, "offset_z": 0.02}
    _recovered(robot, joints, force, np.cross(beside, force), force, "force_point", expected)


def _loaded():
    robot = load_robot("motoman_sk120")
    rng = np.random.default_rng(5)
    return robot, random_poses(robot, 30, rng), rng.normal(size=(30, 3)) * 250.0


def _recovered(robot, joints, told, moment, force, name, expected) -> None:
    """Fit the effect to an arm that `force` and `moment` bend, while `told` is reported."""
    springs = joint_spring_model(robot, STIFF)
    point = np.array([-0.06, 0.04, 0.15])
    readings = Measurements(
        pose=tuple(f"p{k}" for k in range(30)),
        joint_names=robot.actuated,
        joints=joints,
        wrench=np.hstack([told, np.zeros((30, 3))]),
        displacement=springs.deflect(joints, np.hstack([force, moment]), point=point),
        robot=robot.source,
        point=point,
    )
    fixed = replace(springs, parameters=tuple(replace(p, free=False) for p in springs.parameters))
    law = CATALOGUE.effect(robot, name, None, Options(shape=tuple(expected)))
    found = fit(fixed + law, readings, noise=NoiseModel(1e-6))
    for key, value in expected.items():
        got = found.model.parameter(f"{name}:sensor.{key}").value
        assert got == pytest.approx(value, rel=5e-3, abs=1e-3)
