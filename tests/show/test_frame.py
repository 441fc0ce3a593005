"""What a picture shows against the stiffness layer and against exact kinematics."""

import numpy as np
import pytest

from sk120stiff.effects import effect, load_case
from sk120stiff.errors import InputError
from sk120stiff.model import (
    LoadedStiffness,
    Model,
    Parameter,
    joint_spring_model,
    loaded_stiffness,
)
from sk120stiff.robot import load_robot
from sk120stiff.show import Elastic, Scene, scene_html
from sk120stiff.show.scene.frame import Frame, Request, compute_frame
from sk120stiff.show.scene.links import link_tree
from sk120stiff.show.scene.payload import frame_payload
from tests.oracles.sample_urdfs import six_axis_arm
from tests.show.scenes import sk120, springs

WRENCH = np.array([300.0, -800.0, 500.0, 40.0, -20.0, 60.0])
A = np.array([0.3, 0.2, -0.7, 0.4, 0.5, -0.2])


def with_effect(name: str, where: str, stiffness: float) -> Model:
    added = effect(sk120(), name, where)
    parameters = [
        Parameter(added, spec, spec.internal(stiffness) if spec.reciprocal else 1e-4)
        for spec in added.parameters
    ]
    return springs() + parameters


def frame_of(model: Model, wrench: np.ndarray = WRENCH, exaggeration: float = 1.0):
    request = Request(A, wrench, np.zeros(3), exaggeration)
    return compute_frame(link_tree(sk120()), Elastic.of_model(model), request)


def test_a_heavy_arm_is_shown_where_it_sags_to() -> None:
    """As `stiffness` has it, at the pose of the request and at no other."""
    model = joint_spring_model(load_robot(six_axis_arm()), np.full(6, 5e4))
    a = np.array([0.3, 0.9, -0.7, 0.4, 0.5, -0.2])
    request = Request(a, WRENCH, np.zeros(3))
    frame = compute_frame(link_tree(model.robot), Elastic.of_model(model), request)
    agrees(frame, loaded_stiffness(model, a, WRENCH))
    rest = model.solve(load_case(model.robot, a, np.zeros(6))).rest.screws.position[0]
    tool = link_tree(model.robot).names.index("tool")
    np.testing.assert_allclose(frame.links[tool, :3, 3], rest, atol=1e-12)
    assert np.linalg.norm(rest - model.robot.screws(a).position) > 1e-3


@pytest.mark.parametrize(
    "model",
    [
        springs,
        lambda: with_effect("base_rocking", "base_link", 2e7),
        lambda: with_effect("closure_rod", effect_places("closure_rod")[0], 1e8),
    ],
    ids=["springs", "rocking", "rod"],
)
def test_agrees_with_the_stiffness_command(model) -> None:
    agrees(frame_of(model()), loaded_stiffness(model(), A, WRENCH))


def agrees(frame: Frame, found: LoadedStiffness) -> None:
    shown = frame_payload(frame)
    for name, compliance in (
        ("conventional", found.compliance_conventional),
        ("enhanced", found.compliance_enhanced),
    ):
        for group, part in (
            ("translation", compliance[:3, :3]),
            ("rotationAxes", compliance[3:, 3:]),
        ):
            axes = shown[group][name]
            D = np.array(axes["directions"])
            symmetric = 0.5 * (part + part.T)
            again = (D.T * axes["values"]) @ D
            np.testing.assert_allclose(again, symmetric, atol=1e-9 * np.abs(part).max())
    for name in ("conventional", "enhanced", "equilibrium"):
        expected = getattr(found, f"deflection_{name}")
        np.testing.assert_allclose(shown["deflection"][name], expected, rtol=1e-8)
    assert shown["classes"]["K_C"] == found.definiteness_of_K_C
    assert shown["classes"]["stiffness"] == found.definiteness_of_K_theta_minus_K_C
    assert 1.0 / shown["softening"] == pytest.approx(found.critical_factor, rel=1e-9)


def test_beyond_the_critical_load_it_says_so_and_draws_no_deflection() -> None:
    factor = 1.0 / frame_payload(frame_of(springs()))["softening"]
    beyond = frame_payload(frame_of(springs(), 1.5 * factor * WRENCH))
    assert beyond["classes"]["stiffness"] == "indefinite"
    # a negative stiffness is never hidden behind an absolute
    assert min(beyond["translation"]["enhanced"]["values"]) < 0.0
    assert beyond["softening"] > 1.0
    assert "enhanced" not in beyond["deflection"]  # a step to a balance that does not hold


def test_springs_that_are_indefinite_are_drawn_and_said() -> None:
    """Cross compliance beyond √(c₂ c₃): the arm would run away before any load."""
    model = with_effect("closure_coupling", "joint_2_l,joint_3_u", 2e5)
    shown, found = frame_payload(frame_of(model)), loaded_stiffness(model, A, WRENCH)
    stiffness = shown["classes"]["stiffness"]
    assert stiffness == found.definiteness_of_K_theta_minus_K_C == "indefinite"
    assert (shown["softening"], shown["stiffening"]) == (None, None)
    assert found.critical_factor == 0.0
    assert "enhanced" not in shown["deflection"] and np.isnan(found.deflection_enhanced).all()
    page = scene_html(Scene(sk120(), Elastic.of_model(model), wrench=WRENCH))
    assert "indefinite here" in page and "NaN" not in page.split('id="scene">')[1][:200_000]


def test_springs_on_the_edge_are_drawn_too() -> None:
    """Cross compliance of √(c₂ c₃): one combination of the two motors is rigid."""
    c = [p.internal for p in springs().parameters if p.effect.where in ("joint_2_l", "joint_3_u")]
    model = with_effect(
        "closure_coupling", "joint_2_l,joint_3_u", float(1.0 / np.sqrt(c[0] * c[1]))
    )
    shown, found = frame_payload(frame_of(model)), loaded_stiffness(model, A, WRENCH)
    np.testing.assert_allclose(shown["deflection"]["enhanced"], found.deflection_enhanced, 1e-6)
    assert scene_html(Scene(sk120(), Elastic.of_model(model), wrench=WRENCH))


def test_no_load_no_share() -> None:
    frame = frame_of(springs(), np.zeros(6))
    shown = frame_payload(frame)
    assert shown["classes"]["K_C"] == "zero"
    assert shown["softening"] == shown["stiffening"] == 0.0
    assert np.array_equal(frame.links, frame.deflected)


def test_exaggeration_scales_what_is_drawn_and_nothing_else() -> None:
    one, many = frame_of(springs(), exaggeration=1.0), frame_of(springs(), exaggeration=10.0)
    tool = link_tree(sk120()).names.index("tool0")
    moved = one.deflected[tool, :3, 3] - one.links[tool, :3, 3]
    exaggerated = many.deflected[tool, :3, 3] - many.links[tool, :3, 3]
    rest, again = (frame.found.of("deflection_equilibrium") for frame in (one, many))
    np.testing.assert_allclose(moved, rest, atol=1e-12)
    np.testing.assert_allclose(exaggerated, 10.0 * moved, atol=3e-4)
    np.testing.assert_array_equal(rest, again)


@pytest.mark.parametrize(
    ("name", "where"),
    [("base_rocking", "base_link"), ("joint_tilt", "joint_2_l"), ("link_bending", "link_2_l")],
)
def test_links_ride_on_the_compliance_before_them(name: str, where: str) -> None:
    model = with_effect(name, where, 1e7)
    robot, elastic = sk120(), Elastic.of_model(model)
    tree, mechanism = link_tree(robot), elastic.mechanism
    z = 0.01 * np.random.default_rng(5).normal(size=mechanism.n)
    z[: robot.n] = A
    moved = tree.riding(mechanism.chain).place(elastic.joint_values(z))
    tool = moved[tree.names.index("tool0")]
    screws = mechanism.screws(z)
    np.testing.assert_allclose(tool[:3, 3], screws.position, atol=1e-12)
    np.testing.assert_allclose(tool[:3, :3], screws.rotation, atol=1e-12)
    np.testing.assert_allclose(moved[tree.names.index("base_link")], np.eye(4), atol=1e-15)


def effect_places(name: str) -> tuple[str, ...]:
    from sk120stiff.effects import CATALOGUE

    return next(kind for kind in CATALOGUE if kind.name == name).places(sk120())


def test_a_model_in_which_nothing_yields_is_refused() -> None:
    robot = sk120()
    with pytest.raises(InputError, match="nothing in this model yields"):
        Elastic.of_model(Model(robot))
