"""Branches, repetitions, poses and directions of forces in the words of laboratories."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.columns.rows_in_words import understood_words
from sk120stiff.measurements.importers.columns.words import meaning_of
from sk120stiff.measurements.importers.drafting import Draft, drafted
from tests.measurements.importers.reading import SIX, sheet_of, written

HEAD = "Stellung;A1 [°];A2 [°];A3 [°];A4 [°];A5 [°];A6 [°];dX [mm];dY [mm];dZ [mm];"


def read(folder: Path, more: str, rows: list[str], **told: object) -> Draft:
    lines = [f"S{k // 2 + 1};{k // 2};2;3;4;5;6;7,5;8;9;{row}" for k, row in enumerate(rows)]
    sheet = sheet_of(folder, "\n".join([HEAD + more, *lines]) + "\n")
    known = Told(**told)
    return drafted(understood_words(sheet, known), known, SIX, ())


@pytest.mark.parametrize(
    ("words", "header"),
    [
        (("auf", "ab"), "Richtung"), (("up", "down"), "direction"), (("Load", "Unload"), "Branch"),
        (("load", "unload"), "Richtung"), (("belastet", "entlastet"), "Richtung"),
        (("Belastung", "Entlastung"), "Ast"), (("loading", "unloading"), "branch"),
    ],
)  # fmt: skip
def test_branches_in_other_words(words: tuple[str, str], header: str, tmp_path: Path) -> None:
    rows = [f"0;0;-100;{words[0]};1", f"0;0;-100;{words[1]};1", f"0;0;-50;{words[0]};2"]
    found = read(tmp_path, f"Fx [N];Fy [N];Fz [N];{header};Wdh", rows)
    assert written(found)["branch"] == ("load", "unload", "load")
    assert written(found)["repeat"] == ("1", "1", "2")
    assert found.pose == ("S1", "S1", "S2")
    told = any(f"The column {header} tells the branch: {words[0]} is load" in s for s in found.said)
    assert told == (words != ("load", "unload"))


def test_rows_without_load_need_no_branch_and_others_do(tmp_path: Path) -> None:
    more = "Fx [N];Fy [N];Fz [N];Richtung"
    found = read(tmp_path, more, ["0;0;0;-", "0;0;-9;auf", "0;0;0;", "0;0;-9;ab"])
    assert written(found)["branch"] == ("", "load", "", "unload")
    found = read(tmp_path, more, ["0;0;-5;", "0;0;-9;auf"])
    assert "branch" not in written(found)
    assert "column Richtung: some cells are empty" in found.unused


def test_words_that_are_neither_are_told(tmp_path: Path) -> None:
    found = read(tmp_path, "Fx [N];Fy [N];Fz [N];Richtung", ["0;0;-5;links", "0;0;-9;rechts"])
    assert "branch" not in written(found)
    assert any("column Richtung: its words are neither axes" in item for item in found.unused)


def test_repetitions_by_a_label_are_counted(tmp_path: Path) -> None:
    found = read(tmp_path, "Fz [N];Run", ["-5;b", "-9;a", "-9;b"])
    assert written(found)["repeat"] == ("1", "2", "1")
    assert any("counts repetitions: b is 1 and a is 2" in said for said in found.said)
    assert written(read(tmp_path, "Fz [N];Rep", ["-5;3,0", "-9;1,0"]))["repeat"] == ("3", "1")


@pytest.mark.parametrize("header", ["Kraft", "F", "Prüfkraft", "Size"])
def test_a_force_from_its_size_and_its_direction(header: str, tmp_path: Path) -> None:
    words = ["-Z", "+X", "y-", "z", "Y +", "-"]
    rows = [f"{10 if word != '-' else 0};{word}" for word in words]
    found = read(tmp_path, f"{header} [kgf];Richtung", rows)
    expected = np.zeros((6, 6))
    expected[[0, 1, 2, 3, 4], [2, 0, 1, 2, 1]] = 98.0665 * np.array([-1, 1, -1, 1, 1])
    np.testing.assert_allclose(found.loads.wrench, expected)
    assert found.loads.payload is None and found.loads.frame == "base"
    assert any(f"made of {header} [kgf]" in said and "-Z, +X" in said for said in found.said)
    assert not found.unused


@pytest.mark.parametrize("names", ["ex;ey;ez", "n_x;n_y;n_z", "Richtung x;Richtung y;Richtung z"])
def test_a_force_from_its_size_and_a_unit_vector(names: str, tmp_path: Path) -> None:
    found = read(tmp_path, f"|F| / N;{names}", ["100;0,6;0;-0,8", "0;0;0;0"])
    np.testing.assert_allclose(found.loads.wrench[:, :3], [[60, 0, -80], [0, 0, 0]])
    assert not found.unused
    assert any("times its direction" in said for said in found.said)
    with pytest.raises(InputError, match="no unit vector"):
        read(tmp_path, f"Kraft [N];{names}", ["100;0,6;0;-0,8", "50;30;0;40"])


def test_the_first_column_of_a_matrix_is_no_direction(tmp_path: Path) -> None:
    found = read(tmp_path, "Payload [kg];nx;ny;nz;ox;oy;oz;ax;ay;az", ["10;1;0;0;0;1;0;0;0;1"])
    assert found.loads.payload is not None and not found.loads.wrench[:, :2].any()


@pytest.mark.parametrize("names", ["nx;ny;nz", "ex [mm];ey [mm];ez [mm]"])
def test_a_mass_pulls_down_whatever_normal_stands_beside_it(names: str, tmp_path: Path) -> None:
    found = read(tmp_path, f"Payload [kg];{names}", ["10;0;0;1", "0;0;0;1"])
    assert found.loads.payload is not None
    np.testing.assert_allclose(found.loads.wrench[:, 2], [-98.0665, 0.0])


def test_a_mass_over_a_pulley_pulls_along_its_unit_vector(tmp_path: Path) -> None:
    found = read(tmp_path, "mass [kg];ex;ey;ez", ["10;0,6;0;-0,8", "0;0;0;0"])
    assert found.loads.payload is None
    np.testing.assert_allclose(found.loads.wrench[:, :3], 9.80665 * np.array([[6, 0, -8], [0] * 3]))
    assert any("A mass pulls with its weight" in said for said in found.said)


def test_axes_of_the_tool_and_a_unit_that_is_told(tmp_path: Path) -> None:
    rows = ["10;-Z", "-10;Y"]
    found = read(tmp_path, "Kraft;direction", rows, load="kN", forces="tool")
    np.testing.assert_allclose(found.loads.wrench[:, 1:3], [[0, -1e4], [-1e4, 0]])
    assert found.loads.frame == "tool"
    with pytest.raises(InputError, match="nobody said in which unit"):
        read(tmp_path, "Kraft;direction", rows)


@pytest.mark.parametrize(("header", "told"), [("Last [kg]", {}), ("Payload", {"load": "kg"})])
def test_a_mass_pulls_along_its_direction(
    header: str, told: dict[str, str], tmp_path: Path
) -> None:
    found = read(tmp_path, f"{header};Richtung", ["10;-Z", "20;+X"], **told)
    np.testing.assert_allclose(found.loads.wrench[:, [0, 2]], [[0, -98.0665], [196.133, 0]])
    assert found.loads.payload is None
    assert any("A mass pulls with its weight along that direction" in said for said in found.said)


@pytest.mark.parametrize(
    ("more", "rows", "words"),
    [
        ("Kraft [N];Richtung", ["-10;-Z", "5;-Z"], "a sign stands at both"),
        ("Kraft [N];Richtung", ["10;-Z", "5;"], "and no direction"),
        ("Kraft [N];Last [N];Richtung", ["10;1;-Z", "5;1;-Z"], "may each be the size"),
        ("Fz [N];Richtung", ["10;-Z", "5;+X"], r"\+X is no direction of Fz \[N\]"),
    ],
)
def test_directions_that_say_too_much_or_too_little(
    more: str, rows: list[str], words: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=words):
        read(tmp_path, more, rows)


def test_a_direction_beside_components_is_a_note(tmp_path: Path) -> None:
    found = read(tmp_path, "Fx [N];Fy [N];Fz [N];Richtung", ["1;2;-10;+Z", "1;2;-5;+Z"])
    np.testing.assert_array_equal(found.loads.wrench[:, :3], [[1, 2, -10], [1, 2, -5]])
    assert any("column Richtung: the components of the force" in item for item in found.unused)


@pytest.mark.parametrize(
    ("header", "meaning"),
    [("Wiederholung", "repeat"), ("Rep.", "repeat"), ("run", "repeat"), ("Stellung", "pose"),
     ("Pose", "pose"), ("Punkt", "name"), ("Kraftrichtung", "force direction"),
     ("branch", "branch")],
)  # fmt: skip
def test_headers_of_rows(header: str, meaning: str) -> None:
    assert meaning_of(header) == (meaning, 1.0)


def test_a_branch_and_a_direction_of_the_force_stand_side_by_side(tmp_path: Path) -> None:
    found = read(tmp_path, "Kraft [N];Kraftrichtung;Richtung", ["10;-Z;auf", "10;-Z;ab"])
    assert written(found)["branch"] == ("load", "unload")
    np.testing.assert_allclose(found.loads.wrench[:, 2], -10.0)
    assert not found.unused
