"""APT and CLS files: the words that NX and CATIA write."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.programs import read_gcode
from sk120stiff.programs.apt import read_apt

# Written by hand after the public description of NX's CLSF.
CLS = """TOOL PATH/MILL,TOOL,EM20
TLDATA/MILL,20.0000,0.0000,75.0000,0.0000,0.0000
MSYS/0.0000,0.0000,0.0000,1.0000000,0.0000000,0.0000000,0.0000000,1.0000000,0.0000000
$$ the tool is one of two
PAINT/PATH
LOADTL/1
SPINDL/3000,RPM,CLW
RAPID
GOTO/0.0000,0.0000,50.0000,0.0000000,0.0000000,1.0000000
FEDRAT/MMPM,500.0000
GOTO/10.0000,0.0000, $
0.0000
CIRCLE/0.0000,0.0000,0.0000,0.0000000,0.0000000,-1.0000000,10.0000,0.0600,0.5000,20.0,0.0000
GOTO/0.0000,-10.0000,0.0000
FEDRAT/250
GODLTA/5,0,1
GODLTA/2
END-OF-PATH
FINI
"""


def read(folder: Path, text: str):
    file = folder / "path.cls"
    file.write_text(text)
    return read_apt(file, chord=1e-5)


def test_a_cls_file_is_the_same_path_as_its_gcode(tmp_path: Path) -> None:
    path = read(tmp_path, CLS)
    (tmp_path / "same.nc").write_text(
        "G0 X0 Y0 Z50\nG1 X10 Z0 F500\nG2 X0 Y-10 I-10\nG1 X5 Z1 F250\nZ3\n"
    )
    same = read_gcode(tmp_path / "same.nc", chord=1e-5)
    np.testing.assert_allclose(path.position, same.position, atol=1e-12)
    np.testing.assert_allclose(path.feed, same.feed)
    assert path.rapid.tolist() == same.rapid.tolist()
    assert path.axis is not None and (path.axis == [0, 0, 1]).all()
    assert path.lines[[0, 1, 2, -1]].tolist() == [9, 11, 14, 17]
    assert set(path.left_out) == {"TOOL PATH", "TLDATA", "LOADTL", "SPINDL"}


def test_inches_come_from_units_or_from_the_feeds(tmp_path: Path) -> None:
    for head in ("UNITS/INCHES\n", "FEDRAT/10,IPM\n"):
        found = read(tmp_path, f"{head}GOTO/1,2,3\n")
        np.testing.assert_allclose(found.position, [[0.0254, 0.0508, 0.0762]])


def test_the_axis_turns_on_the_way(tmp_path: Path) -> None:
    s = np.sqrt(0.5)
    path = read(tmp_path, f"UNITS/MM\nMULTAX/ON\nGOTO/0,0,0,0,0,1\nGOTO/9,0,0,{s},0,{s}\n")
    np.testing.assert_allclose(path.axis, [[0, 0, 1], [s, 0, s]], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("GOTO/1,2,3\n", "in which unit"),
        ("UNITS/FEET\nGOTO/1,2,3\n", "line 1: UNITS/FEET"),
        ("UNITS/MM\nGOTO/1,2\n", "line 2: GOTO with 2 numbers"),
        ("UNITS/MM\nGOTO/1,2,x\n", "'x' is no number"),
        ("UNITS/MM\nGOTO/1,2,nan\n", "finite"),
        ("UNITS/MM\nGOTO/1,2,3,0,0,2\n", "not 1"),
        ("UNITS/MM\nCYCLE/DRILL,3\nGOTO/1,2,3\n", "line 2: CYCLE"),
        ("UNITS/MM\nGOTO/1,2,1e\n", "'1e' is no number"),
        ("UNITS/MM\nGODLTA/1,2,3\n", "not known"),
        ("UNITS/MM\nGOTO/1,0,0\nFEDRAT/3,MMPR\n", "MMPR"),
        ("UNITS/MM\nGOTO/9,0,0\nCIRCLE/0,0,0,0,0,1,10,0,0,0,0\nGOTO/0,10,0\n", "radius 10"),
        ("UNITS/MM\nGOTO/9,0,0\nCIRCLE/0,0,0,0,0,1,9\n", "no GOTO after it"),
        ("UNITS/MM\nGOTO/9,0,0\nCIRCLE/0,0,0,0,0,1\nGOTO/1,2,3\n", "needs centre"),
        ("UNITS/MM\nFINI\n", "moves nothing"),
    ],
)
def test_what_is_not_understood_stops_with_its_line(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError) as told:
        read(tmp_path, text)
    assert says in str(told.value)
