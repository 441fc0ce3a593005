"""Files and sheets that hold one pose each."""

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from sk120stiff import load_robot
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Imported, import_readings
from tests.measurements.importers.tracked import campaign, ur5

SEEN = campaign(12)
MOVED = np.random.default_rng(3).normal(0.0, 0.5, (12, 3))  # mm, what 100 N move, tracker axes
JOINTS = [f"J{k} [deg]" for k in range(1, 7)]
READINGS = ["Fz [N]", "X [mm]", "Y [mm]", "Z [mm]"]
Rows = list[list[object]]


def readings(pose: int) -> Rows:
    """Without the load and with it."""
    loads = ((0.0, 0.0), (-100.0, 1.0))
    return [[force, *(SEEN.x[pose] + share * MOVED[pose])] for force, share in loads]


def joints(pose: int) -> list[object]:
    return list(SEEN.q[pose])


def table(pose: int) -> Rows:
    return [[*JOINTS, *READINGS], *([*joints(pose), *row] for row in readings(pose))]


def joint_table(labels: Sequence[str]) -> Rows:
    """In another order than that of the poses."""
    rows: Rows = [[label, *joints(k)] for k, label in enumerate(labels)]
    return [["Pose", *JOINTS], *rows[::-1]]


def written(path: Path, rows: Rows) -> Path:
    path.write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n")
    return path


def book(path: Path, sheets: dict[str, Rows]) -> Path:
    made = openpyxl.Workbook()
    made.remove(made.active)
    for title, rows in sheets.items():
        page = made.create_sheet(title)
        for row in rows:
            page.append([float(v) if isinstance(v, float) else v for v in row])
    stream = io.BytesIO()
    made.save(stream)
    path.write_bytes(stream.getvalue())
    return path


def brought(path: Path | list[Path], joints_file: Path | None = None) -> Imported:
    return import_readings(path, load_robot(ur5(), tool="tool0"), joints_file=joints_file)


def of_poses(found: Imported, labels: Sequence[str]) -> None:
    """Both readings of every pose have its label and its joints, in their order."""
    assert found.draft.pose == tuple(label for label in labels for _ in range(2))
    np.testing.assert_allclose(found.draft.joints.values[::2], np.radians(SEEN.q), atol=1e-7)
    np.testing.assert_allclose(found.draft.joints.values[1::2], np.radians(SEEN.q), atol=1e-7)


def said(found: Imported, words: str) -> bool:
    return any(words in each for each in found.said)


NUMBERS = [str(k + 1) for k in range(12)]


def test_files_in_the_order_of_a_shell(tmp_path: Path) -> None:
    paths = [written(tmp_path / f"Pose_{k + 1}.csv", table(k)) for k in range(12)]
    found = brought(sorted(paths))
    of_poses(found, NUMBERS)
    assert said(found, "Each holds one pose, labelled after the names of the files: 1 to 12.")
    assert said(found, "in the order of the numbers in their names: Pose_1.csv, Pose_2.csv")


@pytest.mark.parametrize("name", ["Pose_{}", "scan {}"])
@pytest.mark.parametrize("label", ["{}", "P{}", "Pose {}"])
def test_their_joints_in_another_file(tmp_path: Path, name: str, label: str) -> None:
    """The rows have numbers of their own, which are not those of the poses."""
    paths = []
    for k in range(12):
        rows: Rows = [["Nr", *READINGS], *([n, *row] for n, row in enumerate(readings(k), 1))]
        paths.append(written(tmp_path / f"{name.format(k + 1)}.csv", rows))
    labels = [label.format(k + 1) for k in range(12)]
    other = written(tmp_path / "joints.csv", joint_table(labels))
    found = brought(sorted(paths), other)
    of_poses(found, NUMBERS)
    assert said(found, "So of 11 more.")


@pytest.mark.parametrize("names", [[f"a{k}" for k in range(12)], list("kqwertzuiopa")])
@pytest.mark.parametrize("ending", ["", ".csv"])
def test_a_table_of_joints_that_names_the_files(
    tmp_path: Path, names: list[str], ending: str
) -> None:
    paths = [
        written(tmp_path / f"{name}.csv", [READINGS, *readings(k)]) for k, name in enumerate(names)
    ]
    rows = joint_table([f"{name}{ending}" for name in names])
    other = written(tmp_path / "joints.csv", [["File", *rows[0][1:]], *rows[1:]])
    assert brought(paths, other).draft.pose[::2] == tuple(f"{name}{ending}" for name in names)


def test_files_of_other_numbers_are_of_no_pose_of_the_joints(tmp_path: Path) -> None:
    """Two scans are not the first two of twelve poses."""
    paths = [written(tmp_path / f"scan{k + 1}.csv", [READINGS, *readings(k)]) for k in range(2)]
    other = written(tmp_path / "joints.csv", joint_table(NUMBERS))
    with pytest.raises(InputError, match="neither names nor times"):
        brought(paths, other)


def test_files_of_several_poses_keep_their_own(tmp_path: Path) -> None:
    paths = []
    for k in (0, 1):
        rows = [row for pose in range(6 * k, 6 * k + 6) for row in table(pose)[1:]]
        paths.append(written(tmp_path / f"pose{k + 1}.csv", [table(0)[0], *rows]))
    assert len(set(brought(paths).draft.pose)) == 12


def test_one_sheet_for_each_pose(tmp_path: Path) -> None:
    titles = [f"Pose {k + 1}" for k in range(12)]
    sheets = {title: table(k) for k, title in enumerate(titles)}
    summary: Rows = [["Pose", "dX [mm]", "dY [mm]", "dZ [mm]"], ["Pose 1", 0.1, 0.2, 0.3]]
    found = brought(book(tmp_path / "all.xlsx", {"Summary": summary, **sheets}))
    of_poses(found, titles)
    assert said(found, "Pose 1, Pose 2, Pose 3, Pose 4 and 8 more of all.xlsx are taken together")
    assert "sheet Summary" in found.draft.unused
    assert found.settings["source"].startswith("imported from all.xlsx")


UNITS = ["°"] * 6
ABOVE: dict[str, list[Rows]] = {
    "names above numbers": [[JOINTS, joints(k), []] for k in range(12)],
    "and units between": [[[f"A{j}" for j in range(1, 7)], UNITS, joints(k)] for k in range(12)],
    "behind one word": [[["Pose", k], ["Joint angles [deg]", *joints(k)]] for k in range(12)],
    "one below the other": [
        [[name, value] for name, value in zip(JOINTS, joints(k), strict=True)] for k in range(12)
    ],
    "each with its unit": [
        [[f"q{j}", value, "deg"] for j, value in enumerate(joints(k), 1)] for k in range(12)
    ],
    "in one cell": [
        [[f"q = [{', '.join(f'{v:.9f}' for v in SEEN.q[k])}] deg"]] for k in range(12)
    ],
    "in one cell behind words": [
        [[f"Joint angles (deg): {'; '.join(f'{v:.9f}' for v in SEEN.q[k])}"]] for k in range(12)
    ],
    "in one line": [
        [[cell for pair in zip(JOINTS, joints(k), strict=True) for cell in pair]] for k in range(12)
    ],
}  # fmt: skip


@pytest.mark.parametrize("way", ABOVE)
def test_joints_in_a_few_cells_above_the_table(tmp_path: Path, way: str) -> None:
    titles = [f"P{k + 1}" for k in range(12)]
    sheets = {t: [*ABOVE[way][k], READINGS, *readings(k)] for k, t in enumerate(titles)}
    found = brought(book(tmp_path / "all.xlsx", sheets))
    of_poses(found, titles)
    assert said(found, "joint values above the table, which hold for all its rows")
    assert not any("line 1: J1" in item for item in found.draft.unused)


def test_two_sets_of_joints_above_are_not_chosen_from(tmp_path: Path) -> None:
    rows = [JOINTS, joints(0), JOINTS, joints(1), READINGS, *readings(0)]
    with pytest.raises(InputError, match="holds no joint values"):
        brought(written(tmp_path / "a.csv", rows))


@pytest.mark.parametrize(
    "above",
    [
        [["Joint limits [deg]", *joints(0)]],
        [["", *JOINTS], ["Gear ratio", *joints(0)]],
        [["Home position", *JOINTS], ["", *joints(0)]],
    ],
)
def test_what_else_is_told_of_joints_above_a_table(tmp_path: Path, above: Rows) -> None:
    with pytest.raises(InputError, match="holds no joint values"):
        brought(written(tmp_path / "a.csv", [*above, READINGS, *readings(0)]))


def test_joints_above_are_not_those_of_several_poses(tmp_path: Path) -> None:
    """As of the place where the arm began, above a table whose joints are in another file."""
    rows: Rows = [[f"P{k + 1}", *row] for k in range(12) for row in readings(k)]
    path = written(tmp_path / "a.csv", [JOINTS, [0] * 6, ["Pose", *READINGS], *rows])
    with pytest.raises(InputError, match="holds no joint values"):
        brought(path)
    other = written(tmp_path / "joints.csv", joint_table([f"P{k + 1}" for k in range(12)]))
    of_poses(brought(path, other), [f"P{k + 1}" for k in range(12)])


@pytest.mark.parametrize("title", ["P{}", "Station {} left"])
def test_sheets_whose_joints_are_in_one_more(tmp_path: Path, title: str) -> None:
    titles = [title.format(k + 1) for k in range(12)]
    sheets = {t: [READINGS, *readings(k)] for k, t in enumerate(titles)}
    found = brought(book(tmp_path / "all.xlsx", {**sheets, "Joints": joint_table(titles)}))
    of_poses(found, titles)
    assert not any("sheet" in item for item in found.draft.unused)


def test_sheets_with_names_of_their_own(tmp_path: Path) -> None:
    titles = ["Home", "Left", "Right", "Up", "Down", "Far", "Near", "Low", "High", "X", "Y", "Z"]
    whole = book(tmp_path / "whole.xlsx", {t: table(k) for k, t in enumerate(titles)})
    of_poses(brought(whole), titles)
    sheets = {t: [READINGS, *readings(k)] for k, t in enumerate(titles)}
    apart = book(tmp_path / "apart.xlsx", {**sheets, "Joints": joint_table(titles)})
    of_poses(brought(apart), titles)
    alone = book(tmp_path / "alone.xlsx", dict(sheets))
    with pytest.raises(InputError, match=r"Choose one: --sheet 'Home'"):
        brought(alone)


def test_sheets_of_several_markers_or_other_columns_are_asked_for(tmp_path: Path) -> None:
    rows = [table(0)[0], *(row for k in range(12) for row in table(k)[1:])]
    for sheets in ({"SMR1": rows, "SMR2": rows}, {"S1": rows, "S2": [READINGS, *readings(0)]}):
        with pytest.raises(InputError, match="hold readings"):
            brought(book(tmp_path / "all.xlsx", sheets))


def test_sheets_that_say_a_mass(tmp_path: Path) -> None:
    sheets: dict[str, Rows] = {}
    for share, title in enumerate(("0 kg", "2.5 kg", "5 kg")):
        rows: Rows = [[f"P{k + 1}", *joints(k), *(SEEN.x[k] + share * MOVED[k])] for k in range(12)]
        sheets[title] = [["Pose", *JOINTS, *READINGS[1:]], *rows]
    found = brought(book(tmp_path / "all.xlsx", sheets))
    assert found.draft.loads.payload is not None
    assert sorted(set(found.draft.loads.payload)) == [0.0, 2.5, 5.0]
    assert found.draft.pose[:2] == ("P1", "P2") and len(set(found.draft.pose)) == 12
