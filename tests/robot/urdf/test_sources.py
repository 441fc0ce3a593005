"""The forms a description comes in, and the addresses it refers to."""

import importlib.util
import os
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError, MissingPart
from sk120stiff.robot import load_robot
from sk120stiff.robot.urdf import read_urdf, resolve, source, xacro
from sk120stiff.robot.urdf.packages import package_folders

ARM = """<robot name="arm">
  <link name="base"/>
  <link name="fore"><visual><geometry><mesh filename="{mesh}"/></geometry></visual></link>
  <joint name="elbow" type="revolute">
    <parent link="base"/><child link="fore"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="10" velocity="3"/>
  </joint>
</robot>
"""
XACRO = """<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="length" default="0.5"/>
  <xacro:include filename="parts/joint.xacro"/>
  <xacro:include filename="$(find arm_parts)/tool.xacro"/>
  <link name="base"/><link name="fore"/>
  <xacro:turning name="elbow" length="$(arg length)"/>
</robot>
"""
MACRO = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="turning" params="name length">
    <joint name="${name}" type="revolute">
      <parent link="base"/><child link="fore"/>
      <origin xyz="${2 * length} 0 0"/><axis xyz="0 1 0"/>
      <limit lower="-1" upper="2" effort="10" velocity="3"/>
    </joint>
  </xacro:macro>
</robot>
"""
TOOL = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="tool0"/>
  <joint name="flange" type="fixed"><parent link="fore"/><child link="tool0"/></joint>
</robot>
"""


def arm(mesh: str = "fore.stl") -> str:
    return ARM.format(mesh=mesh)


def xacro_tree(tmp_path: Path) -> Path:
    (tmp_path / "arm/parts").mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere/package.xml").write_text("<package><name>arm_parts</name></package>")
    (tmp_path / "elsewhere/tool.xacro").write_text(TOOL)
    (tmp_path / "arm/parts/joint.xacro").write_text(MACRO)
    path = tmp_path / "arm/arm.urdf.xacro"
    path.write_text(XACRO)
    return path


def test_path_text_and_bytes_are_the_same(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(arm())
    forms = [path, str(path), arm(), "\ufeff\n  " + arm(), arm().encode(), arm().encode("utf-16")]
    texts = {read_urdf(form).xml for form in forms}
    assert len(texts) == 1
    assert read_urdf(path).path == path
    assert read_urdf(arm()).path is None


@pytest.mark.parametrize("below", ["", "urdf", "robots"])
def test_folder_with_one_description(tmp_path: Path, below: str) -> None:
    folder = tmp_path / below
    folder.mkdir(exist_ok=True)
    (folder / "arm.urdf").write_text(arm())
    assert read_urdf(tmp_path).name == "arm"
    assert load_robot(tmp_path).actuated == ("elbow",)


def test_folder_with_several_or_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no robot") as nothing:
        read_urdf(tmp_path)
    assert str(tmp_path) in str(nothing.value)
    for name in ("left.urdf", "right.urdf"):
        (tmp_path / name).write_text(arm())
    with pytest.raises(InputError, match=r"2 robot descriptions: left\.urdf, right\.urdf"):
        read_urdf(tmp_path)


@pytest.mark.timeout(20)
@pytest.mark.parametrize("name", ["absent.urdf", "pipe.urdf", "\0.urdf", "x" * 5000, "", "null"])
def test_what_is_no_file(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    os.mkfifo(tmp_path / "pipe.urdf")
    given = "/dev/zero" if name == "null" else name and f"{tmp_path}/{name}"
    monkeypatch.chdir(tmp_path)
    for read in (read_urdf, load_robot):
        with pytest.raises(InputError) as refusal:
            read(given)
        assert refusal.value.where
        assert refusal.value.remedy


def test_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(source, "MAX_BYTES", 100)
    path = tmp_path / "arm.urdf"
    path.write_text(arm())
    for form in (path, arm(), arm().encode()):
        with pytest.raises(InputError, match="MB"):
            read_urdf(form)


def test_xacro_with_includes_arguments_and_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = xacro_tree(tmp_path)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "elsewhere"))
    document = read_urdf(path)
    assert [link.name for link in document.links] == ["tool0", "base", "fore"]
    (elbow,) = document.moving_joints
    np.testing.assert_allclose(elbow.origin[:3, 3], [1.0, 0.0, 0.0])
    (longer,) = read_urdf(path, xacro_arguments={"length": "0.75"}).moving_joints
    np.testing.assert_allclose(longer.origin[:3, 3], [1.5, 0.0, 0.0])


def test_xacro_runs_no_code_that_lies_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = xacro_tree(tmp_path)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "elsewhere"))
    for module in ("yaml", "json", "xacro", "packages", "sk120stiff"):
        (path.parent / f"{module}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    monkeypatch.chdir(path.parent)
    assert read_urdf(path).name == "arm"
    assert not (tmp_path / "ran").exists()


def test_xacro_without_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = xacro_tree(tmp_path)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingPart, match=r"sk120stiff\[xacro\]"):
        read_urdf(path)


@pytest.mark.timeout(60)
def test_xacro_that_never_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xacro, "TIME_LIMIT", 3.0)
    layers = "".join(
        f'<xacro:macro name="m{k}">{f"<xacro:m{k + 1}/>" * 10}</xacro:macro>' for k in range(12)
    )
    path = tmp_path / "bomb.xacro"
    path.write_text(
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f'{layers}<xacro:macro name="m12"><link name="a"/></xacro:macro><xacro:m0/></robot>'
    )
    with pytest.raises(InputError, match="did not finish within 3 s"):
        read_urdf(path)


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package `arm_description` checked out under another name, beside a secret."""
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(variable, raising=False)
    root = tmp_path / "checkout-main"
    for folder in ("urdf", "meshes"):
        (root / folder).mkdir(parents=True)
    (root / "package.xml").write_text("<package><name> arm_description </name></package>")
    (root / "meshes/fore arm.stl").write_text("solid a\nendsolid a\n")
    (root / "meshes/fore.stl").write_text("solid a\nendsolid a\n")
    (root / "urdf/arm.urdf").write_text(arm())
    (tmp_path / "secret.stl").write_text("solid s\nendsolid s\n")
    return root


def found(package: Path, address: str) -> tuple[Path | None, str]:
    path = package / "urdf/arm.urdf"
    return resolve(address, path, package_folders(path))


@pytest.mark.parametrize(
    "address",
    [
        "package://arm_description/meshes/fore.stl",
        "package:///arm_description/meshes/fore.stl",
        "package://arm_description/meshes/../meshes/fore.stl",
        "package://checkout-main/meshes/fore.stl",
        "package://renamed_description/meshes/fore.stl",
        "model://arm_description/meshes/fore.stl",
        "package://arm_description/meshes/fore%20arm.stl",
        "package://arm_description/meshes/fore arm.stl",
        "../meshes/fore.stl",
        "..\\meshes\\fore.stl",
        "{root}/meshes/fore.stl",
        "file://{root}/meshes/fore.stl",
        "file://{root}/meshes/fore%20arm.stl",
    ],
)
def test_addresses_that_lead_somewhere(package: Path, address: str) -> None:
    path, why = found(package, address.format(root=package))
    assert path is not None, why
    assert path.is_file()


@pytest.mark.parametrize(
    "address",
    [
        "package://arm_description/../secret.stl",
        "package://arm_description/meshes/../../secret.stl",
        "package://arm_description/%2e%2e/secret.stl",
        "package://arm_description/..\\secret.stl",
        "package://../secret.stl",
        "package://./../secret.stl",
        "package://arm_description//{tmp}/secret.stl",
        "model://arm_description/../secret.stl",
    ],
)
def test_addresses_that_leave_their_package(package: Path, address: str) -> None:
    path, why = found(package, address.format(tmp=package.parent))
    assert path is None
    assert why


@pytest.mark.parametrize(
    "address", ["http://example.org/a.stl", "package://", "", "x" * 10_000, "a\0b", "nowhere.stl"]
)
def test_addresses_that_lead_nowhere(package: Path, address: str) -> None:
    path, why = found(package, address)
    assert path is None
    assert why


def test_ros_package_path(package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    address = "package://checkout-main/meshes/fore.stl"
    assert resolve(address, None, package_folders(None))[0] is None
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere{os.pathsep}{tmp_path}")
    assert resolve(address, None, package_folders(None))[0] is not None
