"""A gauge and the letter of the axis it reads along; a rope and the point it pulls to."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.columns.rows_in_words import understood_words
from sk120stiff.measurements.importers.drafting import Draft, drafted
from sk120stiff.measurements.importers.loads.pairs import unfolded
from tests.measurements.importers.reading import SIX, sheet_of, written

JOINTS = ";".join(f"J{k} [°]" for k in range(1, 7))
HEAD = f"Stellung;{JOINTS};Kraft [N];Kraftrichtung;Messuhr [1/100 mm];Messrichtung\n"


def read(folder: Path, text: str) -> Draft:
    sheet = unfolded(understood_words(sheet_of(folder, text), Told()))
    return drafted(sheet, Told(), SIX, ())


def test_direction_of_a_force_and_of_a_gauge_by_letters(tmp_path: Path) -> None:
    text = HEAD + "S1;1;2;3;4;5;6;40;-Y;-11,01;+Y\nS1;1;2;3;4;5;6;80;X;5;-Z\n"
    found = written(read(tmp_path, text))
    assert [found[f"d{axis}[um]"] for axis in "xyz"] == [("", ""), ("-110.1", ""), ("", "-50")]
    assert not any(header.startswith(("d[", "u")) for header in found)


def test_what_the_letters_are_taken_for_is_told(tmp_path: Path) -> None:
    draft = read(tmp_path, HEAD + "S1;1;2;3;4;5;6;40;-Y;-11,01;+Y\n")
    assert any("taken to rise along Messrichtung (+Y)" in said for said in draft.said)
    assert draft.loads.wrench[0].tolist() == [0.0, -40.0, 0.0, 0.0, 0.0, 0.0]


def test_a_gauge_before_and_after_along_a_letter(tmp_path: Path) -> None:
    head = HEAD.replace("Messuhr [1/100 mm]", "Messuhr vorher [mm];Messuhr nachher [mm]")
    found = written(read(tmp_path, head + "S1;1;2;3;4;5;6;40;-Y;1,50;1,25;Y\n"))
    assert found["dy[mm]"] == ("-0.25",) and found["dx[mm]"] == found["dz[mm]"] == ("",)


def test_a_direction_that_is_no_axis(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"'schräg' is no axis.*ux, uy, uz"):
        read(tmp_path, HEAD + "S1;1;2;3;4;5;6;40;-Y;-11,01;schräg\n")


def test_a_direction_without_a_gauge_is_left_out(tmp_path: Path) -> None:
    text = HEAD.replace("Messuhr [1/100 mm]", "dx [mm];dy [mm];dz [mm]")
    draft = read(tmp_path, text + "S1;1;2;3;4;5;6;40;-Y;0,1;0,2;0,3;X\n")
    assert "column Messrichtung: no gauge stands beside it" in draft.unused


ROPE = f"pose;{JOINTS};rope force [N];anchor x [mm];anchor y [mm];anchor z [mm];dx [mm]\n"


def test_a_rope_to_an_anchor_is_told_to_write_unit_vectors(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        read(tmp_path, ROPE + "1;1;2;3;4;5;6;60;1600;-1600;100;0,2\n")
    remedy = str(refused.value.remedy)
    assert "anchor x [mm], anchor y [mm] and anchor z [mm] look like the point" in remedy
    assert "unit vector in columns ex, ey, ez" in remedy
    plain = ROPE.replace("anchor ", "remark ")
    with pytest.raises(InputError, match="or a unit vector in columns ex, ey, ez"):
        read(tmp_path, plain + "1;1;2;3;4;5;6;60;1600;-1600;100;0,2\n")
