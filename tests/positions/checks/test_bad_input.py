"""Slips of the pen in positions: told by the rigid arm before anything is fitted."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.cli.main import main
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.words import findings
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.placing.placing import Placing, place
from sk120stiff.robot import Robot
from tests.hidden.generator.robots import random_arm
from tests.positions.arm import Array, tracked

LIBRARY = next(Path(sys.prefix).glob("lib/python*/site-packages/cmeel.prefix/share"))
ROBOTS = LIBRARY / "example-robot-data" / "robots"
PUBLIC = {
    "ur5": (ROBOTS / "ur_description/urdf/ur5_robot.urdf", "base_link", "tool0"),
    "panda": (ROBOTS / "panda_description/urdf/panda.urdf", "panda_link0", "panda_link8"),
}
ARMS = ("ur5", "panda", "random")
FIT = "point: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
MARKERS = {"A": (20.0, 0.0, 60.0), "B": (-20.0, 0.0, 60.0), "C": (0.0, 20.0, 60.0)}  # mm, a nest
PLACES = ", ".join(f"{k}: {{xyz: {list(v)}, unit: mm}}" for k, v in MARKERS.items())
POINTS = f"points: {{{PLACES}}}\n"
BEFORE = {"A": "B", "B": "C", "C": "A"}


class Campaign:
    """Positions of an arm whose joints are a milliradian off, and the file that says so."""

    def __init__(self, name: str, folder: Path, count: int = 60) -> None:
        if name == "random":
            arm, text = random_arm(np.random.default_rng(11))  # six joints that turn
            urdf, base, tool = folder / "arm.urdf", arm.base_frame, arm.tool_frame
            urdf.write_text(text)
        else:
            urdf, base, tool = PUBLIC[name]
        self.robot: Robot = sk.load_robot(str(urdf), base=base, tool=tool)
        self.folder = folder
        self.head = f"robot: {urdf}\nbase_frame: {base}\ntool_frame: {tool}\n"
        self.rng = np.random.default_rng(5)
        low, high = np.maximum(self.robot.lower, -2.0), np.minimum(self.robot.upper, 2.0)
        self.a = self.rng.uniform(low, high, (count, self.robot.n))
        self.off = 1e-3 * self.rng.normal(size=self.robot.n)
        self.x = self.seen(np.tile([0.05, -0.08, 0.12], (count, 1)))

    def seen(self, marker: Array) -> Array:
        s = self.robot.screws(self.a + self.off)
        x = s.frame_position + np.einsum("nij,nj->ni", s.rotation, marker)
        return tracked(x) + 5e-5 * self.rng.normal(size=x.shape)

    def placed(
        self, a: Array, x: Array, settings: str = FIT, *,
        angle: str = "deg", length: str = "mm", labels: Sequence[str] | None = None,
    ) -> Placing:  # fmt: skip
        """What comes of placing angles and positions in the units of their headers."""
        self.readings = self.written(a, x, settings, angle=angle, length=length, labels=labels)
        found = place(self.robot, self.readings)
        assert found is not None
        return found

    def written(
        self, a: Array, x: Array, settings: str, *, angle: str = "deg", length: str = "mm",
        labels: Sequence[str] | None = None, frame: str = "unknown",
    ) -> Measurements:  # fmt: skip
        """The file read; what is not a number is a blank cell."""
        header = [f"{name}[{angle}]" for name in self.robot.actuated]
        header += [f"{axis}[{length}]" for axis in "xyz"]
        lines = [",".join(header + (["marker"] if labels is not None else []))]
        for k, row in enumerate(np.column_stack([a, x])):
            cells = ["" if np.isnan(v) else f"{v:.10g}" for v in row] + (
                [] if labels is None else [labels[k]]
            )
            lines.append(",".join(cells))
        path = self.folder / "readings.csv"
        path.write_text("\n".join(lines) + "\n")
        path.with_suffix(".yaml").write_text(f"{self.head}position: {{frame: {frame}}}\n{settings}")
        return sk.read(path).with_joints(self.robot.actuated)


Spoil = Callable[[Array, Array, int], tuple[Array, Array]]  # degrees, mm, joints


def _exchanged(a: Array, i: int, j: int) -> Array:
    a = a.copy()
    a[:, [i, j]] = a[:, [j, i]]
    return a


SLIPS: dict[str, tuple[Spoil, str]] = {
    "radians": (lambda a, x, n: (np.radians(a), x), "angles look like radians, not degrees"),
    "metres": (lambda a, x, n: (a, x / 1e3), "look 1000 times too small.*: m?"),
    "inches": (lambda a, x, n: (a, x / 25.4), "in another unit.*: in?"),
    "one joint": (
        lambda a, x, n: (np.where(np.arange(n) == 1, np.radians(a), a), x),
        "column of .* looks like radians",
    ),
    "mirrored": (lambda a, x, n: (a, x * [1, -1, 1]), "look mirrored"),
    "two axes": (lambda a, x, n: (a, x[:, [1, 0, 2]]), "two axes are swapped"),
    "two joints": (lambda a, x, n: (_exchanged(a, 1, 2), x), "look exchanged"),
    "the last two": (lambda a, x, n: (_exchanged(a, n - 2, n - 1), x), "look exchanged"),
    "a sign": (lambda a, x, n: (a * np.where(np.arange(n) == 2, -1, 1), x), "zeros or signs"),
    "rows apart": (lambda a, x, n: (a, np.roll(x, 7, axis=0)), "are of this robot.*rows of joints"),
}  # fmt: skip


@pytest.mark.parametrize("name", ARMS[1:])
def test_each_slip_is_told_with_its_remedy(name: str, tmp_path: Path) -> None:
    arm = Campaign(name, tmp_path)
    a, x, n = np.degrees(arm.a), 1e3 * arm.x, arm.robot.n
    good = arm.placed(a, x)
    assert good.rms < 3e-3 and not good.wild.any() and not good.notes
    for spoil, said in SLIPS.values():
        with pytest.raises(InputError, match=said) as caught:
            arm.placed(*spoil(a, x, n))
        assert "mm are left after the best placing" in str(caught.value)
    with pytest.raises(InputError, match="degrees, not radians"):
        arm.placed(a, x, angle="rad")
    with pytest.raises(InputError, match=r"1000 times too large.*: mm?"):
        arm.placed(a, x, length="m")


@pytest.mark.parametrize("name", ARMS)
def test_markers_of_one_nest_that_are_exchanged(name: str, tmp_path: Path) -> None:
    """40 mm apart on an arm of metres: what is left is little, and says it all the same."""
    arm = Campaign(name, tmp_path)
    labels = arm.rng.choice(list(MARKERS), len(arm.a))
    a, x = np.degrees(arm.a), 1e3 * arm.seen(1e-3 * np.array([MARKERS[k] for k in labels]))
    assert arm.placed(a, x, POINTS, labels=labels).rms < 3e-3
    swapped = [{"A": "B", "B": "A"}.get(k, k) for k in labels]
    with pytest.raises(InputError, match=r"2 markers look exchanged: .* A is B, B is A"):
        arm.placed(a, x, POINTS, labels=swapped)
    with pytest.raises(InputError, match=r"3 markers look exchanged: .* A is C, B is A, C is B"):
        arm.placed(a, x, POINTS, labels=[BEFORE[k] for k in labels])
    few = arm.rng.choice(len(a), 5, replace=False)
    labels[few] = [BEFORE[k] for k in labels[few]]
    assert set(few) == set(np.flatnonzero(arm.placed(a, x, POINTS, labels=labels).wild))


@pytest.mark.parametrize("name", ARMS)
def test_wild_rows_are_told_one_by_one(name: str, tmp_path: Path) -> None:
    """Ten in a thousand: far off, other joints' values, another robot's rows, swapped axes."""
    arm = Campaign(name, tmp_path, 1000)
    a, x = np.degrees(arm.a), 1e3 * arm.x
    wild = np.sort(arm.rng.choice(1000, 10, replace=False))
    x[wild[:4]] += arm.rng.normal(size=(4, 3)) * np.array([[30.0], [100.0], [400.0], [2000.0]])
    a[wild[4:7]] = np.roll(a[wild[4:7]], 1, axis=0)
    other = Campaign("panda" if name == "ur5" else "ur5", tmp_path, 1000)
    shared = min(arm.robot.n, other.robot.n)
    a[wild[7], :shared] = np.degrees(other.a[wild[7], :shared])
    x[wild[7]] = 1e3 * other.x[wild[7]]
    x[wild[8:]] = x[wild[8:]][:, [1, 0, 2]]
    found = arm.placed(a, x)
    assert np.flatnonzero(found.wild).tolist() == wild.tolist()


@pytest.mark.parametrize("name", ARMS)
def test_another_robot_is_no_slip(name: str, tmp_path: Path) -> None:
    arm = Campaign(name, tmp_path)
    other = Campaign("panda" if name == "ur5" else "ur5", tmp_path)
    a = np.zeros_like(arm.a)
    shared = min(arm.robot.n, other.robot.n)
    a[:, :shared] = other.a[:, :shared]
    with pytest.raises(InputError, match="of this robot") as caught:
        arm.placed(np.degrees(a), 1e3 * other.x)
    assert "worst in lines" in str(caught.value)


def test_what_is_said_of_a_wild_row(tmp_path: Path) -> None:
    from sk120stiff.identify.positions.calibrate import calibrate

    arm = Campaign("ur5", tmp_path)
    x = 1e3 * arm.x
    x[20, 1] += 300.0
    arm.placed(np.degrees(arm.a), x)
    said = findings(calibrate(sk.base_model(arm.robot), arm.readings), arm.readings)
    (line,) = [text for text in said if text.startswith("  line 22")]
    far = float(line.rsplit(": ", 1)[1].split(" mm off")[0])
    assert far == pytest.approx(300.0, abs=3.0)


def test_single_axes_of_another_frame_are_no_readings_of_this_arm(tmp_path: Path) -> None:
    """No row has a whole position, so no placing looks at them: the fit does."""
    from sk120stiff.identify.positions.calibrate import calibrate

    arm = Campaign("ur5", tmp_path)
    x = 1e3 * arm.x
    x[np.arange(len(x))[:, None] % 3 != np.arange(3)] = np.nan
    readings = arm.written(np.degrees(arm.a), x, FIT, frame="base")
    with pytest.raises(InputError, match=r"(?s)worst in lines.*mm are left.*frame: unknown"):
        calibrate(sk.base_model(arm.robot), readings)


FLOOR: dict[str, tuple[Callable[[Array], Array], str]] = {  # what the file makes of joint 3
    "a sum that nobody took": (lambda a: a[:, 2] + a[:, 1], r"{3}: -{2} \+ {3}"),
    "against the floor": (lambda a: -a[:, 2] - a[:, 1], r"{3}: -{2} - {3}"),
    "the wrong sign in a sum": (lambda a: a[:, 2] - 2.0 * a[:, 1], r"{3}: 2\*{2} \+ {3}"),
}


@pytest.mark.parametrize("slip", FLOOR)
def test_a_joint_measured_against_another_is_told_with_the_sum(slip: str, tmp_path: Path) -> None:
    arm = Campaign("ur5", tmp_path)
    shown, said = FLOOR[slip]
    a = arm.a.copy()
    a[:, 2] = shown(arm.a)
    two, three = arm.robot.actuated[1:3]
    said = said.replace("{2}", two).replace("{3}", three)
    with pytest.raises(InputError, match=f"signs or sums of joints.* mm are left.*{said}") as told:
        arm.placed(np.degrees(a), 1e3 * arm.x)
    assert "where a joint has an expression there already" in str(told.value)


@pytest.mark.parametrize("slip", ["radians", "metres", "mirrored", "two axes"])
def test_both_commands_tell_the_slips(
    slip: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Through the door: the same words, and nothing is written."""
    arm = Campaign("panda", tmp_path, 30)
    spoil, said = SLIPS[slip]
    arm.written(*spoil(np.degrees(arm.a), 1e3 * arm.x, arm.robot.n), FIT)
    for command in (["identify"], ["explain", "--out", str(tmp_path / "out")]):
        assert main([command[0], str(tmp_path / "readings.csv"), *command[1:]]) == 2
        assert re.search(said, " ".join(capfd.readouterr().err.split()))
        assert not (tmp_path / "out").exists()
