"""Foundations that rock about a point below, by moments and levers."""

from __future__ import annotations

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import effect, load_case
from sk120stiff.effects.foundation import PEDESTALS, BaseRocking
from sk120stiff.effects.options import Options
from sk120stiff.errors import InputError

WRENCH = np.array([[40.0, -60.0, 30.0, 5.0, -2.0, 3.0]])
POINT = np.array([0.03, -0.05, 0.11])


def test_a_base_rocks_about_the_point_that_names_tell() -> None:
    robot = sk.load_robot("motoman_sk120")
    names = [f"{n}_below_550" for n in ("stiffness_x", "stiffness_y", "cross_stiffness")]
    law = BaseRocking.at(robot, "base_link", Options(shape=tuple(names)))
    assert [spec.name for spec in law.parameters] == names
    c = np.array([3e-7, 1e-7, 0.8e-7])
    a = np.array([0.3, 0.2, 0.1, 0.4, 0.3, 0.2])
    moved = (sk.Model(robot) + law).predict(
        load_case(robot, a, WRENCH, point=POINT, force_point=POINT), c
    )[0]
    T = robot.placement(a, point=POINT)
    lever = T[:3, 3] - np.array([0.0, 0.0, -0.55])
    moment = WRENCH[0, 3:] + np.cross(lever, WRENCH[0, :3])
    turn = np.append(np.array([[c[0], c[2]], [c[2], c[1]]]) @ moment[:2], 0.0)
    np.testing.assert_allclose(moved, np.cross(turn, lever), rtol=2e-4, atol=2e-9)


def test_heights_are_tried_and_refined() -> None:
    robot = sk.load_robot("motoman_sk120")
    cases = load_case(robot, np.zeros(6), WRENCH)
    laws = effect(robot, "base_rocking").other_laws(cases)
    assert {law.below for law in laws if isinstance(law, BaseRocking)} == {0.0, *PEDESTALS}
    near = BaseRocking("base_link", askew=True, below=0.8).nearby_laws(cases)
    assert all(0.5 < law.below < 1.2 and law.askew for law in near)
    assert BaseRocking("base_link").nearby_laws(cases) == ()


def test_one_height_for_all_axes() -> None:
    robot = sk.load_robot("motoman_sk120")
    for names in (("stiffness_x_below_800", "stiffness_y"), ("stiffness_x_below_high",) * 2):
        with pytest.raises(InputError, match="rocks about one point"):
            BaseRocking.at(robot, "base_link", Options(shape=names))
