"""Universal Robots URScript: ``movej`` by joints [rad], ``movel`` to poses [m, rotation vector].

The URScript manual, module motion: joint positions are lists of six numbers, a pose is a position
and an axis-angle vector; poses are those of the tool centre point, in the robot's base.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.programs.language import Language, numbers
from sk120stiff.programs.program import BLEND, Program, Setting, Targets, positive
from sk120stiff.robot.rotations import rotation_of, rotation_vector

_MOVE = re.compile(r"move(j|l)\(.*?v=([^,)]*)")
_JOINTS = re.compile(r"(?<!p)\[([^]]*)\]")
_POSE = re.compile(r"p\[([^]]*)\]")


class UrScript(Language):
    """URScript."""

    name = "urscript"
    ending = ".script"
    title = "URScript"
    template = "ur.script.j2"
    settings: ClassVar[Mapping[str, Setting]] = {
        "a": Setting("0.5", "acceleration of straight moves [m/s^2]"),
        "joint_a": Setting("0.8", "acceleration of moves by joints [rad/s^2]"),
        "joint_v": Setting("0.2", "speed of moves by joints [rad/s]"),
        "blend": BLEND,
    }
    axis_digit = 1e-9 * 180.0 / np.pi
    angle_digit = 1e-9
    speed_digit = 1e-7
    most_axes = 6

    def content(self, program: Program) -> dict[str, object]:
        """Joints and pose of every point."""
        if len(program.axes) != 6 or any(program.slides):
            raise InputError(
                f"URScript is for six turning joints, this arm has {len(program.axes)} joints, "
                f"{sum(program.slides)} of which slide",
                where=f"--to {self.name}",
                remedy="Choose another language, or --to csv.",
            )
        for key in ("a", "joint_a", "joint_v"):
            positive(program.settings, key)
        blend = positive(program.settings, "blend", zero=True)
        turn = rotation_vector(program.rotation)
        return {
            "blend": f", r={1e-3 * blend:g}" if blend else "",
            "points": [
                {
                    "joints": _listed(program.joints[k]),
                    "pose": _listed(np.concatenate([program.position[k], turn[k]])),
                    "speed": f"{program.speed[k]:.7f}",
                    "line": program.lines[k],
                }
                for k in range(program.count)
            ],
        }

    def read(self, text: str) -> Targets:
        """Of each move, what it goes by and what its comment says."""
        joints, poses, speeds = [], [], []
        for line in text.splitlines():
            if match := _MOVE.match(line.strip()):
                speeds.append(float(match[2]) if match[1] == "l" else np.nan)
                joints.append(numbers(_JOINTS.findall(line)[0]))
                poses.append(numbers(_POSE.findall(line)[0]))
        pose = np.array(poses)
        return Targets(
            pose[:, :3], rotation_of(pose[:, 3:]), np.degrees(np.array(joints)), np.array(speeds)
        )


def _listed(values: Array) -> str:
    return ", ".join(f"{x:.9f}" for x in values)
