"""`compensate` from G-code, APT and CSV to robot programs, through the command line."""

import csv
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.programs import LANGUAGES, read_gcode
from sk120stiff.robot import load_robot
from tests.cli.conftest import Run
from tests.corpus.robots import example
from tests.oracles.mujoco_sk120 import deflect_sk120

ROOT = Path(__file__).resolve().parents[3]
GCODE = """%
(slot) G21 G90 G17
G0 Z40
G0 X0 Y0
G1 Z0 F300
G1 X150 F1200
G3 X170 Y20 J20
M30
"""
FRAME = "x=1500 mm; y=-300 mm; z=-200 mm; yaw=20 deg"
WRENCH = "100,0,-490,0,20,0 N, N*m"


@pytest.fixture
def slot(tmp_path: Path) -> Path:
    path = tmp_path / "slot.nc"
    path.write_text(GCODE)
    return path


def compensated(run: Run, path: Path, out: Path, *more: str):
    return run("compensate", "motoman_sk120", str(path), "--frame", FRAME, "--wrench", WRENCH,
               "--chord", "0.2 mm", "--step", "1 m", "--out", str(out), "--json",
               *more)  # fmt: skip


def targets_of_csv(out: Path):
    with out.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    robot = load_robot("motoman_sk120")
    a = np.radians([[float(row[f"{j}[deg]"]) for j in robot.actuated] for row in rows])
    meant = 1e-3 * np.array([[float(row[f"{c}[mm]"]) for c in "xyz"] for row in rows])
    command = 1e-3 * np.array([[float(row[f"command_{c}[mm]"]) for c in "xyz"] for row in rows])
    return robot, a, meant, command, rows


def test_all_outputs_of_one_path_lead_to_the_corrected_joints(
    run: Run, slot: Path, tmp_path: Path
) -> None:
    """FK of the joints in each program, and its places, are those of the CSV file; and MuJoCo
    says that the loaded tool then stands on the programmed slot."""
    assert compensated(run, slot, tmp_path / "slot.csv").code == 0
    robot, a, meant, command, rows = targets_of_csv(tmp_path / "slot.csv")
    place = robot.placement(a)
    np.testing.assert_allclose(place[:, :3, 3], command, atol=1e-8)
    load = [100.0, 0.0, -490.0, 0.0, 20.0, 0.0]
    for k in (0, 2, len(a) - 1):
        loaded = command[k] + deflect_sk120(a[k], load).displacement
        assert np.linalg.norm(loaded - meant[k]) < 1e-7
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("z", 20, degrees=True).as_matrix()
    T[:3, 3] = [1.5, -0.3, -0.2]
    np.testing.assert_allclose((T @ [0.15, 0, 0, 1])[:3], meant[2], atol=1e-9)
    assert [row["line"] for row in rows[:4]] == ["4", "5", "6", "7"]
    assert [row["feed[mm/min]"] for row in rows[:3]] == ["", "300", "1200"]
    in_part = np.linalg.inv(T) @ place
    for language in LANGUAGES.values():
        out = tmp_path / f"new{language.ending}"
        found = compensated(run, slot, out)
        assert found.code == 0, found.stderr
        assert found.document["language"] == language.name
        text = out.read_text()
        read = language.read(text)
        if language.name == "gcode":  # what is written can be read as a path
            again = read_gcode(out, chord=1e-3)
            np.testing.assert_allclose(again.position, read.position, atol=1e-12)
        digit = np.radians(language.axis_digit)
        there = robot.placement(np.radians(read.joints))
        expected = in_part if language.name == "gcode" else place
        assert np.linalg.norm(read.position - expected[:, :3, 3], axis=1).max() < 1e-6
        reach = 6 * 2.5 * digit + 1e-8  # six joints, half a digit each, at 2.5 m
        assert np.abs(there[:, :3, 3] - place[:, :3, 3]).max() < reach
        if read.rotation is not None:
            np.testing.assert_allclose(read.rotation, place[:, :3, :3], atol=4e-6)
        speed = read.speed[np.isfinite(read.speed)]
        assert speed[-1] == pytest.approx(0.02, rel=1e-6)
        for said in ("Model: motoman_sk120, model.yaml", "elbow up", "SHA-256"):
            assert said in " ".join(text.replace("'", " ").replace("!", " ").split()) or (
                language.width < 40
            )


def test_the_parts_frame_and_pulses_are_settings(run: Run, slot: Path, tmp_path: Path) -> None:
    out = tmp_path / "slot.jbi"
    made = compensated(
        run, slot, out, "--set", "user=3", "--set", "pulses=1000,1000,1000,900,900,500"
    )
    assert made.code == 0, made.stderr
    assert made.document["settings"]["user"] == "3"
    text = out.read_text()
    assert "///POSTYPE USER" in text and "////FRAME USER 3" in text and "///POSTYPE PULSE" in text
    assert compensated(run, slot, tmp_path / "slot.csv").code == 0
    _, a, *_ = targets_of_csv(tmp_path / "slot.csv")
    read = LANGUAGES["jbi"].read(text)
    counts = np.degrees(a) * [1000, 1000, 1000, 900, 900, 500]
    assert np.abs(read.joints - counts).max() <= 0.5 + 1e-3
    assert np.linalg.norm(read.position[2] - [0.15, 0, 0]) < 2e-3  # the deflection away
    assert compensated(run, slot, out, "--set", "tol=1").code == 2
    assert compensated(run, slot, tmp_path / "x.csv", "--set", "tool=1").code == 2


def test_the_controllers_own_axes_stand_in_the_program(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    folder.mkdir()
    urdf = ROOT / "robots/motoman_sk120"
    for file in ("sk120.urdf", "model.yaml"):
        text = (urdf / file).read_text().replace("robot: motoman_sk120", "robot: .")
        (folder / file).write_text(text)
    (folder / "robot.yaml").write_text(
        (urdf / "robot.yaml").read_text()
        + "controller:\n  axes: {S: -joint_1_s, L: joint_2_l + 90 deg, U: joint_3_u - joint_2_l,\n"
        "    R: joint_4_r, B: joint_5_b, T: 2*joint_6_t}\n"
        "  pulses_per_degree: [1000, 1000, 1000, 1000, 1000, 500]\n"
    )
    path = tmp_path / "path.csv"
    joints = ",".join(f"{j}[deg]" for j in load_robot("motoman_sk120").actuated)
    path.write_text(f"{joints},fx[N],fy[N],fz[N]\n10,20,-30,1,-60,5,0,0,-490\n")
    done = run("compensate", str(folder), str(path), "--out", str(tmp_path / "p.csv"))
    assert done.code == 0, done.stderr
    a = np.degrees(csv_joints(tmp_path / "p.csv")[0])
    expected = [-a[0], a[1] + 90, a[2] - a[1], a[3], a[4], 2 * a[5]]
    for ending, scale in ((".src", 1.0), (".jbi", np.array([1000.0] * 5 + [500.0]))):
        assert (
            run("compensate", str(folder), str(path), "--out", str(tmp_path / f"p{ending}")).code
            == 0
        )
        language = next(each for each in LANGUAGES.values() if each.ending == ending)
        read = language.read((tmp_path / f"p{ending}").read_text())
        np.testing.assert_allclose(read.joints[0] / scale, expected, atol=1.1e-3)
    broken = (folder / "robot.yaml").read_text().replace("-joint_1_s", "joint_9")
    (folder / "robot.yaml").write_text(broken)
    bad = run("compensate", str(folder), str(path), "--out", str(tmp_path / "p.src"))
    assert bad.code == 2 and "joint_9" in bad.stderr


def test_the_two_commands_of_the_docs_lead_from_gcode_to_a_job(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (ROOT / "docs/FILES.md").read_text(encoding="utf-8")
    part, commands = re.findall(r"```(?:gcode|bash)\n(.*?)```", page.partition("part.nc -->")[2],
                                re.DOTALL)[:2]  # fmt: skip
    (tmp_path / "part.nc").write_text(part)
    (tmp_path / "robots").symlink_to(ROOT / "robots")
    monkeypatch.chdir(tmp_path)
    first, second = (shlex.split(line)[1:] for line in commands.splitlines())
    assert run(*first).code == 0
    done = run(*second, "--json")
    assert done.code == 0, done.stderr
    job = (tmp_path / "part.jbi").read_text()
    assert job.startswith("/JOB\n//NAME PART\n") and job.endswith("\nEND\n")
    assert f"///NPOS {done.document['rows']}," in job
    fitted = "".join(job.replace("'", "").split())
    assert "Fittedto" in fitted and "table2_measured.csv" in fitted and "sha256:" in fitted
    assert done.document["before_um"] > 500.0 > 100.0 > done.document["after_um"]
    assert done.document["uncertainty"]["after_std_parameters_um"] > 1.0
    assert (tmp_path / "part.html").stat().st_size > 50_000


def csv_joints(out: Path) -> np.ndarray:
    with out.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    return np.radians(
        [[float(v) for k, v in row.items() if k.startswith("joint_")] for row in rows]
    )


HEAD = ",".join(f"joint_{k}[deg]" for k in ("1_s", "2_l", "3_u", "4_r", "5_b", "6_t"))


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        (["0,10,-20,0,-40,0", "1,10,-20,0,0,0"], "line 3: the arm is singular"),
        (["0,10,-20,0,-40,0", "1,70.5,-20,0,-40,0"], "line 3: joint_2_l would stand at"),
        (["0,10,-20,0,-40,179", "1,10,-20,0,-40,-179"], "line 3: joint_6_t would have to pass"),
    ],
)
def test_bad_targets_stop_with_their_line(
    run: Run, tmp_path: Path, rows: list[str], says: str
) -> None:
    path, out = tmp_path / "path.csv", tmp_path / "p.jbi"
    path.write_text("\n".join([f"{HEAD},fx[N],fy[N],fz[N]", *(f"{row},0,0,-400" for row in rows)]))
    found = run("compensate", "motoman_sk120", str(path), "--out", str(out))
    assert found.code == 1
    assert says in found.stderr
    assert not out.exists()
    free = run("compensate", "motoman_sk120", str(path), "--out", str(out), "--by-joints")
    assert (free.code == 0) == ("limits" not in found.stderr)


def test_a_point_of_gcode_out_of_reach_names_its_line(run: Run, slot: Path, tmp_path: Path) -> None:
    slot.write_text("G0 X0 Y0 Z0\nG1 X5\n\nX9150\n")
    found = compensated(run, slot, tmp_path / "p.src")
    assert found.code == 1
    assert "slot.nc, line 4" in found.document["error"]["where"]


def test_loads_in_tool_axes_are_turned(run: Run, tmp_path: Path) -> None:
    """Down in the base is up for a tool that points down."""
    path = tmp_path / "path.csv"
    path.write_text("x[mm],y[mm],z[mm],roll[deg],pitch[deg],yaw[deg]\n1600,100,200,180,0,0\n")
    loads = {"base": "0,50,-490,1,2,3 N, N*m", "tool": "0,-50,490,1,-2,-3 N, N*m"}
    for axes, wrench in loads.items():
        out = ("--out", str(tmp_path / f"{axes}.csv"), "--load-axes", axes)
        done = run("compensate", "motoman_sk120", str(path), "--wrench", wrench, *out)
        assert done.code == 0, done.stderr
    np.testing.assert_allclose(csv_joints(tmp_path / "tool.csv"), csv_joints(tmp_path / "base.csv"),
                               atol=1e-9)  # fmt: skip


def test_an_axis_of_apt_turns_the_tool(run: Run, tmp_path: Path) -> None:
    path, out = tmp_path / "path.cls", tmp_path / "p.script"
    s, c = np.sin(0.2), np.cos(0.2)
    path.write_text(f"UNITS/MM\nGOTO/0,0,0,0,0,1\nFEDRAT/600,MMPM\nGOTO/50,0,0,{s},0,{c}\n")
    done = compensated(run, path, out, "--orientation")
    assert done.code == 0, done.stderr
    read = LANGUAGES["urscript"].read(out.read_text())
    z = Rotation.from_euler("z", 20, degrees=True).apply([[0, 0, -1], [-s, 0, -c]])
    np.testing.assert_allclose(read.rotation[:, :, 2], z, atol=5e-3)  # the deflection away


def test_seven_joints_and_no_spherical_wrist(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "line.nc"
    path.write_text("G0 X0 Y0 Z0\nG1 Y60 F600\n")
    for arm, ending in (
        ("panda.urdf", ".mod"),
        ("panda.urdf", ".jbi"),
        ("ur5_robot.urdf", ".script"),
    ):
        out = tmp_path / f"p{ending}"
        done = run("compensate", str(example(arm)), str(path), "--frame", "x=450 mm; z=250 mm",
                   "--wrench", "10,0,-40 N", "--out", str(out), "--json")  # fmt: skip
        assert done.code == 0, done.stderr
        robot = load_robot(example(arm))
        language = next(each for each in LANGUAGES.values() if each.ending == ending)
        read = language.read(out.read_text())
        there = robot.placement(np.radians(read.joints))[:, :3, 3]
        plain = " ".join(re.sub(r"[#!']", " ", out.read_text()).split())
        assert "typical of an arm of this size, not measured" in plain
        loose = "this arm of 7 joints can hold in many postures"
        assert (loose in plain) == (loose in done.stderr) == (robot.n == 7)
        assert "Lengths: millimetres" in plain and "Lengths: millimetres" in done.stderr
        if robot.n == 6:  # the maker's base is half a turn about z from `base_link`
            there = there * [-1.0, -1.0, 1.0]
        assert np.abs(there - read.position).max() < 2e-5
    place = ("--frame", "x=450 mm; z=250 mm", "--wrench", "0,0,1 N")
    out = tmp_path / "q.script"
    refused = run("compensate", str(example("panda.urdf")), str(path), *place, "--out", str(out))
    assert refused.code == 2 and "6 axes, this arm 7" in refused.stderr


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ((), "holds no load"),
        (("--wrench", "1,2 N"), "no wrench"),
        (("--wrench", "0,0,1 N", "--frame", "q=1 mm"), "no axis 'q'"),
        (("--wrench", "0,0,1 N", "--frame", "x=1:2:1 mm"), "several values"),
        (("--wrench", "0,0,1 N", "--frame", "x=1 mm; x=2 mm"), "several values"),
        (("--wrench", "0,0,1 N", "--tool-rpy", "1 deg"), "--tool-rpy"),
        (("--wrench", "0,0,1 N", "--chord", "0 um"), "not positive"),
        (("--wrench", "0,0,1 N", "--feed", "3 mm"), "--feed"),
        (("--wrench", "0,0,1 N", "--to", "krx"), "no language"),
        (("--wrench", "0,0,1 N", "--set", "tool"), "KEY=VALUE"),
    ],
)
def test_bad_options_end_with_two(
    run: Run, slot: Path, tmp_path: Path, options: tuple[str, ...], says: str
) -> None:
    out = tmp_path / "p.src"
    found = run("compensate", "motoman_sk120", str(slot), *options, "--out", str(out))
    assert found.code == 2, found.stdout
    assert says in found.stderr
    assert not out.exists()


@pytest.mark.parametrize("name", ["slot.xyz", "slot"])
def test_an_ending_that_names_no_language_is_refused(
    run: Run, slot: Path, tmp_path: Path, name: str
) -> None:
    refused = compensated(run, slot, tmp_path / "out" / name)
    assert refused.code == 2
    assert "names no language" in refused.error["message"]
    assert ".jbi" in refused.error["remedy"] and ".csv" in refused.error["remedy"]
    assert not (tmp_path / "out").exists()


def test_a_program_under_another_ending_is_told_what_to_be_called(
    run: Run, slot: Path, tmp_path: Path
) -> None:
    renamed = slot.rename(tmp_path / "slot.txt")
    refused = run("compensate", "motoman_sk120", str(renamed), "--wrench", WRENCH, "--out",
                  str(tmp_path / "c.csv"), "--json")  # fmt: skip
    assert refused.code == 2 and "ends in .nc" in refused.error["remedy"]


def test_joint_moves_that_a_language_does_not_have_are_refused(
    run: Run, slot: Path, tmp_path: Path
) -> None:
    refused = compensated(run, slot, tmp_path / "out.nc", "--by-joints")
    assert refused.code == 2 and "no moves by joint values" in refused.error["message"]
    assert not (tmp_path / "out.nc").exists()


def test_a_long_straight_move_is_divided_so_that_its_middle_is_corrected_too(
    run: Run, tmp_path: Path
) -> None:
    """The middle of the way between corrected points is where the corrected middle is."""
    path = tmp_path / "long.nc"
    path.write_text("G21 G90 G17\nG0 X0 Y-200 Z50\nG1 Z0 F600\nG1 Y600\n")

    def command(*more: str) -> np.ndarray:
        out = tmp_path / "long.csv"
        made = run("compensate", "motoman_sk120", str(path), "--frame", FRAME, "--wrench", WRENCH,
                   "--out", str(out), "--json", *more)  # fmt: skip
        assert made.code == 0, made.stderr
        far = [w for w in made.document["warnings"] if "posture" in w]
        assert bool(far) == (more == ("--step", "1 m"))
        return targets_of_csv(out)[3]

    usual, ends, fine = command(), command("--step", "1 m"), command("--step", "25 mm")
    assert len(ends) == 3 and len(usual) == 18 and len(fine) == 35
    middle = fine[18]  # 400 mm on
    assert np.linalg.norm(0.5 * (ends[1] + ends[2]) - middle) > 2e-5
    between = 0.5 * (usual[1:-1] + usual[2:])  # the fine ones that are none of the usual
    assert np.linalg.norm(between - fine[3:-1:2], axis=1).max() < 1e-6
