"""A CSV and a YAML file become arrays whose numbers are checked by hand."""

import dataclasses
import hashlib
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.measurements import Measurements, NoiseStatement, read_measurements

CSV = """\
pose,joint_1_s[deg],joint_2_l[rad],rail[mm],fx[N],fy[kN],fz[lbf],my[N*m],mx[Nmm],mz[N*m],dx[mm],dy[um],dz[m],sx[um],sy[um],sz[mm],order,time[min],branch,repeat,use,temperature[degC],note
A,90,0.5,250,1,0.002,1,2,3,4,1.5,250,0.001,10,20,0.03,1,0,load,1,1,20.5,"first, of two"
A,90,0.5,250,2,0,0,0,0,0,3,500,0.002,10,20,0.03,2,0.5,unload,1,0,20.5,

# a remark
B,-90,0.25,-10,0,0,3,0,0,0,0,0,-0.001,10,20,0.03,3,1,load,2,1,21,cooler
"""
YAML = """\
robot: ../robots/arm.urdf
base_frame: base_link
tool_frame: tool0
point: {xyz: [-60.0, 40.0, 150.0], unit: mm}
force: {frame: tool, point: {xyz: [0, 0, 0.1], unit: m}}
displacement: {frame: tool, zero: separate}
noise: {sigma: 10, unit: um, growth: 0.01}
source: a test
"""


def put(folder: Path, csv: str, yaml: str | None = None, name: str = "data") -> Path:
    path = folder / f"{name}.csv"
    path.write_text(csv, encoding="utf-8")
    if yaml is not None:
        path.with_suffix(".yaml").write_text(yaml, encoding="utf-8")
    return path


def test_every_column_and_key_arrives_in_si(tmp_path: Path) -> None:
    path = put(tmp_path, CSV, YAML)
    m = read_measurements(path)
    assert m.pose == ("A", "A", "B")
    assert m.poses == ("A", "B")
    assert m.joint_names == ("joint_1_s", "joint_2_l", "rail")
    assert m.joint_kinds == ("angle", "angle", "length")
    np.testing.assert_allclose(
        m.joints, [[np.pi / 2, 0.5, 0.25], [np.pi / 2, 0.5, 0.25], [-np.pi / 2, 0.25, -0.01]]
    )
    lbf = 4.4482216152605
    np.testing.assert_allclose(
        m.wrench, [[1, 2, lbf, 0.003, 2, 4], [2, 0, 0, 0, 0, 0], [0, 0, 3 * lbf, 0, 0, 0]]
    )
    assert m.displacement is not None
    np.testing.assert_allclose(
        m.displacement, [[1.5e-3, 2.5e-4, 1e-3], [3e-3, 5e-4, 2e-3], [0, 0, -1e-3]]
    )
    # told of displacements, which are two readings each
    np.testing.assert_allclose(m.sigma, np.tile([1e-5, 2e-5, 3e-5], (3, 1)) / np.sqrt(2.0))
    np.testing.assert_array_equal(m.order, [1, 2, 3])
    np.testing.assert_array_equal(m.time, [0, 30, 60])
    assert m.branch == ("load", "unload", "load")
    np.testing.assert_array_equal(m.repeat, [1, 1, 2])
    np.testing.assert_array_equal(m.use, [True, False, True])
    np.testing.assert_array_equal(m.line, [2, 3, 6])
    assert m.extra == {
        "temperature[degC]": ("20.5", "20.5", "21"),
        "note": ("first, of two", "", "cooler"),
    }
    assert m.robot == str((tmp_path / "../robots/arm.urdf").resolve())
    assert (m.base_frame, m.tool_frame) == ("base_link", "tool0")
    np.testing.assert_allclose(m.point, [-0.06, 0.04, 0.15])
    np.testing.assert_allclose(m.force_point, [0, 0, 0.1])
    assert (m.force_frame, m.displacement_frame, m.zero) == ("tool", "tool", "separate")
    assert m.noise == NoiseStatement(1e-5, 0.01)
    assert m.source == "a test"
    assert m.notes == ()
    np.testing.assert_array_equal(m.zero_group, [0, 1, 2])
    digest = hashlib.sha256(path.read_bytes() + path.with_suffix(".yaml").read_bytes())
    assert m.data_hash == digest.hexdigest()


PLAIN = "pose,q1[deg],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm]\n1,0,1,0,0,1,0,0\n1,0,2,0,0,2,0,0\n"


@pytest.mark.parametrize("yaml", [None, "", "# nothing\n", "noise:\nforce:\n"])
def test_defaults(tmp_path: Path, yaml: str | None) -> None:
    m = read_measurements(put(tmp_path, PLAIN, yaml))
    assert m.robot is None
    assert m.base_frame is None
    assert (m.force_frame, m.displacement_frame, m.zero) == ("base", "base", "unknown")
    assert sum("Nobody said in which axes" in note for note in m.notes) == 2
    assert m.noise == NoiseStatement(None, None)
    np.testing.assert_array_equal(m.point, np.zeros(3))
    np.testing.assert_array_equal(m.force_point, np.zeros(3))
    np.testing.assert_array_equal(m.zero_group, [0, 0])
    assert m.use.all()
    assert m.sigma is m.order is m.time is m.branch is m.repeat is None
    assert m.order_since_zero is m.time_since_zero is None


def test_the_force_acts_at_the_measured_point_by_default(tmp_path: Path) -> None:
    m = read_measurements(put(tmp_path, PLAIN, "point: {xyz: [1, 2, 3], unit: mm}"))
    np.testing.assert_allclose(m.force_point, [0.001, 0.002, 0.003])


def test_a_bundled_name_stays_as_written(tmp_path: Path) -> None:
    assert read_measurements(put(tmp_path, PLAIN, "robot: motoman_sk120")).robot == "motoman_sk120"


@pytest.mark.parametrize(
    "spell",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: "\ufeff" + text,
        lambda text: "# made by hand\n\n" + text.replace("\n", "\n\n") + "\n,,,\n",
        lambda text: text.replace(",", " , "),
        lambda text: text.replace("\n", ",,\n"),
        lambda text: text.replace("1,0,1", '"1","0","1"'),
    ],
)
def test_spreadsheets_may_write_as_they_like(tmp_path: Path, spell) -> None:
    m = read_measurements(put(tmp_path, spell(PLAIN)))
    np.testing.assert_allclose(m.displacement, [[0.001, 0, 0], [0.002, 0, 0]])
    np.testing.assert_allclose(m.wrench[:, 0], [1, 2])


def test_one_row_is_readable(tmp_path: Path) -> None:
    assert read_measurements(put(tmp_path, "\n".join(PLAIN.split("\n")[:2]))).n_readings == 1


def test_without_measured_columns_it_is_a_plan(tmp_path: Path) -> None:
    m = read_measurements(put(tmp_path, "pose,q1[deg],fx[N],fy[N],fz[N]\n1,0,0,0,0\n1,0,2,0,0\n"))
    assert m.displacement is None
    assert m.use.all()
    assert "a plan" in repr(m)


def test_joints_are_put_in_the_order_of_the_robot(tmp_path: Path) -> None:
    path = put(tmp_path, CSV, YAML)
    m = read_measurements(path, actuated=("rail", "joint_2_l", "joint_1_s"), prismatic=("rail",))
    np.testing.assert_allclose(m.joints[0], [0.25, 0.5, np.pi / 2])
    assert m.joint_kinds == ("length", "angle", "angle")


def test_joint_names_win_over_known_words(tmp_path: Path) -> None:
    text = "pose,x[mm],y[mm],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm]\n1,5,6,1,0,0,1,0,0\n"
    m = read_measurements(put(tmp_path, text), actuated=("x", "y"))
    np.testing.assert_allclose(m.joints, [[0.005, 0.006]])
    assert m.displacement is not None


def test_selecting_keeps_every_row_field_together(tmp_path: Path) -> None:
    m = read_measurements(put(tmp_path, CSV, YAML))
    part = m.select([2, 0])
    assert part.pose == ("B", "A")
    np.testing.assert_array_equal(part.line, [6, 2])
    np.testing.assert_array_equal(part.zero_group, [2, 0])
    assert part.extra["note"] == ("cooler", "first, of two")
    np.testing.assert_array_equal(m.masked().line, [2, 6])
    np.testing.assert_array_equal(m.rows_of("A"), [0, 1])
    assert m.select(m.rows_of("A")).masked().n_readings == 1
    with pytest.raises(InputError, match=re.escape("The poses are A, B.")):
        m.rows_of("C")
    with pytest.raises(InputError, match="no reading"):
        m.select(np.zeros(3, dtype=bool))


def test_every_row_field_is_cut(tmp_path: Path) -> None:
    read = read_measurements(put(tmp_path, CSV, YAML))
    m = dataclasses.replace(read, zero_order=[7.0, 8.0, 9.0], zero_time=[4.0, 5.0, 6.0])
    part = m.select([1])
    for field in dataclasses.fields(Measurements):
        whole, cut = getattr(m, field.name), getattr(part, field.name)
        if isinstance(whole, np.ndarray) and whole.shape[0] == 3 and "point" not in field.name:
            np.testing.assert_array_equal(cut, whole[[1]], err_msg=field.name)


def test_measurements_cannot_be_changed_but_can_be_sent(tmp_path: Path) -> None:
    m = read_measurements(put(tmp_path, CSV, YAML))
    with pytest.raises(ValueError, match="read-only"):
        m.joints[0, 0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        m.zero = "shared"  # type: ignore[misc]
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(m)).joints, m.joints)  # noqa: S301


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("2,0,0\n", "3000,0,0\n", "line 3: the largest displacement is 3 m"),
        ("1,0,2,0", "1,0,2e6,0", "line 3: the largest force is 2e+06 N"),
        ("q1[deg]", "q1[rad]", "the largest joint angle is 20 rad"),
    ],
)
def test_absurd_sizes_raise_doubt_about_units(
    tmp_path: Path, old: str, new: str, part: str
) -> None:
    text = PLAIN.replace("\n1,0,", "\n1,20,") if "q1" in old else PLAIN
    with pytest.warns(ToolkitWarning) as caught:
        read_measurements(put(tmp_path, text.replace(old, new)))
    assert part in str(caught[0].message)


TURNED = "pose,a[deg],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm],{}\n"
TWO = "A,1,0,0,-9,0,0,-1,0.5\nA,1,0,0,-20,0,0,-2,1\n"


def test_orientations_beside_displacements_are_no_joints_and_that_is_told(tmp_path: Path) -> None:
    path = put(tmp_path, TURNED.format("rx[mrad]") + TWO)
    with pytest.warns(ToolkitWarning, match=r"rx are not used.*call them drx, dry, drz.*x y z"):
        m = read_measurements(path)
    assert m.joint_names == ("a",)


def test_turns_beside_displacements_are_read(tmp_path: Path) -> None:
    m = read_measurements(put(tmp_path, TURNED.format("drx[mrad]") + TWO))
    assert m.joint_names == ("a",) and m.absolute is not None
    turn = m.absolute.channels.turn
    assert turn is not None
    np.testing.assert_allclose(turn, [[5e-4, np.nan, np.nan], [1e-3, np.nan, np.nan]])
    with pytest.raises(InputError, match=r"column drx.*unit"):
        read_measurements(put(tmp_path, TURNED.format("drx") + TWO))


def test_turns_beside_positions_are_told(tmp_path: Path) -> None:
    csv = "pose,a[deg],fx[N],fy[N],fz[N],x[mm],y[mm],z[mm],drx[mrad]\n"
    rows = "A,1,0,0,0,5,5,5,0\nA,1,0,0,-9,5,5,4,0.5\n"
    with pytest.warns(ToolkitWarning, match="drx are not used.*stand beside displacements"):
        read_measurements(put(tmp_path, csv + rows))


def test_torques_by_another_name_are_not_passed_over(tmp_path: Path) -> None:
    csv = "pose,a[deg],fx[N],fy[N],fz[N],tx[N*m],ty[N*m],tz[N*m],dx[mm],dy[mm],dz[mm]\n"
    with pytest.raises(InputError, match=r"'tx\[N\*m\]' is not known \(did you mean 'mx'"):
        read_measurements(put(tmp_path, csv + "A,1,0,0,-9,1,2,3,0,0,-1\n"))


def test_exact_zeros_without_load_are_masked_and_said(tmp_path: Path) -> None:
    m = read_measurements(put(tmp_path, PLAIN + "1,0,0,0,0,0,0,0\n1,0,0,0,0,0.001,0,0\n"))
    np.testing.assert_array_equal(m.use, [True, True, False, True])
    assert any("masked" in note for note in m.notes)


def test_bundled_data_are_read() -> None:
    root = Path(__file__).resolve().parents[3] / "robots/motoman_sk120/data"
    m = read_measurements(root / "table2_measured.csv")
    assert m.n_readings == 15
    assert m.poses == ("1", "2", "3")
    assert m.zero == "shared"
    assert m.robot == "motoman_sk120"
