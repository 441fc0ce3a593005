"""Files with several markers: one that is chosen, or all where it is told where each sits."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import FORMATS, Source
from sk120stiff.measurements.importers.one_file import opened
from sk120stiff.measurements.importers.told import Told
from sk120stiff.measurements.importers.tracker.several_markers import (
    of_marker,
    refuse_one_marker_twice,
    refuse_several_points,
    with_places,
)
from tests.measurements.importers.reading import SIX, draft_of, sheet_of

HEADER = (
    "pose,{}q1[deg],q2[deg],q3[deg],q4[deg],q5[deg],q6[deg],fx[N],fy[N],fz[N],x[mm],y[mm],z[mm]\n"
)
PLACES = {"M1": 100.0, "M2": 240.0, "M3": 310.0}


def table(*names: str, named: bool = True, column: str = "marker") -> str:
    """Three poses, each without load and with it, read at markers that sit apart."""
    lines = [HEADER.format(f"{column}," if named else "")]
    for pose in range(3):
        joints = ",".join(str(10 * pose + k) for k in range(6))
        for load in (0, -500):
            lines += [
                f"P{pose},{f'{name},' if named else ''}{joints},0,0,{load},{900 + 50 * pose},"
                f"{PLACES[name]},{700 + load / 1000}\n"
                for name in names
            ]
    return "".join(lines)


def test_one_of_several_is_read(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, table("M1", "M2", "M3", column="Reflector"))
    found = of_marker(sheet, "M2")
    assert found.lines == (3, 6, 9, 12, 15, 18)
    assert found.get("marker") is None and "Marker M2 is read." in found.notes
    y = found.get("y")
    assert y is not None and set(y.cells) == {"240.0"}
    assert of_marker(sheet, None) is sheet


def test_a_marker_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no marker M7.*M1 and M2"):
        of_marker(sheet_of(tmp_path, table("M1", "M2")), "M7")
    with pytest.raises(InputError, match="no column names markers"):
        of_marker(sheet_of(tmp_path, table("M1", named=False)), "M1")


def test_displacements_of_several_points_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"markers M1, M2 and M3.*--marker M1"):
        refuse_several_points(draft_of(tmp_path, table("M1", "M2", "M3"), SIX))
    refuse_several_points(draft_of(tmp_path, table("M1"), SIX))


SIDE_BY_SIDE = (
    "pose,q1[deg],q2[deg],q3[deg],q4[deg],q5[deg],q6[deg],fx[N],fy[N],fz[N],"
    "dx1[mm],dy1[mm],dz1[mm],dx2[mm],dy2[mm],dz2[mm]\n"
    + "".join(f"P{k},{k},2,3,4,5,{k},0,0,-90,{k},1,2,3,4,5\n" for k in range(3))
)
AT = {"1": np.array([0.05, 0.0, 0.1]), "2": np.array([0.0, 0.08, 0.1])}


def test_displacements_of_markers_whose_places_are_told(tmp_path: Path) -> None:
    draft = draft_of(tmp_path, SIDE_BY_SIDE, SIX)
    with pytest.raises(InputError, match=r"markers 1 and 2.*--point '1=0,0,150 mm'.*--marker 1"):
        refuse_several_points(draft)
    found = with_places(draft, Told(points=AT))
    refuse_several_points(found)
    assert found.marker_of == ("1", "2") * 3 and found.displaced
    assert not any(header == "marker" for header, _ in found.other)
    assert with_places(draft, Told()) is draft
    with pytest.raises(InputError, match="no place is told of 2"):
        with_places(draft, Told(points={"1": AT["1"]}))
    with pytest.raises(InputError, match="no marker is 3"):
        with_places(draft, Told(points={**AT, "3": AT["1"]}))


def test_points_that_nobody_named_are_told_by_where_they_are(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"140 mm apart, lines 2 and 3"):
        refuse_several_points(draft_of(tmp_path, table("M1", "M2", named=False), SIX))


def test_a_single_slip_among_repeats_is_no_other_marker(tmp_path: Path) -> None:
    text = table("M1", "M1", named=False).replace("950,100.0,700.0\n", "950,180.0,700.0\n", 1)
    refuse_several_points(draft_of(tmp_path, text, SIX))


ABOVE = {
    "once": (
        "Trajectories",
        "100",
        ",,tool:a,,,tool:b,,",
        "Frame,Sub,X,Y,Z,X,Y,Z",
        ",,mm,mm,mm,mm,mm,mm",
    ),
    "above each axis": (
        "Format Version,1.23,Length Units,Millimeters",
        ",Name,tool:a,tool:a,tool:a,tool:b,tool:b,tool:b",
        ",,Position,Position,Position,Position,Position,Position",
        "Frame,Time (Seconds),X,Y,Z,X,Y,Z",
    ),
}


@pytest.mark.parametrize("above", ABOVE.values(), ids=ABOVE)
def test_names_in_a_row_above_the_axes(above: tuple[str, ...], tmp_path: Path) -> None:
    """As mocap programs write them."""
    rows = [f"{k},0.1,{900 + k},100,700,{900 + k},240,700" for k in range(4)]
    path = tmp_path / "take.csv"
    path.write_text("\n".join([*above, *rows]) + "\n")
    source = opened(Source(path, SIX))
    sheet = FORMATS.chosen(source)[0].read(source)
    marker, y = sheet.get("marker"), sheet.get("y")
    assert marker is not None and marker.cells[:2] == ("1", "2")
    assert y is not None and y.unit == "mm" and y.cells[:2] == ("100", "240")
    assert sheet.lines[0] == len(above) + 1
    assert any("1 is tool:a, 2 is tool:b" in note for note in sheet.notes)


def test_a_rotation_beside_a_position_is_no_second_marker(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text("Rotation,,,Position,,\nX,Y,Z,X,Y,Z\n1,2,3,4,5,6\n")
    assert opened(Source(path, SIX)).given is None


@pytest.mark.parametrize(("between", "one"), [("1{}.5", True), ("10.5", False), ("250", False)])
def test_two_markers_in_one_place_are_one(tmp_path: Path, between: str, *, one: bool) -> None:
    """What a load moves it moves otherwise in every pose; two dots on one tool stay apart."""
    upper = "Pose,,,,,,,Force,,,0 kg,,,50 kg,,\n"
    lower = ",q1,q2,q3,q4,q5,q6,Fx,Fy,Fz" + ",x,y,z" * 2 + "\n"
    rows = []
    for k in range(4):
        joints = ",".join(str(10 * k + j) for j in range(6))
        rows.append(f"{k},{joints},0,0,-500,10,{k},30,{between.format(k)},{k},31\n")
    text = upper + lower + "".join(rows)
    draft = draft_of(tmp_path, text, length="mm", angle="deg", load="N")
    if not one:
        refuse_one_marker_twice(draft)
        return
    with pytest.raises(InputError, match=r"one marker that was read twice.*x_unloaded"):
        refuse_one_marker_twice(draft)


def test_a_marker_of_number_zero_may_be_a_reading_without_load(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="x0, y0, z0 may be of one marker more"):
        sheet_of(tmp_path, "q1,x0,y0,z0,x1,y1,z1\n1,2,3,4,5,6,7\n", ("joint_1",))
