"""The arms of the benchmark: the SK120, two fixed URDFs, and invented ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .arm import Arm, Typical
from .urdf_arm import read_urdf_arm, urdf_arm

FOLDER = Path(__file__).resolve().parents[1] / "robots"


def six_axis() -> Arm:
    """A light 6R arm with offset wrist and masses."""
    typical = Typical(
        joint={
            "pan": 2.5e4,
            "lift": 2.5e4,
            "elbow": 1.8e4,
            "wrist_1": 6e3,
            "wrist_2": 6e3,
            "wrist_3": 6e3,
        },
        tilt=2e5,
        rocking=4e5,
        sliding=1.5e7,
        bending=1.5e5,
        torsion=1e5,
        tool=4e4,
        tool_sliding=1e7,
        force=100.0,
        lost_motion=2e-4,
        friction=1e-4,
    )
    return read_urdf_arm(
        FOLDER / "six_axis.urdf",
        name="six_axis", reference="six_axis.urdf", base="base_link", tool="tool0",
        typical=typical,
    )  # fmt: skip


def telescope() -> Arm:
    """A heavy arm with a sliding boom and masses."""
    typical = Typical(
        joint={
            "yaw": 9e5,
            "pitch": 6e5,
            "extend": 2e7,
            "roll": 1.5e5,
            "nod": 1.2e5,
            "spin": 8e4,
        },
        tilt=4e6,
        rocking=8e6,
        sliding=6e7,
        bending=2e6,
        torsion=1.5e6,
        tool=2e5,
        tool_sliding=3e7,
        force=400.0,
        lost_motion=1.5e-4,
        friction=6e-5,
    )
    return read_urdf_arm(
        FOLDER / "telescope.urdf",
        name="telescope", reference="telescope.urdf", base="floor", tool="plate",
        typical=typical,
    )  # fmt: skip


def _rod_urdf(name: str, joints: list[tuple], links: list[str], tool: str, last: str) -> str:  # type: ignore[type-arg]
    parts = [f'<?xml version="1.0"?>\n<robot name="{name}">']
    for link, (mass, centre) in links:  # type: ignore[misc]
        if mass <= 0.0:
            parts.append(f'  <link name="{link}"/>')
            continue
        inertia = f"{mass * 0.02:.4f}"
        parts.append(
            f'  <link name="{link}"><inertial><origin xyz="{centre}"/><mass value="{mass:.2f}"/>'
            f'<inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/>'
            "</inertial></link>"
        )
    for joint, kind, parent, child, xyz, axis, low, high in joints:
        place = " ".join(f"{v:.4f}" for v in xyz)
        parts.append(
            f'  <joint name="{joint}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{child}"/><origin xyz="{place}"/><axis xyz="{axis}"/>'
            f'<limit lower="{low}" upper="{high}" effort="1000" velocity="2"/></joint>'
        )
    parts.append(f'  <link name="{tool}"/>')
    parts.append(
        f'  <joint name="{tool}_mount" type="fixed"><parent link="{last}"/><child link="{tool}"/>'
        '<origin xyz="0.12 0 0" rpy="0 1.5707963267948966 0"/></joint>\n</robot>\n'
    )
    return "\n".join(parts)


def random_arm(rng: np.random.Generator) -> tuple[Arm, str]:
    """An arm nobody has seen, and its URDF: 6R, 7R, or 6R on a rail, of random size."""
    kind = rng.choice(["six", "seven", "rail"])
    size = float(np.exp(rng.uniform(np.log(0.5), np.log(1.4))))
    word = "".join(rng.choice(list("bcdfgklmnprstvz"), 2)) + str(rng.integers(10, 99))
    massive = rng.random() < 0.8
    rows: list[tuple[str, str, tuple[float, float, float], str, float, float]] = []
    if kind == "rail":
        rows.append(("rail", "prismatic", (0, 0, 0.3), "0 1 0", -1.5 * size, 1.5 * size))
    rows.append(("a", "revolute", (0, 0, size * rng.uniform(0.2, 0.5)), "0 0 1", -2.6, 2.6))
    rows.append(
        ("b", "revolute", (size * rng.uniform(0, 0.3), 0, size * rng.uniform(0.1, 0.4)), "0 1 0",
         -0.9, 1.3)
    )  # fmt: skip
    if kind == "seven":
        rows.append(("e", "revolute", (0, 0, size * rng.uniform(0.2, 0.4)), "0 0 1", -2.0, 2.0))
    upper = size * rng.uniform(0.5, 0.9)
    rows.append(("c", "revolute", (0, 0, upper), "0 -1 0", -1.0, 1.2))
    fore = (size * rng.uniform(0.5, 1.0), 0, size * rng.uniform(0.0, 0.2))
    rows.append(("d", "revolute", fore, "1 0 0", -2.8, 2.8))
    rows.append(("f", "revolute", (size * rng.uniform(0.0, 0.1), 0, 0), "0 -1 0", -1.9, 1.9))
    rows.append(("g", "revolute", (size * rng.uniform(0.05, 0.12), 0, 0), "1 0 0", -3.0, 3.0))

    links = [(f"{word}_base", (0.0, "0 0 0"))]
    joints = []
    stiff: dict[str, float] = {}
    scale = size**3
    sizes = {"rail": 2e7 * size, "a": 8e5, "b": 6e5, "e": 5e5, "c": 4e5, "d": 1e5, "f": 8e4,
             "g": 5e4}  # fmt: skip
    for number, (key, sort, xyz, axis, low, high) in enumerate(rows):
        link = f"{word}_link{number + 1}"
        weight = 60.0 * scale * 0.7**number if massive else 0.0
        ahead = "0.05 0 0.1" if axis != "1 0 0" else "0.03 0 0"
        links.append((link, (weight, ahead)))
        name = f"{word}_joint_{key}"
        joints.append((name, sort, links[-2][0], link, xyz, axis, round(low, 3), round(high, 3)))
        spread = float(np.exp(rng.normal(0, 0.3)))
        stiff[name] = sizes[key] * spread * (1.0 if key == "rail" else scale)
    tool = f"{word}_tool"
    text = _rod_urdf(f"{word}_arm", joints, links, tool, links[-1][0])
    typical = Typical(
        joint=stiff, tilt=4e6 * scale, rocking=8e6 * scale, sliding=6e7 * size,
        bending=2e6 * scale * size, torsion=1.5e6 * scale * size, tool=2e5 * scale,
        tool_sliding=3e7 * size, force=300.0 * size**2,
    )  # fmt: skip
    arm = urdf_arm(
        text, name=f"{word}_arm", reference=f"{word}_arm.urdf", base=f"{word}_base", tool=tool,
        typical=typical,
    )  # fmt: skip
    return arm, text


def urdf_text(arm: Arm) -> str | None:
    """The URDF file to lay beside the data; None for the SK120, which the product brings."""
    path = FOLDER / arm.reference
    return path.read_text(encoding="utf-8") if path.suffix == ".urdf" else None


def varied(arm: Arm, rng: np.random.Generator) -> dict[str, float]:
    """Base springs (compliances) scattered around the usual values."""
    return {
        name: float(np.exp(rng.normal(0.0, 0.2)) / stiffness)
        for name, stiffness in arm.typical.joint.items()
    }
