"""Small made-up robots for tests, with masses, skew axes and couplings."""

from __future__ import annotations

import numpy as np


def six_axis_arm(seed: int | None = None) -> str:
    """A 6R arm of industrial size. With a seed, axes and offsets are skewed at random."""
    axes = ["0 0 1", "0 1 0", "0 -1 0", "1 0 0", "0 -1 0", "1 0 0"]
    origins = ["0 0 0.5", "0.2 0 0.1", "0 0 1.0", "0.6 0 0.2", "0.5 0 0", "0.1 0 0"]
    turns = ["0 0 0"] * 6
    if seed is not None:
        rng = np.random.default_rng(seed)
        axes = [" ".join(map(repr, rng.normal(size=3).tolist())) for _ in axes]
        turns = [" ".join(map(repr, rng.uniform(-1, 1, 3).tolist())) for _ in turns]
    text = '<robot name="six_axis"><link name="base"/>'
    for index in range(6):
        parent = "base" if index == 0 else f"link_{index}"
        text += (
            f'<joint name="j{index + 1}" type="revolute"><parent link="{parent}"/>'
            f'<child link="link_{index + 1}"/>'
            f'<origin xyz="{origins[index]}" rpy="{turns[index]}"/><axis xyz="{axes[index]}"/>'
            '<limit lower="-3" upper="3" effort="1000" velocity="1"/></joint>'
            f'<link name="link_{index + 1}"><inertial><origin xyz="0.1 0.02 {0.05 * index}"/>'
            f'<mass value="{60 - 9 * index}"/><inertia ixx="2" iyy="2" izz="2" ixy="0" ixz="0" '
            'iyz="0"/></inertial></link>'
        )
    return text + (
        '<joint name="flange" type="fixed"><parent link="link_6"/><child link="tool"/>'
        '<origin xyz="0.15 0.03 -0.02" rpy="0 1.2 0.3"/></joint><link name="tool"/></robot>'
    )


def mimic_tree() -> str:
    """Chained mimics declared before their drivers, continuous and prismatic joints mixed in."""

    def joint(name: str, kind: str, parent: str, child: str, axis: str, extra: str = "") -> str:
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0.3 0.1 0.2" rpy="0.1 -0.2 0.3"/><axis xyz="{axis}"/>'
            f'<limit lower="-1" upper="1" effort="1" velocity="1"/>{extra}</joint>'
        )

    links = "".join(f'<link name="{name}"/>' for name in "abcdef")
    return (
        f'<robot name="mimics">{links}'
        + joint("a_last", "revolute", "a", "b", "0 0 1", '<mimic joint="m" multiplier="-2"/>')
        + joint(
            "m", "revolute", "b", "c", "0 1 0", '<mimic joint="z" multiplier="0.5" offset="0.1"/>'
        )
        + joint("z", "continuous", "c", "d", "1 0 0")
        + joint("s", "prismatic", "d", "e", "0 1 1")
        + joint(
            "t", "prismatic", "e", "f", "1 0 0", '<mimic joint="s" multiplier="3" offset="-0.2"/>'
        )
        + "</robot>"
    )
