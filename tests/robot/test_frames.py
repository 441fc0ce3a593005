"""Where the arm ends, on robots as their makers publish them: hands, helper frames, two arms."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.robot import load_robot
from sk120stiff.robot.checks import check_robot
from sk120stiff.robot.urdf import default_frames, read_urdf
from tests.corpus.robots import example

LIMIT = '<limit lower="-1" upper="1" effort="10" velocity="1"/>'


class Sketch:
    """A robot drawn joint by joint; every link but the first one has the joint that carries it."""

    def __init__(self, root: str = "base") -> None:
        self.root, self.text, self.links = root, "", [root]

    def joint(
        self, name: str, parent: str, child: str, xyz: str = "0 0 0.3", kind: str = "revolute",
        mimic: str | None = None,
    ) -> "Sketch":  # fmt: skip
        moving = "" if kind == "fixed" else f'<axis xyz="0 1 0"/>{LIMIT}'
        follows = f'<mimic joint="{mimic}"/>' if mimic else ""
        self.links.append(child)
        self.text += (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}"/>{moving}{follows}</joint>'
        )
        return self

    def serial(self, count: int, *, start: str = "base", prefix: str = "") -> "Sketch":
        for k in range(1, count + 1):
            below = start if k == 1 else f"{prefix}link{k - 1}"
            self.joint(f"{prefix}joint{k}", below, f"{prefix}link{k}")
        return self

    def __str__(self) -> str:
        links = "".join(f'<link name="{link}"/>' for link in self.links)
        return f'<robot name="sketch">{links}{self.text}</robot>'


def arm(count: int = 6, prefix: str = "") -> Sketch:
    return Sketch().serial(count, prefix=prefix)


def xarm_with_gripper() -> Sketch:
    """One driven knuckle, five that mimic it, and a frame between the fingertips."""
    sketch = arm().joint("gripper_fix", "link6", "xarm_gripper_base_link", "0 0 0", "fixed")
    sketch.joint("drive_joint", "xarm_gripper_base_link", "left_outer_knuckle", "0 0.03 0.06")
    sketch.joint("left_finger_joint", "left_outer_knuckle", "left_finger", "0 0.04 0.04",
                 mimic="drive_joint")  # fmt: skip
    for side, part in (("left", "inner"), ("right", "outer"), ("right", "inner")):
        name = f"{side}_{part}_knuckle"
        sketch.joint(f"{name}_joint", "xarm_gripper_base_link", name, "0 0.02 0.07",
                     mimic="drive_joint")  # fmt: skip
    return sketch.joint("tcp_fix", "xarm_gripper_base_link", "link_tcp", "0 0 0.17", "fixed")


def hand_without_a_telling_name(joints: int = 3) -> Sketch:
    """Chains of small joints that nothing but the shape betrays as fingers."""
    sketch = arm(7, "arm/")
    for digit in ("a", "b", "c"):
        below = "arm/link7"
        for k in range(joints):
            sketch.joint(f"arm/{digit}/{k}", below, f"arm/{digit}{k}", "0 0.01 0.03")
            below = f"arm/{digit}{k}"
    return sketch


def nao() -> Sketch:
    """The driven joint of the hand is its first finger; all others mimic it."""
    sketch = Sketch("torso").serial(5, start="torso", prefix="L")
    sketch.joint("grip", "Llink5", "l_palm", "0.06 0 0", "fixed")
    sketch.joint("LHand", "l_palm", "LFinger11Link", "0.07 0.01 0")
    sketch.joint("LFinger12", "LFinger11Link", "LFinger12Link", "0.015 0 0", mimic="LHand")
    sketch.joint("LFinger21", "l_palm", "LFinger21Link", "0.07 -0.01 0", mimic="LHand")
    return sketch.joint("LThumb1", "l_palm", "LThumb1Link", "0.05 0 -0.02", mimic="LHand")


@pytest.mark.parametrize(
    ("sketch", "tool", "joints", "fingers"),
    [
        (xarm_with_gripper(), "link_tcp", 6, 5),
        (hand_without_a_telling_name(), "arm/link7", 7, 9),
        (hand_without_a_telling_name(4), "arm/link7", 7, 12),
        (nao(), "l_palm", 5, 4),
    ],
    ids=["xarm6 with gripper", "fingers by shape", "longer fingers by shape", "nao"],
)
def test_the_arm_ends_where_the_hand_begins(
    sketch: Sketch, tool: str, joints: int, fingers: int
) -> None:
    robot = load_robot(str(sketch))
    assert robot.tool_frame == tool
    assert robot.n == joints
    assert not set(robot.actuated) & set(robot.choice.fingers)
    assert len(robot.choice.fingers) == fingers
    (told,) = [s for s in check_robot(str(sketch)).chosen_because if "fingers" in s]
    assert robot.choice.fingers[0] in told


def test_a_tool_on_a_finger_makes_the_finger_part_of_the_arm_and_says_so() -> None:
    text = str(xarm_with_gripper())
    with pytest.warns(UserWarning, match="finger joints lie between 'base' and 'left_finger'"):
        robot = load_robot(text, tool="left_finger")
    assert robot.actuated[-1] == "drive_joint"
    (finding,) = [
        f for f in check_robot(text, tool="left_finger").warnings if f.code == "fingers_on_way"
    ]
    assert "choose the tool frame 'link_tcp'" in finding.message
    codes = {f.code for f in check_robot(text).warnings}
    assert "fingers_on_way" not in codes


def test_a_linkage_at_the_wrist_is_no_hand() -> None:
    """The rod of a palletiser follows the arm, and the short branch beside it carries the flange"""
    linkage = arm(4).joint("rod_joint", "link4", "rod", "0 0 0.02", mimic="joint2")
    linkage.joint("wrist", "link4", "plate", "0.05 0 0").joint(
        "f", "plate", "flange", "0.05 0 0", "fixed"
    )
    robot = load_robot(str(linkage))
    assert (robot.tool_frame, robot.n, robot.choice.fingers) == ("flange", 5, ())
    rods = arm(4).joint("rod_joint", "link4", "rod", "0 0 0.02", mimic="joint2")
    rods.joint("wrist", "link4", "plate", "0.05 0 0")
    assert default_frames(read_urdf(str(rods))).fingers == ()


def test_two_arms_on_a_torso_are_no_hand() -> None:
    robot = Sketch().serial(3, prefix="torso_")
    for side in ("left", "right"):
        robot.serial(6, start="torso_link3", prefix=f"{side}_")
    robot.joint("neck", "torso_link3", "head")
    choice = default_frames(read_urdf(str(robot)))
    assert choice.tool == "left_link6"
    assert choice.fingers == ()
    assert choice.others == (("right_link6", 9), ("head", 4))
    assert "right_link6 (9) and head (4)" in choice.about_tool
    assert load_robot(str(robot), tool="right_link6").n == 9


def test_a_shape_for_collision_checks_is_no_tool() -> None:
    """As Franka publishes its arms without a hand: the flange lies 107 mm beyond link7_sc."""
    franka = arm(7).joint("link7_sc_joint", "link7", "link7_sc", "0 0 0", "fixed")
    franka.joint("joint8", "link7", "link8", "0 0 0.107", "fixed")
    franka.joint("link8_sc_joint", "link8", "link8_sc", "0 0 0.02", "fixed")
    choice = default_frames(read_urdf(str(franka)))
    assert choice.tool == "link8"
    assert choice.beside == ("link7",)


def test_a_sensor_is_no_tool_wherever_it_sits() -> None:
    sketch = arm().joint("a", "link6", "flange_plate", "0 0 0.05", "fixed")
    sketch.joint("b", "flange_plate", "wrist_camera", "0.1 0 0.1", "fixed")
    sketch.joint("c", "wrist_camera", "wrist_camera_optical_frame", "0.1 0 0", "fixed")
    assert default_frames(read_urdf(str(sketch))).tool == "flange_plate"


def test_legs_are_arms_only_where_there_is_no_arm() -> None:
    walker = Sketch()
    for part in ("hip", "thigh", "knee", "calf", "ankle", "foot"):
        below = walker.links[-1]
        walker.joint(f"{part}_joint", below, part)
    assert default_frames(read_urdf(str(walker))).tool == "foot"
    walker.serial(4, prefix="arm_")
    choice = default_frames(read_urdf(str(walker)))
    assert (choice.tool, choice.others) == ("arm_link4", (("foot", 6),))


def test_a_mimic_that_leads_nowhere_beside_the_arm_is_a_finding() -> None:
    sketch = xarm_with_gripper()
    broken = str(sketch).replace('mimic joint="drive_joint"', 'mimic joint="drive_jiont"', 1)
    with pytest.warns(UserWarning, match="mimics 'drive_jiont', which does not exist"):
        robot = load_robot(broken)
    assert (robot.tool_frame, robot.n) == ("link_tcp", 6)
    (finding,) = [f for f in check_robot(broken).warnings if f.code == "mimic_unknown"]
    assert "left_finger_joint" in finding.where
    assert "Did you mean 'drive_joint'?" in finding.message


def test_a_mimic_that_leads_nowhere_on_the_arm_is_refused_until_it_is_settled(
    tmp_path: Path,
) -> None:
    text = str(arm(3)).replace(LIMIT + "</joint>", LIMIT + '<mimic joint="jiont1"/></joint>')
    path = tmp_path / "arm.urdf"
    path.write_text(text.replace('<mimic joint="jiont1"/>', "", 2))
    with pytest.raises(InputError, match="lies between 'base' and 'link3'") as refusal:
        load_robot(path)
    assert refusal.value.remedy is not None
    assert "Did you mean 'joint1'?" in refusal.value.remedy
    for settled, joints in (
        ("couplings: {joint3: {driver: joint1, multiplier: -1}}", ("joint1", "joint2")),
        ("actuated: [joint1, joint2, joint3]", ("joint1", "joint2", "joint3")),
    ):
        (tmp_path / "robot.yaml").write_text(f"urdf: arm.urdf\ntool_frame: link3\n{settled}\n")
        with pytest.warns(UserWarning, match="does not exist"):
            assert load_robot(tmp_path).actuated == joints


@pytest.mark.parametrize(
    ("name", "tool", "joints"),
    [
        ("romeo.urdf", "l_gripper", 8),  # its hand is driven by one joint that others mimic
        ("human.urdf", "left_hand", 13),  # middle_thoracic_X is no middle finger
        ("alex_sake_hands.urdf", "RightSakePalmLink", 10),  # GripperYaw turns the wrist
        ("alex_psyonic_hands.urdf", "LeftPsyonicAbilityBaseLink", 10),
        ("alexander_v1.lowerBodyOnly.urdf", "LEFT_FOOT", 6),  # not the sensor in it
        ("tiago_dual.urdf", "arm_left_tool_link", 8),
        ("baxter.urdf", "right_hand_link", 7),
    ],
)
@pytest.mark.filterwarnings("ignore::sk120stiff.errors.ToolkitWarning")
def test_public_robots(name: str, tool: str, joints: int) -> None:
    robot = load_robot(example(name))
    assert (robot.tool_frame, robot.n) == (tool, joints)
    if name in ("baxter.urdf", "tiago_dual.urdf", "romeo.urdf"):
        assert robot.choice.others[0][1] == joints  # the other arm is told
