"""Parameters recovered from data that other code has made.

The generator of the hidden benchmark shares nothing with the product: finite rotations of elastic
hinges, the five-bar as a real loop, beams in many pieces, its own equilibrium. Free of noise, the
product must find what went in.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest

from sk120stiff.effects import CATALOGUE, LoadCases, effect, load_case
from sk120stiff.effects.link_beam import TAPER
from sk120stiff.model import Model, Parameter, joint_spring_model
from sk120stiff.robot import Robot, load_robot
from tests.hidden.generator import causes_elastic, causes_joint, causes_sensor
from tests.hidden.generator.arm import Arm
from tests.hidden.generator.design import plan
from tests.hidden.generator.mechanism import GRAVITY
from tests.hidden.generator.robots import FOLDER, six_axis, telescope
from tests.hidden.generator.rows import Rows
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import Cause, World

C2 = 1.0 / 4.0e5  # compliance of the SK120's joint 2 in the generator's base model


ARMS: dict[str, tuple[Arm, str | None]] = {
    "sk120": (sk120(), None),
    "six_axis": (six_axis(), "six_axis.urdf"),
    "telescope": (telescope(), "telescope.urdf"),
}


@dataclass(frozen=True)
class Case:
    """One cause, and what the product should find: public values by parameter name."""

    arm: str
    cause: Cause
    expected: Mapping[str, float]
    where: str | None = None  # where the product has another name for the place
    rtol: float = 1e-5
    rows: Mapping[str, object] | None = None


def equal(names: tuple[str, ...], value: float) -> dict[str, float]:
    return dict.fromkeys(names, value)


def cases() -> list[Case]:
    e, j, s = causes_elastic, causes_joint, causes_sensor
    out = [
        Case("sk120", e.WristSpring("joint_5_b", {"compliance": 4e-6}), {"stiffness": 2.5e5}),
        Case("six_axis", e.BaseSliding("base_link", {"x": 1e-7, "y": 2e-7, "z": 3e-7}),
             {"stiffness_x": 1e7, "stiffness_y": 5e6, "stiffness_z": 1e7 / 3}),
        Case("sk120", e.BaseSliding("base_link", {"x": 1e-8, "y": 2e-8, "z": 3e-8}),
             {"stiffness_x": 1e8, "stiffness_y": 5e7, "stiffness_z": 1e8 / 3}),
        Case("telescope", e.BaseRocking("floor", {"x": 1e-7, "y": 3e-7}),
             {"stiffness_x": 1e7, "stiffness_y": 1e7 / 3}),
        Case("sk120", e.ClosureCoupling("joint_2_l,joint_3_u", {"compliance": -1e-7}),
             {"cross_stiffness": -1e7}, "joint_2_l,joint_3_u"),
        # the rod's lever changes a little as the linkage moves under load: a second-order matter
        Case("sk120", e.ClosureRod("linkage", {"compliance": 1e-8}), {"stiffness": 1e8}, "rod",
             rtol=1e-2),
        Case("sk120", j.GravityCompensator("joint_2_l", {"share": 1e-3}),
             {"compliance_drop": 1e-3 * C2}, rtol=3e-3),
        Case("sk120", j.LostMotion("joint_2_l", {"half_width": 1e-4}), {"half_width": 1e-4},
             rows={"schedule": "scattered"}),
        Case("telescope", j.LostMotion("yaw", {"half_width": 1e-4}), {"half_width": 1e-4},
             rows={"schedule": "up_down"}),
        Case("sk120", j.FrictionHysteresis("joint_3_u", {"half_width": 5e-5}),
             {"half_width": 5e-5}, rows={"schedule": "up_down"}),
        Case("sk120", j.GearHardening("joint_2_l", {"cubic": 0.6}, {"T": 800.0}),
             {"quadratic": 0.0, "cubic": 0.2 * C2 / 800.0**2}),
        Case("sk120", s.ForceBias("sensor", {"x": 5.0, "y": -3.0, "z": 2.0}),
             {"offset_x": -5.0, "offset_y": 3.0, "offset_z": -2.0}),
        # the generator turns by finite rotations, the product to first order
        Case("sk120", s.ForceRotation("sensor", {"x": 1e-3, "y": -2e-3, "z": 5e-4}),
             {"angle_x": 1e-3, "angle_y": -2e-3, "angle_z": 5e-4}, rtol=3e-3),
        Case("telescope", s.ForceRotation("sensor", {"x": 1e-3, "y": -2e-3, "z": 5e-4}),
             {"angle_x": 1e-3, "angle_y": -2e-3, "angle_z": 5e-4}, rtol=3e-3,
             rows={"moments": True}),
        Case("sk120", s.ForceCrosstalk("sensor", {"xy": 0.01, "zx": -0.02}),
             {"x_on_y": 0.0, "y_on_x": -0.01, "x_on_z": 0.02, "z_on_x": 0.0, "y_on_z": 0.0,
              "z_on_y": 0.0}),
        Case("sk120", s.ReadingRotation("tracker", {"x": 1e-3, "y": -2e-3, "z": 5e-4}),
             {"angle_x": 1e-3, "angle_y": -2e-3, "angle_z": 5e-4}, rtol=3e-3),
        Case("telescope", s.ReadingDrift("tracker", {"x": 1e-6, "y": -2e-6, "z": 5e-7}),
             {"rate_x": 1e-6, "rate_y": -2e-6, "rate_z": 5e-7}),
        Case("sk120", s.ToolOffset("tool0", {"x": 2e-3, "y": -1e-3, "z": 3e-3}),
             {"offset_x": 2e-3, "offset_y": -1e-3, "offset_z": 3e-3}),
        Case("telescope", s.ToolOffset("plate", {"x": 2e-3, "y": -1e-3, "z": 3e-3}),
             {"offset_x": 2e-3, "offset_y": -1e-3, "offset_z": 3e-3}, rows={"moments": True}),
        Case("telescope", s.JointOffset("extend", {"offset": 2e-3}), {"offset": 2e-3}),
        Case("telescope", e.ToolCompliance("plate", {
            "rx": 5e-6, "ry": 4e-6, "rz": 6e-6, "tx": 3e-8, "ty": 2e-8, "tz": 1e-8}),
            {"stiffness_turn_x": 2e5, "stiffness_turn_y": 2.5e5, "stiffness_turn_z": 1e6 / 6,
             "stiffness_shift_x": 1e8 / 3, "stiffness_shift_y": 5e7, "stiffness_shift_z": 1e8}),
    ]  # fmt: skip
    alike = ("stiffness_along", "stiffness_across")
    for arm, joint, size in (
        ("sk120", "joint_2_l", 1e-7), ("sk120", "joint_3_u", 1e-7), ("six_axis", "elbow", 5e-6),
        ("telescope", "pitch", 2e-7), ("telescope", "extend", 2e-7),
    ):  # fmt: skip
        cause = e.JointTilt(joint, {"first": size, "second": size})
        out.append(Case(arm, cause, equal(alike, 1.0 / size), rtol=1e-4))
    for arm, link, size in (
        ("sk120", "link_1_s", 2e-7), ("sk120", "link_2_l", 2e-7), ("sk120", "link_3_u", 2e-7),
        ("six_axis", "upper_arm", 6e-6),
    ):  # fmt: skip
        beam = e.LinkBending(link, {"flexibility": size}, {"taper": TAPER, "pieces": 60})
        out.append(Case(arm, beam, {"EI": 1.0 / size}, rtol=1e-3))  # pieces, not a continuum
        if link == "link_3_u":
            continue  # the generator twists the oblique line to the wrist; see test_laws
        # An arm's own weight twists the generator's shaft along its length, ours at its root.
        shaft = e.LinkTorsion(link, {"flexibility": size}, {"taper": 0.2})
        out.append(Case(arm, shaft, {"GJ": 1.0 / size}, rtol=3e-4 if arm == "six_axis" else 1e-5))
    for arm, name in (("sk120", "joint_2_l"), ("six_axis", "lift")):
        out.append(Case(arm, s.JointOffset(name, {"offset": 2e-3}), {"offset": 2e-3}))
    for arm, link in (("sk120", "link_2_l"), ("six_axis", "forearm")):
        out.append(Case(arm, s.LinkLength(link, {"length": 2e-3}), {"offset": 2e-3}))
    return out


CASES = cases()


def load(case_arm: str) -> tuple[Arm, Robot]:
    arm, file = ARMS[case_arm]
    if file is None:
        return arm, load_robot("motoman_sk120")
    robot = load_robot(FOLDER / file, base=arm.base_frame, tool=arm.tool_frame)
    assert robot.total_mass > 0.0  # both arms sag under their own weight
    return arm, replace(robot, gravity=GRAVITY)


def as_load_cases(robot: Robot, rows: Rows) -> LoadCases:
    a = np.stack([rows.coordinates[name] for name in robot.actuated], axis=1)
    plain = load_case(
        robot, a, np.hstack([rows.force, rows.moment]), point=rows.point,
        force_point=rows.force_point,
    )  # fmt: skip
    labels, index = np.unique(rows.pose, return_inverse=True)
    return replace(
        plain,
        order=rows.order - rows.zero_order,
        branch=rows.branch,
        pose=index,
        poses=tuple(str(label) for label in labels),
    )


def fitted(model: Model, load_cases: LoadCases, measured: np.ndarray) -> tuple[Model, float]:
    """Gauss–Newton on all parameters, and the rms of what is left [m]."""
    scale = np.array([parameter.spec.typical for parameter in model.parameters])
    for _ in range(12):
        predicted, derivative = model.predict_with_sensitivities(load_cases)
        columns = (derivative * scale).reshape(-1, len(scale))
        step = np.linalg.lstsq(columns, (measured - predicted).ravel(), rcond=1e-12)[0]
        model = model.with_values(model.values + scale * step)
    left = measured - model.predict(load_cases)
    return model, float(np.sqrt(np.mean(left**2)))


def start(arm: Arm, robot: Robot) -> Model:
    """Springs of the generator's base model, five per cent off; what it holds rigid is left out."""
    stiffness = [1.05 * arm.typical.joint.get(name, np.inf) for name in robot.actuated]
    return joint_spring_model(robot, stiffness)


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c.arm}-{c.cause.name}:{c.cause.where}")
def test_recovered_from_independent_data(case):
    arm, robot = load(case.arm)
    rng = np.random.default_rng(11)
    rows = plan(
        arm, rng, poses=24, loads=4, point=np.array([0.06, -0.1, 0.15]), **(case.rows or {})
    )
    springs = {name: 1.0 / value for name, value in arm.typical.joint.items()}
    measured = World(arm, springs, (case.cause,)).displacement(rows)
    without = World(arm, springs).displacement(rows)
    assert np.abs(measured - without).max() > 1e-6  # the cause shows
    found = effect(robot, case.cause.name, case.where or case.cause.where)
    model = start(arm, robot) + [
        Parameter(found, spec, 0.3 * spec.typical) for spec in found.parameters
    ]
    load_cases = as_load_cases(robot, rows)
    model, left = fitted(model, load_cases, measured)
    assert left < max(1e-9, 2.0 * case.rtol * np.abs(measured - without).max())
    for parameter in model.parameters[-len(found.parameters) :]:
        expected = parameter.spec.internal(case.expected[parameter.spec.name])
        size = max(abs(parameter.spec.internal(v)) for k, v in case.expected.items()
                   if alike(k, parameter.spec.name))  # fmt: skip
        error = abs(parameter.internal - expected)
        assert error < case.rtol * size + 1e-12, (parameter.name, parameter.value)
    for name, compliance in springs.items():
        found_spring = model.parameter(f"joint_springs:{name}.stiffness").internal
        assert np.isclose(found_spring, compliance, rtol=max(case.rtol, 1e-5))


def alike(a: str, b: str) -> bool:
    """Parameters of the same unit: their names differ in the last letter only, or in all."""
    return a[:-1] == b[:-1] or "_to_" in a


def test_zero_offsets_are_recovered():
    arm, robot = load("sk120")
    rows = plan(arm, np.random.default_rng(12), poses=8, loads=4, schedule="scattered")
    cause = causes_sensor.ZeroOffset("tracker", {"rms": 2e-5}, {"seed": 5})
    springs = {name: 1.0 / value for name, value in arm.typical.joint.items()}
    measured = World(arm, springs, (cause,)).displacement(rows)
    load_cases = as_load_cases(robot, rows)
    model = start(arm, robot) + effect(robot, "zero_offset", poses=load_cases.poses)
    model, left = fitted(model, load_cases, measured)
    assert left < 1e-9
    for k, pose in enumerate(np.unique(rows.pose)):
        own = 2e-5 * np.random.default_rng((5, int(pose))).normal(size=3)
        first = len(springs) + 3 * k
        assert np.allclose(model.values[first : first + 3], own, atol=1e-9)


def test_scale_of_the_reading_is_recovered_when_a_spring_is_known():
    """A scale alone cannot be told from softer springs, so here the springs are held."""
    arm, robot = load("six_axis")
    rows = plan(arm, np.random.default_rng(13), poses=8, loads=4)
    springs = {name: 1.0 / value for name, value in arm.typical.joint.items()}
    cause = causes_sensor.ReadingScale("tracker", {"share": 2e-3})
    measured = World(arm, springs, (cause,)).displacement(rows)
    known = joint_spring_model(robot, [arm.typical.joint[name] for name in robot.actuated])
    model = known + effect(robot, "reading_scale")
    predicted, derivative = model.predict_with_sensitivities(as_load_cases(robot, rows))
    column = derivative[..., -1].ravel()
    assert np.isclose(column @ (measured - predicted).ravel() / (column @ column), 2e-3, rtol=1e-8)


def test_gains_of_the_force_axes_are_recovered_but_for_their_common_part():
    """All gains together are one factor on all compliances; their ratios are not.

    Where the arm weighs, its sag would tell softer springs from a gain, if barely.
    """
    arm, robot = load("six_axis")
    arm, robot = replace(arm, bodies=()), replace(robot, gravity=np.zeros(3))
    point = np.array([0.06, -0.1, 0.15])
    rows = plan(arm, np.random.default_rng(14), poses=24, loads=4, point=point)
    springs = {name: 1.0 / value for name, value in arm.typical.joint.items()}
    cause = causes_sensor.ForceScale("sensor", {"x": 0.02, "y": -0.01, "z": 0.005})
    measured = World(arm, springs, (cause,)).displacement(rows)
    model = start(arm, robot) + effect(robot, "force_scale")
    model, left = fitted(model, as_load_cases(robot, rows), measured)
    assert left < 1e-9
    gains = 1.0 - model.values[-3:]  # true over reported
    truth = np.array([1.02, 0.99, 1.005])
    assert np.allclose(gains / gains[0], truth / truth[0], rtol=1e-6)
    factor = gains[0] / truth[0]
    for name, compliance in springs.items():
        found = model.parameter(f"joint_springs:{name}.stiffness").internal
        assert np.isclose(found * factor, compliance, rtol=1e-6)


def test_every_effect_of_the_catalogue_is_recovered_somewhere():
    here = {case.cause.name for case in CASES} | {"zero_offset", "reading_scale", "force_scale"}
    here.add("force_point")  # in test_words.py
    assert here == {kind.name for kind in CATALOGUE if not kind.only_absolute}
