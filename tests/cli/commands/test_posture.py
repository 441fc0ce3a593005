import csv
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.robot import load_robot
from sk120stiff.robot.rotations import rotation_from_rpy
from tests.cli.conftest import Run

MODEL = str(Path(__file__).resolve().parents[3] / "robots/motoman_sk120/model.yaml")


@pytest.fixture
def path(tmp_path: Path) -> str:
    file = tmp_path / "path.csv"
    rows = [f"{k},1500,{-200 + 100 * k},300,0,0,500" for k in range(5)]
    file.write_text("point,x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n" + "\n".join(rows) + "\n")
    return str(file)


def test_the_path_is_passed_with_the_tool_as_asked(run: Run, path: str, tmp_path: Path) -> None:
    out = tmp_path / "best.csv"
    options = ("--tool-axis", "0,0,-1", "--minimise", "deflection", "--place", "x=-100:100 mm")
    found = run("posture", MODEL, path, *options, "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    document = found.document
    assert document["rows"] == 5
    assert document["worst"] == max(document["per_point"])
    assert document["worst"] <= document["blind_choice"]["best"]
    assert -0.1 <= document["placement"]["x"] <= 0.1
    with out.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    robot = load_robot("motoman_sk120")
    for k, row in enumerate(rows):
        a = np.radians([float(row[f"{joint}[deg]"]) for joint in robot.actuated])
        T = robot.placement(a)
        meant = [1.5 + document["placement"]["x"], -0.2 + 0.1 * k, 0.3]
        np.testing.assert_allclose(T[:3, 3], meant, atol=1e-7)
        told = [1e-3 * float(row[f"{axis}[mm]"]) for axis in "xyz"]
        np.testing.assert_allclose(told, meant, atol=1e-7)
        np.testing.assert_allclose(T[:3, 2], [0.0, 0.0, -1.0], atol=1e-7)


@pytest.mark.parametrize("axis", [(), ("--tool-axis", "0,0,-1")])
def test_a_picture_and_a_page_are_written(
    run: Run, path: str, tmp_path: Path, axis: tuple[str, ...]
) -> None:
    picture, page = tmp_path / "best.svg", tmp_path / "best.html"
    files = ("--out", str(tmp_path / "b.csv"), "--picture", str(picture), "--page", str(page))
    found = run("posture", MODEL, path, *axis, *files, "--json")
    assert found.code == 0, found.stderr
    assert found.document["picture"] == str(picture)
    assert picture.read_text().rstrip().endswith("</svg>")
    assert "point 5" in page.read_text()


def test_a_picture_of_another_kind_is_refused_before_the_work(
    run: Run, path: str, tmp_path: Path
) -> None:
    out = tmp_path / "b.csv"
    found = run("posture", MODEL, path, "--out", str(out), "--picture", str(tmp_path / "b.gif"))
    assert found.code == 2
    assert ".svg" in found.stderr
    assert not out.exists()


def test_people_see_what_there_was_to_gain(run: Run, path: str, tmp_path: Path) -> None:
    found = run("posture", MODEL, path, "--out", str(tmp_path / "best.csv"))
    assert found.code == 0, found.stderr
    assert "blind choices" in found.stdout
    assert "N/µm" in found.stdout
    assert "The arm's lowest point is" in found.stdout and "give floor:" in found.stdout


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--tool-axis", "0,0,0"), "no direction"),
        (("--direction", "up"), "no direction"),
        (("--place", "x=100:-100 mm"), "ends before"),
        (("--place", "w=1:2 mm"), "yaw"),
        (("--place", "x=1:2"), "unit"),
        (("--limit-margin", "5"), "unit"),
    ],
)
def test_bad_input(
    run: Run, path: str, tmp_path: Path, options: tuple[str, ...], says: str
) -> None:
    found = run("posture", MODEL, path, *options, "--out", str(tmp_path / "b.csv"))
    assert found.code == 2
    assert says in found.stderr


def test_no_posture_is_an_explained_refusal(run: Run, path: str, tmp_path: Path) -> None:
    found = run(
        "posture", MODEL, path, "--singularity-margin", "0.99", "--out", str(tmp_path / "b")
    )
    assert found.code == 1
    assert "singular poses" in found.stderr


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ([(-800,), (-700,), (800,)], ("point 2 and point 3, 1500 mm", "with 31 in every move")),
        ([(0, 25 * k) for k in range(40)], ("0 mm apart, joint_6_t jumps", "no branch", "divide")),
    ],
)
def test_points_between_which_a_joint_jumps_are_named(
    run: Run, tmp_path: Path, rows: list[tuple[int, ...]], says: tuple[str, ...]
) -> None:
    path = tmp_path / "path.csv"
    turned = len(rows[0]) == 2
    header = "x[mm],z[mm],fx[N],fy[N],fz[N],y[mm]" + ",yaw[deg],roll[deg],pitch[deg]" * turned
    lines = [
        ",".join(map(str, (1300, 300, 0, 0, 500, *row, *(180, 0)[: 2 * turned]))) for row in rows
    ]
    path.write_text("\n".join([header, *lines]) + "\n")
    options = () if turned else ("--tool-axis", "0,0,-1")
    found = run("posture", MODEL, str(path), *options, "--out", str(tmp_path / "b.csv"))
    assert found.code == 1
    for said in says:
        assert said in " ".join(found.stderr.split())


def test_its_path_is_checked_row_by_row(run: Run, path: str, tmp_path: Path) -> None:
    """Joints are driven; positions beside them must agree, unless they are those under load."""
    best, corrected = tmp_path / "best.csv", tmp_path / "corrected.csv"
    words = ("plan", "--check", str(best))
    assert run("posture", MODEL, path, "--tool-axis", "0,0,-1", "--out", str(best)).code == 0
    found = run(*words, "--model", MODEL, "--json")
    assert found.code == 0, found.stderr
    rows = found.document["rows"]
    assert [(row["line"], row["pose"]) for row in rows] == [(k + 2, str(k)) for k in range(5)]
    low = run(*words, "--model", MODEL, "--floor", "400 mm", "--json").document
    assert low["feasible"] == 0 and "floor" in low["rows"][0]["faults"][0]
    assert run("compensate", MODEL, str(best), "--out", str(corrected)).code == 0
    assert run("plan", "--check", str(corrected), "--model", MODEL).code == 0
    for wrong, said in (
        (words, "--model"),
        ((*words, "--model", MODEL, "--point", "0,0,100 mm"), "100 mm away"),
        (("plan", "--check", path, "--model", MODEL), "many postures"),
    ):
        refused = run(*wrong)
        assert refused.code == 2 and said in refused.stderr


def test_its_path_is_taken_by_compensate(run: Run, path: str, tmp_path: Path) -> None:
    """Joints are driven, and what stands beside them is held against them."""
    best, turned = tmp_path / "best.csv", tmp_path / "turned.csv"
    first, *rest = Path(path).read_text().splitlines()
    lines = [first + ",roll[deg],pitch[deg],yaw[deg]", *(f"{row},180,0,0" for row in rest)]
    turned.write_text("\n".join(lines) + "\n")
    first = run("posture", MODEL, str(turned), "--tool-axis", "0,0,-1", "--out", str(best))
    for said in ("joint limits with 0 deg", "100 % of their effort", "no cell.yaml", "No floor"):
        assert said in " ".join(first.stdout.split())
    robot = load_robot("motoman_sk120")
    with best.open(newline="") as stream:
        row = list(csv.DictReader(stream))[1]
    a = np.radians([float(row[f"{joint}[deg]"]) for joint in robot.actuated])
    angles = np.radians([float(row[f"{name}[deg]"]) for name in ("roll", "pitch", "yaw")])
    stands = robot.placement(a[None])[0][:3, :3]
    np.testing.assert_allclose(stands, rotation_from_rpy(angles), atol=1e-8)
    words = ("compensate", MODEL, str(best), "--out", str(tmp_path / "c.csv"))
    found = run(*words, "--floor=-2 m", "--json")
    assert found.code == 0, found.stderr
    assert found.document["after_um"] < 1.0 < found.document["before_um"]
    assumed = " ".join(found.document["assumed"])
    assert "joints are driven" in assumed and "joint limits" in assumed
    assert "No floor" not in assumed  # it was given
    rows = best.read_text().splitlines()
    for column, said in (("x[mm]", "1 mm away"), ("yaw[deg]", "1 deg away from the orientation")):
        k = rows[0].split(",").index(column)
        cells = rows[2].split(",")
        other = ",".join([*cells[:k], str(float(cells[k]) + 1.0), *cells[k + 1 :]])
        best.write_text("\n".join([*rows[:2], other, *rows[3:]]) + "\n")
        refused = run(*words)
        assert refused.code == 2 and "line 3" in refused.stderr and said in refused.stderr


def test_rig_and_tracker_are_asked_of_measurements_alone(
    run: Run, path: str, tmp_path: Path
) -> None:
    """The load is the path's own, and nobody looks on; what stands in the way is named."""
    cell = tmp_path / "cell.yaml"
    rig = "rig: {kind: cable, anchors: [[1.5, 0, 5]], steps: '100 N'}\n"
    cell.write_text(rig + "tracker: {xyz: [0, 0, -9], axis: [0, 0, 1], cone: 5 deg}\n")
    words = ("posture", MODEL, path, "--tool-axis", "0,0,-1", "--out", str(tmp_path / "b.csv"))
    assert run(*words).code == 0
    cell.write_text("obstacles:\n- {name: crate, sphere: 0.1, xyz: [1.5, 0, 0.3]}\n")
    found = run(*words)
    assert found.code == 1
    assert "crate" in found.stderr


def test_loads_turn_with_the_part_and_are_written_so(run: Run, tmp_path: Path) -> None:
    """What the file says of the best posture is what `stiffness` says there under its load."""
    path, out = tmp_path / "path.csv", tmp_path / "best.csv"
    path.write_text("x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1500,-200,300,400,0,-300\n")
    options = ("--tool-axis", "0,0,-1", "--minimise", "deflection", "--place", "yaw=20:40 deg")
    found = run("posture", MODEL, str(path), *options, "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    with out.open(newline="") as stream:
        (row,) = csv.DictReader(stream)
    yaw = found.document["placement"]["yaw"]
    assert np.radians(20.0) <= yaw <= np.radians(40.0)
    force = [float(row[f"{name}[N]"]) for name in ("fx", "fy", "fz")]
    np.testing.assert_allclose(force, [400 * np.cos(yaw), 400 * np.sin(yaw), -300], atol=1e-6)
    pose = ",".join(row[f"{joint}[deg]"] for joint in load_robot("motoman_sk120").actuated)
    load = ",".join(map(str, force))
    bent = run("stiffness", MODEL, "--pose", f"{pose} deg", "--wrench", f"{load} N", "--json")
    length = np.linalg.norm(bent.document["deflection"]["enhanced"])
    assert length == pytest.approx(found.document["worst"], rel=1e-6)


def test_motors_hold_the_load_however_the_part_may_turn(run: Run, tmp_path: Path) -> None:
    path, out = tmp_path / "path.csv", tmp_path / "best.csv"
    path.write_text("x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n500,-200,300,0,900,-900\n")
    for place in ((), ("--place", "yaw=-5:5 deg")):
        refused = run("posture", "ur5e", str(path), *place, "--out", str(out), "--json")
        assert refused.code == 1 and not out.exists()
        assert "N*m" in refused.error["message"]


def test_margins_that_are_none_are_refused(run: Run, path: str, tmp_path: Path) -> None:
    out = ("--out", str(tmp_path / "b.csv"), "--json")
    for margin in ("-5 deg", "200 deg"):
        refused = run("posture", MODEL, path, "--limit-margin", margin, *out)
        assert refused.code == 2 and refused.error["where"] == "--limit-margin"
        assert "narrowest range" in refused.error["remedy"]
    for ratio in ("-0.1", "2"):
        assert run("posture", MODEL, path, "--singularity-margin", ratio, *out).code == 2
    assert not (tmp_path / "b.csv").exists()


def test_what_is_out_of_reach_is_told_with_the_joint_that_stands_in_the_way(
    run: Run, tmp_path: Path
) -> None:
    """A narrow range of the upper arm stands in the way; five metres off nothing helps."""
    path, out = tmp_path / "path.csv", ("--out", str(tmp_path / "b.csv"), "--json")
    far, near = (f"x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n{x},0,300,0,0,-300\n" for x in (5000, 2400))
    path.write_text(far)
    for command in ("posture", "compensate"):
        refused = run(command, MODEL, str(path), *out)
        assert refused.code == 1
        assert "no posture puts the tool there" in refused.error["message"]
    path.write_text(near)
    refused = run("posture", MODEL, str(path), "--limit-margin", "65 deg", *out)
    assert refused.code == 1
    assert "joint_2_l would have to stand at" in refused.error["message"]
    assert "has -5 to 5 deg" in refused.error["message"]
