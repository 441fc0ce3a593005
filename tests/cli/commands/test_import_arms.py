"""`sk120stiff import`: of a robot of two arms, the one whose joints the columns name."""

from pathlib import Path

import numpy as np
import openpyxl
import yaml

from sk120stiff.robot import load_robot
from tests.corpus.robots import example

BAXTER = str(example("baxter.urdf"))
LEFT = load_robot(BAXTER, tool="left_hand_link")
RNG = np.random.default_rng(1)
Q = RNG.uniform(-0.6, 0.6, (15, 7)).round(5)
X = 1e3 * LEFT.placement(Q)[:, :3, 3] + RNG.normal(0.0, 0.05, (15, 3))
XYZ = ["X [mm]", "Y [mm]", "Z [mm]"]
Rows = list[list[object]]


def joints(prefix: str) -> list[str]:
    return [f"{prefix}{name[len('left_') :]} [rad]" for name in LEFT.actuated]


def table(*headers: str, values: np.ndarray) -> Rows:
    return [["Pose", *headers], *([f"P{k}", *map(float, row)] for k, row in enumerate(values))]


def written(path: Path, rows: Rows) -> str:
    path.write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n")
    return str(path)


def test_the_arm_that_the_columns_name(run, tmp_path: Path) -> None:
    points = written(tmp_path / "points.csv", table(*XYZ, values=X))
    angles = written(tmp_path / "joints.csv", table(*joints("left_"), values=Q))
    out = tmp_path / "own.csv"
    told = ("--joints-file", angles, "--robot", BAXTER, "--out", str(out))
    outcome = run("import", points, *told)
    assert outcome.code == 0
    assert "Tool frame: left_hand_link, since the columns name the joints" in outcome.stderr
    assert yaml.safe_load(out.with_suffix(".yaml").read_text())["tool_frame"] == "left_hand_link"
    right = run("import", points, *told, "--tool", "right_hand_link")
    assert right.code == 2 and "since the columns" not in right.stderr


def test_in_another_sheet_of_a_workbook(run, tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    for title, rows in (
        ("Points", table(*XYZ, values=X)),
        ("Joints", table(*joints("left_"), values=Q)),
    ):
        page = book.create_sheet(title)
        for row in rows:
            page.append(row)
    path = tmp_path / "all.xlsx"
    book.save(path)
    outcome = run("import", str(path), "--robot", BAXTER, "--preview")
    assert outcome.code == 0 and "Tool frame: left_hand_link" in outcome.stderr


def test_where_no_column_tells_the_choices_are_named(run, tmp_path: Path) -> None:
    both = table(*joints(""), *XYZ, values=np.hstack([Q, X]))
    outcome = run("import", written(tmp_path / "a.csv", both), "--robot", BAXTER, "--preview")
    assert outcome.code == 2
    assert (
        "--tool right_hand_link (right_s0 to right_w2) or --tool left_hand_link (left_s0 to "
        "left_w2)" in outcome.stderr
    )


def test_columns_of_both_arms_leave_the_usual_choice(run, tmp_path: Path) -> None:
    both = table(*joints("left_"), *joints("right_"), *XYZ, values=np.hstack([Q, Q, X]))
    outcome = run("import", written(tmp_path / "a.csv", both), "--robot", BAXTER, "--preview")
    assert "Tool frame: right_hand_link (its name says so" in outcome.stderr
