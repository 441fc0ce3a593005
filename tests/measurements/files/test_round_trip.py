"""What is written reads back: bit for bit in SI units, to rounding in others."""

import dataclasses
import os
import string
import tempfile
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.errors import InputError
from sk120stiff.measurements import (
    Measurements,
    NoiseStatement,
    read_measurements,
    write_measurements,
)
from sk120stiff.measurements.joining import join_measurements

LABEL = st.text(alphabet=string.ascii_letters + string.digits + ' _-.,;"äλ', min_size=1, max_size=8)
FIELDS = [f.name for f in dataclasses.fields(Measurements)]
FROM_THE_FILE = {"path", "line", "notes", "data_hash"}


def numbers(limit: float) -> st.SearchStrategy[float]:
    return st.floats(-limit, limit, allow_subnormal=False)


@st.composite
def measurements(draw: st.DrawFn) -> Measurements:
    count = draw(st.integers(1, 7))
    kinds = draw(st.lists(st.sampled_from(["angle", "length"]), min_size=1, max_size=3))
    labels = draw(
        st.lists(LABEL.filter(lambda t: t == t.strip()), min_size=1, max_size=3, unique=True)
    )
    which = draw(st.lists(st.integers(0, len(labels) - 1), min_size=count, max_size=count))
    at = [[draw(numbers(3)) for _ in kinds] for _ in labels]

    def array(limit: float, columns: int) -> np.ndarray:
        cells = st.lists(numbers(limit), min_size=count * columns, max_size=count * columns)
        return np.array(draw(cells)).reshape(count, columns)

    def maybe(value: object) -> object:
        return value if draw(st.booleans()) else None

    wrench = array(1e4, 6)
    # Rows without load and without displacement would be masked, as another test shows.
    wrench[:, 0] = np.where(wrench[:, 0] == 0, 1.0, wrench[:, 0])
    if draw(st.booleans()):
        wrench[:, 3:] = 0.0
    zero = draw(st.sampled_from(["shared", "separate", "unknown"]))
    use = np.array(draw(st.lists(st.booleans(), min_size=count, max_size=count)))
    extra: dict[str, object] = {}
    if draw(st.booleans()):  # zero readings that the reader could not guess
        extra["zero_group"] = np.array(which) * 2 + 5
        extra["zero_count"] = np.array(which) + 1
        extra["zero_order"] = np.where(np.arange(count) % 2, np.nan, array(1e3, 1)[:, 0])
        extra["zero_time"] = array(1e3, 1)[:, 0]
    return Measurements(
        pose=tuple(labels[k] for k in which),
        joint_names=tuple(f"joint {k}" for k in range(len(kinds))),
        joint_kinds=tuple(kinds),
        joints=np.array([at[k] for k in which]),
        wrench=wrench,
        displacement=maybe(array(0.05, 3)),  # type: ignore[arg-type]
        robot=draw(st.sampled_from([None, "motoman_sk120"])),
        base_frame=draw(st.sampled_from([None, "base: 1"])),
        tool_frame=draw(st.sampled_from([None, "tool0"])),
        point=array(1, 3)[0],
        force_point=array(1, 3)[0],
        force_frame=draw(st.sampled_from(["base", "tool"])),
        displacement_frame=draw(st.sampled_from(["base", "tool"])),
        noise=NoiseStatement(maybe(draw(st.floats(1e-9, 1e-3))), maybe(0.01)),  # type: ignore[arg-type]
        zero=zero,
        sigma=maybe(np.abs(array(1e-3, 3)) + 1e-9),  # type: ignore[arg-type]
        order=maybe(array(1e6, 1)[:, 0]),  # type: ignore[arg-type]
        time=maybe(array(1e6, 1)[:, 0]),  # type: ignore[arg-type]
        branch=maybe(tuple(draw(st.sampled_from(["load", "unload"])) for _ in which)),  # type: ignore[arg-type]
        repeat=maybe(np.arange(count)),  # type: ignore[arg-type]
        use=use if use.any() else np.ones(count, dtype=bool),
        source=draw(st.sampled_from(["", "a: b # c\nd", "Größe"])),
        extra=draw(
            st.sampled_from(
                [{}, {"note": tuple("x,y z" for _ in which), "t[degC]": tuple("1" for _ in which)}]
            )
        ),
        **extra,  # type: ignore[arg-type]
    )


def there_and_back(m: Measurements, **units: str) -> Measurements:
    with tempfile.TemporaryDirectory() as folder:
        path = write_measurements(m, Path(folder) / "data.csv", **units)
        assert sorted(os.listdir(folder)) == ["data.csv", "data.yaml"]
        return read_measurements(path)


def compare(m: Measurements, back: Measurements, rtol: float) -> None:
    for name in FIELDS:
        if name in FROM_THE_FILE:
            continue
        here, there = getattr(m, name), getattr(back, name)
        if name == "branch" and here is None and there is not None:  # told by the order of loads
            assert "loading and unloading" in " ".join(back.notes).replace("\n", " ")
            continue
        if name == "zero_group":
            here, there = ([list(g).index(k) for k in g] for g in (here, there))
        if name == "sigma" and here is not None:  # of one reading, told of a displacement
            np.testing.assert_allclose(there, here, rtol=max(rtol, 2.3e-16))
            continue
        if isinstance(here, np.ndarray):
            np.testing.assert_allclose(there, here, rtol=rtol, atol=0, err_msg=name)
        elif name == "noise" and here.sigma is not None:
            assert there.sigma == pytest.approx(here.sigma, rel=rtol or 1e-300, abs=0)
            assert there.growth == here.growth
        else:
            assert there == here, name


@given(measurements())
@settings(deadline=None, max_examples=80)
def test_si_units_come_back_bit_for_bit(m: Measurements) -> None:
    compare(m, there_and_back(m, angle="rad", length="m"), rtol=0.0)


@given(measurements())
@settings(deadline=None, max_examples=80)
def test_uncertainties_of_a_file_come_back_bit_for_bit(m: Measurements) -> None:
    read = there_and_back(m, angle="rad", length="m")
    again = there_and_back(read, angle="rad", length="m")
    np.testing.assert_array_equal(again.sigma, read.sigma)


@given(measurements())
@settings(deadline=None, max_examples=40)
def test_other_units_come_back_to_rounding(m: Measurements) -> None:
    compare(m, there_and_back(m), rtol=1e-15)
    compare(m, there_and_back(m, angle="mrad", length="um"), rtol=1e-15)


@given(measurements())
@settings(deadline=None, max_examples=20)
def test_a_second_writing_is_the_same_file(m: Measurements) -> None:
    with tempfile.TemporaryDirectory() as folder:
        first = write_measurements(m, Path(folder) / "a.csv", angle="rad", length="m")
        second = write_measurements(
            read_measurements(first), Path(folder) / "b.csv", angle="rad", length="m"
        )
        assert first.read_text().split("\n")[0] == second.read_text().split("\n")[0]
        assert first.read_bytes() == second.read_bytes()
        assert first.with_suffix(".yaml").read_bytes() == second.with_suffix(".yaml").read_bytes()


POSITIONS = """\
pose,q1[deg],fx[N],fy[N],fz[N],x[mm],y[mm],z[mm],order
A,0,0,0,0,1000,500,0,1
A,0,5,0,0,1003,500,1,2
A,0,0,0,0,1002,500,0,3
B,0,1,0,0,1003,500,1,4
B,0,0,0,0,1000,500,0,5
"""


def test_positions_come_back_as_the_displacements_they_were(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(POSITIONS)
    m = read_measurements(tmp_path / "a.csv")
    back = there_and_back(m, angle="rad", length="m")
    compare(m, back, rtol=0.0)
    np.testing.assert_array_equal(back.zero_count, [2, 1])
    np.testing.assert_array_equal(back.order_since_zero, m.order_since_zero)


def test_a_robot_path_is_relative_to_the_file(tmp_path: Path) -> None:
    (tmp_path / "robots").mkdir()
    (tmp_path / "a.csv").write_text(POSITIONS)
    (tmp_path / "a.yaml").write_text("robot: robots/arm.urdf")
    m = read_measurements(tmp_path / "a.csv")
    path = write_measurements(m, tmp_path / "deep" / "b.csv")
    assert yaml.safe_load(path.with_suffix(".yaml").read_text())["robot"] == "../robots/arm.urdf"
    assert read_measurements(path).robot == m.robot == str(tmp_path / "robots" / "arm.urdf")


def test_what_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(POSITIONS)
    m = read_measurements(tmp_path / "a.csv")
    with pytest.raises(InputError, match=r"\.csv"):
        write_measurements(m, tmp_path / "b.txt")
    (tmp_path / "b.yml").write_text("")
    with pytest.raises(InputError, match=r"b\.yml"):
        write_measurements(m, tmp_path / "b.csv")
    with pytest.raises(InputError, match="length"):
        write_measurements(m, tmp_path / "c.csv", length="N")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b.yml"]


def test_joined_parts_never_share_a_zero_reading(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(POSITIONS)
    m = read_measurements(tmp_path / "a.csv")
    both = join_measurements([m, m.select(m.rows_of("A")), m])
    assert both.pose == ("A", "B", "A", "A", "B")
    np.testing.assert_array_equal(both.zero_group, [0, 1, 2, 3, 4])
    np.testing.assert_array_equal(both.zero_count, [2, 1, 2, 2, 1])
    np.testing.assert_allclose(both.displacement[2], m.displacement[0])


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"force_frame": "tool"}, "different force_frame"),
        ({"point": np.ones(3)}, "different point"),
        ({"order": None}, "the column order"),
        ({"zero": "unknown"}, "how zero readings are shared"),
        ({"joints": np.ones((2, 1))}, "pose 'A'"),
    ],
)
def test_unlike_parts_are_not_joined(tmp_path: Path, change: dict[str, object], part: str) -> None:
    (tmp_path / "a.csv").write_text(POSITIONS)
    m = read_measurements(tmp_path / "a.csv")
    with pytest.raises(InputError, match=part):
        join_measurements([m, dataclasses.replace(m, **change)])  # type: ignore[arg-type]
    with pytest.raises(InputError):
        join_measurements([])


def test_a_noise_is_written_without_the_rounding_of_its_unit(tmp_path: Path) -> None:
    file = tmp_path / "made.csv"
    file.write_text("pose,a[deg],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm]\n1,0,0,0,1,0,0,1\n")
    file.with_suffix(".yaml").write_text("robot: arm\nnoise: {sigma: 15, unit: um}\n")
    write_measurements(read_measurements(file, ("a",)), tmp_path / "again.csv")
    assert "sigma: 0.015\n" in (tmp_path / "again.yaml").read_text(encoding="utf-8")
