"""Arms with closed loops, as URDF text and robot.yaml: opened trees that closures close."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import yaml

from sk120stiff.robot import Robot, load_robot


def joint(
    name: str,
    parent: str,
    child: str,
    xyz: str,
    axis: str = "0 1 0",
    kind: str = "revolute",
    rpy: str = "0 0 0",
    mimic: str = "",
) -> str:
    motion = "" if kind == "fixed" else f'<axis xyz="{axis}"/>'
    if kind in ("revolute", "prismatic"):
        motion += '<limit lower="-3" upper="3" effort="1" velocity="1"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/>{motion}{mimic}</joint>'
    )


def urdf(name: str, *joints: str) -> str:
    text = "".join(joints)
    links = dict.fromkeys(
        part.split('"')[0] for key in ('parent link="', 'child link="') for part in
        text.split(key)[1:]
    )  # fmt: skip
    bodies = "".join(f'<link name="{link}"/>' for link in links)
    return f'<robot name="{name}">{bodies}{text}</robot>'


def write_robot(folder: Path, text: str, **keys: object) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.urdf").write_text(text, encoding="utf-8")
    (folder / "robot.yaml").write_text(yaml.safe_dump(keys), encoding="utf-8")
    return folder


SK120_LOOP = urdf(
    "sk120_loop",
    joint("joint_1_s", "base_link", "link_1_s", "0 0 0", "0 0 1"),
    joint("joint_2_l", "link_1_s", "link_2_l", "0.215 0 0"),
    joint("joint_elbow", "link_2_l", "link_3_u", "0 0 1.1", "0 -1 0"),
    joint("joint_4_r", "link_3_u", "link_4_r", "1.3 0 0.25", "1 0 0"),
    joint("joint_5_b", "link_4_r", "link_5_b", "0 0 0", "0 -1 0"),
    joint("joint_6_t", "link_5_b", "link_6_t", "0 0 0", "1 0 0"),
    joint("flange", "link_6_t", "tool0", "0.23 0 0", kind="fixed", rpy="0 1.5707963267948966 0"),
    joint("joint_3_u", "link_1_s", "crank", "0.215 0 0", "0 -1 0"),
    joint("joint_rod", "crank", "rod", "-0.542 0 0", "0 1 0"),
    joint("crank_pin", "crank", "crank_end", "-0.542 0 0", kind="fixed"),
    joint("rod_pin", "rod", "rod_end", "0 0 1.1", kind="fixed"),
    joint("lever_pin", "link_3_u", "forearm_lever_end", "-0.542 0 0", kind="fixed"),
)
SK120_MOTORS = ["joint_1_s", "joint_2_l", "joint_3_u", "joint_4_r", "joint_5_b", "joint_6_t"]


def sk120_loop(folder: Path, kind: str = "point") -> Robot:
    """The SK120 with its five-bar as a true closed loop."""
    closure = {"name": "five-bar", "frames": ["rod_end", "forearm_lever_end"], "type": kind}
    if kind == "axis":
        closure["axis"] = [0.0, 1.0, 0.0]
    write_robot(
        folder, SK120_LOOP, base_frame="base_link", tool_frame="tool0", actuated=SK120_MOTORS,
        closures=[closure],
        linkages=[{"rod": "rod", "drivers": ["joint_2_l", "joint_3_u"],
                   "corners": ["crank", "crank_end", "rod_end"]}],
    )  # fmt: skip
    return load_robot(folder)


# A turret that carries a four-bar of four different lengths; the tool is on the coupler. Pivots at
# (0, 0) and (0.4, −0.1), driven link 0.5, rocker 0.7, coupler pins 0.45 apart.
FOUR_BAR = urdf(
    "four_bar",
    joint("turret", "base", "column", "0.1 0 0.5", "0 0 1"),
    joint("drive", "column", "driven", "0 0 0"),
    joint("knee", "driven", "coupler", "0 0 0.5"),
    joint("nose", "coupler", "tool", "0.8 0.05 0.3", kind="fixed", rpy="0.2 0.4 -0.3"),
    joint("rock", "column", "rocker", "0.4 0 -0.1"),
    joint("rocker_pin", "rocker", "rocker_end", "0 0 0.7", kind="fixed"),
    joint("coupler_pin", "coupler", "coupler_end", "0.45 0 0", kind="fixed"),
)


def four_bar(folder: Path, kind: str = "point", **closure: object) -> Robot:
    """A four-bar that is no parallelogram on a turret; two coordinates."""
    rule = {"name": "quad", "frames": ["coupler_end", "rocker_end"], "type": kind, **closure}
    if kind == "axis":
        rule.setdefault("axis", [0.0, 1.0, 0.0])
    rule.setdefault("start", {"knee": 0.1, "rock": 0.1})
    write_robot(
        folder, FOUR_BAR, base_frame="base", tool_frame="tool", actuated=["turret", "drive"],
        closures=[rule],
    )  # fmt: skip
    return load_robot(folder)


# A boom lifted by a cylinder: the drive slides, two pins follow; the boom carries a wrist.
CYLINDER = urdf(
    "cylinder",
    joint("swing", "floor", "post", "0 0 0.2", "0 0 1"),
    joint("lift", "post", "boom", "0 0 0.8", "0 -1 0"),
    joint("wrist", "boom", "hand", "1.5 0 0.1", "1 0 0"),
    joint("mount", "hand", "tool", "0.2 0.1 0", kind="fixed"),
    joint("foot", "post", "barrel", "0.3 0 0.1", "0 -1 0"),
    joint("piston", "barrel", "stick", "0 0 0", "0 0 1", kind="prismatic"),
    joint("head", "boom", "ear", "0.6 0 0", kind="fixed"),
)


def cylinder(folder: Path) -> Robot:
    """A boom that a sliding drive lifts through a triangle."""
    write_robot(
        folder, CYLINDER, base_frame="floor", tool_frame="tool",
        closures=[{"frames": ["stick", "ear"], "dependent": ["lift", "foot"],
                   "start": {"piston": 0.76, "foot": -0.4}}],
    )  # fmt: skip
    return load_robot(folder)


def differences(function, a: np.ndarray, step: float = 1e-3) -> np.ndarray:
    """Derivative along a last axis by the coordinates, fourth order."""
    columns = []
    for e in step * np.eye(len(a)):
        near, far = function(a + e) - function(a - e), function(a + 2 * e) - function(a - 2 * e)
        columns.append((8.0 * near - far) / (12.0 * step))
    return np.stack(columns, axis=-1)
