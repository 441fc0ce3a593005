"""An arm that hangs from a wall or a ceiling, and whose file does not say so."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.checks import gravity_direction
from sk120stiff.identify.positions.checks.gravity_direction import refuse_another_gravity
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from tests.positions.arm import Arm, Array, errors, poses, tracked, write
from tests.positions.loaded_arm import MARKERS, SPRINGS, rests
from tests.positions.test_distances import POINTS
from tests.positions.test_forms import rows

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
UP = {"ceiling": [0.0, 0.0, -1.0], "wall": [-1.0, 0.0, 0.0], "slope": [0.6, 0.0, 0.8]}
BALANCED = np.array([1.0, -1.5, 1.0, 1.0, 1.0, 1.0])  # joint 2 is lifted by more than it bears


def read(
    folder: Path, up: list[float], more: str = "", *, count: int = 60, waves: float = 0.0,
    yields: Array | None = None,
) -> tuple[sk.Robot, Measurements]:  # fmt: skip
    """Positions of an arm whose joint frames are all off and that hangs somehow."""
    rng = np.random.default_rng(7)
    arm = errors(3)
    arm.up, arm.waves = np.array(up), waves * rng.normal(size=(6, 2))
    arm.compliance = arm.compliance * (1.0 if yields is None else yields)
    a = poses(count, 11)
    x = tracked(arm.stands(a)[0]) + 2e-5 * rng.normal(size=(count, 3))
    data = sk.read(write(folder, a, x, FIT + more))
    return sk.load_robot(data.robot, base="base", tool="tool"), data


def told(robot: sk.Robot, data: Measurements) -> tuple[str, ...]:
    data = data.with_joints(robot.actuated)
    base = calibrate(Model(robot), data, geometry=False, waves=False, shared=False)
    return refuse_another_gravity(base, data)


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ("ceiling", r"gravity: \[0, 0, 9.81\]"),
        ("wall", r"gravity: \[9.81, 0, 0\]"),
        ("slope", r"gravity: \[-[56][.\d]*, -?0[.\d]*, -7[.\d]*\]"),
    ],
)
def test_the_direction_is_told_with_what_to_write(tmp_path: Path, how: str, says: str) -> None:
    robot, data = read(tmp_path, UP[how], waves=2e-4)
    with pytest.raises(InputError, match=says) as error:
        told(robot, data)
    assert "gravity: [0, 0, -9.81], if that is right" in error.value.remedy


def test_a_base_that_is_not_level_is_told_and_stops_nothing(tmp_path: Path) -> None:
    tilt = np.radians(3.0)  # told to some 0.3 deg by so many
    robot, data = read(tmp_path, [0.0, np.sin(tilt), np.cos(tilt)], count=400)
    (line,) = told(robot, data)
    found = re.match(r"The arm sags as if its base stood (\S+) deg off level", line)
    assert found is not None and abs(float(found[1]) - 3.0) < 0.5
    assert re.search(r"gravity: \[-?0[.\d]*, -0\.[45]\d?, -9\.\d+\]", line), line
    robot, data = read(
        tmp_path,
        [0.0, np.sin(tilt), np.cos(tilt)],
        f"gravity: [0, {-9.81 * np.sin(tilt)}, {-9.81 * np.cos(tilt)}]\n",
        count=400,
    )
    assert told(robot.under(data.gravity), data) == ()


@pytest.mark.parametrize("verb", [sk.fit, sk.explain])
def test_both_verbs_stop(tmp_path: Path, verb: object) -> None:
    robot, data = read(tmp_path, UP["ceiling"])
    model = sk.base_model(robot) if verb is sk.fit else Model(robot)
    with pytest.raises(InputError, match="as if gravity were"):
        verb(model, data)  # type: ignore[operator]


def test_what_the_file_states_is_told_and_kept(tmp_path: Path) -> None:
    robot, data = read(tmp_path, UP["ceiling"], "gravity: [0, 0, -9.80665]\n")
    (line,) = told(robot, data)
    assert line.startswith("The arm sags as if gravity were [0, 0, 9.81]")
    found = sk.fit(sk.base_model(robot), data)
    assert isinstance(found, Calibration) and line[:40] in " ".join(found.notes)


@pytest.mark.parametrize("more", ["gravity: [0, 0, 9.80665]\n"])
def test_a_ceiling_that_is_stated_is_well(tmp_path: Path, more: str) -> None:
    robot, data = read(tmp_path, UP["ceiling"], more)
    assert told(robot.under(data.gravity), data) == ()
    found = sk.fit(sk.base_model(robot), data)
    assert isinstance(found, Calibration)
    values = np.array([p.internal for p in found.parameters if p.effect.joint_spring])
    std = np.array([p.internal_std for p in found.parameters if p.effect.joint_spring])
    true = errors(3).compliance
    seen = std > 0.0
    assert np.all(np.abs(values - true)[seen] < 4.0 * std[seen]) and seen.sum() >= 4


@pytest.mark.parametrize(
    ("waves", "yields", "count"),
    [
        (0.0, None, 60),
        (3e-4, None, 25),
        (3e-4, None, 120),
        (2e-4, np.zeros(6), 60),
        (0.0, BALANCED, 25),
        (2e-4, BALANCED, 60),
        (2e-4, BALANCED, 120),
    ],
)
def test_nothing_else_looks_like_it(
    tmp_path: Path, waves: float, yields: Array | None, count: int
) -> None:
    """Springs, waves that springs would stand for, and a balancer that lifts too much."""
    floor = [0.0, 0.0, 1.0]
    assert told(*read(tmp_path, floor, count=count, waves=waves, yields=yields)) == ()


@pytest.mark.parametrize("other", [0.0, 0.5])
def test_a_balancer_that_nothing_else_tells_from_a_ceiling(
    monkeypatch: pytest.MonkeyPatch, other: float
) -> None:
    """One spring pushes, another pulls: that springs of either sign explain more is what counts."""
    by_axis = np.zeros((3, 60, 2))
    by_axis[2] = np.random.default_rng(5).normal(size=(60, 2))
    gap = by_axis[2] @ [3.0, -other] + 1e-3 * np.ones(60)
    sag = gravity_direction._Sag(by_axis, np.zeros((60, 2)), gap, 58, np.full(2, np.inf))
    monkeypatch.setattr(gravity_direction._Sag, "of", classmethod(lambda _cls, _found: sag))
    robot = SimpleNamespace(gravity_in_base=np.array([0.0, 0.0, -9.81]))
    problem = SimpleNamespace(channels=SimpleNamespace(present=("position",)))
    found = SimpleNamespace(model=SimpleNamespace(robot=robot), problem=problem)
    readings = SimpleNamespace(gravity=np.array([0.0, 0.0, -9.81]))
    assert bool(refuse_another_gravity(found, readings)) == (other == 0.0)  # type: ignore[arg-type]


def test_an_arm_without_masses_or_gravity_says_nothing(tmp_path: Path) -> None:
    robot, data = read(tmp_path, UP["ceiling"], "massless")
    assert told(robot, data) == ()
    assert told(robot.under(np.zeros(3)), data) == ()


@pytest.mark.parametrize("weighs", [False, True])
def test_loads_that_pull_to_a_side_are_no_gravity(tmp_path: Path, weighs: bool) -> None:
    a = np.repeat(poses(40, 3), 2, axis=0)
    force = 500.0 * np.random.default_rng(2).normal(size=(80, 3))
    force[::2] = 0.0
    origin, axes = rests(Arm(compliance=SPRINGS, weighs=weighs), a, force)
    x = origin + np.einsum("nij,j->ni", axes, MARKERS["A"])
    x = tracked(x + 2e-5 * np.random.default_rng(1).normal(size=x.shape))
    cells = [",".join(f"{v:g}" for v in f) for f in force]
    settings = FIT + "force: {frame: base, point: {xyz: [0, 0, 100], unit: mm}}\n"
    path = write(
        tmp_path, a, x, settings + ("" if weighs else "massless"), more=",fx[N],fy[N],fz[N]",
        cells=cells,
    )  # fmt: skip
    data = sk.read(path)
    assert told(sk.load_robot(data.robot, base="base", tool="tool"), data) == ()


@pytest.mark.parametrize("ask", [sk.fit, sk.explain])
def test_wires_show_it_too(tmp_path: Path, ask: Any) -> None:
    """Distances to three fixed points whose places are known, of an arm on a ceiling."""
    arm = errors(3)
    arm.up = np.array(UP["ceiling"])
    a = np.repeat(poses(40, 11), 3, axis=0)
    at = np.tile(POINTS, (40, 1))
    far = np.linalg.norm(arm.stands(a)[0] - at, axis=1)
    far += 2e-5 * np.random.default_rng(7).normal(size=len(far))
    cells = rows(np.column_stack([1e3 * far, tracked(at)]))
    nothing = np.full((len(a), 3), np.nan)
    data = sk.read(write(tmp_path, a, nothing, FIT, more=",l[mm],ax[m],ay[m],az[m]", cells=cells))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    with pytest.raises(InputError, match=r"as if gravity were \[.*9.8\d*\] in axes of the base"):
        ask(sk.base_model(robot), data)
