"""How long an arm is: slides count as far as they go, the rail of a whole arm does not."""

from __future__ import annotations

from pathlib import Path

import pytest

import sk120stiff as sk
from sk120stiff.robot.anatomy import arm_length


def arm(folder: Path, kinds: str, travel: float) -> sk.Robot:
    """Links of 0.5 m, joints that slide (s) or turn (t) in turn about and along y and z."""
    links, joints = ['<link name="l0"/>'], []
    for k, kind in enumerate(kinds):
        name, far = ("prismatic", travel) if kind == "s" else ("revolute", 3.0)
        links.append(f'<link name="l{k + 1}"/>')
        joints.append(
            f'<joint name="j{k}" type="{name}"><parent link="l{k}"/><child link="l{k + 1}"/>'
            f'<origin xyz="{0.5 if k else 0.0} 0 0"/><axis xyz="0 {k % 2} {1 - k % 2}"/>'
            f'<limit lower="0" upper="{far}" effort="1" velocity="1"/></joint>'
        )
    path = folder / "arm.urdf"
    path.write_text(f'<robot name="arm">{"".join([*links, *joints])}</robot>')
    return sk.load_robot(path)


@pytest.mark.parametrize(
    ("kinds", "length"),
    [
        ("tttttt", 2.5),
        ("stttttt", 3.0),  # a rail
        ("sssttt", 2.5 + 3 * 4.0),  # a gantry with a wrist
        ("ttst", 1.5 + 4.0),  # a SCARA
        ("ssstttttt", 4.0),  # an arm that hangs on a gantry
    ],
)
def test_slides_count_unless_they_carry_a_whole_arm(
    tmp_path: Path, kinds: str, length: float
) -> None:
    assert arm_length(arm(tmp_path, kinds, 4.0)) == pytest.approx(length, rel=1e-12)
