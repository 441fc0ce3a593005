"""Units of everything at once: told where the springs that follow are implausible, no finding."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.data_checks import find_slip, look
from sk120stiff.data_checks.efforts import efforts_doubt
from sk120stiff.data_checks.scale import USUAL, _doubt, usual_stiffness
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.measurements import Measurements
from sk120stiff.model import joint_spring_model
from sk120stiff.robot import Robot
from tests.data_checks.readings import ARMS, SCALES, UR5, Arm, loads_as_if


@pytest.mark.parametrize(("factor", "unit"), SCALES)
def test_a_scale_beyond_the_known_springs_is_told_as_a_doubt(factor: float, unit: str) -> None:
    known = ARMS["sk120"]()
    data = loads_as_if(known.readings, factor)
    found = look(known.model, data)
    assert found.slip is None
    assert found.scale is not None and not found.scale.certain
    assert unit in found.scale.sentence
    assert "one number to these readings" in found.scale.sentence
    assert find_slip(known.robot, data) is None  # and it is never called found


def test_without_known_springs_the_size_of_the_arm_speaks() -> None:
    known = ARMS["ur5"]()
    assert look(known.model, known.readings).scale is None
    found = look(known.model, loads_as_if(known.readings, 9.807)).scale
    assert found is not None
    base = ", ".join(known.robot.actuated[:2]) + f" and {known.robot.actuated[2]}"
    assert f"the springs of {base} come out at about" in found.sentence
    assert "forces in kgf labelled N" in found.sentence


@pytest.mark.parametrize(
    ("times", "said"), [(12.0, "Perhaps: "), (40.0, "Likely: "), (1 / 12, "Perhaps: ")]
)
def test_a_little_beyond_what_is_usual_the_arm_may_be_another_than_most(
    times: float, said: str
) -> None:
    found = _doubt("so", times, 0.1, 10.0)
    assert found is not None and said in found.sentence
    than = f"an arm that is {'softer' if times > 1.0 else 'stiffer'} than most of its size"
    assert (than in found.sentence) == (said == "Perhaps: ")


FIXED = '<joint name="world_joint" type="fixed">'
RAIL = (
    '<joint name="rail" type="prismatic"><axis xyz="0 1 0"/>'
    '<limit lower="0" upper="4" effort="1e4" velocity="1"/>'
)


@pytest.mark.parametrize("rail", [1e8, 3e3])  # N/m
def test_of_an_arm_on_a_rail_the_gears_are_judged_alone(tmp_path: Path, rail: float) -> None:
    """However soft the rail is: its springs are no sign of a unit, and hide none."""
    path = tmp_path / "track.urdf"
    path.write_text(UR5.read_text(encoding="utf-8").replace(FIXED, RAIL), encoding="utf-8")
    robot = load_robot(str(path), base="world", tool="tool0")
    sound = ARMS["ur5"]().readings
    track = np.random.default_rng(2).uniform(0.0, 4.0, 14).repeat(4)
    joints = np.column_stack([track, sound.joints])
    springs = [rail, 2.0e4, 2.2e4, 1.6e4, 4.0e3, 4.5e3, 3.5e3]
    moved = joint_spring_model(robot, springs).deflect(joints, sound.wrench, point=sound.point)
    readings = replace(
        sound,
        robot=str(path),
        base_frame="world",
        joint_names=robot.actuated,
        joint_kinds=("length", *["angle"] * 6),
        joints=joints,
        displacement=moved,
    )
    start = joint_spring_model(robot)
    assert look(start, readings).scale is None
    found = look(start, replace(readings, displacement=moved / 25.4)).scale
    assert found is not None
    assert "displacements in inch labelled mm" in found.sentence


SOFT = {
    "base_rocking": ({"x": 5e4, "y": 4e4}, "base_link"),  # N·m/rad: on wheels
    "tool_compliance": ({"turn_x": 4e2, "turn_y": 4e2, "turn_z": 4e3}, "tool0"),  # on rubber
}


@pytest.mark.parametrize("part", SOFT)
@pytest.mark.parametrize("factor", [1.0, 9.807])
def test_what_a_user_brought_may_be_softer_than_any_drive(part: str, factor: float) -> None:
    """All together looks soft, and no unit is to blame; a unit makes springs soft beside it."""
    known = ARMS["sk120"]()
    values, where = SOFT[part]
    whole = (known.model + effect(known.robot, part, where)).with_public(
        {f"{part}:{where}.stiffness_{name}": value for name, value in values.items()}
    )
    sound = known.readings
    moved = whole.deflect(sound.joints, sound.wrench, point=sound.point)
    found = look(known.model, loads_as_if(replace(sound, displacement=moved), factor)).scale
    assert (found is None) == (factor == 1.0)


@pytest.mark.parametrize("length", [0.5, 1.0, 1.7, 2.9, 3.3])
def test_larger_arms_are_stiffer(length: float) -> None:
    softest, stiffest = usual_stiffness(length)
    assert 0.99 * USUAL[0][1] < softest < stiffest < USUAL[-1][2]
    assert usual_stiffness(1.2 * length)[0] > softest


def test_the_paper_lies_in_the_table() -> None:
    known = ARMS["sk120"]()
    springs = known.model.joint_stiffness()[:3]
    softest, stiffest = usual_stiffness(2.87)
    assert softest < springs.min() and springs.max() < stiffest


def test_loads_that_no_motor_of_the_arm_holds_are_told() -> None:
    """A force in N labelled lbf passes every check of the springs; the URDF's efforts know more."""
    known = ARMS["ur5"]()
    assert look(known.model, known.readings).efforts is None
    said = look(known.model, _loaded(known, 2.5)).efforts
    assert said is not None
    assert "the loads ask 2.5 times of" in said


def test_efforts_of_no_motors_say_nothing_of_loads() -> None:
    known = ARMS["ur5"]()
    heavy = _loaded(known, 2.5)
    assert efforts_doubt(_with_efforts(known.robot, 1.0), heavy) is None  # all alike
    assert efforts_doubt(_with_efforts(known.robot, 1.0, 0.1), heavy) is None  # they cannot stand
    assert efforts_doubt(_with_efforts(known.robot, 9e3, 9e4), heavy) is None


def _loaded(known: Arm, times: float) -> Measurements:
    """The same readings under loads that ask so many times the effort of one joint."""
    load_cases = load_cases_of(known.robot, known.readings)
    screws = known.robot.screws(load_cases.a, point=load_cases.force_point)
    asked = float((np.abs(screws.torques(load_cases.wrench)) / known.robot.efforts).max())
    return replace(known.readings, wrench=known.readings.wrench * times / asked)


def _with_efforts(robot: Robot, *efforts: float) -> Robot:
    """The robot with these efforts in turn in its URDF."""
    joints = [
        replace(joint, effort=efforts[k % len(efforts)])
        for k, joint in enumerate(robot.document.joints)
    ]
    return replace(robot, document=replace(robot.document, joints=tuple(joints)))
