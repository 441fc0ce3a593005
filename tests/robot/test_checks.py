"""What `check_robot` says about robots that load."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.robot import load_robot
from sk120stiff.robot.checks import CheckReport, check_robot
from tests.corpus.robots import example

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def arm(*axes: str, mass: str = "1", extra: str = "") -> str:
    """A serial arm, links 0.5 m long along x, one joint per axis."""
    text = '<robot name="arm"><link name="l0"/>'
    for k, axis in enumerate(axes, start=1):
        text += (
            f'<link name="l{k}"><inertial><mass value="{mass}"/><inertia ixx="1" ixy="0" ixz="0" '
            f'iyy="1" iyz="0" izz="1"/></inertial></link><joint name="j{k}" type="revolute">'
            f'<parent link="l{k - 1}"/><child link="l{k}"/><origin xyz="0.5 0 0"/>'
            f'<axis xyz="{axis}"/>{LIMIT}</joint>'
        )
    return (
        text
        + f'<link name="tool0"/><joint name="flange" type="fixed"><parent link="l{len(axes)}"/>'
        + f'<child link="tool0"/><origin xyz="0.5 0 0"/></joint>{extra}</robot>'
    )


def codes(report: CheckReport) -> set[str]:
    return {finding.code for finding in report.warnings}


def test_a_clean_arm_has_nothing_to_say() -> None:
    report = check_robot(arm("0 0 1", "0 1 0"))
    assert report.warnings == ()
    assert report.actuated == ("j1", "j2")
    assert report.moving == ("j1", "j2")
    assert (report.coupled, report.loops) == ((), ())
    assert report.frames == ("l0", "l1", "l2", "tool0")
    assert (report.base_frame, report.tool_frame) == ("l0", "tool0")
    assert report.total_mass_kg == 2.0


def test_the_report_is_plain_data() -> None:
    text = json.dumps(dataclasses.asdict(check_robot("motoman_sk120")))
    assert {"name", "actuated", "coupled", "loops", "frames", "total_mass_kg", "warnings"} <= set(
        json.loads(text)
    )


def test_the_bundled_robot() -> None:
    report = check_robot("motoman_sk120")
    assert report.actuated == load_robot("motoman_sk120").actuated
    assert "joint_elbow_parallel = -1 · joint_2_l + 0" in report.coupled
    assert "no_mass" in codes(report)
    assert report.total_mass_kg == 0.0


def test_singular_at_zero_only_where_it_is() -> None:
    assert "singular_at_zero" not in codes(check_robot(arm("0 0 1", "0 1 0", "1 0 0")))
    parallel = check_robot(arm(*["0 0 1"] * 4))  # a stretched planar arm
    (finding,) = [f for f in parallel.warnings if f.code == "singular_at_zero"]
    assert "rank 2 of 4" in finding.message


def test_a_side_branch_is_no_part_of_the_arm() -> None:
    idle = (
        '<link name="lamp"/><joint name="lamp_joint" type="revolute"><parent link="l0"/>'
        f'<child link="lamp"/><axis xyz="0 0 1"/>{LIMIT}</joint>'
    )
    report = check_robot(arm("0 0 1", extra=idle))
    assert report.actuated == ("j1",)
    with pytest.raises(InputError, match="carried by"):
        load_robot(arm("0 0 1", extra=idle), base="lamp", tool="tool0")


def test_a_joint_that_does_not_move_the_tool() -> None:
    text = arm("0 0 1", "0 1 0").replace(
        "</robot>",
        '<link name="w"/><joint name="roll" type="prismatic"><parent link="tool0"/>'
        f'<child link="w"/><axis xyz="1 0 0"/><mimic joint="j2" multiplier="0"/>{LIMIT}</joint>'
        "</robot>",
    )
    assert "idle_joint" not in codes(check_robot(text))
    follower = text.replace(
        'name="j1" type="revolute">',
        'name="j1" type="revolute"><mimic joint="free" multiplier="0"/>',
    )
    follower = follower.replace(
        "</robot>",
        '<link name="f"/><joint name="free" type="revolute">'
        '<parent link="l0"/><child link="f"/>' + LIMIT + "</joint></robot>",
    )
    (finding,) = [f for f in check_robot(follower).warnings if f.code == "idle_joint"]
    assert "free" in finding.message


def test_frames_as_told() -> None:
    report = check_robot(arm("0 0 1", "0 1 0", "1 0 0"), base="l1", tool="l3")
    assert (report.base_frame, report.tool_frame) == ("l1", "l3")
    assert report.actuated == ("j2", "j3")
    assert any("as told" in reason for reason in report.chosen_because)
    with pytest.raises(InputError, match="there is no frame 'l33'"):
        check_robot(arm("0 0 1"), tool="l33")


def test_lengths_beyond_all_robots_are_refused() -> None:
    text = arm("0 0 1", "0 1 0").replace('xyz="0.5 0 0"', 'xyz="1e308 1e308 0"')
    with pytest.raises(InputError, match=r"line 1, joint 'j1': .*too large for a number"):
        check_robot(text)
    assert "units" in codes(check_robot(text.replace("1e308", "1e12")))


def test_load_robot_warns_of_repairs_and_check_does_not(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(arm("0 0 2", "0 1 0"))
    with pytest.warns(ToolkitWarning, match=r"arm\.urdf: line 1, joint 'j1': the axis has length"):
        load_robot(path)
    assert "axis_not_unit" in codes(check_robot(path))


def test_many_repairs_make_few_warnings() -> None:
    text = arm(*["0 0 2"] * 40)
    with pytest.warns(ToolkitWarning) as told:
        load_robot(text)
    assert len(told) == 1 and "39 more of this kind; see check" in str(told[0].message)


def test_kinds_beyond_the_most_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sk120stiff.robot.loading._MOST_WARNINGS", 0)
    with pytest.warns(ToolkitWarning) as told:
        load_robot(arm(*["0 0 2"] * 40))
    assert len(told) == 1 and "40 more findings; see check" in str(told[0].message)


def test_a_ball_joint_must_be_locked_by_word(tmp_path: Path) -> None:
    text = arm("0 0 1", "0 1 0").replace('name="j2" type="revolute"', 'name="j2" type="spherical"')
    with pytest.raises(InputError, match="3 degrees of freedom"):
        load_robot(text)
    with pytest.warns(ToolkitWarning) as told:
        assert load_robot(text, lock={"j2": 0.0}).actuated == ("j1",)
    assert {str(one.message).rsplit("[")[-1] for one in told} == {
        "joint_locked]",
        "locked_on_chain]",
    }
    with pytest.raises(InputError, match="held at zero only"):
        load_robot(text, lock={"j2": 0.5})
    with pytest.raises(InputError, match="cannot be actuated because it is spherical"):
        load_robot(text, actuated=["j2"], lock={"j2": 0.0})
    (tmp_path / "arm.urdf").write_text(text)
    (tmp_path / "robot.yaml").write_text("urdf: arm.urdf\nlock: {j2: 0.0}\n")
    report = check_robot(tmp_path)
    assert report.actuated == ("j1",)
    assert "locked_on_chain" in codes(report)


@pytest.mark.parametrize(
    ("name", "base", "tool", "joints"),
    [
        ("ur10_robot.urdf", "world", "tool0", 6),
        ("panda.urdf", "panda_link0", "panda_hand_tcp", 7),
        ("xarm7.urdf", "world", "link_eef", 7),
        ("kinova.urdf", "base", "j2s6s200_end_effector", 6),
        ("z1.urdf", "world", "gripperStator", 6),
        ("so100.urdf", "base", "gripper", 5),
        ("tiago_no_hand.urdf", "base_footprint", "arm_tool_link", 8),
        ("tiago.urdf", "base_footprint", "arm_tool_link", 8),
        ("finger_edu.urdf", "base_link", "finger_tip_link", 3),
    ],
)
def test_default_frames_leave_grippers_out(name: str, base: str, tool: str, joints: int) -> None:
    report = check_robot(example(name))
    assert (report.base_frame, report.tool_frame) == (base, tool)
    assert len(report.actuated) == joints


def pin_joint(name: str, parent: str, child: str, xyz: str, kind: str = "revolute") -> str:
    moving = f'<axis xyz="0 1 0"/>{LIMIT}' if kind == "revolute" else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/>{moving}</joint>'
    )


FOUR_BAR = (
    '<robot name="four_bar">'
    + "".join(f'<link name="{link}"/>' for link in ("base", "crank", "coupler", "rocker", "pin"))
    + pin_joint("crank_joint", "base", "crank", "0 0 0")
    + pin_joint("knee", "crank", "coupler", "0 0 1")
    + pin_joint("coupler_end", "coupler", "pin", "1.5 0 0", "fixed")
    + pin_joint("rocker_joint", "base", "rocker", "1.5 0 0")
    + pin_joint("rocker_end", "rocker", "pin", "0 0 1")
    + "</robot>"
)


def test_the_advice_for_a_closed_loop_works(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="form a closed loop") as refusal:
        check_robot(FOUR_BAR)
    assert "make rocker_end fixed" in str(refusal.value.remedy)
    assert "new empty child link pin_closure" in str(refusal.value.remedy)
    closures = str(refusal.value.remedy).partition("closures:")[2]
    opened = FOUR_BAR.replace(
        pin_joint("rocker_end", "rocker", "pin", "0 0 1"),
        pin_joint("rocker_end", "rocker", "pin_closure", "0 0 1", "fixed"),
    ).replace("<joint", '<link name="pin_closure"/><joint', 1)
    (tmp_path / "arm.urdf").write_text(opened)
    (tmp_path / "robot.yaml").write_text(
        f"urdf: arm.urdf\ntool_frame: coupler\nactuated: [crank_joint]\nclosures:{closures}\n"
    )
    report = check_robot(tmp_path)
    assert report.actuated == ("crank_joint",)
    assert len(report.loops) == 1
    assert "pin_closure meets pin" in report.loops[0]
    assert {"knee by a closed loop", "rocker_joint by a closed loop"} <= set(report.coupled)
    assert load_robot(tmp_path).placement([0.4])[:3, :3] == pytest.approx(np.eye(3), abs=1e-9)


def test_a_loop_that_is_open_at_zero_is_said(tmp_path: Path) -> None:
    opened = FOUR_BAR.replace(
        pin_joint("rocker_end", "rocker", "pin", "0 0 1"),
        pin_joint("rocker_end", "rocker", "far", "0 0 1", "fixed"),
    ).replace("<joint", '<link name="far"/><joint', 1)
    opened = opened.replace('"1.5 0 0"/><axis', '"2.5 0 0"/><axis')  # reached by leaning forward
    (tmp_path / "arm.urdf").write_text(opened)
    (tmp_path / "robot.yaml").write_text(
        "urdf: arm.urdf\ntool_frame: coupler\nactuated: [crank_joint]\n"
        "closures: [{frames: [far, pin], start: {crank_joint: 0.8, knee: 0.3}}]\n"
    )
    (finding,) = [f for f in check_robot(tmp_path).warnings if f.code == "open_at_zero"]
    assert "cannot be closed" in finding.message


def test_gravity_without_masses_is_never_silent() -> None:
    light = arm("0 1 0", "0 1 0", mass="0")
    with pytest.warns(ToolkitWarning, match="states no masses"):
        assert load_robot(light).gravity_torque([0.0, 0.0]) == pytest.approx([0.0, 0.0])
    assert "no_mass" in codes(check_robot(light))
    heavy = load_robot(arm("0 1 0", "0 1 0"))  # 1 kg, 0.5 m from the first axis; y turns x down
    assert heavy.gravity_torque([0.0, 0.0]) == pytest.approx([9.80665 * 0.5, 0.0])
