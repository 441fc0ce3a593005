import csv
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.model import joint_spring_model, write_model
from sk120stiff.robot import load_robot
from tests.cli.conftest import Run
from tests.corpus.robots import example
from tests.oracles.mujoco_sk120 import deflect_sk120
from tests.workspace.test_branch import SPRINGS, milling_path, other_elbow, ur10

MODEL = str(Path(__file__).resolve().parents[3] / "robots/motoman_sk120/model.yaml")
JOINTS = [f"joint_{k}" for k in ("1_s", "2_l", "3_u", "4_r", "5_b", "6_t")]
POSES = np.array([[10.0, 20.0, -30.0, 0.0, -60.0, 0.0], [12.0, 22.0, -28.0, 5.0, -60.0, 0.0]])
FORCES = np.array([[0.0, 0.0, -490.0], [100.0, -200.0, -300.0]])


def joint_path(folder: Path) -> Path:
    head = ["point", *(f"{joint}[deg]" for joint in JOINTS), "fx[N]", "fy[N]", "fz[N]", "tool"]
    rows = [
        ["a,1", *map(str, POSES[0]), *map(str, FORCES[0]), "mill"],
        ["b", *map(str, POSES[1]), *map(str, FORCES[1]), "mill"],
    ]
    path = folder / "path.csv"
    with path.open("w", newline="") as stream:
        csv.writer(stream).writerows([head, *rows])
    return path


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_written_commands_put_the_loaded_tool_in_place(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "corrected.csv"
    found = run("compensate", MODEL, str(joint_path(tmp_path)), "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    document = found.document
    assert document["rows"] == 2
    assert document["before_um"] > 300.0
    assert document["after_um"] < 1e-3
    assert document["remaining"] == []
    robot = load_robot("motoman_sk120")
    rows = rows_of(out)
    assert [row["point"] for row in rows] == ["a,1", "b"]
    assert rows[0]["tool"] == "mill"
    assert float(rows[0]["before[um]"]) > 100.0
    for row, meant, force in zip(rows, np.radians(POSES), FORCES, strict=True):
        command = np.radians([float(row[f"{joint}[deg]"]) for joint in JOINTS])
        moved = deflect_sk120(command, [*force, 0.0, 0.0, 0.0]).displacement
        where = [robot.placement(a)[:3, 3] for a in (command, meant)]
        assert np.linalg.norm(where[0] + moved - where[1]) < 1e-8


def test_where_a_marker_sat_moves_no_tool(run: Run, tmp_path: Path) -> None:
    """Of a model from positions: the marker sat 50 mm off, and the flange was led there."""
    text = Path(MODEL).read_text()
    off = zip("xyz", (0.03, 0.0, 0.04), strict=True)
    offset = ", ".join(f"offset_{axis}: {{value: {size}, unit: m}}" for axis, size in off)
    model = tmp_path / "model.yaml"
    model.write_text(
        f"{text}  - name: tool_offset\n    where: tool0\n    parameters: {{{offset}}}\n"
    )
    written = set()
    for used, told in ((str(model), True), (MODEL, False)):
        path, out = joint_path(tmp_path), tmp_path / "out.csv"
        found = run("compensate", used, str(path), "--out", str(out), "--json")
        assert found.code == 0, found.stderr
        said = " ".join(found.document["assumed"])
        assert ("marker sat 50 mm off its stated place" in said) == told
        written.add(out.read_bytes())
    assert len(written) == 1


def test_positions_and_orientation(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_text(
        "point,x[mm],y[mm],z[mm],roll[deg],pitch[deg],yaw[deg],fx[N],fy[N],fz[N],mx[N*m],my[N*m],"
        "mz[N*m]\n1,1600,100,200,180,0,0,0,0,-490,0,5,0\n2,1600,150,200,180,0,0,0,0,-490,0,5,0\n"
    )
    out = tmp_path / "corrected.csv"
    found = run("compensate", MODEL, str(path), "--orientation", "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    assert found.document["after_um"] < 1e-3
    assert found.document["after_max_urad"] < 1e-3
    rows = rows_of(out)
    assert f"{JOINTS[0]}[deg]" in rows[0]
    assert rows[0]["x[mm]"] == "1600"
    second = run("compensate", MODEL, str(path), "--out", str(out))
    assert "2 points" in second.stdout


def test_a_wrong_model_is_judged_by_the_right_one(run: Run, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(Path(MODEL).read_text().replace("4.0076e+5", "4.4e+5"))
    path, out = str(joint_path(tmp_path)), str(tmp_path / "c.csv")
    found = run("compensate", str(wrong), path, "--against", MODEL, "--out", out, "--json")
    assert found.code == 0, found.stderr
    assert 5.0 < found.document["after_um"] < 0.2 * found.document["before_um"]


def test_what_remains_is_told(run: Run, tmp_path: Path) -> None:
    path, out = str(joint_path(tmp_path)), str(tmp_path / "c.csv")
    few = ("--only", "joint_1_s, joint_2_l")
    found = run("compensate", MODEL, path, *few, "--out", out, "--json")
    assert found.code == 0
    remaining = found.document["remaining"]
    assert [item["line"] for item in remaining] == [2, 3]
    assert "2 joints cannot correct 3 directions" in remaining[0]["reason"]
    people = run("compensate", MODEL, path, *few, "--out", out)
    assert "Not fully corrected: 2 of 2 points" in people.stdout


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x[mm],y[mm],z[mm]\n1,2,3\n", "'fx' is missing"),
        ("fx[N],fy[N],fz[N]\n1,2,3\n", "no points"),
        ("x[mm],y[mm],fx[N],fy[N],fz[N]\n1,2,1,2,3\n", "'z' is missing"),
        ("x,y[mm],z[mm],fx[N],fy[N],fz[N]\n1,2,3,1,2,3\n", "no unit"),
        ("x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1,2,nan,1,2,3\n", "finite"),
        ("joint_1_s[deg],fx[N],fy[N],fz[N]\n1,2,1,2\n", "joint_2_l"),
    ],
)
def test_bad_paths_end_with_two(run: Run, tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "path.csv"
    path.write_text(text)
    found = run("compensate", MODEL, str(path), "--out", str(tmp_path / "c.csv"))
    assert found.code == 2, found.stdout
    assert says in found.stderr
    assert not (tmp_path / "c.csv").exists()


def test_a_point_out_of_reach_is_a_refusal_that_names_its_line(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_text("x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1600,0,0,0,0,0\n9000,0,0,0,0,0\n")
    found = run("compensate", MODEL, str(path), "--out", str(tmp_path / "c.csv"))
    assert found.code == 1
    assert "line 3" in found.stderr
    assert run("compensate", MODEL, str(path), "--only", "elbow", "--out", "c.csv").code == 2


def test_no_load_that_holds_is_an_explained_failure(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    head = ",".join(f"{joint}[deg]" for joint in JOINTS)
    path.write_text(f"{head},fx[N],fy[N],fz[N],mx[N*m],my[N*m],mz[N*m]\n{'0,' * 10}1e9,0\n")
    found = run("compensate", MODEL, str(path), "--out", str(tmp_path / "c.csv"), "--json")
    assert found.code == 1
    assert "cannot hold" in found.document["remaining"][0]["reason"]


def test_the_branch_is_printed_and_what_goes_below_is_warned_of(run: Run, tmp_path: Path) -> None:
    robot = ur10()
    model, path = tmp_path / "model.yaml", milling_path(tmp_path, robot)
    write_model(joint_spring_model(robot, SPRINGS), model)
    out = ("--out", str(tmp_path / "new.csv"))
    said = run("compensate", str(model), str(path), *out)
    assert said.code == 0, said.stderr
    assert "elbow up (elbow_joint" in said.stdout
    assert "below the floor" not in said.stderr
    under = ",".join(f"{x:.4f}" for x in np.degrees(other_elbow(robot)))
    sunk = run("compensate", str(model), str(path), *out, "--start", f"{under} deg", "--json")
    assert sunk.code == 0, sunk.stderr
    branch = sunk.document["branch"]
    assert branch["elbow_up"] is False
    assert branch["points_below_floor"] == 40
    assert branch["lowest_m"] < -0.05
    assert "below the floor" in sunk.stderr
    assert f"line {branch['lowest_line']}" in sunk.stderr
    told = run(
        "compensate", str(model), str(path), *out, "--start", f"{under} deg", "--floor", "-2 m"
    )
    assert "below the floor" not in told.stderr
    refused = run("compensate", str(model), str(path), *out, "--start", "1,2 deg")
    assert refused.code == 2
    assert "--start" in refused.stderr


def test_a_branch_that_touches_nothing_is_taken(run, tmp_path: Path) -> None:
    """A ball where the elbow would be: the arm takes another branch, which leaves it alone."""
    path, out, cell = (tmp_path / name for name in ("path.csv", "out.csv", "ball.yaml"))
    path.write_text(
        "point,x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1,600,-200,300,0,0,-60\n"
        "2,600,-190,300,0,0,-60\n",
        encoding="utf-8",
    )
    file = example("ur10_robot.urdf")
    words = ("compensate", str(file), str(path), "--out", str(out), "--json")
    free = run(*words)
    assert free.code == 0, free.stderr
    robot = load_robot(file)
    first = free.document["branch"]["first"]
    x, y, z = robot.screws(np.array([[first[name] for name in robot.actuated]])).origins[0, 2]
    cell.write_text(
        f"obstacles:\n- {{name: ball, sphere: 0.05, xyz: [{x:.3f}, {y:.3f}, {z:.3f}]}}\n",
        encoding="utf-8",
    )
    found = run(*words, "--cell", str(cell))
    assert found.code == 0, found.stderr
    assert not found.document["infeasible"], found.document["infeasible"]
    assert found.document["branch"]["first"] != first


def test_points_that_run_into_the_cell_are_told(run, tmp_path: Path) -> None:
    """A table where the path goes: every line that touches it is named."""
    cell = tmp_path / "cell.yaml"
    cell.write_text(
        "pedestal: none\nobstacles:\n- {name: table, box: [1, 3, 0.4], xyz: [1.6, 0, -0.6]}\n",
        encoding="utf-8",
    )
    path = tmp_path / "path.csv"
    path.write_text(
        "point,x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1,1600,-200,600,0,0,-490\n"
        "2,1600,0,-500,0,0,-490\n",
        encoding="utf-8",
    )
    model = "robots/motoman_sk120/model.yaml"
    out = str(tmp_path / "out.csv")
    found = run("compensate", model, str(path), "--cell", str(cell), "--out", out, "--json")
    assert found.code == 0, found.stderr
    (wrong,) = found.document["infeasible"]
    assert wrong["line"] == 3 and any("table" in fault for fault in wrong["faults"])
    assert "cannot stand so" in found.stderr


def test_an_orientation_that_nobody_stated_is_told_to_be_free(run, tmp_path) -> None:
    path = tmp_path / "path.csv"
    for turned, told in (("", True), (",roll[deg],pitch[deg],yaw[deg]", False)):
        angles = "" if told else ",180,0,0"
        path.write_text(
            f"x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]{turned}\n1500,0,300,0,0,-300{angles}\n"
        )
        found = run("compensate", MODEL, str(path), "--out", str(tmp_path / "a.csv"))
        assert found.code == 0, found.stderr
        assert ("The tool's orientation is free" in found.stdout) is told
        assert "(judged by model.yaml)" in found.stdout
