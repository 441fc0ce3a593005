"""What a load does to the tool, read as displacements of several markers and as turns."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.data_checks.turns import turn_slip
from sk120stiff.errors import InputError, Refusal, ToolkitWarning
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.answer.next_step import next_step_of_positions
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.measurements.channels import Channels, Moved
from sk120stiff.measurements.importers import import_readings
from sk120stiff.model import Model
from sk120stiff.model.pose_reading import move_by_load
from sk120stiff.robot.rotations import rotation_of, rotation_vector
from tests.effects.arms import ARMS, LOOPED, arm
from tests.positions.arm import NAMES, TURN, Arm, Array, errors, poses, tracked, urdf
from tests.positions.loaded_arm import MARKERS, PULLED, SPRINGS, moved, rests, write_moved
from tests.positions.test_sensitivities import load_cases_of, with_everything

POINT = "point: {xyz: [150, 0, 100], unit: mm}\n"
STATED = "displacement: {frame: base, zero: separate}\nnoise: {sigma: 5, unit: um"
PLAIN = STATED + "}\n"
SIGMA, TURNING = 5e-6 * np.sqrt(2.0), 2e-5 * np.sqrt(2.0)  # m, rad; both of two readings
SETTLED = 1e-13  # m or rad, to which an equilibrium is found
ROCKING = 4e-7  # rad/(N·m)
POINTS = "points: {" + ", ".join(
    f"{name}: {{xyz: {[float(v) for v in 1e3 * at]}, unit: mm}}" for name, at in MARKERS.items()
) + "}\n"  # fmt: skip


def pulls(count: int, seed: int) -> tuple[Array, Array]:
    """Poses and forces [N] of a campaign, two loads at each pose."""
    rng = np.random.default_rng(seed)
    force = rng.normal(size=(2 * count, 3))
    size = rng.uniform(300.0, 700.0, (2 * count, 1))
    return np.repeat(poses(count, seed), 2, axis=0), size * force / np.linalg.norm(
        force, axis=1, keepdims=True
    )


def six_columns(a: Array, force: Array, *, rocking: float = 0.0, seed: int = 0) -> dict[str, Array]:
    """Displacement [mm] and turn [mrad] of the arm with springs, with noise."""
    d, turn = moved(Arm(compliance=SPRINGS, weighs=False), a, force, MARKERS["A"], rocking)
    rng = np.random.default_rng(seed)
    d, turn = d + SIGMA * rng.normal(size=d.shape), turn + TURNING * rng.normal(size=d.shape)
    out = {f"d{axis}[mm]": 1e3 * d[:, k] for k, axis in enumerate("xyz")}
    return out | {f"dr{axis}[mrad]": 1e3 * turn[:, k] for k, axis in enumerate("xyz")}


def robot_of(path: Path) -> sk.Robot:
    return sk.load_robot(path.parent / "six.urdf", base="base", tool="tool")


def explained(path: Path) -> Explained:
    answer = sk.explain(Model(robot_of(path)), sk.read(path))
    assert isinstance(answer, Explained)
    return answer


@pytest.mark.parametrize("name", [*ARMS, *LOOPED])
def test_derivatives_against_central_differences(name: str) -> None:
    """Of displacement and turn in axes of base and of tool, by every smooth effect there is."""
    robot = arm(name)
    load_cases = load_cases_of(robot, seed=4)
    axes = load_cases.reading_axes.copy()
    axes[::2] = load_cases.rotation[::2]
    load_cases = replace(load_cases, reading_axes=axes)
    model, values = with_everything(robot, seed=5)
    exact = move_by_load(model, load_cases, values, derivative=True).columns
    typical = np.array([p.spec.typical for p in model.parameters])
    size = np.abs(exact * typical).max(axis=(0, 1))
    even = np.where(size > 0.0, typical / np.where(size > 0.0, size, 1.0), typical)
    rng = np.random.default_rng(6)

    def between(way: Array) -> Array:
        ahead, behind = (move_by_load(model, load_cases, values + s * way) for s in (1.0, -1.0))
        turned = ahead.rotation @ np.swapaxes(behind.rotation, 1, 2)
        moved = ahead.displacement - behind.displacement
        return np.concatenate([moved, rotation_vector(turned)], axis=1)

    for _ in range(6):  # every effect moves as much as any other, or by its typical size
        way = rng.normal(size=len(typical)) * np.minimum(1e-6 * even, 0.005 * typical)
        slope = (8.0 * between(way) - between(2.0 * way)) / 12.0
        assert np.abs(exact @ way - slope).max() < 1e-7 * np.abs(slope).max() + 2.0 * SETTLED


@pytest.mark.parametrize("weighs", [False, True])
@pytest.mark.parametrize("frame", ["base", "tool"])
def test_what_another_code_says(weighs: bool, frame: str, tmp_path: Path) -> None:
    """Displacements and turns at the true springs, of an arm that nothing of the product knows."""
    a, force = pulls(6, 1)
    true = Arm(compliance=SPRINGS, weighs=weighs)
    d, turn = moved(true, a, force, MARKERS["A"])
    if frame == "tool":
        axes = true.pose(a)[1]
        d, turn = (np.einsum("nji,nj->ni", axes, v) for v in (d, turn))
    columns = {f"d{axis}[mm]": 1e3 * d[:, k] for k, axis in enumerate("xyz")}
    columns |= {f"dr{axis}[mrad]": 1e3 * turn[:, k] for k, axis in enumerate("xyz")}
    settings = POINT + f"displacement: {{frame: {frame}}}\n"
    path = write_moved(tmp_path, a, force, columns, settings, weighs=weighs)
    base = sk.base_model(robot_of(path))
    model = base.with_values(SPRINGS)
    said = sk.predict(model, sk.read(path))
    assert said.turn is not None and said.position is None
    np.testing.assert_allclose(said.displacement, d, atol=2e-8)
    np.testing.assert_allclose(said.turn, turn, atol=2e-8)
    gap = said.gap(sk.read(path))
    assert np.abs(gap).max() < 2e-8


def test_springs_come_out_sharper_with_turns(tmp_path: Path) -> None:
    a, force = pulls(12, 2)
    columns = six_columns(a, force)
    settings = POINT + STATED + ", rotation: 20, rotation_unit: urad}\n"
    path = write_moved(tmp_path, a, force, columns, settings)
    model = sk.base_model(robot_of(path))
    whole = sk.fit(model, sk.read(path))
    assert isinstance(whole, Calibration)
    values = np.array([p.internal for p in whole.parameters])
    std = np.array([p.internal_std for p in whole.parameters])
    assert np.all(np.abs(values - SPRINGS) < 4.0 * std) and whole.misfit[2] > 1e-3
    alone = {k: v for k, v in columns.items() if not k.startswith("dr")}
    plain = sk.fit(model, sk.read(write_moved(tmp_path, a, force, alone, settings)))
    assert std[5] < 0.7 * plain.parameters[5].internal_std


def test_an_axis_that_was_not_read(tmp_path: Path) -> None:
    """A level reads how the tool tilts and not how it turns about the plumb line."""
    a, force = pulls(12, 3)
    columns = six_columns(a, force)
    del columns["drz[mrad]"]
    columns["dry[mrad]"][3] = np.nan
    path = write_moved(tmp_path, a, force, columns, POINT + PLAIN)
    read = sk.read(path)
    found = sk.fit(sk.base_model(robot_of(path)), read)
    assert isinstance(found, Calibration)
    assert len(found.residual) == 5 * len(a) - 1
    values = np.array([p.internal for p in found.parameters])
    assert np.all(np.abs(values / SPRINGS - 1.0) < 0.05)


def test_a_base_that_rocks_is_named(tmp_path: Path) -> None:
    a, force = pulls(30, 4)
    path = write_moved(tmp_path, a, force, six_columns(a, force, rocking=ROCKING), POINT + PLAIN)
    answer = explained(path)
    names = {finding.effect.id for finding in answer.findings}
    assert answer.verdict == "named" and "base_rocking:base" in names
    assert {name for name in names if not name.startswith("joint_springs")} == {"base_rocking:base"}
    assert answer.steps[-1].heldout_rms < 1.1 * SIGMA
    arm = Arm(compliance=SPRINGS, weighs=False)
    rocks = moved(arm, a, force, MARKERS["A"], ROCKING)[0] - moved(arm, a, force, MARKERS["A"])[0]
    budget = {share.name: share for share in answer.budget}
    share = budget["base_rocking:base"]
    assert share.std is not None
    assert abs(share.rms - np.sqrt(np.mean(rocks**2))) < 3.0 * share.std + 1e-6
    assert answer.budget[0].name in next_step_of_positions(answer)
    entries = answer.document().budget
    assert {item.name: item.rms_um for item in entries}["base_rocking:base"] == (
        pytest.approx(1e6 * share.rms)
    )


def test_several_markers_under_one_load(tmp_path: Path) -> None:
    """Three reflectors on the tool, each with its own displacement; a whole file of them."""
    a, force = pulls(20, 5)
    true, rng = Arm(compliance=SPRINGS, weighs=False), np.random.default_rng(1)
    parts = [moved(true, a, force, at, ROCKING)[0] for at in MARKERS.values()]
    d = np.stack(parts, axis=1).reshape(-1, 3)
    d += SIGMA * rng.normal(size=d.shape)
    three = np.repeat(a, 3, axis=0), np.repeat(force, 3, axis=0)
    columns: dict[str, Array | list[str]] = {"marker": [*MARKERS] * len(a)}
    columns |= {f"d{axis}[mm]": 1e3 * d[:, k] for k, axis in enumerate("xyz")}
    path = write_moved(tmp_path, *three, columns, POINTS + PLAIN)
    answer = explained(path)
    names = {finding.effect.id for finding in answer.findings}
    assert {name for name in names if not name.startswith("joint_springs")} == {"base_rocking:base"}
    assert answer.steps[-1].heldout_rms < 1.1 * SIGMA
    text = path.with_suffix(".yaml").read_text()
    path.with_suffix(".yaml").write_text(text.replace(POINTS, ""))
    with pytest.raises(InputError, match=r"line 3.*'A' and 'B'.*points: \{A: .*a note"):
        sk.read(path)
    path.with_suffix(".yaml").write_text(text.replace("unit: mm}}", "unit: mm, fit: true}}"))
    with pytest.raises(InputError, match=r"does not tell where it sits"):
        explained(path)


def test_a_marker_column_that_is_a_note_stays_one(tmp_path: Path) -> None:
    a, force = pulls(4, 6)
    columns: dict[str, Array | list[str]] = {"marker": ["old", "new"] * 4}
    columns |= {k: v for k, v in six_columns(a, force).items() if not k.startswith("dr")}
    read = sk.read(write_moved(tmp_path, a, force, columns, POINT + PLAIN))
    assert read.absolute is None and "marker" in read.extra


def test_they_are_written_as_they_are_read(tmp_path: Path) -> None:
    a, force = pulls(3, 7)
    settings = POINT + STATED + ", rotation: 20, rotation_unit: urad}\n"
    read = sk.read(write_moved(tmp_path, a, force, six_columns(a, force), settings))
    again = sk.read(sk.write_measurements(read, tmp_path / "again.csv"))
    assert again.absolute is not None and read.absolute is not None
    one, other = read.absolute.channels, again.absolute.channels
    np.testing.assert_allclose(other.displacement, one.displacement, rtol=1e-12)
    np.testing.assert_allclose(other.turn, one.turn, rtol=1e-12)
    assert other.sigma == pytest.approx(one.sigma)
    assert one.sigma["displacement"] == pytest.approx(SIGMA)
    assert one.sigma["turn"] == pytest.approx(TURNING)


SLIPS = {
    "inverted": (lambda turn, axes: -turn, "inverted"),
    "tool axes": (lambda turn, axes: np.einsum("nji,nj->ni", axes, turn), "in tool axes"),
    "degrees": (lambda turn, axes: np.degrees(turn) / 1e3, "degrees labelled mrad"),
    "swapped": (lambda turn, axes: turn[:, [1, 0, 2]], "look like dry, drx, drz"),
    "roll pitch yaw": (
        lambda turn, axes: _change(turn, axes, lambda R: R.as_euler("xyz")),
        "differences of roll, pitch and yaw",
    ),
    "vectors": (
        lambda turn, axes: _change(turn, axes, lambda R: R.as_rotvec()),
        "differences of rotation vectors",
    ),
}


def _change(turn: Array, axes: Array, angles: object) -> Array:
    before = Rotation.from_matrix(axes)
    after = Rotation.from_rotvec(1e-3 * turn) * before
    change = np.asarray(angles(after)) - np.asarray(angles(before))  # type: ignore[operator]
    return np.asarray(1e3 * np.where(np.abs(change) > 1.0, np.nan, change))


@pytest.mark.parametrize("slip", SLIPS)
def test_slips_in_turns_are_told(slip: str, tmp_path: Path) -> None:
    a, force = pulls(20, 8)
    columns = six_columns(a, force)
    names = [f"dr{axis}[mrad]" for axis in "xyz"]
    change, words = SLIPS[slip]
    wrong = change(np.column_stack([columns[name] for name in names]), Arm().pose(a)[1])
    columns |= {name: wrong[:, k] for k, name in enumerate(names)}
    path = write_moved(tmp_path, a, force, columns, POINT + PLAIN)
    with pytest.raises(Refusal, match=words):
        explained(path)


def test_turns_of_other_poses_are_told_and_stop_nothing(tmp_path: Path) -> None:
    a, force = pulls(20, 9)
    columns = six_columns(a, force)
    for name in columns:
        if name.startswith("dr"):
            columns[name] = np.random.default_rng(0).permutation(columns[name])
    path = write_moved(tmp_path, a, force, columns, POINT + PLAIN)
    with pytest.warns(ToolkitWarning, match="do not go with the displacements"):
        explained(path)


def test_a_slip_in_displacements_beside_turns_is_told(tmp_path: Path) -> None:
    a, force = pulls(20, 10)
    columns = six_columns(a, force)
    columns["dy[mm]"] *= -1.0
    path = write_moved(tmp_path, a, force, columns, POINT + PLAIN)
    with pytest.raises(Refusal, match="dy seems to have the wrong sign"):
        explained(path)


def test_a_load_misread_in_axes_of_the_base_is_named(tmp_path: Path) -> None:
    """A rig that pulls down by 6 % more than it says: no law in axes of the tool explains it."""
    a, force = pulls(30, 11)
    columns = six_columns(a, force)
    path = write_moved(tmp_path, a, force * [1.0, 1.0, 1.06], columns, POINT + PLAIN)
    answer = explained(path)
    names = {finding.effect.id for finding in answer.findings}
    assert {n for n in names if not n.startswith("joint_springs")} == {"force_scale:sensor"}
    assert any(p.name.endswith("scale_base_z") for p in answer.final.model.parameters)
    assert answer.families["compliance"] > 10.0 * answer.families["load"]


def test_load_pairs_with_orientations_stay_positions(tmp_path: Path) -> None:
    """Differences would leave out how the load turned the tool; the marker is where it pulls."""
    a = poses(30, 12)
    true = replace(errors(3), weighs=False)
    rng = np.random.default_rng(4)
    pull = 350.0 * rng.normal(size=(len(a), 3))
    sits = Rotation.from_rotvec([0.3, -0.6, 1.1])
    lines = [
        ",".join([*(f"{n}[rad]" for n in NAMES), "fx[N],fy[N],fz[N],x[mm],y[mm],z[mm],qw,qx,qy,qz"])
    ]
    for force in (0.0 * pull, pull):
        x, R = rests(true, a, force)
        seen = tracked(x + np.einsum("nij,j->ni", R, PULLED)) + SIGMA * rng.normal(size=x.shape)
        turned = TURN * Rotation.from_matrix(R) * sits
        turned = turned * Rotation.from_rotvec(2e-4 * rng.normal(size=x.shape))
        numbers = np.hstack([a, force, 1e3 * seen, np.roll(turned.as_quat(), 1, axis=1)])
        lines += [",".join(f"{v:.9g}" for v in row) for row in numbers]
    (tmp_path / "pairs.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "six.urdf").write_text(urdf(False))
    robot = robot_of(tmp_path / "pairs.csv")
    found = import_readings(tmp_path / "pairs.csv", robot)
    assert found.mode == "positions" and found.orientation is not None
    assert found.fitted is not None and found.fitted.rms < 3e-3  # by the rows without load
    at = found.settings["force"]["point"]["xyz"]
    np.testing.assert_allclose(at, 1e3 * PULLED, atol=2.0)
    said = found.readings.absolute
    assert said is not None and said.channels.rotation is not None
    fitted = sk.fit(sk.base_model(robot), found.readings)
    values = np.array([p.internal for p in fitted.parameters if p.effect.joint_spring])
    assert np.all(np.abs(values[:5] / SPRINGS[:5] - 1.0) < 0.03)


def test_an_axis_of_a_turn_that_was_not_read_says_nothing() -> None:
    turn = np.array([[0.1, 0.2, 0.3]])
    foretold = Moved(np.zeros((1, 3)), rotation_of(turn), np.zeros((1, 6, 0)))
    channels = Channels(turn=np.array([[0.1, 0.2, np.nan]]))
    nowhere = np.zeros((1, 3)), np.eye(3)[None], np.zeros((1, 6, 0))
    gap, slope = channels.project(*nowhere, foretold)
    assert gap.shape == (2,) and slope.shape == (2, 0)
    np.testing.assert_allclose(gap, 0.0, atol=1e-15)


def test_a_row_may_state_how_uncertain_its_displacement_is(tmp_path: Path) -> None:
    a, force = pulls(3, 13)
    columns: dict[str, Array] = dict(six_columns(a, force))
    columns |= {f"s{axis}[um]": np.array([5.0, 6.0, 7.0, 8.0, 9.0, 10.0]) for axis in "xyz"}
    read = sk.read(write_moved(tmp_path, a, force, columns, POINT))
    assert read.absolute is not None
    channels = read.absolute.channels
    assert channels.stated("displacement") and not channels.stated("turn")
    np.testing.assert_allclose(channels.scale("displacement")[::3], 1e-6 * np.arange(5.0, 11.0))


def test_turns_that_fit_in_two_ways_are_not_doubted(tmp_path: Path) -> None:
    """An arm that yields about the plumb line alone: x and y may as well be swapped."""
    a, force = pulls(12, 14)
    d, turn = moved(Arm(compliance=SPRINGS * np.eye(6)[0], weighs=False), a, force, MARKERS["A"])
    columns = {f"d{axis}[mm]": 1e3 * d[:, k] for k, axis in enumerate("xyz")}
    columns |= {f"dr{axis}[mrad]": 1e3 * turn[:, k] for k, axis in enumerate("xyz")}
    path = write_moved(tmp_path, a, force, columns, POINT)
    assert np.abs(turn[:, 2]).max() > 1e-4 > 1e3 * np.abs(turn[:, :2]).max()
    assert turn_slip(robot_of(path), sk.read(path)) is None
