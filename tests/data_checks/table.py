"""How many slips are found, and how often sound readings are doubted: the counts behind a table."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sk120stiff import base_model, load_robot
from sk120stiff.data_checks import find_slip, look, refuse_unbelievable
from sk120stiff.data_checks.sheet import sheet_of
from sk120stiff.data_checks.slips import floors
from sk120stiff.errors import Refusal
from sk120stiff.measurements import read_measurements
from sk120stiff.model import joint_spring_model
from tests.data_checks.random_arms import random_arm
from tests.data_checks.readings import PUBLIC, UR5, Arm, sk120, spoilt
from tests.hidden.generator.build import build
from tests.hidden.generator.writing import write_case

ARMS = {
    "ur3": PUBLIC / "ur_description/urdf/ur3_robot.urdf",
    "ur5": UR5,
    "ur10": PUBLIC / "ur_description/urdf/ur10_robot.urdf",
    "panda": PUBLIC / "panda_description/urdf/panda.urdf",
    "xarm7": PUBLIC / "xarm_description/urdf/xarm7.urdf",
    "z1": PUBLIC / "z1_description/urdf/z1.urdf",
}
# slip, and what must stand in the finding
SLIPS = (
    ("sign,0", "wrong sign"),
    ("sign,1", "wrong sign"),
    ("sign,2", "wrong sign"),
    ("sign,3", "wrong sign"),
    ("sign,4", "wrong sign"),
    ("sign,5", "wrong sign"),
    ("exchanged,0,1", "exchanged"),
    ("exchanged,1,2", "exchanged"),
    ("exchanged,3,5", "exchanged"),
    ("degrees labelled rad", "deg labelled rad"),
    ("degrees labelled rad,1", "deg labelled rad"),
    ("radians labelled deg", "rad labelled deg"),
    ("force of the tool", "the force looks as if it were given in tool axes"),
    ("displacement of the tool", "the displacement looks as if it were given in tool axes"),
    ("both of the tool", "both were given in tool axes"),
    ("unit of one axis,1", "dy looks as if it were in another unit"),
    ("readings shifted,1", "1 row too low"),
    ("readings shifted,-1", "1 row too high"),
    ("loads shifted,1", "1 row too low"),
    ("readings reversed", "reverse order"),
    ("floor", "measured against the floor"),
    ("shuffled", "refused"),
    ("random", "refused"),
)


@dataclass(frozen=True)
class Outcome:
    """What was said of one file."""

    what: str
    arm: str
    right: bool
    said: str


def spoilt_readings(seeds: Sequence[int], arms: Sequence[str]) -> Iterator[Outcome]:
    """Every slip on drawn readings of every arm, and on the SK120."""
    for name in arms:
        for seed in seeds if name != "sk120" else seeds[:1]:
            arm = sk120() if name == "sk120" else _arm(name, seed)
            for slip, words in SLIPS:
                if slip == "floor" and not has_a_floor(arm):
                    continue
                said = _said(arm, slip)
                yield Outcome(slip, name, words in said, said)


def has_a_floor(arm: Arm) -> bool:
    """Do the second and the third joint turn in one plane? On arms of seven axes they do not."""
    sheet = sheet_of(arm.robot, arm.readings)
    return sheet is not None and any(k == 2 for k, _, _ in floors(sheet))


def _arm(name: str, seed: int) -> Arm:
    return random_arm(load_robot(str(ARMS[name])), seed)


def _said(arm: Arm, slip: str) -> str:
    data = spoilt(arm, slip)
    if slip in ("shuffled", "random"):
        return _refused(arm, data)
    found = find_slip(arm.robot, data)
    return "" if found is None else found.said


def _refused(arm: Arm, data) -> str:
    try:
        refuse_unbelievable(look(arm.model, data), arm.model, data)
    except Refusal as refusal:
        return f"refused: {refusal}"
    return ""


def sound_readings(seeds: Sequence[int], arms: Sequence[str]) -> Iterator[Outcome]:
    """Drawn readings without a slip: every second with a missing effect."""
    for name in arms:
        for seed in seeds:
            arm = random_arm(load_robot(str(ARMS[name])), seed, effect=seed % 4 < 3)
            yield _sound(arm, name)


def blind_readings(levels: Sequence[str], count: int, seed: int) -> Iterator[Outcome]:
    """Cases of the blind benchmark: other code, effects known and foreign, messy noise."""
    for level in levels:
        for number in range(count):
            with tempfile.TemporaryDirectory() as folder:
                root = Path(folder)
                write_case(build(level, seed, number), "case", root / "cases", root / "truth")
                data = read_measurements(root / "cases" / "case" / "train.csv")
                robot = load_robot(str(data.robot), base=data.base_frame, tool=data.tool_frame)
                model = base_model(robot) or joint_spring_model(robot)
                yield _sound(Arm(model, data), level)


def _sound(arm: Arm, name: str) -> Outcome:
    doubts = look(arm.model, arm.readings)
    said = " ".join(doubts.sentences) + _refused(arm, arm.readings)
    return Outcome("sound", name, not said, said)
