"""Sizes at which a command must stay linear: processor time and peak memory of each."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from sk120stiff import base_model, load_robot, write_measurements
from sk120stiff.measurements import Measurements
from tests.attacks.judge import Verdict, apart
from tests.data_checks.random_arms import random_arm

ROBOT = "motoman_sk120"
MEMORY = 1.0e9  # bytes at most
LIMIT = 180.0  # s of processor time: thirty joints have hundreds of candidates
READINGS, PATH_POINTS, JOINTS = 100_000, 100_000, 30
# The last words of a process: what it has used at most [kB]. (`ru_maxrss` counts the parent too.)
PEAK = (
    "import atexit; atexit.register(lambda: print('peak', next(line.split()[1] for line in "
    "open('/proc/self/status') if line.startswith('VmHWM')), file=sys.stderr))"
)


def long_chain(joints: int) -> str:
    """URDF of a serial arm: 0.1 m between joints that turn about z, y and x by turns."""
    links = "".join(f'<link name="l{k}"/>' for k in range(joints + 1))
    axes = ("0 0 1", "0 1 0", "1 0 0")
    turns = "".join(
        f'<joint name="j{k}" type="revolute"><parent link="l{k}"/><child link="l{k + 1}"/>'
        f'<origin xyz="0.02 0.01 0.1"/><axis xyz="{axes[k % 3]}"/>'
        '<limit lower="-1" upper="1" effort="100" velocity="1"/></joint>'
        for k in range(joints)
    )
    return f'<robot name="chain">{links}{turns}</robot>'


def many_readings(folder: Path, count: int) -> list[str]:
    """`identify` with that many readings, four to a pose."""
    arm = random_arm(load_robot(ROBOT), 1, poses=count // 4)
    write_measurements(replace(arm.readings, robot=ROBOT), folder / "many.csv")
    return ["identify", "many.csv", "--out", "found.yaml"]


def long_path(folder: Path, count: int) -> list[str]:
    """`compensate` along that many points."""
    model = base_model(load_robot(ROBOT))
    assert model is not None
    way = np.linspace(0.0, 40.0, count)
    angles = np.column_stack([30.0 * np.sin(way + k) for k in range(6)]) + [0, 10, -30, 0, -40, 0]
    load = np.column_stack([100.0 * np.cos(way), 50.0 * np.sin(way), -300.0 + 0.0 * way])
    head = ",".join([f"{name}[deg]" for name in model.robot.actuated] + ["fx[N]", "fy[N]", "fz[N]"])
    np.savetxt(
        folder / "path.csv", np.hstack([angles, load]), "%.5f", ",", header=head, comments=""
    )
    return ["compensate", ROBOT, "path.csv", "--out", "commands.csv"]


def many_joints(folder: Path, count: int) -> list[str]:
    """`explain` of an arm with that many joints."""
    (folder / "chain.urdf").write_text(long_chain(count), encoding="utf-8")
    robot = load_robot(folder / "chain.urdf")
    data: Measurements = random_arm(robot, 3, poses=count).readings
    write_measurements(replace(data, robot="chain.urdf"), folder / "chain.csv")
    return ["explain", "chain.csv", "--out", "answer"]


SIZES: dict[str, tuple[Callable[[Path, int], list[str]], int]] = {
    "readings": (many_readings, READINGS),
    "path points": (long_path, PATH_POINTS),
    "joints": (many_joints, JOINTS),
}


def load_sizes(folder: Path, share: float = 1.0) -> Iterator[Verdict]:
    """Every size, or a share of it: an answer in bounded time and memory."""
    folder.mkdir(parents=True, exist_ok=True)
    for what, (made, count) in SIZES.items():
        words = made(folder, int(share * count))
        yield measured(f"{int(share * count)} {what}", words, folder)


def measured(attack: str, words: list[str], folder: Path, memory: float = MEMORY) -> Verdict:
    """Run in a process of its own; the peak of its memory counts too."""
    said = folder / "said.txt"
    with said.open("wb") as stream:
        found = apart(
            attack, words, before=PEAK, cwd=folder, codes=(0,), limit=LIMIT, stderr=stream
        )
    text = said.read_text(encoding="utf-8", errors="replace")
    told = re.search(r"peak (\d+)", text)
    peak = 1024.0 * int(told[1]) if told else np.inf
    loss = found.loss and f"{found.loss} {text[-300:]}"
    if not loss and peak > memory:
        loss = f"{peak / 1e9:.2f} GB of memory"
    return Verdict(attack, loss, found.seconds, f"{found.seconds:.1f} s, {peak / 1e9:.2f} GB")
