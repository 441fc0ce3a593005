"""`sk120stiff import`: a calibration file, and what the other commands make of the result."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.measurements import read_measurements
from sk120stiff.model import base_model
from sk120stiff.robot import Robot, load_robot
from tests.corpus.robots import example

TOLD = ("--robot", "motoman_sk120", "--length", "m", "--angle", "rad")
POSES = ([0.2, 0.4, -0.5, 0, -1, 0], [-0.7, 0.6, -0.8, 0, -0.8, 0], [0.9, -0.2, 0.1, 0, 0.5, 0])


def marks(folder: Path, payload: bool = True) -> str:
    """Positions of the flange by J K⁻¹ Jᵀ W, side load and weight, two loads at each pose."""
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    springs = np.array([1.4098e6, 4.0076e5, 9.3528e5])
    lines = ["x1,y1,z1,q1,q2,q3,q4,q5,q6" + (",load" if payload else "")]
    for a in np.array(POSES):
        x, J = robot.placement(a)[:3, 3], robot.jacobian(a)[:3, :3]
        for count in (0, 1) if payload else (0,):
            d = J @ ((J.T @ [0.0, 300.0, -490.0]) / springs) * count
            cells = [*(repr(float(v)) for v in x + d), *map(str, a)]
            lines.append(",".join([*cells, str(count)] if payload else cells))
    path = folder / "marks.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return str(path)


def test_the_springs_come_out(run, tmp_path: Path) -> None:
    out = str(tmp_path / "own.csv")
    outcome = run(
        "import", marks(tmp_path), *TOLD, "--wrench", "0,300,-490 N", "--out", out, "--json"
    )
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert [said for said in found["doubts"] if "they look computed" not in said] == []
    assert (found["rows"], found["poses"], found["useful_poses"]) == (6, 3, 3)
    assert found["stiffness_identifiable"] is True
    assert read_measurements(out).robot == "motoman_sk120"
    values = [p["value"] for p in run("identify", out, "--json").document["parameters"]]
    assert values == pytest.approx([1.4098e6, 4.0076e5, 9.3528e5], rel=2e-3)


def test_positions_alone_are_written_as_positions(run, tmp_path: Path) -> None:
    out = str(tmp_path / "own.csv")
    outcome = run("import", marks(tmp_path, payload=False), *TOLD, "--out", out)
    assert outcome.code == 0, outcome.stderr
    said = " ".join(outcome.stderr.split())
    assert "No pose of the 3 was read under two different loads." in said
    assert "position: {frame: unknown}" in said
    assert read_measurements(out).absolute is not None


def test_the_file_itself_sends_one_here(run, tmp_path: Path) -> None:
    refused = run("identify", marks(tmp_path))
    assert refused.code == 2
    assert "sk120stiff import" in refused.stderr


def test_bad_options(run, tmp_path: Path) -> None:
    source, out = marks(tmp_path), str(tmp_path / "own.csv")
    for arguments, word in (
        ((*TOLD[:2], "--angle", "rad", "--out", out), "--length m or mm"),
        ((*TOLD[:4], "--out", out), "--angle rad or deg"),
        ((*TOLD, "--out", out), "--wrench"),
        ((*TOLD, "--out", source), "overwrite"),
        ((*TOLD, "--point", "1,2 mm", "--out", out), "not 3"),
        ((*TOLD, "--marker", "2", "--out", out), "no marker 2"),
        ((*TOLD[2:], "--robot", "nobody", "--out", out), "nobody"),
    ):
        refused = run("import", source, *arguments)
        assert refused.code == 2, arguments
        assert word in refused.stderr
        assert not Path(out).exists()


def test_a_turned_tracker_is_registered_and_a_wrong_unit_is_named(run, tmp_path: Path) -> None:
    """Load pairs in axes that are turned by 90 degrees give the same springs all the same."""
    source = Path(marks(tmp_path))
    lines = source.read_text(encoding="utf-8").splitlines()
    turned = [lines[0]]
    for line in lines[1:]:
        x, y, *rest = line.split(",")
        turned.append(",".join([y, str(-float(x)), *rest]))
    source.write_text("\n".join(turned) + "\n", encoding="utf-8")
    out = str(tmp_path / "own.csv")
    pairs = (*TOLD, "--wrench", "0,300,-490 N", "--out", out)
    found = run("import", str(source), *pairs, "--json").document
    assert found["registered"] is True
    assert found["registration"]["turned_deg"] == pytest.approx(90.0, abs=0.1)
    values = [p["value"] for p in run("identify", out, "--json").document["parameters"]]
    assert values == pytest.approx([1.4098e6, 4.0076e5, 9.3528e5], rel=5e-3)
    doubts = run("import", str(source), *pairs, "--no-register", "--json").document["doubts"]
    (doubt,) = [said for said in doubts if "they look computed" not in said]
    assert "about 90 deg" in doubt and "--register" in doubt
    told = (*TOLD[:2], "--length", "mm", "--angle", "rad")
    Path(out).unlink()
    outcome = run("import", marks(tmp_path), *told, "--wrench", "0,0,-9 N", "--out", out)
    assert outcome.code == 1
    assert "another unit" in outcome.stderr
    assert not Path(out).exists()


def cloud(folder: Path, robot: Robot, poses: np.ndarray, marker: list[float]) -> str:
    """What a tracker anywhere in the room sees of a marker on a robot, joints as q1, q2, ..."""
    turn = Rotation.from_rotvec([0.3, -0.5, 1.9]).as_matrix()
    T = robot.placement(poses)
    at = T[:, :3, 3] + T[:, :3, :3] @ marker
    seen = at @ turn.T + [3.0, -1.0, 0.5]
    head = "x1,y1,z1," + ",".join(f"q{k + 1}" for k in range(robot.n))
    lines = [
        ",".join(map(repr, [*map(float, x), *map(float, q)]))
        for x, q in zip(seen, poses, strict=True)
    ]
    path = folder / "cloud.csv"
    path.write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")
    return str(path)


def test_the_residual_of_registration_is_told(run, tmp_path: Path) -> None:
    """Nothing is left for the right robot, whatever the tracker's frame and the marker's place."""
    robot = load_robot("motoman_sk120")
    poses = np.random.default_rng(0).uniform(-0.8, 0.8, (12, 6))
    source, out = cloud(tmp_path, robot, poses, [0.1, -0.05, 0.2]), str(tmp_path / "own.csv")
    found = run("import", source, *TOLD, "--out", out, "--json").document["registration"]
    assert found["rms_mm"] < 1e-6
    assert found["marker_m"] == pytest.approx([0.1, -0.05, 0.2], abs=1e-8)
    said = run("import", source, *TOLD, "--out", out).stderr
    assert "12 poses, the tracker's frame and the marker's place fitted" in said


@pytest.mark.parametrize("harm", ["another robot", "joints exchanged", "a sign", "degrees for rad"])
def test_positions_of_another_robot_are_refused(run, tmp_path: Path, harm: str) -> None:
    poses = np.random.default_rng(1).uniform(-0.8, 0.8, (15, 6))
    name = "ur10_robot.urdf" if harm == "another robot" else "motoman_sk120"
    robot = load_robot(example(name) if name.endswith("urdf") else name)
    source = cloud(tmp_path, robot, poses, [0.0, 0.0, 0.1])
    lines = Path(source).read_text(encoding="utf-8").splitlines()
    cells = [line.split(",") for line in lines[1:]]
    for row in cells:
        if harm == "joints exchanged":
            row[4], row[5] = row[5], row[4]
        if harm == "a sign":
            row[5] = str(-float(row[5]))
    Path(source).write_text("\n".join([lines[0], *map(",".join, cells)]), encoding="utf-8")
    told = (*TOLD[:-1], "deg") if harm == "degrees for rad" else TOLD
    out = tmp_path / "own.csv"
    refused = run("import", source, *told, "--out", str(out))
    assert refused.code == 1
    assert "not this robot's positions" in refused.stderr
    assert "mm are left" in refused.stderr
    assert not out.exists()


def test_a_poorly_calibrated_robot_is_taken(run, tmp_path: Path) -> None:
    """Zeros some tenths of a degree off, as robots have: told in mm, and imported."""
    robot = load_robot("motoman_sk120")
    poses = np.random.default_rng(0).uniform(-0.8, 0.8, (12, 6))
    off = np.radians([0.0, 0.2, -0.3, 0.3, -0.2, 0.0])
    source, out = cloud(tmp_path, robot, poses + off, [0.1, 0.0, 0.2]), str(tmp_path / "own.csv")
    lines = Path(source).read_text(encoding="utf-8").splitlines()
    rows = [",".join([*line.split(",")[:3], *map(repr, map(float, q))])
            for line, q in zip(lines[1:], poses, strict=True)]  # fmt: skip
    Path(source).write_text("\n".join([lines[0], *rows]), encoding="utf-8")
    outcome = run("import", source, *TOLD, "--out", out, "--json")
    assert outcome.code == 0
    assert 0.5 < outcome.document["registration"]["rms_mm"] < 15.0


def test_joints_that_the_robot_does_not_have_are_no_remark(run, tmp_path: Path) -> None:
    source, out = Path(marks(tmp_path, payload=False)), tmp_path / "own.csv"
    lines = source.read_text(encoding="utf-8").splitlines()
    for extra in ("q7", "joint_7", "A7", "panda_joint7", "axis 7"):
        text = [f"{lines[0]},{extra}", *(f"{line},0.1" for line in lines[1:])]
        source.write_text("\n".join(text) + "\n", encoding="utf-8")
        refused = run("import", str(source), *TOLD, "--out", str(out))
        assert (refused.code, out.exists()) == (2, False)
        assert extra in refused.stderr and "--joints" in refused.stderr
    for harmless in ("phix1", "joint_7_torque", "temperature", "quality", "finger_joint1"):
        text = [f"{lines[0]},{harmless}", *(f"{line},0.1" for line in lines[1:])]
        source.write_text("\n".join(text) + "\n", encoding="utf-8")
        assert run("import", str(source), *TOLD, "--out", str(out)).code == 0, harmless


def test_forces_in_axes_of_the_tool(run, tmp_path: Path) -> None:
    """The same pushes, told in axes of the flange, give the same springs."""
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    springs, head = np.array([1.4098e6, 4.0076e5, 9.3528e5]), "x,y,z,q1,q2,q3,q4,q5,q6,fx,fy,fz"
    lines = [head]
    for a in np.array(POSES):
        T, J = robot.placement(a), robot.jacobian(a)[:3, :3]
        for push in (np.zeros(3), np.array([0.0, 300.0, -490.0])):
            x = T[:3, 3] + J @ ((J.T @ push) / springs)
            cells = [*x, *a, *(T[:3, :3].T @ push)]
            lines.append(",".join(repr(float(v)) for v in cells))
    path = tmp_path / "tool.csv"
    path.write_text("\n".join(lines) + "\n")
    out = tmp_path / "own.csv"
    told = (*TOLD, "--load", "N", "--out", str(out))
    outcome = run("import", str(path), *told, "--forces", "tool", "--json")
    assert outcome.code == 0, outcome.stderr
    assert "in axes of the tool frame" in " ".join(outcome.document["assumed"])
    values = [p["value"] for p in run("identify", str(out), "--json").document["parameters"]]
    assert values == pytest.approx(springs.tolist(), rel=2e-3)
    refused = run("import", marks(tmp_path), *TOLD, "--wrench", "0,0,-490 N", "--forces", "tool",
                  "--out", str(out))  # fmt: skip
    assert refused.code == 2 and "no column fx, fy, fz holds any" in refused.stderr
    assert run("import", str(path), *told, "--forces", "flange").code == 2


def test_forces_in_axes_of_the_instrument(run, tmp_path: Path) -> None:
    """A cable's direction as the tracker saw it, beside positions in the same axes."""
    robot = load_robot("motoman_sk120")
    springs = np.array([1.4098e6, 4.0076e5, 9.3528e5])
    turn = Rotation.from_euler("zyx", [70.0, 4.0, -3.0], degrees=True)
    rng, lines = np.random.default_rng(2), ["x,y,z,q1,q2,q3,q4,q5,q6,fx,fy,fz"]
    for a in rng.uniform(-0.4, 0.4, (12, 6)):
        T, J = robot.placement(a), robot.jacobian(a)[:3, :3]
        for push in (np.zeros(3), rng.uniform(-400.0, 400.0, 3)):
            x = T[:3, 3] + J @ ((J.T @ push) / springs)
            cells = [*(turn.apply(x) + [3.0, -1.0, 0.4]), *a, *turn.apply(push)]
            lines.append(",".join(repr(float(v)) for v in cells))
    path, out = tmp_path / "seen.csv", tmp_path / "own.csv"
    path.write_text("\n".join(lines) + "\n")
    told = (*TOLD, "--load", "N", "--out", str(out))
    outcome = run("import", str(path), *told, "--forces", "instrument", "--json")
    assert outcome.code == 0, outcome.stderr
    values = [p["value"] for p in run("identify", str(out), "--json").document["parameters"]]
    assert values == pytest.approx(springs.tolist(), rel=5e-3)
    assert run("import", str(path), *told).code == 0  # taken for those of the base
    assert "--forces instrument" in run("identify", str(out)).stderr
    kept = run("import", str(path), *told, "--forces", "instrument", "--no-register")
    assert kept.code == 2 and "--register" in kept.stderr


def test_two_files_are_one_campaign(run, tmp_path: Path) -> None:
    whole = Path(marks(tmp_path, payload=False)).read_text().splitlines()
    parts = [tmp_path / "monday.csv", tmp_path / "friday.csv"]
    parts[0].write_text("\n".join(whole[:3]) + "\n")
    parts[1].write_text("\n".join([whole[0], *whole[3:]]) + "\n")
    out = tmp_path / "own.csv"
    outcome = run("import", *map(str, parts), *TOLD, "--out", str(out), "--json")
    assert outcome.code == 0, outcome.stderr
    assert outcome.document["rows"] == 3 and outcome.document["registration"]["stations"] == []
    assert any("2 files are one campaign" in said for said in outcome.document["assumed"])
    assert read_measurements(out).n_readings == 3


def test_positions_before_and_under_the_load_in_two_files(run, tmp_path: Path) -> None:
    """Springs come out of two files as out of one, with the load told once for all rows."""
    rows = Path(marks(tmp_path)).read_text().splitlines()
    names = ("before", "after")
    for name, own in zip(names, (rows[1::2], rows[2::2]), strict=True):
        text = [rows[0].replace(",load", ""), *(row.rpartition(",")[0] for row in own)]
        (tmp_path / f"{name}.csv").write_text("\n".join(text) + "\n")
    before, after = (str(tmp_path / f"{name}.csv") for name in names)
    out, load = str(tmp_path / "own.csv"), ("--wrench", "0,300,-490 N")
    outcome = run("import", after, "--before", before, *TOLD, *load, "--out", out)
    assert outcome.code == 0, outcome.stderr
    said = " ".join(outcome.stderr.split())
    assert "before.csv" in said and "(displacement: {zero: separate})" in said
    values = [p["value"] for p in run("identify", out, "--json").document["parameters"]]
    assert values == pytest.approx([1.4098e6, 4.0076e5, 9.3528e5], rel=2e-3)
    again = run("import", after, before, *TOLD, "--before", before, "--preview")
    assert again.code == 2 and "and one of positions without load" in again.stderr


def test_a_mass_is_told_for_each_file(run, tmp_path: Path) -> None:
    """One file for each mass; of those whose names say none the option does."""
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    paths = []
    for mass in (0.0, 40.0):
        lines = ["x,y,z,q1,q2,q3,q4,q5,q6"]
        for a in np.random.default_rng(0).uniform(-0.6, 0.6, (8, 6)).round(4):
            x, J = robot.placement(a)[:3, 3], robot.jacobian(a)[:3, :3]
            d = J @ ((J.T @ [0.0, 0.0, -9.80665 * mass]) / [1.4098e6, 4.0076e5, 9.3528e5])
            lines.append(",".join([*(repr(float(v)) for v in x + d), *map(str, a)]))
        paths.append(tmp_path / f"run{len(paths)}.csv")
        paths[-1].write_text("\n".join(lines) + "\n", encoding="utf-8")
    files, out = [str(path) for path in paths], str(tmp_path / "own.csv")
    told = ("--payload", "run0.csv=0 kg", "--payload", "run1=40 kg")
    outcome = run("import", *files, *TOLD, *told, "--out", out, "--json")
    assert outcome.code == 0, outcome.stderr
    assert outcome.document["largest_load_N"] == pytest.approx(9.80665 * 40.0)
    assert (outcome.document["mode"], outcome.document["useful_poses"]) == ("load pairs", 8)
    found = run("identify", out, "--json").document["parameters"]
    assert [p["value"] for p in found][1:] == pytest.approx([4.0076e5, 9.3528e5], rel=2e-3)
    refused = run("import", *files, *TOLD, *told[:2], "--payload", "run0.csv=1 kg", "--out", out)
    assert refused.code == 2 and "two masses are told of run0.csv" in refused.stderr
