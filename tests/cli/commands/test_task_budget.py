"""`explain --task` and `compensate` say alike what moves the loaded tool on a path."""

from pathlib import Path

import pytest

from sk120stiff.cli.shares import budget_tables_of, with_members
from sk120stiff.model import Share
from sk120stiff.robot.bundled import bundled_robots
from tests.cli.conftest import Run

DATA = bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
JOINTS = "joint_1_s,joint_2_l,joint_3_u,joint_4_r,joint_5_b,joint_6_t"
TASK = (
    ",".join(f"{name}[deg]" for name in JOINTS.split(","))
    + ",fx[N],fy[N],fz[N]\n10,20,-30,0,-60,0,100,0,-490\n-20,0,10,5,-30,0,0,300,-490\n"
)


@pytest.fixture
def task(tmp_path: Path) -> Path:
    file = tmp_path / "task.csv"
    file.write_text(TASK)
    return file


def test_a_task_has_the_budget_that_compensate_gives_it(run: Run, task: Path, tmp_path: Path):
    out = tmp_path / "o"
    words = ("explain", str(DATA), "--only", "joint_tilt:joint_1_s", "--out", str(out))
    done = run(*words, "--task", str(task), "--json")
    assert done.code == 0, done.stderr
    told = done.document["budget_task"]
    assert (told["path"], told["points"]) == ("task.csv", 2)
    assert {entry["name"] for entry in told["joints"]} == {
        name.partition(":")[2] for name in (e["name"] for e in told["effects"])
    }
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "task.csv" in page and "Rms per axis along the task" in page
    again = run("compensate", str(out / "model.yaml"), str(task), "--out",
                str(tmp_path / "new.csv"), "--json")  # fmt: skip
    assert again.code == 0, again.stderr
    mine = {entry["name"]: entry for entry in told["effects"]}
    for entry in again.document["budget"]["effects"]:
        other = mine[entry["name"]]
        assert entry["rms_um"] == pytest.approx(3**0.5 * other["rms_um"], rel=1e-6)
        assert entry["std_um"] == pytest.approx(3**0.5 * other["std_um"], rel=1e-6)
    assert again.document["budget"]["joints"]
    shown = run("compensate", str(out / "model.yaml"), str(task), "--out", str(tmp_path / "n.csv"))
    assert "Uncorrected, along the path [µm rms]" in shown.stdout


def test_without_a_task_there_is_none(run: Run, tmp_path: Path) -> None:
    done = run("explain", str(DATA), "--only", "joint_tilt:joint_1_s", "--no-report", "--json",
               "--out", str(tmp_path / "o"))  # fmt: skip
    assert done.document["budget_task"] is None
    assert all(entry["members"] for entry in done.document["budget_joints"])


def test_a_task_that_cannot_be_read_stops_before_the_work(run: Run, tmp_path: Path) -> None:
    bad = tmp_path / "task.csv"
    bad.write_text("x[mm],y[mm]\n1,2\n")
    done = run("explain", str(DATA), "--task", str(bad), "--out", str(tmp_path / "o"))
    assert done.code == 2 and "is missing" in done.stderr
    assert not (tmp_path / "o").exists()


def test_tables_say_how_many_they_leave_out() -> None:
    many = [Share(f"joint_springs:j{k}", 1e-5 / (k + 1), 1e-6) for k in range(11)]
    both = [
        Share("j0", 2e-5, 1e-6, ("joint_springs:j0", "lost_motion:j0")),
        Share("j1", 1e-5, None),
    ]
    first, second = budget_tables_of("At the measured loads", "µm", many, both)
    assert "the largest 8 of 11" in str(first.title)
    assert with_members(both[0]) == "j0: joint_springs + lost_motion"
    assert list(second.columns[2].cells) == ["1", "?"]
    (alone,) = budget_tables_of("At", "µm", many[:3], both[1:])
    assert "largest" not in str(alone.title)
