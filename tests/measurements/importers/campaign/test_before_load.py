"""Positions without and with the load in two files."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from sk120stiff import load_robot
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Imported, Told, import_readings
from sk120stiff.measurements.importers.campaign.before_load import with_before
from sk120stiff.measurements.importers.loads.pairs import unfolded
from tests.measurements.importers.reading import sheet_of
from tests.measurements.importers.tracked import TURN, Campaign, campaign, ur5

SEEN = campaign(14)
MOVED = np.random.default_rng(3).normal(0.0, 2.0, (14, 3))  # mm, what the load moves, tracker axes
JOINTS = [f"J{k} [deg]" for k in range(1, 7)]


def table(path: Path, head: list[str], rows: list[list[object]]) -> Path:
    path.write_text("\n".join(";".join(map(str, row)) for row in [head, *rows]) + "\n")
    return path


def positions(path: Path, x: np.ndarray, names: tuple[str, ...] | None, head: str = "Name") -> Path:
    labels = [[n] for n in names] if names else [[] for _ in x]
    rows = [[*label, *(f"{v:.4f}" for v in row)] for label, row in zip(labels, x, strict=True)]
    return table(path, [*([head] if names else []), "X [mm]", "Y [mm]", "Z [mm]"], rows)


def files(folder: Path, seen: Campaign = SEEN, named: bool = True) -> dict[str, Path]:
    """Positions under load, those without in reverse order if named, joints and loads."""
    names = tuple(seen.names) if named else None
    back = slice(None, None, -1) if named else slice(None)
    label = [[n] for n in seen.names] if named else [[] for _ in seen.names]
    joints = [[*k, *(f"{v:.5f}" for v in q)] for k, q in zip(label, seen.q, strict=True)]
    head = ["Name"] if named else []
    return {
        "path": positions(folder / "after.csv", seen.x + MOVED, names),
        "before": positions(folder / "before.csv", seen.x[back], names and names[back]),
        "joints_file": table(folder / "joints.csv", [*head, *JOINTS], joints),
        "loads_file": table(folder / "loads.csv", [*head, "Fz [N]"], [[*k, -200] for k in label]),
    }


def brought(given: dict[str, Path], **told: object) -> Imported:
    robot = load_robot(ur5(), tool="tool0")
    return import_readings(given.pop("path"), robot, Told(**told), **given)


@pytest.mark.parametrize("named", [True, False])
def test_they_are_paired_by_name_or_by_row(named: bool, tmp_path: Path) -> None:
    found = brought(files(tmp_path, named=named))
    assert found.mode == "load pairs" and found.useful_poses == 14
    order = [SEEN.names.index(p) for p in found.readings.pose] if named else np.arange(14)
    moved = 1e3 * found.readings.displacement
    np.testing.assert_allclose(moved, TURN.inv().apply(MOVED[order]), atol=0.15)
    np.testing.assert_allclose(found.readings.wrench[:, 2], -200.0)
    how = "matched by name" if named else "matched by order"
    assert sum(how in said for said in found.said) == 3
    found.write(tmp_path / "own.csv")
    keys = yaml.safe_load((tmp_path / "own.yaml").read_text())
    assert keys["displacement"] == {"frame": "base", "zero": "separate"}
    assert any("zero reading of its own" in said for said in found.said)
    assert "before.csv" in keys["source"]


def test_poses_of_one_file_alone_are_told_and_left_out(tmp_path: Path) -> None:
    given = files(tmp_path)
    names = ("elsewhere", *SEEN.names[1:])
    positions(given["before"], SEEN.x, names)
    found = brought(given)
    assert found.useful_poses == 13
    lost = [each.reason for each in found.draft.sheet.unpaired]
    assert f"{SEEN.names[0]}: not in before.csv" in lost
    assert "elsewhere of before.csv: no point" in lost


def test_two_loads_of_a_pose_share_the_reading_without(tmp_path: Path) -> None:
    given = files(tmp_path)
    x, names = np.vstack([SEEN.x + MOVED, SEEN.x + 2.0 * MOVED]), tuple(SEEN.names) * 2
    positions(given["path"], x, names)
    rows = [f"{'200' if k < 14 else '400'}" for k in range(28)]
    text = given["path"].read_text().splitlines()
    text = [f"{text[0]};Fz [N]", *(f"{a};{b}" for a, b in zip(text[1:], rows, strict=True))]
    given["path"].write_text("\n".join(text) + "\n")
    del given["loads_file"]
    found = brought(given)
    assert found.readings.zero == "shared" and found.readings.n_readings == 28
    assert found.settings["displacement"]["zero"] == "shared"
    np.testing.assert_allclose(np.unique(found.readings.wrench[:, 2]), [200.0, 400.0])


def test_one_load_in_all_rows_may_be_told(tmp_path: Path) -> None:
    given = files(tmp_path)
    del given["loads_file"]
    found = brought(given, wrench=np.array([0.0, 10.0, -50.0, 0.0, 0.0, 0.0]))
    np.testing.assert_allclose(found.readings.wrench, [[0.0, 10.0, -50.0, 0, 0, 0]] * 14)
    with pytest.raises(InputError, match="no column says the load") as caught:
        brought(files(tmp_path) | {"loads_file": None})
    assert "--wrench" in caught.value.remedy


def test_names_may_stand_in_a_column_of_poses(tmp_path: Path) -> None:
    given = files(tmp_path)
    positions(given["before"], SEEN.x[::-1], tuple(SEEN.names[::-1]), head="Pose")
    found = brought(given)
    assert any("matched by name (Name, Pose)" in said for said in found.said)


def test_joints_of_both_files_are_held_against_each_other(tmp_path: Path) -> None:
    given = files(tmp_path)
    del given["joints_file"]

    def with_joints(path: Path, x: np.ndarray, q: np.ndarray) -> None:
        rows = [
            [n, *map(str, each), *map(str, place)]
            for n, each, place in zip(SEEN.names, q, x, strict=True)
        ]
        table(path, ["Name", *JOINTS, "X [mm]", "Y [mm]", "Z [mm]"], rows)

    with_joints(given["before"], SEEN.x, SEEN.q)
    assert brought(dict(given)).useful_poses == 14  # of the file without load alone
    with_joints(given["path"], SEEN.x + MOVED, SEEN.q)
    assert brought(dict(given)).useful_poses == 14
    with_joints(given["path"], SEEN.x + MOVED, SEEN.q + np.eye(14, 6)[::-1])
    with pytest.raises(InputError, match="another pose"):
        brought(dict(given))


def test_what_does_not_go_together_is_refused(tmp_path: Path) -> None:
    given = files(tmp_path)
    with pytest.raises(InputError, match="the same to the last digit"):
        brought(given | {"before": given["path"]})
    with pytest.raises(InputError, match="this file holds"):
        brought(given | {"before": given["joints_file"]})
    names = (SEEN.names[1], *SEEN.names[1:])
    positions(given["before"], SEEN.x, names)
    with pytest.raises(InputError, match=f"{SEEN.names[1]} stands there more than once"):
        brought(dict(given))
    given = files(tmp_path)
    text = given["before"].read_text().splitlines()
    text = [f"{text[0]};Fz [N]", *(f"{line};-5" for line in text[1:])]
    given["before"].write_text("\n".join(text) + "\n")
    with pytest.raises(InputError, match="a load stands in the file of positions without load"):
        brought(dict(given))
    given = files(tmp_path)
    robot = load_robot(ur5(), tool="tool0")
    paths = [given["path"], given["before"]]
    with pytest.raises(InputError, match="2 files of positions, and one of positions without"):
        import_readings(paths, robot, before=given["before"], joints_file=given["joints_file"])


def test_two_passes_that_say_no_load_are_doubted(tmp_path: Path) -> None:
    given = files(tmp_path)
    paths = [given["path"], given["before"]]
    robot = load_robot(ur5(), tool="tool0")
    found = import_readings(paths, robot, joints_file=given["joints_file"])
    assert any(
        "the same names, and none says a load" in d and "--before" in d for d in found.doubts
    )


def test_loads_by_size_and_direction_in_their_own_file(tmp_path: Path) -> None:
    given = files(tmp_path)
    rows = [[name, 20, "+X" if k % 2 else "-Z"] for k, name in enumerate(SEEN.names)]
    table(given["loads_file"], ["Name", "Kraft [daN]", "Richtung"], rows)
    found = brought(given)
    odd = np.array([SEEN.names.index(p) % 2 for p in found.readings.pose], dtype=bool)
    np.testing.assert_allclose(found.readings.wrench[odd, 0], 200.0)
    np.testing.assert_allclose(found.readings.wrench[~odd, 2], -200.0)


def test_a_reading_without_load_serves_several_loads_once(tmp_path: Path) -> None:
    """It was written once for every load, and then told as a row that was pasted twice."""
    loaded = "name,payload[kg],x[mm],y[mm],z[mm]\n" + "".join(
        f"{name},{mass},{x},2,{3 - mass}\n" for name, x in (("A", 1), ("B", 4)) for mass in (1, 2)
    )
    before = sheet_of(tmp_path, "name,x[mm],y[mm],z[mm]\nA,1,2,3\nB,4,2,3\n")
    (tmp_path / "loaded").mkdir()
    whole = unfolded(with_before(sheet_of(tmp_path / "loaded", loaded), before, Told()))
    payload, z = whole.get("payload"), whole.get("z")
    assert payload is not None and payload.cells == ("0", "1", "2", "0", "1", "2")
    assert z is not None and z.cells == ("3", "2", "1", "3", "2", "1")
