"""Xacro as makers publish it: arguments, packages of a workspace, macro files, and bounds."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml

from sk120stiff.errors import InputError
from sk120stiff.model import joint_spring_model, read_model, write_model
from sk120stiff.robot import load_robot
from sk120stiff.robot.checks import check_robot
from sk120stiff.robot.urdf import read_urdf, xacro

HEAD = '<robot {}xmlns:xacro="http://www.ros.org/wiki/xacro">'
# In the style of the makers: an argument without default, one whose default comes too late for the
# robot's own name, constants in YAML found by package, a macro in a file of its own, and another
# package for the tool.
TOP = (
    HEAD.format('name="$(arg title)" ')
    + """
  <xacro:arg name="title" default="arm"/>
  <xacro:arg name="name"/>
  <xacro:arg name="arm_type" default="five"/>
  <xacro:arg name="constants" default="$(find arm_description)/config/$(arg arm_type)/size.yaml"/>
  <xacro:arg name="with_tool" default="true"/>
  <xacro:include filename="$(find arm_description)/urdf/arm_macro.xacro"/>
  <xacro:arm prefix="$(arg name)_" constants="$(arg constants)"/>
  <xacro:if value="$(arg with_tool)">
    <xacro:include filename="$(find tool_description)/urdf/tool.xacro"/>
    <xacro:tool parent="$(arg name)_fore"/>
  </xacro:if>
</robot>
"""
)
ARM_MACRO = (
    HEAD.format("")
    + """
  <xacro:macro name="arm" params="prefix constants">
    <xacro:property name="size" value="${xacro.load_yaml(constants)}"/>
    <link name="${prefix}base"/><link name="${prefix}upper"/><link name="${prefix}fore"/>
    <joint name="${prefix}shoulder" type="revolute">
      <parent link="${prefix}base"/><child link="${prefix}upper"/><axis xyz="0 0 1"/>
      <limit lower="${size['limit']}" upper="${radians(90)}" effort="10" velocity="3"/>
    </joint>
    <joint name="${prefix}elbow" type="revolute">
      <parent link="${prefix}upper"/><child link="${prefix}fore"/><axis xyz="0 1 0"/>
      <origin xyz="${size['upper']['length']} 0 0"/>
      <limit lower="-1" upper="1" effort="10" velocity="3"/>
    </joint>
  </xacro:macro>
</robot>
"""
)
TOOL = (
    HEAD.format("")
    + """
  <xacro:macro name="tool" params="parent">
    <link name="tool0"/>
    <joint name="flange" type="fixed">
      <parent link="${parent}"/><child link="tool0"/><origin xyz="0.1 0 0"/>
    </joint>
  </xacro:macro>
</robot>
"""
)

R = {"title": "arm", "name": "r"}


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two packages in checkouts of other names, in one workspace; the top file is in `arms`."""
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(variable, raising=False)
    src = tmp_path / "ws/src"
    for folder, package in (("arms-main", "arm_description"), ("tools", "tool_description")):
        (src / folder / "urdf").mkdir(parents=True)
        (src / folder / "package.xml").write_text(f"<package><name>{package}</name></package>")
    for name, length in (("five", 0.5), ("ten", 1.0)):
        (src / "arms-main/config" / name).mkdir(parents=True)
        (src / "arms-main/config" / name / "size.yaml").write_text(
            f"upper: {{length: {length}}}\nlimit: !degrees -45.0\n"
        )
    (src / "arms-main/urdf/arm.urdf.xacro").write_text(TOP)
    (src / "arms-main/urdf/arm_macro.xacro").write_text(ARM_MACRO)
    (src / "tools/urdf/tool.xacro").write_text(TOOL)
    return src


def top(workspace: Path) -> Path:
    return workspace / "arms-main/urdf/arm.urdf.xacro"


def test_a_missing_argument_is_told_with_the_command(workspace: Path) -> None:
    with pytest.raises(InputError, match="no value for its argument 'title', 'name'") as refusal:
        load_robot(top(workspace))
    told = str(refusal.value.remedy)
    command = f"sk120stiff check {top(workspace)} --xacro-arg title:=arm --xacro-arg name:=VALUE"
    assert command in told
    assert "arm_type (five)" in told
    assert str(top(workspace)) in str(refusal.value.where)
    with pytest.raises(InputError, match="no value for its argument 'name'"):
        load_robot(top(workspace), xacro={"title": "arm"})
    with pytest.raises(InputError, match=r"none/size\.yaml") as refusal:
        load_robot(top(workspace), xacro=R | {"arm_type": "none"})
    assert "arm_type (five)" in str(refusal.value.remedy)


def test_arguments_choose_the_robot(workspace: Path) -> None:
    robot = load_robot(top(workspace), xacro=R | {"arm_type": "ten"})
    assert robot.name == "arm"
    assert robot.actuated == ("r_shoulder", "r_elbow")
    assert robot.lower[0] == pytest.approx(-np.pi / 4)  # !degrees
    np.testing.assert_allclose(robot.placement([0.0, 0.0])[:3, 3], [1.1, 0.0, 0.0], atol=1e-12)
    short = load_robot(f"{top(workspace)} title:=t name:=r with_tool:=false")
    assert short.tool_frame == "r_fore"
    assert check_robot(f"{top(workspace)} title:=t name:=s").actuated == ("s_shoulder", "s_elbow")


def test_arguments_of_robot_yaml_and_those_on_top_of_it(workspace: Path, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    arguments = {**R, "arm_type": "ten", "with_tool": False}
    path = os.path.relpath(top(workspace), folder)
    (folder / "robot.yaml").write_text(yaml.safe_dump({"urdf": path, "xacro": arguments}))
    assert load_robot(folder).tool_frame == "r_fore"
    longer = load_robot(folder, xacro={"with_tool": "true"})
    assert longer.tool_frame == "tool0"
    assert longer.placement([0.0, 0.0])[0, 3] == pytest.approx(1.1)


def test_a_misspelt_argument_is_refused(workspace: Path) -> None:
    with pytest.raises(InputError, match="no argument 'arm_typ'") as refusal:
        load_robot(top(workspace), xacro=R | {"arm_typ": "ten"})
    assert "Did you mean 'arm_type'?" in str(refusal.value.remedy)
    plain = '<robot name="a"><link name="b"/></robot>'
    (workspace / "plain.urdf").write_text(plain)
    with pytest.raises(InputError, match="no xacro and takes no arguments"):
        read_urdf(workspace / "plain.urdf", xacro_arguments={"name": "r"})


def test_a_model_finds_its_robot_with_the_arguments_again(
    workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    robot = load_robot(
        top(workspace).relative_to(tmp_path),
        xacro={"title": "my arm", "name": "r", "arm_type": "ten"},
    )
    file = write_model(joint_spring_model(robot), tmp_path / "model.yaml")
    said = yaml.safe_load(file.read_text())["robot"]
    assert said == "ws/src/arms-main/urdf/arm.urdf.xacro title:='my arm' name:=r arm_type:=ten"
    again = read_model(file).robot
    assert again.placement([0.1, 0.2]) == pytest.approx(robot.placement([0.1, 0.2]))


def test_a_workspace_is_crawled_for_packages(
    workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    far = tmp_path / "far/away/src/group"
    far.mkdir(parents=True)
    (workspace / "circle").symlink_to(workspace / "circle")
    (workspace / "tools").rename(far / "tools")
    with pytest.raises(InputError, match="package 'tool_description' was not found"):
        load_robot(top(workspace), xacro=R)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "far/away"))
    assert load_robot(top(workspace), xacro=R).tool_frame == "tool0"
    (far / "COLCON_IGNORE").touch()
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "far"))
    with pytest.raises(InputError, match="package 'tool_description' was not found"):
        load_robot(top(workspace), xacro=R)
    installed = tmp_path / "install/share"
    installed.mkdir(parents=True)
    (far / "tools").rename(installed / "any_name")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
    assert load_robot(top(workspace), xacro=R).tool_frame == "tool0"


def test_a_file_of_macros_names_the_file_that_calls_them(workspace: Path) -> None:
    with pytest.raises(InputError, match="only defines the macro 'arm'") as refusal:
        load_robot(workspace / "arms-main/urdf/arm_macro.xacro")
    assert f"Give a file that uses it: {top(workspace)}." in str(refusal.value.remedy)
    (workspace / "tools/urdf/constants.xacro").write_text(
        HEAD.format("") + '<xacro:property name="length" value="1"/></robot>'
    )
    with pytest.raises(InputError, match="holds no link and describes no robot"):
        load_robot(workspace / "tools/urdf/constants.xacro")


def test_dirname_is_that_of_the_file_it_stands_in(workspace: Path) -> None:
    text = TOP.replace("$(find arm_description)/urdf/", "$(dirname)/")
    top(workspace).write_text(text)
    assert load_robot(top(workspace), xacro=R).n == 2


@pytest.mark.parametrize(
    ("name", "text", "what"),
    [
        ("world.xacro", '<sdf version="1.6" xmlns:xacro="x"><xacro:a v="${1/0}"/></sdf>', "an SDF"),
        ("page.xacro", "<html><body>${1/0}</body></html>", "a web page"),
        ("plain.urdf", '<robot name="${1/0}"><link name="$(eval 1/0)"/></robot>', None),
        ("plain.xacro", '<robot name="a"><link name="b"/></robot>', None),
    ],
)
def test_xacro_runs_only_from_a_file_that_is_one(
    tmp_path: Path, name: str, text: str, what: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(xacro, "_run", lambda *_: pytest.fail("xacro ran"))
    (tmp_path / name).write_text(text)
    if what is None:
        read_urdf(tmp_path / name)
    else:
        with pytest.raises(InputError, match=what):
            read_urdf(tmp_path / name)
    with pytest.raises(InputError, match="from a file only"):
        read_urdf(TOP)


def test_too_much_memory_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xacro, "MEMORY_LIMIT", 300 * 1024**2)
    path = tmp_path / "fat.xacro"
    path.write_text(HEAD.format('name="${len([0] * 10**9)}" ') + '<link name="a"/></robot>')
    with pytest.raises(InputError, match=r"needs more than 0\.29\d+ GB of memory"):
        read_urdf(path)


SLOW = (
    HEAD.format('name="slow" ')
    + "".join(
        f'<xacro:macro name="m{k}">{f"<xacro:m{k + 1}/>" * 10}</xacro:macro>' for k in range(12)
    )
    + '<xacro:macro name="m12"><link name="a"/></xacro:macro><xacro:m0/></robot>'
)


def children(pid: int) -> set[int]:
    done = subprocess.run(["ps", "-eo", "pid,ppid"], capture_output=True, text=True, check=True)
    pairs = [tuple(map(int, re.findall(r"\d+", line))) for line in done.stdout.splitlines()[1:]]
    return {child for child, parent in pairs if parent == pid}


@pytest.mark.timeout(60)
def test_an_interrupt_leaves_no_process_behind(tmp_path: Path) -> None:
    path = tmp_path / "slow.xacro"
    path.write_text(SLOW)
    command = [sys.executable, "-m", "sk120stiff", "check", str(path)]
    running = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    try:
        for _ in range(300):
            if found := children(running.pid):
                break
            time.sleep(0.05)
        assert found, "xacro was not started"
        time.sleep(0.3)
        running.send_signal(signal.SIGINT)
        _, said = running.communicate(timeout=20)
    finally:
        running.kill()
    assert running.returncode == 130
    assert b"Interrupted" in said
    for pid in found:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
