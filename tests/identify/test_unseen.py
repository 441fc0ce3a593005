"""A spring that no such reading can show, and the reason in words."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff import fit, joint_spring_model, load_robot
from sk120stiff.effects import effect, load_case
from sk120stiff.identify import unseen_reasons, unseen_sentences, weak_directions, why_unseen
from sk120stiff.identify.checks.unseen import NOT_SHOWN
from sk120stiff.measurements import Measurements, NoiseModel
from tests.corpus.robots import example

SPRINGS = np.array([3e4, 3e4, 2e4, 2e4, 1e4, 8e3, 5e3])


def pushed(point: np.ndarray, force_point: np.ndarray | None = None) -> Measurements:
    robot = load_robot(example("panda.urdf"))
    rng = np.random.default_rng(3)
    a = rng.uniform(np.maximum(robot.lower, -1.5), np.minimum(robot.upper, 1.5), (20, robot.n))
    wrench = np.concatenate([rng.normal(0.0, 60.0, (20, 3)), np.zeros((20, 3))], axis=1)
    force_at = point if force_point is None else force_point
    load_cases = load_case(robot, a, wrench, point=point, force_point=force_at)
    exact = joint_spring_model(robot, SPRINGS).predict(load_cases)
    return Measurements(
        pose=tuple(str(k) for k in range(20)), joint_names=robot.actuated,
        joint_kinds=("angle",) * robot.n, joints=a, wrench=wrench,
        displacement=exact + rng.normal(0.0, 1.4e-5, exact.shape), robot=str(robot.source),
        point=point, force_point=force_at, noise=NoiseModel(1e-5),
    )  # fmt: skip


@pytest.mark.filterwarnings("ignore::sk120stiff.errors.ToolkitWarning")
def test_a_point_on_the_last_axis_hides_its_spring() -> None:
    readings = pushed(np.zeros(3))
    found = fit(joint_spring_model(load_robot(example("panda.urdf"))), readings)
    (name,) = unseen_reasons(found)
    assert name == "joint_springs:panda_joint7.stiffness"
    why = unseen_reasons(found)[name]
    assert "the point lies on the axis of panda_joint7; give a point off the axis (--point" in why
    assert any(name in said and why in said for said in weak_directions(found))


@pytest.mark.filterwarnings("ignore::sk120stiff.errors.ToolkitWarning")
def test_loads_through_the_axis_hide_it_too() -> None:
    off = np.array([0.1, 0.0, 0.05])
    found = fit(joint_spring_model(load_robot(example("panda.urdf"))), pushed(off, np.zeros(3)))
    why = unseen_reasons(found)["joint_springs:panda_joint7.stiffness"]
    assert "every load passes through the axis of panda_joint7" in why


@pytest.mark.filterwarnings("ignore::sk120stiff.errors.ToolkitWarning")
def test_a_point_off_the_axis_shows_it() -> None:
    readings = pushed(np.array([0.1, 0.0, 0.05]))
    found = fit(joint_spring_model(load_robot(example("panda.urdf"))), readings)
    assert not unseen_reasons(found)
    load_cases = found.problem.load_cases
    assert all(why_unseen(load_cases, p) is None for p in found.parameters)


def test_many_values_of_one_effect_are_told_in_one_sentence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A gauge along one axis says nothing of the other two of every pose's offset."""
    effects = ["zero_offset:tracker"] * 5 + ["joint_springs:j1"] * 2
    names = [f"{effect}.{k}" for k, effect in enumerate(effects)]
    reasons = dict.fromkeys(names, NOT_SHOWN)
    monkeypatch.setattr("sk120stiff.identify.checks.unseen.unseen_reasons", lambda _: reasons)
    shown = SimpleNamespace(name="shown", effect=SimpleNamespace(id="zero_offset:tracker"))
    hidden = [
        SimpleNamespace(name=name, effect=SimpleNamespace(id=effect))
        for name, effect in zip(names, effects, strict=True)
    ]
    assert unseen_sentences(SimpleNamespace(parameters=[shown, *hidden])) == [
        "5 values of zero_offset:tracker cannot be seen: they do not show in these readings.",
        *(f"{name} cannot be seen: {NOT_SHOWN}." for name in names[5:]),
    ]


def test_hanging_weights_are_parallel_to_a_first_axis_that_stands_upright() -> None:
    """Beside the axis such a load tells nothing either: another remedy than for one through it."""
    robot = load_robot(example("panda.urdf"))
    a = np.random.default_rng(1).uniform(-1.0, 1.0, (6, robot.n))
    cases = load_case(robot, a, [0, 0, -40.0, 0, 0, 0], point=[0.1, 0.0, 0.05])
    model = joint_spring_model(robot, SPRINGS)
    why = [why_unseen(cases, p) for p in model.parameters]
    assert why[0] == (
        "every load is parallel to the axis of panda_joint1; push across it, or add a moment"
    )
    assert not any(why[1:])


def test_loads_square_to_a_slide() -> None:
    rail = load_robot(
        """<robot name="r"><link name="a"/><link name="b"/><joint name="x" type="prismatic">
        <parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
        <limit lower="0" upper="1" effort="0" velocity="0"/></joint></robot>"""
    )
    cases = load_case(rail, np.zeros((2, 1)), [0, 0, -40.0, 0, 0, 0], point=np.zeros(3))
    (parameter,) = joint_spring_model(rail, [1e6]).parameters
    assert why_unseen(cases, parameter) == "every load is square to the slide of x; push along it"


@pytest.mark.filterwarnings("ignore::sk120stiff.errors.ToolkitWarning")
def test_a_spring_that_a_tipping_base_shows_by_less_than_the_noise_is_not_measured() -> None:
    """Vertical loads: a base that tips lets them turn the first joint by a hair. Of that hair a
    spring of 200 N·m/rad was made, and whatever came from the side was foretold with it.
    """
    robot, point = load_robot(example("panda.urdf")), np.array([0.1, 0.0, 0.05])
    readings = pushed(point)
    wrench = readings.wrench * [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    load_cases = load_case(robot, readings.joints, wrench, point=point, force_point=point)
    rocking = effect(robot, "base_rocking", "panda_link0")
    true = joint_spring_model(robot, SPRINGS) + rocking
    true = true.with_values(np.where(np.arange(9) < 7, true.values, 2e-6))
    noise = np.random.default_rng(5).normal(0.0, 1.4e-5, (20, 3))
    down = replace(readings, wrench=wrench, displacement=true.predict(load_cases) + noise)
    found = fit(joint_spring_model(robot) + rocking, down)
    name = "joint_springs:panda_joint1.stiffness"
    assert "every load is parallel to the axis of panda_joint1" in unseen_reasons(found)[name]
    start = joint_spring_model(robot).parameter(name)
    assert found.model.parameter(name).internal == pytest.approx(start.internal)
    told = {p.name: p for p in found.parameters}[f"{rocking.id}.stiffness_y"]
    assert abs(told.internal - 2e-6) < 3.0 * (told.internal_std or 0.0)


def test_a_loose_joint_that_loads_turn_is_measured_however_soft() -> None:
    robot, point = load_robot(example("panda.urdf")), np.array([0.1, 0.0, 0.05])
    readings = pushed(point)
    wrench = 0.02 * readings.wrench
    load_cases = load_case(robot, readings.joints, wrench, point=point, force_point=point)
    loose = joint_spring_model(robot, np.where(np.arange(7) < 6, SPRINGS, 120.0))
    noise = np.random.default_rng(5).normal(0.0, 1.4e-5, (20, 3))
    faint = replace(readings, wrench=wrench, displacement=loose.predict(load_cases) + noise)
    found = fit(joint_spring_model(robot), faint)
    told = found.model.parameter("joint_springs:panda_joint7.stiffness")
    assert told.value == pytest.approx(120.0, rel=0.2)
