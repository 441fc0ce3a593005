"""`--xacro-arg` on the commands that take a robot."""

import json
import shlex
from pathlib import Path

import pytest
import yaml

from sk120stiff.cli.main import COMMANDS

ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="prefix"/>
  <xacro:arg name="length" default="0.5"/>
  <link name="base"/><link name="$(arg prefix)fore"/>
  <joint name="$(arg prefix)elbow" type="revolute">
    <parent link="base"/><child link="$(arg prefix)fore"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/>
  </joint>
  <link name="tool0"/>
  <joint name="flange" type="fixed"><parent link="$(arg prefix)fore"/><child link="tool0"/>
    <origin xyz="$(arg length) 0 0"/></joint>
</robot>
"""


@pytest.fixture
def arm(tmp_path: Path) -> str:
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(ARM)
    return str(path)


def test_the_command_that_a_refusal_shows_works(run, arm: str) -> None:
    refused = run("check", arm)
    assert refused.code == 2
    assert "no value for its argument 'prefix'" in refused.stderr
    command = refused.stderr.partition("Write: sk120stiff ")[2].partition(" (or")[0]
    shown = run(*shlex.split(command.replace("VALUE", "my_")), "--json")
    assert shown.code == 0
    assert shown.document["actuated"] == ["my_elbow"]


def test_arguments_are_kept_in_the_model(run, arm: str, tmp_path: Path) -> None:
    values = ("--xacro-arg", "prefix:=r_", "--xacro-arg", "length:=0.25")
    model = tmp_path / "model.yaml"
    model.write_text(
        f"robot: {arm} prefix:=r_ length:=0.25\neffects:\n  - name: joint_springs\n"
        "    where: r_elbow\n    parameters: {stiffness: {value: 1e4, unit: N*m/rad}}\n"
    )
    load = ("--wrench", "0,0,-100 N", "--model", str(model), "--json")
    document = run("stiffness", arm, *values, *load).document
    # 25 N·m on 1e4 N·m/rad turn a lever of 0.25 m
    assert document["deflection"]["conventional"][2] == pytest.approx(-25.0 / 1e4 * 0.25)


def test_a_new_folder_keeps_the_arguments(run, arm: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("new", Path(arm).name, "--xacro-arg", "prefix:=007_", "--out", "mine").code == 0
    described = yaml.safe_load(Path("mine/robot.yaml").read_text())
    assert described["urdf"] == "../arm.urdf.xacro"
    assert described["xacro"] == {"prefix": "007_"}
    monkeypatch.chdir(tmp_path.parent)
    assert run("check", str(tmp_path / "mine"), "--json").document["actuated"] == ["007_elbow"]


def test_every_command_that_takes_a_robot_has_the_option(run) -> None:
    for name in COMMANDS:
        said = run(name, "--help").stdout
        usage = said.partition("Options:")[0]
        takes = "ROBOT" in usage or "--robot ROBOT" in said
        assert ("--xacro-arg" in said) == takes, name


def test_what_is_no_argument_is_told(run, arm: str, tmp_path: Path) -> None:
    refused = run("check", arm, "--xacro-arg", "prefix=a", "--json")
    assert refused.code == 2
    assert "NAME:=VALUE" in json.loads(refused.stdout)["error"]["remedy"]
    model = run("stiffness", str(tmp_path / "model.yaml"), "--xacro-arg", "prefix:=a")
    assert model.code == 2
    assert "a model knows its robot" in model.stderr
