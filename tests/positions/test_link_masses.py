"""An arm that weighs otherwise than its URDF states, by positions of another hand."""

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import load_case, load_cases_of
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.model import joint_spring_model, loaded_stiffness
from sk120stiff.model.sensitivities import pose_sensitivities, reading_sensitivities
from tests.positions.arm import MASSES, errors, poses, tracked, write
from tests.positions.test_forms import _with

SIGMA = 1e-5
SAID = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n" + (
    "payload: {point: {xyz: [0, 0, 0], unit: m}}\nnoise: {sigma: 10, unit: um}\n"
)


def explained(tmp_path: Path, mass: np.ndarray, stated: float, hung: float = 1.0) -> Explained:
    """Of two readings at each pose; every mass in the file is `stated` times what it is.

    The payload is `hung` times what the file says.
    """
    a = np.repeat(poses(60, 4), 2, axis=0)
    arm = _with(payload=(hung * mass, np.zeros(3)))
    arm.compliance = np.array([0.0, 1 / 8e5, 1 / 5e5, 0.0, 0.0, 0.0])
    x = tracked(arm.stands(a)[0]) + SIGMA * np.random.default_rng(1).normal(size=(120, 3))
    path = write(tmp_path, a, x, SAID, more=",payload[kg]", cells=[f"{m:g}" for m in mass])
    file = tmp_path / "six.urdf"
    text = file.read_text()
    for each in MASSES:
        text = text.replace(f'value="{each}"', f'value="{stated * each}"')
    file.write_text(text)
    robot = sk.load_robot(file, base="base", tool="tool")
    return sk.explain(sk.Model(robot), sk.read(path))


@pytest.mark.parametrize(
    ("stated", "payloads"), [(1.0, [0.0, 40.0]), (1.3, [0.0, 40.0]), (1.3, [40.0, 40.0])]
)
def test_masses_are_named_where_they_are_wrong(
    tmp_path: Path, stated: float, payloads: list[float]
) -> None:
    """One payload tells them too: it pulls at the joints in other proportions than the links."""
    found = explained(tmp_path, np.tile(payloads, 60), stated)
    names = {each.effect.id for each in found.findings if each.effect.name != "joint_frame"}
    springs = {"joint_springs:j2", "joint_springs:j3"}
    assert names == springs | ({"link_masses:base"} if stated != 1.0 else set())
    model = found.final.model
    for joint, true in (("j2", 8e5), ("j3", 5e5)):
        spring = model.parameter(f"joint_springs:{joint}.stiffness")
        # or else the payload is off by as much, and with it every spring
        off = stated - 1.0
        assert spring.value == pytest.approx(true, abs=min(3.5 * spring.std, 0.01 * true))
        assert off - 0.02 < spring.std / true < off + 0.02
    if stated != 1.0:
        heavier = model.parameter("link_masses:base.scale")
        assert heavier.value == pytest.approx(1.0 / stated - 1.0, abs=3.5 * heavier.std)
        assert heavier.std < (0.01 if len(set(payloads)) > 1 else 0.03)


def test_a_payload_that_is_off_looks_the_same_and_is_said_to(tmp_path: Path) -> None:
    """The ratio of both weights is told, and the springs are by the payload as it was stated."""
    found = explained(tmp_path, np.tile([0.0, 40.0], 60), 1.0, hung=1.25)
    (named,) = [each for each in found.findings if each.effect.name == "link_masses"]
    assert "or the payload's is" in named.effect.sentence()
    model = found.final.model
    heavier = model.parameter("link_masses:base.scale")
    assert heavier.value == pytest.approx(1.0 / 1.25 - 1.0, abs=3.5 * heavier.std)
    spring = model.parameter("joint_springs:j2.stiffness")
    assert spring.value == pytest.approx(8e5 / 1.25, rel=0.01)
    assert spring.value == pytest.approx(8e5, abs=2.0 * spring.std)  # by the payload as it is


def test_without_a_payload_nothing_is_told_of_them(tmp_path: Path) -> None:
    """Then all springs may be softer instead, and nobody is told that masses are wrong."""
    found = explained(tmp_path, np.zeros(120), 1.3)
    assert all(each.effect.name != "link_masses" for each in found.findings)
    assert "link_masses" not in {effect.name for effect in found.linear.candidates}


def test_stiffness_under_its_weight_goes_with_it(tmp_path: Path) -> None:
    """An arm that is stated heavier by a half is one whose file states as much."""
    write(tmp_path, poses(2, 1), np.zeros((2, 3)), SAID)
    file = tmp_path / "six.urdf"
    light = sk.load_robot(file, base="base", tool="tool")
    text = file.read_text()
    for each in MASSES:
        text = text.replace(f'value="{each}"', f'value="{1.5 * each}"')
    file.write_text(text)
    heavy = sk.load_robot(file, base="base", tool="tool")
    K = [9e4, 8e4, 5e4, 1e4, 8e3, 5e3]
    more = joint_spring_model(light, K) + sk.effect(light, "link_masses", "base")
    more = more.with_public(**{"link_masses:base.scale": 0.5})
    a, wrench = poses(1, 3)[0], np.array([100.0, 50.0, -200.0, 5.0, -3.0, 1.0])
    one, two = (loaded_stiffness(each, a, wrench) for each in (more, joint_spring_model(heavy, K)))
    plain = loaded_stiffness(joint_spring_model(light, K), a, wrench)
    np.testing.assert_allclose(one.K_gravity, two.K_gravity, rtol=1e-12, atol=1e-9)
    moved = [
        each.predict(load_case(each.robot, a, wrench))
        for each in (more, joint_spring_model(heavy, K))
    ]
    np.testing.assert_allclose(*moved, rtol=1e-9)
    ratio = np.linalg.norm(one.K_gravity) / np.linalg.norm(plain.K_gravity)
    assert ratio == pytest.approx(1.5, rel=1e-3)  # not quite: it has sagged a little farther


@pytest.mark.parametrize("scale", [0.3, -1.0])
def test_its_derivative_is_exact_beside_a_gear_that_hardens(tmp_path: Path, scale: float) -> None:
    """And where nothing weighs any more; positions and displacements, by central differences."""
    a = poses(6, 3)
    path = write(tmp_path, a, np.zeros((6, 3)), SAID, more=",payload[kg]", cells=["40"] * 6)
    robot = sk.load_robot(tmp_path / "six.urdf", base="base", tool="tool")
    model = joint_spring_model(robot, [9e5, 8e5, 5e5, 1e5, 8e4, 5e4])
    model = (
        model + sk.effect(robot, "gear_hardening", "j2") + sk.effect(robot, "link_masses", "base")
    )
    values = np.array([*model.values[:6], 3e-10, 1e-13, scale])
    cases = load_cases_of(robot, sk.read(path))

    def stands(values: np.ndarray) -> np.ndarray:
        return model.assembly.stand(cases, values).rest.screws.position

    def moves(values: np.ndarray) -> np.ndarray:
        return model.assembly.solve(cases, values).displacement

    stood, moved = model.assembly.stand(cases, values), model.assembly.solve(cases, values)
    step = np.array([*np.zeros(8), 0.02])  # both are nearly straight; positions round at 1e-16 m
    for predicted, exact in (
        (stands, pose_sensitivities(model.assembly, stood, values)[:, :3, -1]),
        (moves, reading_sensitivities(model.assembly, moved, values)[..., -1]),
    ):
        near, far = (predicted(values + s * step) - predicted(values - s * step) for s in (1, 2))
        slope = (8.0 * near - far) / (12.0 * 0.02)
        np.testing.assert_allclose(exact, slope, rtol=0.0, atol=1e-7 * np.abs(slope).max())


def test_an_arm_without_masses_has_none_to_be_wrong() -> None:
    assert sk.CATALOGUE["link_masses"].places(sk.load_robot("motoman_sk120")) == ()
    assert errors(1).weighs
