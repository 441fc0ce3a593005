"""Every kind of unusable CSV file: one message with file, line, column and remedy; exit code 2."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements import read_measurements

GOOD = """\
pose,joint_1_s[deg],joint_2_l[deg],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm]
A,10,20,100,0,0,0.1,0.2,0.3
A,10,20,200,0,0,0.2,0.4,0.6
B,-10,20,0,100,0,0.1,0.2,0.3
"""
JOINTS = ("joint_1_s", "joint_2_l")


def change(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new, 1)


def with_column(header: str, *cells: str) -> str:
    lines = GOOD.strip().split("\n")
    return "\n".join(f"{line},{cell}" for line, cell in zip(lines, (header, *cells), strict=True))


def complaint(folder: Path, csv: str | bytes) -> str:
    """The message; it names the file, has a remedy, and nothing was written."""
    path = folder / "data.csv"
    path.write_bytes(csv.encode() if isinstance(csv, str) else csv)
    before = sorted(folder.iterdir())
    with pytest.raises(InputError) as caught:
        read_measurements(path, actuated=JOINTS, prismatic=())
    error = caught.value
    assert error.exit_code == 2
    assert error.remedy
    assert "data." in str(error.where)
    assert sorted(folder.iterdir()) == before
    return str(error)


CSV = {
    # headers
    "no pose": (change("pose,", "label,"), ["line 1", "'pose' is missing", "Add the column pose"]),
    "no force": (change("fz[N]", "force_z"), ["line 1", "'fz' is missing", "fz[N]", "fx, fy, fz"]),
    "half a displacement": (change("dy[mm]", "remark"), ["'dy' is missing", "dy[mm]"]),
    "half a moment": (with_column("mx[N*m]", "1", "1", "1"), ["'my' is missing", "my[N*m]"]),
    "half an uncertainty": (with_column("sy[um]", "1", "1", "1"), ["'sx' is missing", "sx[um]"]),
    "no joint": (
        change("joint_1_s[deg],joint_2_l[deg]", "a,b"),
        ["no column holds a joint", "[deg]", "a and b have no unit"],
    ),
    "joints by number": (
        change("joint_1_s[deg],joint_2_l[deg]", "J1[deg],J2[deg]"),
        ["called 'J1'", "'sk120stiff import' takes columns in the order of the joints"],
    ),
    "one joint less": (
        change("joint_2_l[deg]", "spare"),
        ["'joint_2_l' has no column", "joint_2_l[deg]", "joint_1_s, joint_2_l"],
    ),
    "unit absent": (change("fx[N]", "fx"), ["line 1", "column fx", "'fx' has no unit", "fx[N]"]),
    "unit empty": (change("dx[mm]", "dx[]"), ["column dx", "no unit", "dx[mm]"]),
    "joint without unit": (
        change("joint_2_l[deg]", "joint_2_l"),
        ["'joint_2_l'", "joint_2_l[deg]"],
    ),
    "unit of a joint unknown": (
        change("joint_2_l[deg]", "joint_2_l[degrs]"),
        ["'joint_2_l[degrs]'", "joint_2_l[deg]"],
    ),
    "unit in round brackets": (
        change("dx[mm],dy[mm],dz[mm]", "dx (mm),dy (mm),dz (mm)"),
        ["'dx (mm)'", "did you mean 'dx'", "dx[mm]"],
    ),
    "unit after a stroke": (
        change("dx[mm],dy[mm],dz[mm]", "dx_mm,dy_mm,dz_mm"),
        ["'dx_mm'", "dx[mm]"],
    ),
    "unit unknown": (
        change("fx[N]", "fx[Nn]"),
        ["line 1", "column fx[Nn]", "'Nn' is not known", "kN"],
    ),
    "unit of another kind": (
        change("dx[mm]", "dx[N]"),
        ["column dx[N]", "not a unit of length", "mm"],
    ),
    "angle for a length": (change("fy[N]", "fy[deg]"), ["column fy[deg]", "not a unit of force"]),
    "slide for a hinge": (
        change("joint_2_l[deg]", "joint_2_l[mm]"),
        ["column joint_2_l", "takes an angle", "joint_2_l[deg]"],
    ),
    "unknown joint": (
        change("joint_2_l[deg]", "joint_2[deg]"),
        ["column joint_2", "did you mean 'joint_2_l'", "joint_1_s, joint_2_l"],
    ),
    "case of a word": (change("fx[N]", "FX[N]"), ["'FX[N]' is not known", "did you mean 'fx'"]),
    "slip in a word": (with_column("brnach", "load", "load", "load"), ["did you mean 'branch'"]),
    "unit on a word": (with_column("order[s]", "1", "2", "3"), ["'order' takes no unit"]),
    "time without unit": (with_column("time", "1", "2", "3"), ["'time' has no unit", "time[s]"]),
    "broken brackets": (change("fx[N]", "fx[N"), ["line 1", "'fx[N'", "fx[N]."]),
    "a column twice": (with_column("fx[kN]", "1", "2", "3"), ["column fx[kN]", "twice"]),
    "a column without name": (change("fx[N],", ","), ["column 4 has no name"]),
    "both kinds": (with_column("x[mm]", "1", "2", "3"), ["dx, dy, dz", "(x)", "Keep one kind"]),
    "a payload for a force": (
        change("fx[N],fy[N],fz[N]", "payload[kg],b,c"),
        ["'fx' is missing", "sk120stiff import", "--point 'X,Y,Z mm'", "-z of the base"],
    ),
    # shape
    "empty": ("", ["empty", "pose,joint_1_s[deg]"]),
    "only comments": ("# a\n\n# b\n", ["empty"]),
    "header only": (GOOD.split("\n")[0] + "\n\n", ["no row of data"]),
    "semicolons": (GOOD.replace(",", ";"), ["line 1", "semicolons", "1.5, not 1,5"]),
    "tabs": (GOOD.replace(",", "\t"), ["line 1", "tabs"]),
    "decimal commas": (
        GOOD.replace("0.1,", "0,1,"),
        ["line 2", "10 cells", "9 headers", "1.5, not 1,5"],
    ),
    "decimal commas in quotes": (
        change("0.1,", '"0,1",'),
        ["line 2", "column dx[mm]", "'0,1'", "1.5, not 1,5"],
    ),
    "short row": (change("0.2,0.4,0.6", "0.2,0.4"), ["line 3", "8 cells"]),
    "open quote": (change("A,10", '"A,10'), ["line 2", "uotation"]),
    "not text": (GOOD.encode().replace(b"B,", b"\xe9,"), ["line 4", "UTF-8"]),
    "utf-16": (GOOD.encode("utf-16"), ["UTF-8"]),
    "zip of a spreadsheet": (b"PK\x03\x04\x14\x00\x06\x00\x08", ["data.csv"]),
    # cells
    "blank cell": (change("100,0,0,0.1", "100,,0,0.1"), ["line 2", "column fy[N]", "empty", "use"]),
    "nan": (change("0.4", "nan"), ["line 3", "column dy[mm]", "nan is not a finite number"]),
    "infinity": (change("0.4", "-inf"), ["line 3", "column dy[mm]", "-inf"]),
    "overflow": (change("0.4", "1e999"), ["line 3", "column dy[mm]", "1e999"]),
    "text": (change("200", "much"), ["line 3", "column fx[N]", "'much' is no number"]),
    "unit in the cell": (change("200", "200 N"), ["line 3", "'200 N'", "in the header"]),
    "underscore": (change("200", "2_00"), ["line 3", "'2_00'"]),
    "spreadsheet error": (change("200", "#REF!"), ["line 3", "'#REF!'"]),
    "empty label": (change("A,10,20,200", ",10,20,200"), ["line 3", "column pose", "label"]),
    "differing joints": (
        change("A,10,20,200", "A,10,21,200"),
        ["line 3", "column joint_2_l", "'A'", "21 deg", "20 deg", "line 2"],
    ),
    "use": (
        with_column("use", "1", "maybe", "1"),
        ["line 3", "column use", "'maybe'", "0 to mask"],
    ),
    "all masked": (with_column("use", "0", "0", "0"), ["every row is masked"]),
    "branch": (
        with_column("branch", "load", "up", "load"),
        ["line 3", "column branch", "'up'", "unload"],
    ),
    "repeat": (with_column("repeat", "1", "1.5", "1"), ["line 3", "column repeat", "'1.5'"]),
    "order": (with_column("order", "1", "x", "3"), ["line 3", "column order", "'x'"]),
    "zero_count": (with_column("zero_count", "1", "0", "1"), ["line 3", "column zero_count"]),
    "negative sigma": (
        with_column("sx[um],sy[um],sz[um]", "1,1,1", "1,-2,1", "1,1,1"),
        ["line 3", "column sy[um]", "-2 is not positive"],
    ),
    "sigma of zero": (
        with_column("sx[um],sy[um],sz[um]", "1,1,1", "1,1,1", "1,1,0"),
        ["line 4", "column sz[um]", "not positive"],
    ),
}


@pytest.mark.parametrize("case", CSV)
def test_csv(tmp_path: Path, case: str) -> None:
    text, parts = CSV[case]
    message = complaint(tmp_path, text)
    for part in parts:
        assert part in message, message


@pytest.mark.parametrize(
    ("name", "part"),
    [("absent.csv", "No such file"), (".", "directory"), ("data.yaml", "holds no readings"),
     ("robot.urdf", "holds no readings")],
)  # fmt: skip
def test_paths(tmp_path: Path, name: str, part: str) -> None:
    with pytest.raises(InputError) as caught:
        read_measurements(tmp_path / name)
    assert part in str(caught.value)
    assert str(tmp_path) in str(caught.value)


def test_the_good_file_is_good(tmp_path: Path) -> None:
    """Otherwise every message above could be about something else."""
    (tmp_path / "data.csv").write_text(GOOD)
    assert read_measurements(tmp_path / "data.csv", JOINTS, ()).n_readings == 3
