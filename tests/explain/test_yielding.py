"""Suspects are the catalogue's elastic effects, set free: columns against exact sensitivities."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from sk120stiff import CATALOGUE, Model, base_model, load_robot
from sk120stiff.effects import LoadCases, effect, load_cases_of
from sk120stiff.effects.joint_springs import JointSprings
from sk120stiff.effects.joint_tilt import JointTilt
from sk120stiff.explain.localise.suspects import suspects_of
from sk120stiff.explain.localise.yielding import yielding
from tests.explain.readings import hidden


@pytest.fixture(scope="module")
def cases() -> LoadCases:
    return load_cases_of(load_robot("motoman_sk120"), hidden())


@pytest.mark.parametrize(
    ("name", "where", "said"),
    [
        ("base_rocking", "base_link", ["the moment that tips the base"]),
        ("base_sliding", "base_link", ["the force that pushes the base"]),
        ("joint_tilt", "joint_2_l", ["the moment that joint_2_l carries across its axis"]),
        ("link_bending", "link_2_l", ["the moment that bends link_2_l"]),
        ("link_torsion", "link_3_u", ["the moment that twists link_3_u"]),
        ("tool_compliance", "tool0",
         ["the moment that the tool carries", "the force that the tool carries"]),
    ],
)  # fmt: skip
def test_a_suspect_does_what_its_effect_does(
    cases: LoadCases, name: str, where: str, said: list[str]
) -> None:
    """Whatever the sizes of the parameters, the effect's change is a sum of the columns."""
    own = [each for each in yielding(cases, CATALOGUE) if each.name in said]
    assert [each.name for each in own] == said
    model = Model(cases.robot) + effect(cases.robot, name, where)
    _, columns = model.predict_with_sensitivities(cases)  # at zero: first order, exact
    free = np.concatenate([each.columns for each in own], axis=2).reshape(3 * cases.count, -1)
    for column in columns.reshape(3 * cases.count, -1).T:
        left = column - free @ np.linalg.lstsq(free, column, rcond=None)[0]
        assert np.linalg.norm(left) < 1e-9 * np.linalg.norm(column)
    assert all(f"{name}:{where}" in each.frees for each in own)


def test_every_elastic_effect_that_says_so_is_a_suspect_at_all_its_places(cases) -> None:
    named = {name for each in yielding(cases, CATALOGUE) for name in each.frees}
    for kind in CATALOGUE:
        if getattr(kind, "yields_under", ""):
            assert {f"{kind.name}:{where}" for where in kind.places(cases.robot)} <= named


def test_an_effect_from_outside_is_a_suspect_too(cases: LoadCases) -> None:
    @dataclass(frozen=True)
    class Clamp(JointTilt):
        name: ClassVar[str] = "clamp"
        yields_under: ClassVar[str] = "the clamp of {where} holds"

    names = [each.name for each in yielding(cases, CATALOGUE + Clamp)]
    assert "the moment that the clamp of joint_2_l holds" in names
    usual = [each.name for each in yielding(cases, CATALOGUE)]
    assert "the moment that the clamp of joint_2_l holds" not in usual


@pytest.mark.parametrize("which", ["hung weights", "a plane", "no load at all"])
def test_columns_do_not_go_by_what_was_pulled(cases: LoadCases, which: str) -> None:
    """Weights that hang pull along z alone, so nothing tips the base about z; columns stay."""
    wrench = np.zeros_like(cases.wrench)
    wrench[:, 2] = -400.0 if which != "no load at all" else 0.0
    wrench[:, 0] = 100.0 if which == "a plane" else 0.0
    a = np.where(np.isin(np.arange(cases.robot.n), (0, 3, 5)), 0.0, cases.a)
    hung = replace(cases, wrench=wrench, a=a if which == "a plane" else cases.a)
    usual = {each.name: each for each in yielding(cases, CATALOGUE)}
    model = base_model(cases.robot)
    assert model is not None
    every = suspects_of(model, hung, np.zeros((cases.count, 3)))
    for each in yielding(hung, CATALOGUE):
        assert each.columns.shape == usual[each.name].columns.shape
        assert each.carried.shape == usual[each.name].carried.shape
    assert all(np.isfinite(each.columns).all() for each in every)


def test_an_effect_of_a_motor_is_a_suspect_too(cases: LoadCases) -> None:
    @dataclass(frozen=True)
    class Motor(JointSprings):
        name: ClassVar[str] = "motor"
        yields_under: ClassVar[str] = "drives {where}"

    names = [each.name for each in yielding(cases, CATALOGUE + Motor)]
    assert "the moment that drives joint_2_l" in names
