"""Each law against arithmetic that fits on the back of an envelope.

A boom of 2 m turns about z at the origin; a second joint at its end turns about y and carries
another metre. All small numbers: first-order formulas hold to a part in ten thousand.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import CATALOGUE, effect, load_case
from sk120stiff.effects.gear import GearHardening
from sk120stiff.effects.link_beam import STATIONS, TAPER, shares
from sk120stiff.effects.options import Options
from sk120stiff.errors import InputError
from sk120stiff.model import Model, Parameter, joint_spring_model
from sk120stiff.robot import load_robot

BOOM = """<robot name="boom">
<link name="floor"/><link name="boom"><inertial><origin xyz="1 0 0"/><mass value="{mass}"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="arm"/><link name="tool"/>
<joint name="yaw" type="revolute"><parent link="floor"/><child link="boom"/><origin xyz="0 0 0"/>
<axis xyz="{axis}"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="nod" type="revolute"><parent link="boom"/><child link="arm"/><origin xyz="2 0 0"/>
<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="flange" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="1 0 0"/>
</joint></robot>"""
NOTHING = np.zeros(2)


def boom(axis="0 0 1", mass=0.0):
    return load_robot(BOOM.format(axis=axis, mass=mass), base="floor", tool="tool")


def moved(robot, name, where, load, pose=NOTHING, point=None, breaks=(), **values):
    """Displacement [m] by one effect with some public parameter values, the rest absent."""
    found = effect(robot, name, where, poses=("1",), breaks=breaks)
    model = Model(robot) + found
    model = model.with_public(**{f"{found.id}.{key}": value for key, value in values.items()})
    wrench = np.zeros(6)
    wrench[: len(load)] = load
    load_cases = load_case(robot, pose, wrench, point=point)
    load_cases = replace(load_cases, order=np.array([7.0]), time=np.array([60.0]))
    return model.predict(load_cases)[0]


def close(got, expected, rtol=1e-3):
    """Agreement in length: what is of second order in the angles is allowed for."""
    error = np.abs(np.asarray(got) - expected).max()
    assert error <= rtol * np.abs(expected).max() + 2e-9, got


def test_joint_spring_turns_by_torque_over_stiffness():
    # 100 N at 3 m is 300 N·m; over 1e6 N·m/rad is 0.3 mrad; times 3 m is 0.9 mm
    close(moved(boom(), "joint_springs", "yaw", [0, 100, 0], stiffness=1e6), [0, 0.9e-3, 0])


def test_joint_tilt_along_and_across_the_link():
    # 100 N up at 3 m about y: 300 N·m over 1e6 times 3 m
    up = [0, 0, 100]
    close(moved(boom(), "joint_tilt", "yaw", up, stiffness_across=1e6), [0, 0, 0.9e-3])
    close(moved(boom(), "joint_tilt", "yaw", up, stiffness_along=1e6), [0, 0, 0])
    # half a metre beside the boom: 50 N·m about it, lifts by 0.5 · 50/1e6
    beside = moved(boom(), "joint_tilt", "yaw", up, point=[0, 0.5, 0], stiffness_along=1e6)
    close(beside, [0, 0, 25e-6])


def test_beam_bends_as_the_tables_say():
    # a uniform cantilever of L = 2 with a force beyond its end: w' and w at L from
    # F L²/2EI + M L/EI and F L³/3EI + M L²/2EI, and the tool 1 m further
    EI, F, L, M = 1e6, 100.0, 2.0, 100.0
    slope, sag = F * L**2 / 2 / EI + M * L / EI, F * L**3 / 3 / EI + M * L**2 / 2 / EI
    uniform = sag + slope
    got = moved(boom(), "link_bending", "boom", [0, 0, F], EI=EI)[2]
    # the flexibility of the slimmer far end counts more, that of the near end less
    s, share = STATIONS, shares(TAPER)
    arm = 3.0 - 2.0 * s
    close(got, F / EI * L * (share * arm**2).sum())
    assert 0.8 * uniform < got < uniform
    share = shares(0.0)
    arm = 3.0 - 2.0 * s
    close(F / EI * L * (share * arm**2).sum(), uniform)


@pytest.mark.parametrize("taper", [-0.5, 0.0, 0.3, 0.6, 0.7])
def test_stations_integrate_squares_over_the_taper(taper):
    s, share = STATIONS, shares(taper)
    fine = (np.arange(200_000) + 0.5) / 200_000
    rho = (1.0 - taper * fine) ** -3
    rho /= rho.mean()
    for power in range(3):
        assert np.isclose((share * s**power).sum(), (rho * fine**power).mean(), rtol=1e-8)
    assert (s > 0).all() and (s < 1).all() and (share > 0).all()


def test_a_shaft_twists_by_torque_times_length_over_GJ():
    got = moved(boom(), "link_torsion", "boom", [0, 0, 100], point=[0, 0.5, 0], GJ=1e6)
    close(got, [0, 0, 0.5 * 50 * 2 / 1e6])


def test_the_base_rocks_and_slides():
    close(moved(boom(), "base_rocking", None, [0, 0, 100], stiffness_y=1e6), [0, 0, 0.9e-3])
    close(moved(boom(), "base_rocking", None, [0, 0, 100], stiffness_x=1e6), [0, 0, 0])
    turned = moved(boom(), "base_rocking", None, [0, 0, 100], [np.pi / 2, 0], stiffness_x=1e6)
    close(turned, [0, 0, 0.9e-3])
    close(moved(boom(), "base_sliding", None, [5, 0, 100], stiffness_z=1e7), [0, 0, 1e-5])


def test_the_tool_turns_and_shifts_in_its_own_axes():
    lever = [0, 0, 0.2]
    got = moved(boom(), "tool_compliance", None, [100, 0, 0], point=lever, stiffness_turn_y=1e5)
    close(got, [0.2 * 20 / 1e5, 0, 0])
    # the tool turned by a quarter about z: its y is the base's −x
    quarter = [np.pi / 2, 0]
    got = moved(boom(), "tool_compliance", None, [100, 0, 0], quarter, stiffness_shift_y=1e7)
    close(got, [1e-5, 0, 0])
    got = moved(boom(), "tool_compliance", None, [100, 0, 0], quarter, stiffness_shift_x=1e7)
    close(got, [0, 0, 0])


def sk120_moved(name, where, load, pose, **values):
    return moved(load_robot("motoman_sk120"), name, where, load, np.radians(pose), **values)


def test_torque_on_one_motor_moves_the_other():
    # upright arm: 100 N down at 1.53 m; j2 = (1.1 + 0.25, ·, −1.53), j3 = (−0.25, ·, 1.53)
    pose = [0, 0, 0, 0, 0, 0]
    j2, j3 = np.array([1.35, 0, -1.53]), np.array([-0.25, 0, 1.53])
    j2[0] -= 0.25  # the forearm keeps its direction: joint 2 only carries the elbow
    j2[2] = 0.0
    force = np.array([100.0, 0, -200.0])
    got = sk120_moved("closure_coupling", None, force, pose, cross_stiffness=1e8)
    close(got, 1e-8 * (j2 * (j3 @ force) + j3 * (j2 @ force)))
    negative = sk120_moved("closure_coupling", None, force, pose, cross_stiffness=-1e8)
    close(negative, -got)


def test_the_rod_stretches_more_as_the_linkage_folds():
    # crank 0.542 m, crank and rod square at zero; j3 = (−0.25, 0, 1.53)
    j3, force = np.array([-0.25, 0, 1.53]), np.array([0, 0, -100.0])
    close(
        sk120_moved("closure_rod", None, force, [0] * 6, stiffness=1e8),
        j3 * (j3 @ force) / (1e8 * 0.542**2),
    )
    # upper arm leaning by 60°: crank level, rod at 60° from vertical, sin γ = cos 60°
    close(
        sk120_moved("closure_rod", None, force, [0, 60, 0, 0, 0, 0], stiffness=1e8),
        4.0 * j3 * (j3 @ force) / (1e8 * 0.542**2),
    )


def test_gear_hardening_as_a_series():
    # τ = 300 N·m: e = −κ₂ τ² − κ₃ τ³, at 3 m
    side = [0, 100, 0]
    close(moved(boom(), "gear_hardening", "yaw", side, quadratic=1e-9), [0, -3 * 9e-5, 0])
    close(moved(boom(), "gear_hardening", "yaw", side, cubic=1e-12), [0, -3 * 27e-6, 0])
    back = moved(boom(), "gear_hardening", "yaw", [0, -100, 0], quadratic=1e-9)
    close(back, [0, 3 * 9e-5, 0])


def test_gear_hardening_in_steps_of_a_data_sheet():
    # softer by 1e-6 rad/(N·m) below 120 N·m: 120e-6 rad at 300 N·m, 30e-6 rad at 30 N·m
    def steps(force, **values):
        return moved(
            boom(), "gear_hardening", "yaw", [0, force, 0], breaks=(120.0, 240.0), **values
        )[1]

    close(steps(100, extra_below_120=1e-6), 3 * 120e-6)
    close(steps(10, extra_below_120=1e-6), 3 * 30e-6)
    close(steps(-100, extra_below_120=1e-6, extra_below_240=1e-7), -3 * (120e-6 + 24e-6))


def test_gear_that_is_softer_one_way():
    # 1e-6 rad/(N·m) more below zero: 300 N·m the other way turn it by 300e-6 rad, at 3 m
    told = GearHardening.options_of({"extra_negative": "rad/(N*m)"})
    gear = GearHardening.at(boom(), "yaw", told)
    model = (Model(boom()) + gear).with_public(**{f"{gear.id}.extra_negative": 1e-6})
    for side, expected in ((100, 0.0), (-100, -3 * 300e-6)):
        wrench = np.array([0.0, side, 0.0, 0.0, 0.0, 0.0])
        close(model.predict(load_case(model.robot, NOTHING, wrench))[0], [0, expected, 0])
    assert "one sign" in gear.sentence()


def breaks_of(*names):
    return GearHardening.options_of(dict.fromkeys(names, "rad/(N*m)")).breaks


def test_break_torques_are_read_from_names():
    assert breaks_of("extra_below_120", "extra_below_0.5") == (120.0, 0.5)
    assert breaks_of("quadratic", "cubic") == ()
    for name in ("extra_below_", "extra_below_x", "extra_below_-3", "extra_below_1e1",
                 "extra_below_nan"):  # fmt: skip
        with pytest.raises(InputError, match="break torque"):
            breaks_of(name)


def test_hardening_starts_from_the_weight():
    # boom about y: 50 kg at 1 m presses with +490.3 N·m; 100 N up at 3 m takes 300 away
    weight = 50 * 9.80665
    got = moved(boom("0 1 0", 50.0), "gear_hardening", "yaw", [0, 0, 100], quadratic=1e-9)[2]
    close(got, -3 * -1e-9 * ((weight - 300) ** 2 - weight**2))
    cubic = moved(boom("0 1 0", 50.0), "gear_hardening", "yaw", [0, 0, 100], cubic=1e-12)[2]
    close(cubic, -3 * -1e-12 * ((weight - 300) ** 3 - weight**3))


def test_lost_motion_is_crossed_when_the_torque_turns_round():
    def lost(force, mass=0.0):
        robot = boom("0 1 0", mass)
        return moved(robot, "lost_motion", "yaw", [0, 0, force], half_width=1e-4)[2]

    close(lost(10), 3e-4)
    close(lost(-10), -3e-4)
    # 10 kg at 1 m hold the play on one side until 98.07 N·m, 32.7 N at the tool, are reached
    close(lost(30, 10.0), 0.0)
    close(lost(36, 10.0), 6e-4)
    close(lost(-500, 10.0), 0.0)


def test_friction_lags_on_both_branches():
    robot = boom()
    model = Model(robot) + effect(robot, "friction_hysteresis", "yaw")
    model = model.with_public(**{"friction_hysteresis:yaw.half_width": 1e-4})
    wrench = np.array([[0, 50.0, 0, 0, 0, 0], [0, 50, 0, 0, 0, 0], [0, -50, 0, 0, 0, 0]])
    load_cases = replace(load_case(robot, [[0, 0]] * 3, wrench), branch=np.array([1.0, -1.0, 1.0]))
    close(model.predict(load_cases)[:, 1], [-3e-4, 3e-4, 3e-4])


def test_a_jump_finds_its_rest_where_the_torque_almost_vanishes():
    """At 0.1 mrad beside the dead point a jump of 0.2 mrad would turn the torque round."""
    robot = boom()
    model = joint_spring_model(robot, [1e6, np.inf]) + effect(robot, "lost_motion", "yaw")
    model = model.with_public(**{"lost_motion:yaw.half_width": 2e-4})
    pull = np.array([1000.0, 0.05, 0, 0, 0, 0])
    got = model.predict(load_case(robot, NOTHING, pull))[0]
    assert np.isclose(got[1], 6e-4, rtol=1e-2)


def test_a_balancer_stiffens_the_upright_arm():
    # joint 2 of the SK120, upright: cos θ = 1; leaning by 60°: one half
    upright = sk120_moved(
        "gravity_compensator", "joint_2_l", [100, 0, 0], [0] * 6, compliance_drop=1e-7
    )
    close(upright, [-1.1 * 110 * 1e-7, 0, 0])
    lean = sk120_moved(
        "gravity_compensator", "joint_2_l", [0, 0, -100], [0, 60, 0, 0, 0, 0], compliance_drop=1e-7
    )
    across = 1.1 * np.array([0.5, 0, -np.sin(np.pi / 3)])
    close(lean, -0.5 * 1e-7 * across * (across @ [0, 0, -100]))


def springy(robot):
    return joint_spring_model(robot, [1e6, 1e6])


def with_instrument(name, load, pose=NOTHING, **values):
    """Displacement with springs and an instrument error, and without the error."""
    robot = boom()
    found = effect(robot, name, poses=("1", "2"))
    model = springy(robot) + found
    model = model.with_public(**{f"{found.id}.{key}": value for key, value in values.items()})
    load_cases = replace(load_case(robot, pose, load), order=np.array([7.0]))
    return model.predict(load_cases)[0], springy(robot).predict(load_cases)[0]


SIDE = [0, 100.0, 0, 0, 0, 0]


def test_the_force_sensor_reads_too_much():
    """Of 100 N reported, 2 were never there."""
    got, plain = with_instrument("force_scale", SIDE, scale_y=0.02, scale_x=0.5)
    close(got, 0.98 * plain)
    # the tool turned by a quarter about z: the load lies along the sensor's x
    got, plain = with_instrument("force_scale", SIDE, [np.pi / 2, 0], scale_x=0.02)
    close(got, 0.98 * plain)


def test_the_force_sensor_is_off_by_a_constant():
    got, plain = with_instrument("force_bias", SIDE, offset_z=-10.0)
    # 10 N up that the sensor hides: 10 N·m on the nod and 1 m, in rad and m
    close(got - plain, [0, 0, 10 * 1.0 / 1e6])


def test_the_force_sensor_is_turned():
    got, plain = with_instrument("force_rotation", SIDE, angle_x=0.01)
    close(got - plain, [0, 0, 1.0 * 1.0 / 1e6], rtol=1e-2)  # 1 N of the 100 N point up


def test_the_force_sensor_has_crosstalk():
    got, plain = with_instrument("force_crosstalk", SIDE, y_on_z=0.01)
    close(got - plain, [0, 0, -1e-6])
    got, plain = with_instrument("force_crosstalk", SIDE, z_on_y=0.01)
    close(got, plain)


def test_the_tracker_is_turned_and_scaled():
    got, plain = with_instrument("reading_rotation", SIDE, angle_z=0.001)
    close(got - plain, [-0.001 * plain[1], 0.001 * plain[0], 0])
    got, plain = with_instrument("reading_scale", SIDE, scale=0.01)
    close(got, 1.01 * plain)


def test_the_tracker_drifts_from_its_zero():
    got, plain = with_instrument("reading_drift", SIDE, rate_x=2e-6)
    close(got - plain, [14e-6, 0, 0])


def test_the_tracker_drifts_while_it_warms_up():
    """1 µm per reading at first, less and less over 10 readings: 10 µm in the end."""
    law = CATALOGUE["reading_drift"].at(boom(), "tracker", Options(shape=("rate_x_over_10",)))
    assert law.over == (10.0,)
    load_cases = replace(
        load_case(boom(), np.zeros((3, 2)), np.zeros((3, 6))),
        order=np.array([1.0, 5.0, 200.0]), order_at_zero=np.array([0.0, 5.0, 0.0]),
    )  # fmt: skip
    model = (Model(boom()) + law).with_values([1e-6, 0.0, 0.0])
    e = np.exp
    gone = 10e-6 * np.array([1 - e(-0.1), e(-0.5) - e(-1.0), 1.0 - e(-20.0)])
    assert np.allclose(model.predict(load_cases)[:, 0], gone, rtol=1e-12)
    with pytest.raises(InputError, match="over how long"):
        CATALOGUE["reading_drift"].at(boom(), "tracker", Options(shape=("rate_x_over_now",)))


def test_the_zero_reading_of_a_pose_was_off():
    got, plain = with_instrument("zero_offset", SIDE, **{"1.z": 5e-6, "2.z": 1.0})
    close(got - plain, [0, 0, 5e-6])


def with_wrong_geometry(name, where, load, pose=NOTHING, point=None, **values):
    robot = boom()
    found = effect(robot, name, where)
    model = springy(robot) + found
    model = model.with_public(**{f"{found.id}.{key}": value for key, value in values.items()})
    return model.predict(load_case(robot, pose, load, point=point))[0]


def test_the_joint_stands_elsewhere():
    # the load of 100 N stays along the base's y: at 10 mrad the lever is 3 cos 0.01
    pose = [0.0, 0.0]
    got = with_wrong_geometry("joint_offset", "yaw", SIDE, pose, offset=0.01)
    right = with_wrong_geometry("joint_offset", "yaw", SIDE, [0.01, 0.0], offset=0.0)
    close(got, right, rtol=1e-9)


def test_the_tool_point_and_the_link_are_longer():
    # lever 3.01 m instead of 3 m: 100 · 3.01² / 1e6
    close(with_wrong_geometry("tool_offset", None, SIDE, offset_x=0.01)[1], 3.01**2 * 1e-4)
    close(with_wrong_geometry("link_length", "boom", SIDE, offset=0.01)[1], 3.01**2 * 1e-4)
    # up: the nod carries 1 m of tool, and the boom's length is none of its business
    up = [0, 0, 100.0, 0, 0, 0]
    close(with_wrong_geometry("tool_offset", None, up, offset_x=0.01)[2], 1.01**2 * 1e-4)
    close(with_wrong_geometry("link_length", "boom", up, offset=0.01)[2], 1e-4)
    close(with_wrong_geometry("link_length", "arm", up, offset=0.01)[2], 1.01**2 * 1e-4)


def test_a_forearm_is_the_shaft_of_the_joint_that_rolls_the_wrist():
    """On the SK120 the twist of the forearm is joint 4's spring, K = GJ / L, at any pose."""
    robot = load_robot("motoman_sk120")
    length = float(np.hypot(1.3, 0.25))
    rng = np.random.default_rng(5)
    a = rng.uniform(-1.0, 1.0, (20, 6))
    load = np.hstack([rng.normal(size=(20, 3)) * 200.0, np.zeros((20, 3))])
    predicted = []
    for name, where, value in (
        ("link_torsion", "link_3_u", 3e5 * length),
        ("joint_springs", "joint_4_r", 3e5),
    ):
        found = effect(robot, name, where)
        spec = found.parameters[0]
        model = Model(robot) + [Parameter(found, spec, spec.internal(value))]
        load_cases = load_case(robot, a, load, point=[-0.06, 0.04, 0.15])
        predicted.append(model.predict(load_cases))
    assert np.abs(predicted[1]).max() > 1e-5
    assert np.allclose(predicted[0], predicted[1], rtol=0, atol=1e-12)
