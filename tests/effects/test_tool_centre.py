"""A bracket has its elastic centre on the way to its end: beam theory, names, and who offers it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.effects import effect, load_case
from sk120stiff.effects.tool_compliance import ToolCompliance
from sk120stiff.errors import InputError
from sk120stiff.model import Model, model_from_text, model_text
from tests.effects.arms import arm, readings
from tests.effects.test_contract import assert_same_columns, differences

LENGTH, EI = 0.45, 3.0e4  # m, N·m²
POINT = np.array([0.0, 0.0, LENGTH])


def cantilever() -> Model:
    """Turns and shifts about the middle: EI / L and 12 EI / L³."""
    robot = load_robot("motoman_sk120")
    law = replace(effect(robot, "tool_compliance"), about=(0.0, 0.0, LENGTH / 2))
    values = np.array(
        [LENGTH / EI, LENGTH / EI, 0, LENGTH**3 / (12 * EI), LENGTH**3 / (12 * EI), 0]
    )
    return (Model(robot) + law).with_values(values)


def test_the_end_of_a_beam_moves_as_beam_theory_says() -> None:
    """F L³ / 3 EI under a force, M L² / 2 EI under a moment, each as force along x of the tool."""
    model = cantilever()
    robot, q = model.robot, model.robot.rest
    R = robot.placement(q)[:3, :3]
    force, moment = 100.0, 30.0
    wrenches = np.zeros((2, 6))
    wrenches[0, :3], wrenches[1, 3:] = R @ [force, 0, 0], R @ [0, moment, 0]
    cases = load_case(robot, [q, q], wrenches, point=POINT, force_point=POINT)
    moved = model.predict(cases) @ R
    assert moved[0] == pytest.approx([force * LENGTH**3 / (3 * EI), 0, 0], rel=2e-3, abs=2e-6)
    assert moved[1] == pytest.approx([moment * LENGTH**2 / (2 * EI), 0, 0], rel=2e-3, abs=2e-6)


def test_its_derivatives_and_names() -> None:
    model = cantilever()
    cases = readings(model.robot, 6, seed=4)
    exact = model.predict_with_sensitivities(cases)[1]
    assert_same_columns(model, exact, differences(model, cases))
    names = [spec.name for spec in model.effects[0].parameters]
    assert names[0] == "stiffness_turn_x_about_0_0_225"
    again = model_from_text(model_text(model))
    assert again.effects == model.effects
    below = replace(model.effects[0], about=(-0.1, 0.02, 0.3))
    assert below.parameters[5].name == "stiffness_shift_z_about_minus_100_20_300"
    with pytest.raises(InputError, match="about one point"):
        model_from_text(model_text(model).replace("turn_x_about_0_0_225", "turn_x"))


def test_positions_choose_among_centres_on_the_way_to_the_load() -> None:
    robot = arm("six_axis")
    usual = effect(robot, "tool_compliance")
    cases = load_case(robot, robot.rest[None], np.ones((1, 6)), point=POINT, force_point=POINT)
    laws = usual.laws_at_positions(cases)
    assert [law.about[2] for law in laws] == pytest.approx([0.1125, 0.225, 0.3375], abs=6e-4)
    assert usual in laws[1].laws_at_positions(cases) and laws[1] not in laws[1].laws_at_positions(
        cases
    )
    at_flange = load_case(robot, robot.rest[None], np.ones((1, 6)))
    assert usual.laws_at_positions(at_flange) == ()
    assert all(isinstance(law, ToolCompliance) for law in laws)
