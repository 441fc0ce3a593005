"""A mass on the tool that a name of a file, a line above the table or an option says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Imported, Told, import_readings
from sk120stiff.measurements.importers.loads.masses_in_words import (
    mass_told,
    masses_of_comment,
    masses_of_name,
)
from tests.measurements.importers.tracked import campaign, ur5

SEEN = campaign(8)
HEAD = ",".join([*(f"q{k} [deg]" for k in range(1, 7)), "x [mm]", "y [mm]", "z [mm]"])
JOINTS = ",".join(f"q{k} [deg]" for k in range(1, 7))


def written(folder: Path, name: str, above: str = "", sunk: float = 0.0) -> Path:
    """Eight positions, `sunk` mm lower."""
    path = folder / name
    rows = [",".join(f"{v:.5f}" for v in (*q, x, y, z - sunk))
            for q, (x, y, z) in zip(SEEN.q, SEEN.x, strict=True)]  # fmt: skip
    path.write_text("\n".join([*([above] if above else []), HEAD, *rows]) + "\n")
    return path


def brought(*paths: Path, before: Path | None = None, **told: object) -> Imported:
    robot = load_robot(ur5(), tool="tool0")
    return import_readings(list(paths), robot, Told(**told), before=before)  # type: ignore[arg-type]


def hung(found: Imported) -> list[float] | None:
    payload = found.draft.loads.payload
    return None if payload is None else payload[::8].round(9).tolist()


@pytest.mark.parametrize(
    ("name", "masses"),
    [
        ("UR10_payload_5kg", (5.0,)), ("load10kg", (10.0,)), ("load_2.5kg", (2.5,)),
        ("w 2,5 kg", (2.5,)), ("m=2p5kg", (2.5,)), ("load_500g", (0.5,)), ("m=3kg", (3.0,)),
        ("with-5Kg-b", (5.0,)), ("load_10lb", (4.5359237,)), ("mit_5kg_KR16", (5.0,)),
        ("sk120_5kg_load", (5.0,)), ("robot_14kg_load_5kg", (5.0,)),
        ("load_0kg_load_5kg", (0.0, 5.0)), ("KR210", ()), ("UR5", ()), ("200N", ()), ("5G", ()),
        ("load_10kgf", ()), ("lte_5g_test", ()), ("acc_2g", ()), ("12gauge", ()),
    ],
)  # fmt: skip
def test_masses_of_names(name: str, masses: tuple[float, ...]) -> None:
    assert masses_of_name(name).masses == pytest.approx(masses)


@pytest.mark.parametrize(
    "name",
    [
        "a_5kg", "pose_001_3kg", "0kg", "UR10_5kg", "KR16kg", "iiwa_14kg", "IRB6700_155kg",
        "counterweight_30kg", "tare_2kg", "max_10kg_a", "payload_max_5kg", "payload_class_16kg",
        "max_payload_5kg", "without_5kg", "sans_5kg", "no_5kg_load", "unloaded_5kg",
        "payload_5kg_removed", "brake_off_payload_5kg", "load_2_5kg", "payload 12_5 kg",
    ],
)  # fmt: skip
def test_masses_that_need_not_have_hung_are_left_and_said(name: str) -> None:
    found = masses_of_name(name)
    assert found.masses == () and len(found.left) == 1


def test_masses_that_differ_from_file_to_file_are_of_the_files() -> None:
    assert masses_of_name("ur10_5kg", ["ur10_0kg", "ur10_5kg"]).masses == (5.0,)
    assert masses_of_name("ur10_0kg", ["ur10_0kg", "ur10_5kg"]).masses == (0.0,)
    assert masses_of_name("ur10_5kg", ["ur10_5kg", "ur10_5kg_b"]).masses == ()
    assert masses_of_name("iiwa_14kg_a", ["iiwa_14kg_a", "iiwa_14kg_b"]).masses == ()
    assert masses_of_name("lte_5g", ["lte_4g", "lte_5g"]).masses == ()
    poses = [f"pose_{k:03}_{m}kg" for k in range(1, 12) for m in (0, 3)]
    assert [masses_of_name(name, poses).masses for name in poses[:2]] == [(0.0,), (3.0,)]


def test_a_number_that_counts_the_files_goes_with_several_masses() -> None:
    """2_5kg is 2.5 kg, or the second file with 5 kg."""
    counted = ["1_0kg", "1_5kg", "2_0kg", "2_5kg"]
    assert masses_of_name("2_5kg", counted).masses == (5.0,)
    parts = masses_of_name("2_5kg", ["2_5kg", "5_0kg", "7_5kg"])
    assert parts.masses == () and "whole part" in parts.left[0][1]


@pytest.mark.parametrize(
    "text",
    [
        "payload 5 kg removed before the readings", "UR5 robot payload 5 kg, reach 850 mm",
        "UR10e: payload 12.5 kg", "no payload 5 kg", "KR 16, payload class 16 kg",
        "payload 5 kg set in controller", "payload configured 0.8 kg; hung 10 kg",
        "load cell 20 kg",
        "max. payload 10 kg", "Traglast max 16 kg", "robot mass 33 kg", "mass of the arm: 33 kg",
    ],
)  # fmt: skip
def test_lines_that_say_more_than_what_hung_are_pointed_out(text: str, tmp_path: Path) -> None:
    found = brought(written(tmp_path, "a.csv", f"# {text}"))
    assert hung(found) is None
    (doubt,) = [d for d in found.doubts if "Not taken for what hung on the tool" in d]
    assert "line 1 of a.csv" in doubt and "--payload 'FILE=5 kg'" in doubt
    told = brought(written(tmp_path, "a.csv", f"# {text}"), payloads={"": 5.0})
    assert hung(told) == [5.0] and not any("Not taken" in d for d in told.doubts)


def test_a_file_that_is_without_a_mass_is_asked_for_beside_one_with_it(tmp_path: Path) -> None:
    paths = [written(tmp_path, "without_5kg.csv"), written(tmp_path, "with_5kg.csv", sunk=1.0)]
    with pytest.raises(InputError, match=r"not taken is '5kg' in the name without_5kg\.csv"):
        brought(*paths)
    assert hung(brought(*paths, payloads={"without_5kg": 0.0})) == [0.0, 5.0]


@pytest.mark.parametrize(
    ("text", "masses"),
    [
        ("payload 10 kg", (10.0,)), ("Last: 2,5 kg", (2.5,)), ("m = 500 g", (0.5,)),
        ("with a mass of 3 kg", (3.0,)), ("5 kg load", (5.0,)), ("Charge = 4 kg", (4.0,)),
        ("payload 5 kg on tool0", (5.0,)), ("weighs 5 kg", ()), ("payload unknown", ()),
        ("payload 0 kg, later 5 kg", ()), ("loaded", ()),
    ],
)  # fmt: skip
def test_masses_of_comments(text: str, masses: tuple[float, ...]) -> None:
    assert masses_of_comment(text).masses == pytest.approx(masses)


def test_names_of_files_say_the_mass(tmp_path: Path) -> None:
    found = brought(*(written(tmp_path, f"ur_{m}kg.csv", sunk=m / 10) for m in (0, 2, 5)))
    assert hung(found) == [0.0, 2.0, 5.0]
    np.testing.assert_allclose(found.draft.loads.wrench[23, 2], -9.80665 * 5.0)
    (said,) = [s for s in found.said if "What hung on the tool" in s]
    assert "0 kg (ur_0kg.csv), 2 kg (ur_2kg.csv) and 5 kg (ur_5kg.csv)" in said
    assert "the name of the file" in said and "--payload 'FILE=5 kg'" in said
    assert found.mode == "load pairs" and found.useful_poses == 8
    assert not any("all rows are taken to be without" in s for s in found.said)


@pytest.mark.parametrize("mark", ["%", "#", "//"])
def test_a_comment_above_the_table_says_it(tmp_path: Path, mark: str) -> None:
    found = brought(written(tmp_path, "a.csv", f"{mark} payload 10 kg"))
    assert hung(found) == [10.0]
    assert any("a line above the table" in s and "10 kg (a.csv)" in s for s in found.said)
    assert not any("payload 10 kg" in item for item in found.draft.unused)


def test_name_and_comment_have_to_agree(tmp_path: Path) -> None:
    assert hung(brought(written(tmp_path, "load_5kg.csv", "# payload 5 kg"))) == [5.0]
    same = brought(written(tmp_path, "load_5kg.csv", "# UR10 payload 5 kg"))
    assert hung(same) == [5.0] and not any("Not taken" in doubt for doubt in same.doubts)
    assert hung(brought(written(tmp_path, "2_5kg.csv", "# payload 2.5 kg"))) == [2.5]
    with pytest.raises(InputError, match=r"may be 5 kg or 10 kg.*'5kg' in the name") as refused:
        brought(written(tmp_path, "load_5kg.csv", "# payload 10 kg"))
    assert "--payload 'load_5kg.csv=5 kg'" in str(refused.value.remedy)


def test_a_name_that_can_be_read_in_two_ways_is_pointed_out(tmp_path: Path) -> None:
    path = written(tmp_path, "load_2_5kg.csv")
    found = brought(path)
    assert hung(found) is None and any("'5kg' in the name" in doubt for doubt in found.doubts)
    assert hung(brought(path, payloads={"load_2_5kg": 2.5})) == [2.5]
    assert hung(brought(path, payloads={"": 5.0})) == [5.0]


def test_a_mass_that_some_files_lack_is_asked_for(tmp_path: Path) -> None:
    paths = [written(tmp_path, "load_5kg.csv", sunk=1.0), written(tmp_path, "b.csv")]
    with pytest.raises(
        InputError, match=r"known of 1 of 2 files \(5 kg in load_5kg.csv\)"
    ) as refused:
        brought(*paths)
    assert "--payload 'b.csv=0 kg'" in str(refused.value.remedy)
    assert hung(brought(*paths, payloads={"b": 0.0})) == [5.0, 0.0]
    assert hung(brought(*paths, payloads={"": 0.0})) == [0.0, 0.0]


@pytest.mark.parametrize("name", ["unloaded", "no_load", "ohne_Last", "leer"])
def test_a_file_without_load_by_its_name(tmp_path: Path, name: str) -> None:
    free = written(tmp_path, f"{name}.csv")
    assert hung(brought(written(tmp_path, "load_5kg.csv", sunk=1.0), free)) == [5.0, 0.0]
    assert hung(brought(free)) is None


def test_a_column_of_the_load_goes_before_the_name(tmp_path: Path) -> None:
    path = written(tmp_path, "load_5kg.csv")
    head, *rows = path.read_text().splitlines()
    path.write_text("\n".join([f"{head},payload [kg]", *(f"{row},2" for row in rows)]) + "\n")
    assert hung(brought(path)) == [2.0]
    with pytest.raises(InputError, match="given twice: by --payload and in payload"):
        brought(path, payloads={"": 5.0})


def test_forces_in_names_are_told_and_not_taken(tmp_path: Path) -> None:
    found = brought(*(written(tmp_path, f"{f}N.csv") for f in (0, 200)))
    assert hung(found) is None
    (doubt,) = [d for d in found.doubts if "forces whose direction" in d]
    assert "0N (0N.csv) and 200N (200N.csv)" in doubt and "fz[N]" in doubt


def test_displacements_of_a_file_are_of_its_mass(tmp_path: Path) -> None:
    path = tmp_path / "load_5kg.csv"
    rows = [",".join([*(f"{v:.4f}" for v in q), "0", "0", "-0.5"]) for q in SEEN.q]
    path.write_text("\n".join([f"{JOINTS},dx [mm],dy [mm],dz [mm]", *rows]) + "\n")
    found = brought(path)
    assert found.mode == "displacements"
    assert dict(found.columns)["fz[N]"][0] == repr(-9.80665 * 5.0)


def test_the_mass_in_words_is_that_of_the_rows_under_load(tmp_path: Path) -> None:
    found = brought(written(tmp_path, "load_5kg.csv", sunk=1.0),
                    before=written(tmp_path, "unloaded.csv"))  # fmt: skip
    assert any("all rows of a file: 5 kg (load_5kg.csv)" in s for s in found.said)


def test_a_decimal_comma_is_said_back_with_a_point(tmp_path: Path) -> None:
    mass = mass_told("0,5 kg", "--payload")
    found = brought(written(tmp_path, "a.csv"), payloads={"": mass})
    assert any("as told: 0.5 kg (a.csv)" in s for s in found.said)


def test_masses_that_are_told(tmp_path: Path) -> None:
    assert [mass_told(text, "--payload") for text in ("5 kg", "500g", "2,5kg")] == [5.0, 0.5, 2.5]
    with pytest.raises(InputError, match="'5' is no mass"):
        mass_told("5", "--payload")
    with pytest.raises(InputError, match="told of 'b', and no file is called that"):
        brought(written(tmp_path, "a.csv"), payloads={"b": 5.0})


def test_a_pattern_tells_the_mass_of_many_files(tmp_path: Path) -> None:
    paths = [written(tmp_path, f"{n}.csv", sunk=k) for k, n in enumerate(("1_a", "2_a", "1_b"))]
    assert hung(brought(*paths, payloads={"*_a.csv": 0.0, "*_b": 3.0})) == [0.0, 0.0, 3.0]
    assert hung(brought(*paths, payloads={"": 0.0, "1_b": 3.0})) == [0.0, 0.0, 3.0]
    with pytest.raises(InputError, match=r"two masses are told of 1_a\.csv: by 1_\* and \*_a"):
        brought(*paths, payloads={"1_*": 0.0, "*_a": 3.0, "*_b": 3.0})
