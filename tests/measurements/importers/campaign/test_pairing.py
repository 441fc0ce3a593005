"""Joints and loads of separate files: matched by name or order, and nothing lost silently."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Sheet
from sk120stiff.measurements.importers.campaign.pairing import paired
from tests.measurements.importers.reading import sheet_of

POINTS = "name,x[mm],y[mm],z[mm]\nA,1,2,3\nB,4,5,6\nC,,,\nD,7,8,9\n"


def joints(folder: Path, names: Sequence[str], header: str = "name,q1,q2,q3,q4,q5,q6") -> Sheet:
    rows = [f"{n},{k},0,0,0,0,0".lstrip(",") for k, n in enumerate(names)]
    (folder / "joints").mkdir(exist_ok=True)
    return sheet_of(folder / "joints", "\n".join([header, *rows]), role="joints")


def values(sheet: Sheet) -> dict[str, str]:
    column = sheet.get("joint 1")
    assert column is not None
    return dict(zip(sheet.get("name").cells, column.cells, strict=True))


def test_by_name_in_any_order(tmp_path: Path) -> None:
    found = paired(sheet_of(tmp_path, POINTS), joints(tmp_path, "DCBA"), "joints")
    assert values(found) == {"A": "3", "B": "2", "D": "0"}
    assert "matched by name" in " ".join(found.notes)
    column = found.get("joint 1")
    assert column is not None and found.place(column).endswith("joints/file, column q1")
    assert dict(found.skipped)[4].startswith("nothing stands in")


def test_by_name_what_has_no_partner_is_listed(tmp_path: Path) -> None:
    found = paired(sheet_of(tmp_path, POINTS), joints(tmp_path, "XABY"), "joints")
    assert values(found) == {"A": "1", "B": "2"}
    reasons = [each.reason for each in found.unpaired]
    assert reasons == ["D: not in file", "X of file: no point", "Y of file: no point"]


def test_by_order_counts_points_that_were_not_measured(tmp_path: Path) -> None:
    """C was not measured: D still has the fourth row of joints, not the third."""
    unnamed = joints(tmp_path, ["", "", "", ""], "q1,q2,q3,q4,q5,q6")
    found = paired(sheet_of(tmp_path, POINTS), unnamed, "joints")
    assert values(found) == {"A": "0", "B": "1", "D": "3"}
    assert "matched by order" in " ".join(found.notes)


def test_several_readings_of_a_name_share_its_joints(tmp_path: Path) -> None:
    text = POINTS.replace("D,", "A,")
    found = paired(sheet_of(tmp_path, text), joints(tmp_path, "ABC"), "joints")
    column = found.get("joint 1")
    assert column is not None and column.cells == ("0", "1", "0")


@pytest.mark.parametrize("names", ["ABCDEFGHIJKLMNOP", "XYZ", "123"])
def test_counts_that_differ_are_an_error(tmp_path: Path, names: str) -> None:
    other = joints(tmp_path, names)
    points = sheet_of(tmp_path, POINTS)
    if names.startswith("A"):
        assert len(paired(points, other, "joints").lines) == 3
        return
    with pytest.raises(InputError, match=r"4 points, but 3 rows of joints.*same names"):
        paired(points, other, "joints")


def test_a_few_names_that_agree_are_a_mistake(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"only 1 of 4 names agree \(D among them\)"):
        paired(sheet_of(tmp_path, POINTS), joints(tmp_path, "DEFG"), "joints")


def point_table(header: str, names: list[str]) -> str:
    rows = [f"{name},{k},0,0" for k, name in enumerate(names)]
    return "\n".join([f"{header},x[mm],y[mm],z[mm]", *rows])


@pytest.mark.parametrize(
    ("header", "own", "theirs", "how"),
    [
        ("Punto", ["1", "2", "3"], ["P3", "P1", "P2"], "by their numbers, as 1 and P1"),
        ("Pose", ["Pose 1", "Pose 2", "Pose 3"], ["P03", "P01", "P02"], "by their numbers"),
        ("Nr", ["1", "2", "3"], ["3.0", "1.0", "2.0"], "by their numbers"),
        ("Bodíček", ["P1", "P2", "P3"], ["P3", "P1", "P2"], "by what they hold"),
    ],
)
def test_labels_that_are_written_otherwise(
    tmp_path: Path, header: str, own: list[str], theirs: list[str], how: str
) -> None:
    points = sheet_of(tmp_path, point_table(header, own))
    found = paired(points, joints(tmp_path, theirs), "joints")
    column = found.get("joint 1")
    assert column is not None and column.cells == ("1", "2", "0")
    assert how in " ".join(found.notes)


@pytest.mark.parametrize("headers", ["Nr,Pose", "Nr,Punto", "Nr,Config", "Index,Bodíček"])
def test_of_two_columns_of_labels_that_counts_which_the_other_file_has(
    tmp_path: Path, headers: str
) -> None:
    """A count of rows agrees with some of the poses' numbers by chance."""
    text = f"{headers},x[mm],y[mm],z[mm]\n" + "".join(
        f"{k + 1},{k // 2 + 1},{k},0,0\n" for k in range(6)
    )
    found = paired(sheet_of(tmp_path, text), joints(tmp_path, "321"), "joints")
    column = found.get("joint 1")
    assert column is not None and column.cells == ("2", "2", "1", "1", "0", "0")


@pytest.mark.parametrize("theirs", [["B1", "B2", "B3"], ["P1", "P2", "Home"]])
def test_labels_that_do_not_agree_are_told(tmp_path: Path, theirs: list[str]) -> None:
    points = sheet_of(tmp_path, point_table("name", ["A1", "A2", "A3"]))
    found = paired(points, joints(tmp_path, theirs), "joints")
    assert "matched by order (name and name do not agree)" in " ".join(found.notes)
