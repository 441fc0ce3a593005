"""Forces of which a file has some components alone, and files of loads that say too little."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import FORMATS, Source
from sk120stiff.measurements.importers.campaign.pairing import paired
from sk120stiff.measurements.importers.loads.loads import loads_of
from sk120stiff.measurements.importers.one_file import opened
from sk120stiff.measurements.importers.told import Told
from tests.measurements.importers.reading import SIX, draft_of, sheet_of

POINTS = "name,x,y,z,q1,q2,q3,q4,q5,q6\nA,1,2,3,1,2,3,4,5,6\nB,2,3,4,2,3,4,5,6,7\n"
MOVED = "dx,dy,dz,q1,q2,q3,q4,q5,q6,{}\n1,2,3,1,2,3,4,5,6,{}\n2,3,4,2,3,4,5,6,7,{}\n"


def wrench(folder: Path, loads: str) -> tuple[np.ndarray, str]:
    """What a file of loads beside `POINTS` says, (2, 6), and the sentence of it."""
    points = sheet_of(folder, POINTS)
    path = folder / "loads.csv"
    path.write_text(loads)
    source = opened(Source(path, SIX, "loads"))
    found = loads_of(paired(points, FORMATS.chosen(source)[0].read(source), "loads"), Told())
    assert found.payload is None
    return found.wrench, found.said


def test_a_force_along_one_axis_keeps_its_sign(tmp_path: Path) -> None:
    W, said = wrench(tmp_path, "Name;Fz [N]\nA;196.13\nB;-5\n")
    np.testing.assert_array_equal(W[:, :3], [[0.0, 0.0, 196.13], [0.0, 0.0, -5.0]])
    assert "Of fx and fy there is no column: taken as zero." in said


def test_the_file_of_readings_follows_the_same_rule(tmp_path: Path) -> None:
    text = MOVED.format("fy [kN],mz [N*m]", "0.2,3", "0,1")
    loads = draft_of(tmp_path, text, length="mm", angle="deg").loads
    np.testing.assert_allclose(loads.wrench, [[0, 200.0, 0, 0, 0, 3.0], [0, 0, 0, 0, 0, 1.0]])
    assert "Of fx, fz, mx and my there is no column" in loads.said


def test_three_components_say_nothing_of_zeros(tmp_path: Path) -> None:
    W, said = wrench(tmp_path, "Name;Fx [N];Fy [N];Fz [N]\nA;1;2;3\nB;4;5;6\n")
    np.testing.assert_array_equal(W[:, :3], [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    assert "no column" not in said


def test_a_component_under_a_name_that_is_not_known_is_asked_for(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="fx and fy have no column, and what 'Fquer") as e:
        wrench(tmp_path, "Name;Fz [N];Fquer [N]\nA;1;2\nB;4;5\n")
    assert "loads.csv" in str(e.value.where)


def test_numbers_of_no_unit_beside_two_components_may_be_the_third(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="fy has no column, and what 'g' is is not known"):
        wrench(tmp_path, "Name;Fx [N];g;Fz [N]\nA;1;2;3\nB;4;5;6\n")
    W, _ = wrench(tmp_path, "Name;Fx [N];g;Fz [N]\nA;1;gut;3\nB;4;gut;6\n")
    np.testing.assert_array_equal(W[:, :3], [[1.0, 0.0, 3.0], [4.0, 0.0, 6.0]])


def test_moments_alone_are_refused(tmp_path: Path) -> None:
    text = MOVED.format("mx [N*m]", "1", "2")
    with pytest.raises(InputError, match="no column fx, fy, fz holds a force"):
        draft_of(tmp_path, text, length="mm", angle="deg")


@pytest.mark.parametrize("header", ["Kraft [N]", "F [N]", "Wert"])
def test_numbers_under_another_header_are_no_payload(header: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no format that is known fits this file") as caught:
        wrench(tmp_path, f"Name;{header}\nA;196.13\nB;5\n")
    assert "fx[N], fy[N], fz[N]" in caught.value.remedy and "--columns" not in caught.value.remedy


def test_a_force_without_an_axis_is_asked_for_beside_displacements(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="along which axis 'Kraft \\[N\\]' acts") as caught:
        draft_of(tmp_path, MOVED.format("Kraft [N]", "1", "2"), length="mm", angle="deg")
    assert "direction" in caught.value.remedy
    free = draft_of(tmp_path, MOVED.format("Strom [A]", "1", "2"), length="mm", angle="deg")
    assert not free.loads.wrench.any()


@pytest.mark.parametrize(
    "form",
    ["ft_{}[N]", "netft_{}[N]", "ati_{}[N]", "{}_sensor[N]", "tool_{}[N]", "flange_{}[N]",
     "/ft/wrench/force/{}"],
)  # fmt: skip
def test_axes_of_a_sensor_are_asked_for(form: str, tmp_path: Path) -> None:
    names = [form.format(a if "/" in form else f"f{a}") for a in "xyz"]
    text = MOVED.format(",".join(names), "1,2,3", "4,5,6")
    with pytest.raises(InputError, match="in which axes they are") as caught:
        draft_of(tmp_path, text, length="mm", angle="deg", load="N" if "/" in form else None)
    assert "--forces tool" in caught.value.remedy
    loads = draft_of(
        tmp_path, text, length="mm", angle="deg", forces="tool", load="N" if "/" in form else None
    ).loads
    assert loads.frame == "tool" and loads.wrench[0, 0] == 1.0


def test_a_sensor_that_is_screwed_on_turned_is_written_with_its_turn(tmp_path: Path) -> None:
    text = MOVED.format("fx[N],fy[N],fz[N]", "1,2,3", "4,5,6")
    told = {"length": "mm", "angle": "deg", "forces_rpy": np.radians([0.0, 0.0, 45.0])}
    for of_no_frame in ({}, {"forces": "instrument"}):
        with pytest.raises(InputError, match="against which"):
            draft_of(tmp_path, text, **told, **of_no_frame)
    loads = draft_of(tmp_path, text, forces="tool", **told).loads
    assert "turned by roll, pitch, yaw 0, 0, 45 deg in the tool frame" in loads.said
    assert loads.wrench[0, :3].tolist() == [1.0, 2.0, 3.0]  # as read: the YAML file turns them
