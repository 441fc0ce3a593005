"""Each slip of the pen is found and told with what mends it, on a bundled arm and on another."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.data_checks import find_slip, look
from sk120stiff.errors import Refusal
from sk120stiff.explain import explain
from tests.data_checks.random_arms import random_arm
from tests.data_checks.readings import ARMS, UR5, spoilt

# slip, words of the finding, words of the remedy; {k} is a joint's name
SLIPS = [
    ("sign,1", "{1} seems to have the wrong sign", "Negate the column {1}."),
    ("sign,3", "{3} seems to have the wrong sign", "Negate the column {3}."),
    ("exchanged,1,2", "columns {1} and {2} seem to be exchanged", "Exchange the headers"),
    ("exchanged,3,5", "columns {3} and {5} seem to be exchanged", "Exchange the headers"),
    ("degrees labelled rad", "{5} look like deg labelled rad", "{1}[rad] → {1}[deg]"),
    ("degrees labelled rad,1", "the values of {1} look like deg", "header {1}[rad] → {1}[deg]"),
    ("radians labelled deg", "{5} look like rad labelled deg", "{0}[deg] → {0}[rad]"),
    ("radians labelled deg,3,4", "of {3}, {4} look like rad labelled deg", "{4}[deg] → {4}[rad]"),
    ("force of the tool", "given in tool axes, not in base axes", "force: {{frame: tool}}"),
    ("displacement of the tool", "in tool axes, not in base", "displacement: {{frame: tool}}"),
    ("both of the tool", "both were given in tool axes", "and displacement: {{frame: tool}}"),
    ("unit of one axis,1", "dy looks as if it were in another unit", "header of dy"),
    ("readings shifted,1", "(dx, dy, dz) seem to stand 1 row too low", "up by 1 row."),
    ("readings shifted,-2", "(dx, dy, dz) seem to stand 2 rows too high", "down by 2 rows."),
    ("loads shifted,1", "(fx, fy, fz) seem to stand 1 row too low", "up by 1 row."),
    ("readings reversed", "seem to stand in reverse order", "upside down"),
    ("floor", "{2} seems to be measured against the floor", "{2} is {2} + {1} of this file"),
]


@pytest.mark.parametrize("arm", ARMS)
def test_sound_readings_are_not_doubted(arm: str) -> None:
    known = ARMS[arm]()
    assert look(known.model, known.readings).sentences == ()


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize(("slip", "said", "remedy"), SLIPS, ids=[slip for slip, *_ in SLIPS])
def test_a_slip_is_told_with_what_mends_it(arm: str, slip: str, said: str, remedy: str) -> None:
    known = ARMS[arm]()
    names = known.robot.actuated
    found = find_slip(known.robot, spoilt(known, slip))
    assert found is not None
    assert len(found.corrections) == 1 and found.rival is None
    assert said.format(*names) in found.said
    assert remedy.format(*names) in found.remedy
    assert found.after > 0.99 > found.before


def test_a_controllers_own_convention_is_told_as_a_whole() -> None:
    known = ARMS["ur5"]()
    names = known.robot.actuated
    found = find_slip(known.robot, spoilt(known, "floor and wrist"))
    assert found is not None
    assert f"{names[2]} is -{names[2]} + {names[1]} of this file" in found.remedy
    for name in names[3:]:
        assert f"Negate the column {name}." in found.remedy
    assert len(found.corrections) == 4


def test_two_wrong_signs_of_the_force_may_be_half_a_turn() -> None:
    known = ARMS["ur5"]()
    by = np.array([-1.0, 1.0, -1.0, -1.0, 1.0, -1.0])
    found = find_slip(known.robot, replace(known.readings, wrench=known.readings.wrench * by))
    assert found is not None and len(found.corrections) == 2
    assert "half a turn about y" in found.remedy and "upside down" in found.remedy


def test_two_slips_at_once_are_both_told() -> None:
    known = ARMS["sk120"]()
    twice = replace(known, readings=spoilt(known, "degrees labelled rad"))
    found = find_slip(known.robot, spoilt(twice, "readings shifted,1"))
    assert found is not None
    assert len(found.corrections) == 2
    assert "labelled rad" in found.said and "1 row too low" in found.said


def test_a_mended_file_is_sound_again() -> None:
    """The edit that is asked for is the one that mends it."""
    known = ARMS["ur5"]()
    bent = spoilt(known, "floor")
    mended = bent.joints.copy()
    mended[:, 2] += mended[:, 1]
    np.testing.assert_allclose(mended, known.readings.joints, atol=1e-12)
    assert find_slip(known.robot, replace(bent, joints=mended)) is None


def test_nothing_is_explained_before_a_slip_is_mended() -> None:
    known = ARMS["ur5"]()
    with pytest.raises(Refusal, match="have the wrong sign") as refused:
        explain(known.model, spoilt(known, "sign,1"))
    assert f"Negate the column {known.robot.actuated[1]}." in str(refused.value.remedy)


def test_poses_beyond_the_joint_limits_are_told() -> None:
    known = ARMS["sk120"]()
    far = spoilt(known, "sign,1")
    far = replace(far, joints=far.joints + [0.0, 2.0, 0.0, 0.0, 0.0, 0.0])
    said = look(known.model, far).limits
    assert said is not None
    assert "joint_2_l stands at" in said and "(-70 .. 70)" in said


def test_a_slip_is_told_beside_an_effect_that_no_passive_arm_has() -> None:
    """What is missing from the model leaves a tenth of the squares of sound readings."""
    known = random_arm(load_robot(str(UR5)), 90211)
    sound = look(known.model, known.readings)
    assert sound.slip is None
    found = find_slip(known.robot, spoilt(known, "sign,1"))
    assert found is not None
    assert found.said.startswith(f"{known.robot.actuated[1]} seems to have the wrong sign")
    assert found.after < 0.9
