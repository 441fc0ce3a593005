"""A command that takes a robot takes a model, and the other way round."""

from pathlib import Path

import pytest

from sk120stiff.robot.bundled import bundled_robots
from tests.corpus.robots import example

ROBOT = bundled_robots()["motoman_sk120"]
MODEL = str(ROBOT / "model.yaml")
LOAD = ("--pose", "10,20,-30,0,-60,0 deg", "--wrench", "100,0,-200 N")
GRID = ("--grid", "joint_2_l=0:10:5 deg")
DATA = str(ROBOT / "data" / "table2_measured.csv")


def without(document: dict, *keys: str) -> dict:
    return {key: value for key, value in document.items() if key not in keys}


@pytest.fixture
def here(tmp_path: Path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("path.csv").write_text(
        "joint_1_s[deg],joint_2_l[deg],joint_3_u[deg],joint_4_r[deg],joint_5_b[deg],"
        "joint_6_t[deg],fx[N],fy[N],fz[N]\n0,20,-30,0,-60,0,0,100,-200\n"
    )
    return tmp_path


@pytest.mark.parametrize(
    ("before", "after", "ignored"),
    [
        (("check",), (), ()),
        (("stiffness",), LOAD, ()),
        (("map",), (*GRID, "--out", "m.zarr"), ("seconds", "points_per_second", "out")),
        (("view",), ("--static", "page.html"), ()),
        (("predict",), (DATA,), ()),
        (("simulate",), (DATA, "--out", "read.csv"), ()),
        (("compensate",), ("path.csv", "--out", "c.csv"), ("judged_by",)),
        (("export",), ("--out", "arm.xml"), ()),
        (("plan", "--count", "4", "--candidates", "20", "--model"), (), ()),
        (("identify", DATA, "--model"), (), ()),
    ],
    ids=lambda words: words[0] if words else None,
)
def test_robot_and_model_give_the_same(run, here: Path, before, after, ignored) -> None:
    answers = []
    for named in ("motoman_sk120", MODEL, str(ROBOT / "robot.yaml")):
        for old in ("m.zarr",):
            if Path(old).exists():
                Path(old).rename(f"{old}.{len(answers)}")
        outcome = run(*before, named, *after, "--json")
        assert outcome.code == 0, (named, outcome.stderr)
        answers.append(without(outcome.document, *ignored))
    assert answers[0] == answers[1] == answers[2]


def test_a_model_of_another_robot_is_refused(run, here: Path) -> None:
    outcome = run("predict", str(example("ur5_robot.urdf")), DATA, "--json")
    assert (outcome.code, outcome.error["kind"]) == (2, "input")
    assert "this is another robot than" in outcome.error["message"]


def test_springs_that_nobody_measured_are_told(run, here: Path) -> None:
    outcome = run("stiffness", str(example("ur5_robot.urdf")), "--json")
    assert outcome.code == 0
    assert any("typical of an arm of this size" in said for said in outcome.document["warnings"])
    assert run("stiffness", "motoman_sk120", "--json").document["warnings"] == []


def test_a_spring_that_its_readings_did_not_show_is_told(run, here: Path) -> None:
    text = Path(MODEL).read_text(encoding="utf-8")
    last = text.rindex("origin:")
    origin = "origin: 'not identifiable, not to be trusted'}"
    Path("found.yaml").write_text(text[:last] + origin + "\n", encoding="utf-8")
    outcome = run("stiffness", "found.yaml", "--json")
    assert outcome.code == 0, outcome.stderr
    assert any("not to be trusted" in said for said in outcome.document["warnings"])
