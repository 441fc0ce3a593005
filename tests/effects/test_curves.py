"""Laws with free shapes: flanks, pre-sliding, beams along their roll axis, foundations askew."""

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.effects.foundation import BaseRocking, NonlinearRocking
from sk120stiff.effects.gear import FrictionHysteresis, LostMotion
from sk120stiff.effects.joint_tilt import NonlinearTilt
from sk120stiff.effects.link_beam import LinkBending
from sk120stiff.effects.options import Options
from sk120stiff.effects.reading_drift import ReadingDrift
from sk120stiff.effects.tool_compliance import NonlinearTool
from sk120stiff.measurements import Measurements
from sk120stiff.model import base_model, model_from_text, model_text
from tests.effects.arms import arm
from tests.hidden.generator.causes_curves import MaxwellSlip

POINT = np.array([0.06, 0.04, 0.15])
JOINT = "joint_1_s"


@pytest.fixture(scope="module")
def robot():
    return load_robot("motoman_sk120")


def pushed(robot, forces, branch=None, repeat=None):
    """Sideways pushes at one pose, after one zero reading."""
    count = len(forces)
    wrench = np.zeros((count, 6))
    wrench[:, 1] = forces
    return load_cases_of(
        robot,
        Measurements(
            pose=("1",) * count,
            joint_names=robot.actuated,
            joint_kinds=robot.kinds,
            joints=np.tile([0.0, 0.2, 0.1, 0.0, 0.3, 0.0][: robot.n], (count, 1)),
            wrench=wrench,
            displacement=None,
            point=POINT,
            zero="shared",
            branch=branch,
            repeat=repeat,
        ),
    )


def test_a_flank_closes_as_tanh_and_each_side_has_its_own(robot):
    load_cases = pushed(robot, [-300.0, -20.0, 20.0, 300.0])
    torque = LostMotion(JOINT).load_torque(load_cases)
    law = LostMotion(JOINT, flanks=(0.0, 40.0), sided=True)
    b = np.array([3e-5, 1e-5, 2e-5, 4e-5])  # jump +, jump -, flank +, flank -
    found = law.elongation(torque, load_cases, b).value[:, 0]
    t = torque[:, 0]
    up, down = (3e-5 + 2e-5 * np.tanh(t / 40.0)), (-1e-5 + 4e-5 * np.tanh(t / 40.0))
    assert np.allclose(found, np.where(t > 0.0, up, down), rtol=1e-12)


def test_presliding_is_a_maxwell_slip_gear(robot):
    """One spring with a slider beside the joint's: its loop by equations of another hand."""
    K, reach, h = 2e6, 1e-4, 3e-5
    gear = MaxwellSlip(JOINT, {"half_width": h}, {"shares": (1.0,), "reach": (reach,)})
    forces = np.array([100, 250, 400, 300, 150, -50, -300, -350, -100, 200, 380], float)
    branch = tuple("load" if k < 3 else "unload" for k in range(len(forces)))
    load_cases = pushed(robot, forces, branch)
    torque = FrictionHysteresis(JOINT).load_torque(load_cases)
    advance, state, twists = gear.advance(K), None, []
    for now in (0.0, *torque[:, 0]):
        twist, state = advance(state, np.array([now]))
        twists.append(float(twist[0]) - now / K)
    slips = K * reach + h * K  # the torque at which the slider starts to slip
    law = FrictionHysteresis(JOINT, reaches=(slips,))
    found = law.elongation(torque, load_cases, np.array([h])).value[:, 0]
    assert np.allclose(found, np.array(twists[1:]) - twists[0], rtol=0, atol=1e-12)
    assert np.ptp(found) > h


@pytest.mark.parametrize("reach", [2e-5, 1e-4, 2e-3], ids=["slips early", "slips", "sticks"])
def test_an_arm_that_was_loaded_before_its_zero_begins_in_its_loop(robot, reach):
    """The ladder is gone through ten times before it is read; then friction's part is a loop."""
    K, h = 2e6, 3e-5
    gear = MaxwellSlip(JOINT, {"half_width": h}, {"shares": (1.0,), "reach": (reach,)})
    ladder = np.array([100, 200, 300, 200, 100, 0], float)
    branch = ("load",) * 3 + ("unload",) * 3
    load_cases = pushed(robot, ladder, branch)
    torque = FrictionHysteresis(JOINT).load_torque(load_cases)
    advance, state, twists = gear.advance(K), None, []
    for now in (0.0, *(10 * torque[:, 0].tolist()), *torque[:, 0]):
        twist, state = advance(state, np.array([now]))
        twists.append(float(twist[0]) - now / K)
    slips = K * reach + h * K
    law = FrictionHysteresis(JOINT, reaches=(slips,), start="cycled")
    found = law.elongation(torque, load_cases, np.array([h])).value[:, 0]
    begun = -len(ladder) - 1  # where the last ladder but one ended, its zero is read
    assert np.allclose(found, np.array(twists[begun + 1 :]) - twists[begun], rtol=0, atol=1e-12)
    assert found[-1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("reach", [2e-5, 1e-4, 2e-3], ids=["slips early", "slips", "sticks"])
def test_a_gear_that_bears_the_arm_begins_where_its_weight_brought_it(reach):
    """The weight comes first, then the ladder; the twist is read from the weight's on."""
    robot, K, h = arm("six_axis"), 2e5, 3e-5
    joint = FrictionHysteresis.places(robot)[1]
    gear = MaxwellSlip(joint, {"half_width": h}, {"shares": (1.0,), "reach": (reach,)})
    ladder = np.array([20, 60, 90, 60, 20, 0, -40, 10], float)
    load_cases = pushed(robot, ladder, ("load",) * 3 + ("unload",) * 5)
    slips = K * reach + h * K
    law = FrictionHysteresis(joint, reaches=(slips,), start="weighed")
    torque = law.load_torque(load_cases)
    weight = float(law.weight_torque(load_cases)[0, 0])
    assert abs(weight) > 1.0
    advance, state, twists = gear.advance(K), None, []
    for now in (0.0, weight, *(weight + torque[:, 0])):
        twist, state = advance(state, np.array([now]))
        twists.append(float(twist[0]) - now / K)
    found = law.elongation(torque, load_cases, np.array([h])).value[:, 0]
    assert np.allclose(found, np.array(twists[2:]) - twists[1], rtol=0, atol=1e-12)
    assert type(law).at(robot, joint, Options(shape=law_names(law))).start == "weighed"


def test_between_repeats_the_load_is_off(robot):
    """What slipped under the first load is still there when it comes again."""
    load_cases = pushed(robot, [300.0, 300.0], repeat=np.array([1, 2]))
    steps, zero, own = load_cases.history
    assert steps[:, 0].tolist() == [-1, 0, -1, 1]
    assert (zero.tolist(), own.tolist()) == ([0, 0], [1, 3])


@pytest.mark.parametrize(
    "law",
    [
        LostMotion(JOINT, flanks=(12.5,)),
        LostMotion(JOINT, flanks=(0.0, 30.0, 120.0), sided=True),
        FrictionHysteresis(JOINT, reaches=(15.0, 45.0)),
        FrictionHysteresis(JOINT, reaches=(15.0, 45.0), start="cycled"),
        LinkBending("link_3_u", taper=-0.5, roll=True, planes=True),
        LinkBending("link_3_u", taper=0.6),
        BaseRocking("base_link", askew=True),
        NonlinearRocking("base_link", full=(1500.0, 2000.0)),
        NonlinearRocking("base_link"),
        NonlinearTilt(JOINT, full=(900.0, 900.0)),
        NonlinearTool("tool0"),
        ReadingDrift("tracker", over=(30.0,)),
        ReadingDrift("tracker", per_second=True, over=(0.0, 120.0, 400.0)),
    ],
    ids=repr,
)
def test_a_law_is_read_as_it_was_written(robot, law):
    model = base_model(robot)
    model = model + type(law).at(robot, law.where, Options(shape=law_names(law)))
    values = model.values.copy()
    values[-len(law.parameters) :] = [spec.typical for spec in law.parameters]
    text = model_text(model.with_values(values))
    again = model_from_text(text, robot=robot)
    assert again.effects[-1].parameters == model.effects[-1].parameters
    assert law_names(again.effects[-1]) == law_names(law)
    assert np.allclose(again.values, values, rtol=1e-5)


def law_names(law):
    return tuple(spec.name for spec in law.parameters)


def test_the_forearm_bends_along_its_roll_axis(robot):
    """Its line and the axis of joint 4 are 10.9 degrees apart; all of its length is along it."""
    joints = LinkBending("link_3_u", roll=True).virtual_joints(robot)
    straight = LinkBending("link_3_u").virtual_joints(robot)
    line = joints[-1].placement[:3, 3] - joints[0].placement[:3, 3]
    other = straight[-1].placement[:3, 3] - straight[0].placement[:3, 3]
    cosine = line @ other / np.linalg.norm(line) / np.linalg.norm(other)
    assert np.degrees(np.arccos(cosine)) == pytest.approx(10.9, abs=0.1)
    for joint in joints:
        assert abs(joint.axis @ line) < 1e-9 * np.linalg.norm(line)


def test_a_foundation_askew_turns_about_its_own_axes(robot):
    turn, soft, stiff = 0.7, 4e-7, 1e-7
    u = np.array([np.cos(turn), np.sin(turn)])
    v = np.array([-u[1], u[0]])
    C = soft * np.outer(u, u) + stiff * np.outer(v, v)
    law = effect(robot, "base_rocking").other_laws(pushed(robot, [1.0]))[0]
    made = np.tensordot([C[0, 0], C[1, 1], C[0, 1]], law.patterns(pushed(robot, [1.0])), axes=1)
    assert np.allclose(made, C, rtol=1e-12)
