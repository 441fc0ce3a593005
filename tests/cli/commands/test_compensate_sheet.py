"""The sheet of a path: before and after, the shares, and the points that came back."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.model import joint_spring_model, read_model, write_model
from sk120stiff.robot import load_robot
from sk120stiff.workspace import read_path, standing, standing_budgets
from sk120stiff.workspace.returned import read_returned
from tests.cli.conftest import Run

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT / "robots/motoman_sk120/data/table2_measured.csv"
PATH = """point,x[mm],y[mm],z[mm],roll[deg],pitch[deg],yaw[deg]
a,0,0,0,180,0,0
b,100,0,0,180,0,0
c,100,80,0,180,0,0
"""
PLACE = ("--frame", "x=1600 mm; y=-200 mm; z=-100 mm; yaw=90 deg", "--wrench", "0,0,-490 N")


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The springs of the paper's readings, with their uncertainty."""
    from sk120stiff.cli.main import main

    out = tmp_path_factory.mktemp("fit") / "fitted.yaml"
    assert main(["identify", str(DATA), "--out", str(out)]) == 0
    return out


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "path.csv"
    file.write_text(PATH)
    return file


def visible(page: str) -> str:
    text = re.sub(r"<(style|svg|script)\b.*?</\1>", " ", page, flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]+>", " ", text).replace("\u00a0", " ").split())


def test_the_sheet_says_what_the_command_says(
    run: Run, fitted: Path, path: Path, tmp_path: Path
) -> None:
    sheet = tmp_path / "sheet.html"
    words = ("compensate", str(fitted), str(path), *PLACE, "--out", str(tmp_path / "new.csv"))
    found = run(*words, "--sheet", str(sheet), "--json")
    assert found.code == 0, found.stderr
    page = sheet.read_text(encoding="utf-8")
    assert not re.search(r'(?:src|href)="https?:', page)  # readable offline
    text = visible(page)
    before, doubt = found.document["before_um"], found.document["uncertainty"]
    assert f"{before:.0f} µm (rms)" in text
    std = np.hypot(doubt["after_std_parameters_um"], doubt["after_std_remainder_um"])
    assert f"± {std:#.3g} µm are expected" in text
    for name in ("joint_springs:joint_2_l", "joint_springs:joint_3_u"):
        assert name in text
    assert "As measured" not in text
    assert "x=1600 mm; y=-200 mm" in text and "elbow up" in text


def test_the_terminal_names_the_sheet_and_rounds_as_it_does(
    run: Run, path: Path, tmp_path: Path
) -> None:
    out, sheet = tmp_path / "new.csv", tmp_path / "sheet.html"
    found = run("compensate", "motoman_sk120", str(path), *PLACE, "--out", str(out), "--sheet",
                str(sheet))  # fmt: skip
    assert found.code == 0, found.stderr
    assert f"Written: {out} and {sheet}" in found.stdout
    assert "after: < 0.001 µm rms, < 0.001 at most" in found.stdout
    assert "&lt; 0.001" in visible(sheet.read_text(encoding="utf-8"))


def test_points_that_come_back_stand_beside_the_prediction(
    run: Run, fitted: Path, path: Path, tmp_path: Path
) -> None:
    """Made up to leave 30 µm at every point, in the path's own axes; before: what is predicted."""
    robot, model = load_robot("motoman_sk120"), read_model(fitted)
    words = ("compensate", str(fitted), str(path), *PLACE, "--out", str(tmp_path / "new.csv"))
    plain = run(*words, "--json").document
    rows = ["point,run,x[mm],y[mm],z[mm]"]
    for label, x, y in (("a", 0, 0), ("b", 100, 0), ("c", 100, 80)):
        rows.append(f"{label},after,{x + 0.03},{y},0")
    back = tmp_path / "back.csv"
    back.write_text("\n".join(rows))
    sheet = tmp_path / "sheet.html"
    found = run(*words, "--measured", str(back), "--sheet", str(sheet), "--json").document
    after = found["measured"]["after"]
    assert (after["points"], found["before_um"]) == (3, plain["before_um"])
    for key in ("rms_um", "max_um", "off_prediction_um"):
        assert after[key] == pytest.approx(30.0, abs=1e-3)
    np.testing.assert_allclose(after["constant_um"], [30, 0, 0], atol=2e-3)
    assert after["about_constant_um"] < 2e-3
    assert "after 3 30.0 0 30.0 +30" in visible(sheet.read_text(encoding="utf-8"))
    T = robot.placement(np.radians(joints_of(tmp_path / "new.csv")))
    np.testing.assert_allclose(T[0, :3, 3], [1.6, -0.2, -0.1], atol=2e-3)
    nominal = read_path(path, robot, wrench=np.zeros(6))
    assert nominal.count == 3
    # the predicted displacement, written as measured before correction: nothing is apart
    meant = np.array([[1.6, -0.2, -0.1], [1.6, -0.1, -0.1], [1.52, -0.1, -0.1]])
    a = nominal_joints(robot, meant)
    away = standing(model, a, a, [0, 0, -490, 0, 0, 0]).away
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    own = 1e3 * away @ turn
    back.write_text(
        "run,dx[mm],dy[mm],dz[mm]\n"
        + "\n".join(f"before,{x!r},{y!r},{z!r}" for x, y, z in own.tolist())
    )
    found = run(*words, "--measured", str(back), "--json").document["measured"]["before"]
    assert found["rms_um"] == pytest.approx(plain["before_um"], rel=1e-3)
    assert found["off_prediction_um"] < 2.0


@pytest.mark.parametrize(
    "rows",
    [
        "x[m],y[m],z[m]\n0,0,0\n100,0,0\n100,80,0\n",
        "x[mm],y[mm],z[mm]\n1600,-200,-100\n1600,-100,-100\n1520,-100,-100\n",
    ],
)
def test_points_in_another_unit_or_other_axes_are_refused(
    run: Run, path: Path, tmp_path: Path, rows: str
) -> None:
    back = tmp_path / "back.csv"
    back.write_text(rows)
    refused = run("compensate", "motoman_sk120", str(path), *PLACE, "--out",
                  str(tmp_path / "new.csv"), "--measured", str(back), "--json")  # fmt: skip
    assert refused.code == 2 and "from its target" in refused.error["message"]
    assert not (tmp_path / "new.csv").exists()


def joints_of(out: Path) -> np.ndarray:
    head, *rows = [line.split(",") for line in out.read_text().splitlines()]
    columns = [k for k, name in enumerate(head) if name.startswith("joint_")]
    return np.array([[float(row[k]) for k in columns] for row in rows])


def nominal_joints(robot, meant: np.ndarray) -> np.ndarray:
    from sk120stiff.workspace import Task, elastic_arm, solve_inverse

    down = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1.0]])
    start = np.tile(np.radians([-7, 15, -50, 0, -40, 0]), (3, 1))
    arm = elastic_arm(joint_spring_model(robot))
    reached = solve_inverse(arm, Task(meant, rotation=np.tile(down, (3, 1, 1))), start)
    assert reached.found.all()
    return reached.a


def test_shares_are_what_each_spring_alone_does() -> None:
    """Springs so stiff that the first order is all: one spring at a time, the others rigid."""
    robot = load_robot("motoman_sk120")
    stiffness = np.array([3e8, 1e8, 2e8, np.inf, np.inf, np.inf])
    a = np.radians([[10, 20, -30, 0, -60, 0], [-20, 0, 10, 5, -30, 0]])
    load = np.array([[100.0, 200.0, -490.0, 0, 0, 0], [0, 300.0, 0, 0, 20.0, 0]])
    found, _ = standing_budgets(joint_spring_model(robot, stiffness), a, load)
    for share in found:
        k = robot.actuated.index(share.name.partition(":")[2])
        alone = np.full(6, np.inf)
        alone[k] = stiffness[k]
        away = standing(joint_spring_model(robot, alone), a, a, load).away
        assert share.rms == pytest.approx(np.sqrt(np.mean(away**2)), rel=1e-4)
        assert share.std is None
    assert [share.rms for share in found] == sorted((s.rms for s in found), reverse=True)


def test_the_error_of_a_share_is_that_of_its_spring(fitted: Path) -> None:
    """One spring moves the tool in proportion to its compliance, and so does its error."""
    model = read_model(fitted)
    known = model.uncertainty
    assert known is not None
    a = np.radians([[10, 20, -30, 0, -60, 0]])
    for share in standing_budgets(model, a, [[100, 0, -490, 0, 0, 0]])[0]:
        k = known.names.index(f"{share.name}.stiffness")
        assert share.std == pytest.approx(share.rms * known.std[k] / known.values[k], rel=1e-6)


def test_a_share_that_no_reading_shows_has_no_error(fitted: Path) -> None:
    model = read_model(fitted)
    known = model.uncertainty
    assert known is not None
    unseen = np.zeros((1, len(known.names)))
    unseen[0, known.names.index("joint_springs:joint_2_l.stiffness")] = known.values.max()
    doubtful = model.known(replace(known, unseen=unseen))
    a = np.radians([[10, 20, -30, 0, -60, 0]])
    found, _ = standing_budgets(doubtful, a, [[100, 0, -490, 0, 0, 0]])
    told = {share.name: share.std for share in found}
    assert told["joint_springs:joint_2_l"] is None
    assert told["joint_springs:joint_3_u"] is not None


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("point,x[mm],y[mm]\na,1,2\n", "'z' is missing"),
        ("point,x[mm],y[mm],z[mm]\nq,1,2,3\n", "no point 'q'"),
        ("point,run,x[mm],y[mm],z[mm]\na,later,1,2,3\n", "no run"),
        ("point,x[mm],y[mm],z[mm]\na,1,2,3\na,1,2,3\n", "stands twice"),
        ("x[mm],y[mm],z[mm]\n1,2,3\n", "1 rows of the run 'after' for 3 points"),
        ("x[mm],y[mm],z[mm]\n" + "1,2,3\n" * 4, "4 rows"),
        ("x[mm],y[mm],z[mm]\n1,2,nan\n1,2,3\n1,2,3\n", "finite"),
    ],
)
def test_what_comes_back_wrong(run: Run, path: Path, tmp_path: Path, text: str, says: str) -> None:
    back, out = tmp_path / "back.csv", tmp_path / "new.src"
    back.write_text(text)
    found = run("compensate", "motoman_sk120", str(path), *PLACE, "--out", str(out),
                "--measured", str(back))  # fmt: skip
    assert found.code == 2
    assert says in found.stderr
    assert not out.exists()


def test_a_sheet_is_a_page(run: Run, path: Path, tmp_path: Path) -> None:
    out = ("--out", str(tmp_path / "new.csv"))
    bad = run("compensate", "motoman_sk120", str(path), *PLACE, *out, "--sheet", "sheet.pdf")
    assert bad.code == 2 and ".html" in bad.stderr
    sheet = tmp_path / "sheet.html"
    good = run("compensate", "motoman_sk120", str(path), *PLACE, *out, "--sheet", str(sheet))
    assert good.code == 0, good.stderr
    text = visible(sheet.read_text(encoding="utf-8"))
    assert "No uncertainty is stored in this model" in text
    assert "how far off the tool stands in truth is not known" in text


def test_points_without_labels_go_by_number(path: Path, tmp_path: Path) -> None:
    robot = load_robot("motoman_sk120")
    write_model(joint_spring_model(robot), tmp_path / "m.yaml")
    path.write_text(PATH.replace("point", "name"))
    given = read_path(path, robot, wrench=np.zeros(6))
    back = tmp_path / "back.csv"
    back.write_text("point,dx[um],dy[um],dz[um]\n3,1,2,3\n")
    (found,) = read_returned(back, given, np.zeros((3, 3)))
    np.testing.assert_allclose(found.away[2], [1e-6, 2e-6, 3e-6])
    assert found.seen.tolist() == [False, False, True]
