"""Orientations beside positions: the placed arm tells how their numbers are meant."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff import base_model, fit, load_robot, read_measurements
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.run import Imported, import_readings
from tests.measurements.importers.tracked import TURN, Campaign, campaign, ur5

SITS = Rotation.from_euler("xyz", [15.0, -40.0, 110.0], degrees=True)
SEEN = campaign(30)
Numbers = Callable[[Rotation], np.ndarray]


def target(seen: Campaign = SEEN, noise: float = 2e-4, sits: Rotation = SITS) -> Rotation:
    """Axes of a target on the tool as the tracker sees them; no joint stands where it reads."""
    q = np.radians(seen.q + [0.0, 0.08, -0.05, 0.1, 0.05, 0.0])
    axes = Rotation.from_matrix(load_robot(ur5(), tool="tool0").placement(q)[:, :3, :3])
    rng = np.random.default_rng(1)
    return TURN * axes * sits * Rotation.from_rotvec(noise * rng.normal(size=(len(q), 3)))


def brought(
    folder: Path, headers: str, numbers: np.ndarray, seen: Campaign = SEEN, **options: object
) -> Imported:
    lines = [",".join([*(f"A{k}[deg]" for k in range(1, 7)), "x[mm],y[mm],z[mm]", headers])]
    for q, x, own in zip(seen.q, seen.x, numbers, strict=True):
        cells = ["" if np.isnan(v) else f"{v:.7f}" for v in (*q, *x, *own)]
        lines.append(",".join(cells))
    path = folder / "seen.csv"
    path.write_text("\n".join(lines) + "\n")
    robot = load_robot(ur5(), tool="tool0")
    return import_readings(path, robot, Told(), **options)  # type: ignore[arg-type]


def euler(axes: str) -> Numbers:
    return lambda turned: turned.as_euler(axes, degrees=True)


@pytest.mark.parametrize(
    ("headers", "numbers", "way"),
    [
        ("A[deg],B[deg],C[deg]", euler("ZYX"), "moved axes z, y, x (as KUKA's A, B, C)"),
        ("W,P,R", euler("xyz"), "fixed axes x, y, z (as FANUC's W, P, R)"),
        ("o,a,t", euler("ZYZ"), "moved axes z, y, z (as Kawasaki's O, A, T)"),
        ("roll[rad],pitch[rad],yaw[rad]", lambda r: r.as_euler("xyz"), "fixed axes x, y, z"),
        ("rx[rad],ry[rad],rz[rad]", lambda r: r.as_rotvec(), "rotation vectors"),
        ("rx[deg],ry[deg],rz[deg]", euler("XYZ"), "moved axes x, y, z"),
        ("qw,qx,qy,qz", lambda r: np.roll(r.as_quat(), 1, axis=1), "the real part first"),
        ("qw,qx,qy,qz", lambda r: r.as_quat(), "the real part last"),
        ("q1,q2,q3,q4", lambda r: np.roll(r.as_quat(), 1, axis=1), "the real part first"),
        ("A,B,C", lambda r: euler("ZYX")(r.inv()), "of the tracker in axes of the target"),
    ],
)
def test_the_arm_tells_how_they_are_meant(
    headers: str, numbers: Numbers, way: str, tmp_path: Path
) -> None:
    found = brought(tmp_path, headers, numbers(target()))
    read = found.orientation
    assert read is not None and way in read.way
    assert 0.005 < np.degrees(read.off) < 0.2 < 5.0 < np.degrees(read.next)
    said = found.readings.absolute
    assert said is not None and said.fit_axes
    apart = Rotation.from_matrix(said.channels.rotation).inv() * target()
    assert apart.magnitude().max() < 1e-6
    assert found.settings["rotation"] == {"axes": "target"}
    assert not any(header in item for item in found.draft.unused for header in headers.split(","))


def test_axes_that_are_turned_against_those_of_the_positions_are_put_right(
    tmp_path: Path,
) -> None:
    """A scanner that tells turns in axes of its own, x and y exchanged."""
    other = Rotation.from_euler("z", -90.0, degrees=True)
    found = brought(tmp_path, "rx[deg],ry[deg],rz[deg]", euler("xyz")(other * target()))
    read, said = found.orientation, found.readings.absolute
    assert read is not None and said is not None
    assert "fixed axes x, y, z" in read.way and "(0, 0, -90) deg" in read.sentence()
    known = Rotation.from_matrix(said.channels.rotation)
    apart = known.inv() * target()  # but for how the target is said to sit
    assert (apart[0].inv() * apart).magnitude().max() < 1e-6


def test_they_come_into_base_axes_with_the_positions(tmp_path: Path) -> None:
    found = brought(tmp_path, "A,B,C", euler("ZYX")(target()), into_base=True)
    said = found.readings.absolute
    assert said is not None and said.channels.rotation is not None
    apart = Rotation.from_matrix(said.channels.rotation).inv() * TURN.inv() * target()
    assert apart.magnitude().max() < 2e-3  # as well as positions tell the base


def test_a_blank_cell_is_a_target_that_was_not_seen(tmp_path: Path) -> None:
    angles = euler("ZYX")(target())
    angles[3, 1] = np.nan
    found = brought(tmp_path, "A,B,C", angles)
    said = found.readings.absolute
    assert said is not None and said.channels.rotation is not None
    lost = np.isnan(said.channels.rotation).any(axis=(1, 2))
    assert np.flatnonzero(lost).tolist() == [3]
    four = np.roll(target().as_quat(), 1, axis=1)
    four[5] = 0.0
    found = brought(tmp_path, "qw,qx,qy,qz", four)
    said = found.readings.absolute
    assert said is not None and said.channels.rotation is not None
    assert (
        np.isnan(said.channels.rotation[5]).all() and not np.isnan(said.channels.rotation[4]).any()
    )


def test_what_is_written_is_identified(tmp_path: Path) -> None:
    """From the controller's angles to the target's place on the tool."""
    found = brought(tmp_path, "A,B,C", euler("ZYX")(target()))
    found.write(tmp_path / "out.csv")
    robot = load_robot(ur5(), tool="tool0")
    model = base_model(robot)
    assert model is not None
    answer = fit(model, read_measurements(tmp_path / "out.csv", robot.actuated))
    values = [answer.model.parameter(f"target_rotation:tool0.r{axis}").value for axis in "xyz"]
    apart = Rotation.from_rotvec(values).inv() * SITS
    assert apart.magnitude() < 3e-3  # what the last joint is off is counted there


@pytest.mark.parametrize(
    ("headers", "numbers", "why"),
    [
        ("A,B,C", euler("ZYX")(target(noise=0.3)), "in no usual way"),
        ("A,B,C", np.tile([10.0, 20.0, 30.0], (30, 1)), "in no usual way"),
        ("A,B", euler("ZYX")(target())[:, :2], ""),
        ("roll[deg],pitch[deg]", euler("xyz")(target())[:, :2], "the others are missing"),
    ],
)
def test_what_is_no_orientation_of_this_arm_is_left_out(
    headers: str, numbers: np.ndarray, why: str, tmp_path: Path
) -> None:
    found = brought(tmp_path, headers, numbers)
    said = found.readings.absolute
    assert found.orientation is None and said is not None and said.channels.rotation is None
    assert why in next(item for item in found.draft.unused if item.startswith("column "))
    assert "rotation" not in found.settings


def test_what_a_controller_computes_is_not_taken_for_measured(tmp_path: Path) -> None:
    robot = load_robot(ur5(), tool="tool0")
    axes = Rotation.from_matrix(robot.placement(np.radians(SEEN.q))[:, :3, :3])
    seen = replace(SEEN, x=1e3 * (TURN.apply(robot.placement(np.radians(SEEN.q))[:, :3, 3]) + 1.0))
    seen = replace(seen, x=seen.x + np.random.default_rng(2).normal(0.0, 0.02, seen.x.shape))
    found = brought(tmp_path, "A,B,C", euler("ZYX")(TURN * axes), seen)
    assert found.orientation is None
    assert any("as a controller shows them" in item for item in found.draft.unused)


def test_a_tool_that_never_turns_does_not_tell(tmp_path: Path) -> None:
    """Every pose with the same axes: any three numbers that do not change would do."""
    q = SEEN.q * [0.0, 1.0, 1.0, 0.0, 0.0, 0.0] + [0.0, 0.0, 0.0, 0.0, -90.0, 0.0]
    q[:, 3] = -q[:, 1] - q[:, 2]  # the wrist takes back what upper arm and forearm turn
    robot = load_robot(ur5(), tool="tool0")
    T = robot.placement(np.radians(q))
    rng = np.random.default_rng(3)
    x = 1e3 * (TURN.apply(T[:, :3, 3]) + 1.0) + rng.normal(0.0, 0.02, (len(q), 3))
    axes = TURN * Rotation.from_matrix(T[:, :3, :3]) * SITS
    axes = axes * Rotation.from_rotvec(2e-4 * rng.normal(size=(len(q), 3)))
    found = brought(tmp_path, "A,B,C", euler("ZYX")(axes), replace(SEEN, q=q, x=x))
    assert found.orientation is None


MOTIVE = """\
Format Version,1.23,Take Name,Take 1,Capture Frame Rate,120,Length Units,Meters
,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body
,,tool,tool,tool,tool,tool,tool,tool
,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position
Frame,Time (Seconds),X,Y,Z,W,X,Y,Z
"""


def test_headers_in_two_rows_as_mocap_programs_write_them(tmp_path: Path) -> None:
    """OptiTrack's Motive: Rotation above X Y Z W, Position above X Y Z."""
    numbers = np.column_stack(
        [np.arange(30), 0.5 * np.arange(30), target().as_quat(), 1e-3 * SEEN.x]
    )
    rows = [",".join(f"{v:.7f}" for v in row) for row in numbers]
    path, joints = tmp_path / "take.csv", tmp_path / "joints.csv"
    path.write_text(MOTIVE + "\n".join(rows) + "\n")
    head = ",".join(f"q{k}[deg]" for k in range(1, 7))
    np.savetxt(joints, SEEN.q, delimiter=",", header=head, comments="", fmt="%.6f")
    robot = load_robot(ur5(), tool="tool0")
    found = import_readings(path, robot, Told(), joints_file=joints)
    assert found.fitted is not None and found.fitted.rms < 2e-3
    assert found.orientation is not None and "the real part first" in found.orientation.way
    assert found.draft.sheet.frame is None
    assert dict(found.columns)["time[s]"][:2] == ("0.0000000", "0.5000000")


@pytest.mark.parametrize(
    ("headers", "turn"),
    [
        (",".join(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), lambda m: m),
        (",".join(f"R{i}{j}" for i in (0, 1, 2) for j in (0, 1, 2)), lambda m: m),
        ("nx,ny,nz,ox,oy,oz,ax,ay,az", lambda m: np.swapaxes(m, 1, 2)),
    ],
)
def test_matrices_row_by_row_or_column_by_column(
    headers: str, turn: Callable[[np.ndarray], np.ndarray], tmp_path: Path
) -> None:
    found = brought(tmp_path, headers, turn(target().as_matrix()).reshape(-1, 9))
    assert found.orientation is not None and "matrices" in found.orientation.way
    said = found.readings.absolute
    assert said is not None
    apart = Rotation.from_matrix(said.channels.rotation).inv() * target()
    assert apart.magnitude().max() < 1e-6


def test_a_t_beside_forces_is_a_torque(tmp_path: Path) -> None:
    """As force sensors write them; without forces it is a translation, as above."""
    path = tmp_path / "wrench.csv"
    head = [f"q{k}[deg]" for k in range(1, 7)] + [f"F{axis}[N]" for axis in "xyz"]
    head += [f"T{axis}[N*m]" for axis in "xyz"] + [f"d{axis}[mm]" for axis in "xyz"]
    path.write_text(",".join(head) + "\n10,-60,50,20,30,40,0,0,-100,1,2,3,0.1,0.2,-0.9\n")
    found = import_readings(path, load_robot(ur5(), tool="tool0"), Told())
    assert found.readings.wrench[0].tolist() == [0.0, 0.0, -100.0, 1.0, 2.0, 3.0]


def test_headers_that_name_something_else_are_not_passed_over(tmp_path: Path) -> None:
    """Twelve numbers in a row are no table of calibration where they have other names."""
    rows = np.column_stack([SEEN.x, euler("xyz")(target()), SEEN.q])
    path = tmp_path / "foo.csv"
    head = "foo,bar,baz,u,v,w," + ",".join(f"J{k} (deg)" for k in range(1, 7))
    np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.6f")
    with pytest.raises(InputError, match=r"foo, bar, baz.*--columns"):
        import_readings(path, load_robot(ur5(), tool="tool0"), Told(length="mm"))
    path.write_text(path.read_text().replace("foo,bar,baz", "tx,ty,tz"))
    found = import_readings(path, load_robot(ur5(), tool="tool0"), Told(length="mm"))
    assert found.fitted is not None and found.fitted.rms < 2e-3


@pytest.mark.parametrize("moments", [True, False])
def test_moments_are_those_about_the_flange_and_not_about_the_marker(
    tmp_path: Path, moments: bool
) -> None:
    """A sensor between flange and tool has them; a cable that pulls has none."""
    path = tmp_path / "sensed.csv"
    head = [
        "x[mm]",
        "y[mm]",
        "z[mm]",
        *(f"J{k}[deg]" for k in range(1, 7)),
        "Fx[N]",
        "Fy[N]",
        "Fz[N]",
    ]
    rng = np.random.default_rng(1)
    loads = rng.normal(size=(len(SEEN.q), 6 if moments else 3))
    head += ["Mx[N*m]", "My[N*m]", "Mz[N*m]"] if moments else []
    rows = np.column_stack([SEEN.x, SEEN.q, loads])
    np.savetxt(path, rows, delimiter=",", header=",".join(head), comments="", fmt="%.6f")
    told = Told(forces="base")
    found = import_readings(path, load_robot(ur5(), tool="tool0"), told)
    point = found.readings.force_point
    assert (np.linalg.norm(point) == 0.0) == moments
    assert ("about the origin of the tool frame" in " ".join(found.said)) == moments
