"""The bundled data files: untouched copies, a deterministic conversion, and the right signs."""

import csv
import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.oracles.table2_reference import ROBOT, SIGNS, SPRINGS, jacobian, printed_rows, rms

DATA = ROBOT / "data"
SCRIPT = ROBOT.parents[1] / "scripts" / "make_sk120_data.py"
GENERATED = [
    f"table2_{kind}.{end}" for kind in ("measured", "calculated") for end in ("csv", "yaml")
]

PRINTED = {
    "table2.csv": "215fd1e5fb739922c74c7f163e470e579c28fdc350f885a0983bb9bdf171c0ec",
    "table3.csv": "d0f1de5f8ba3207e9dd32448dbb91fa7b46bb222f36ca9c982a889dd01666bd2",
    "table4.csv": "8b4bb9fd452f01fb927192088a9de41a81a5d2d3fbe2ac08177b97d816437224",
}


def read(name: str) -> list[dict[str, str]]:
    with open(DATA / name, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def numbers(row: dict[str, str], names: list[str]) -> np.ndarray:
    return np.array([float(row[name]) for name in names])


@pytest.mark.parametrize("name", PRINTED)
def test_printed_tables_are_untouched(name):
    assert hashlib.sha256((DATA / "printed" / name).read_bytes()).hexdigest() == PRINTED[name]


def test_committed_files_are_what_the_script_writes(tmp_path: Path):
    subprocess.run([sys.executable, str(SCRIPT), "--out", str(tmp_path)], check=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(GENERATED)
    for name in GENERATED:
        assert (tmp_path / name).read_bytes() == (DATA / name).read_bytes(), name


@pytest.mark.parametrize(("name", "prefix"), [("measured", ""), ("calculated", "calc_")])
def test_only_signs_and_the_wrist_differ_from_print(name, prefix):
    forces, moves = ["fx[N]", "fy[N]", "fz[N]"], ["dx[mm]", "dy[mm]", "dz[mm]"]
    arm = ["joint_1_s[deg]", "joint_2_l[deg]", "joint_3_u[deg]"]
    wrist = ["joint_4_r[deg]", "joint_5_b[deg]", "joint_6_t[deg]"]
    converted, printed = read(f"table2_{name}.csv"), printed_rows()
    assert list(converted[0]) == ["pose", *arm, *wrist, *forces, *moves]
    assert len(converted) == len(printed) == 15
    for ours, theirs in zip(converted, printed, strict=True):
        force_sign, move_sign = SIGNS[theirs["pose"]]
        assert ours["pose"] == theirs["pose"]
        assert np.array_equal(numbers(ours, arm), numbers(theirs, arm))
        assert np.array_equal(numbers(ours, wrist), np.zeros(3))
        assert np.array_equal(numbers(ours, forces), numbers(theirs, forces) * force_sign)
        printed_moves = numbers(theirs, [prefix + column for column in moves])
        assert np.array_equal(numbers(ours, moves), printed_moves * move_sign)


@pytest.mark.parametrize(
    ("name", "limits"), [("calculated", (0.18, 0.24, 0.06)), ("measured", (29.3, 22.8, 26.8))]
)
def test_converted_files_agree_with_the_geometry(name, limits):
    gaps: dict[str, list[np.ndarray]] = {}
    for row in read(f"table2_{name}.csv"):
        J = jacobian(
            np.radians(numbers(row, ["joint_1_s[deg]", "joint_2_l[deg]", "joint_3_u[deg]"]))
        )
        force = numbers(row, ["fx[N]", "fy[N]", "fz[N]"])
        move = numbers(row, ["dx[mm]", "dy[mm]", "dz[mm]"])
        gaps.setdefault(row["pose"], []).append((J @ (J.T @ force / SPRINGS) - move) * 1e3)
    for gap, limit in zip(gaps.values(), limits, strict=True):
        assert rms(np.array(gap)) == pytest.approx(limit, rel=0.05)


def test_sidecars_say_what_the_numbers_are():
    measured = yaml.safe_load((DATA / "table2_measured.yaml").read_text(encoding="utf-8"))
    assert measured["displacement"] == {"frame": "base", "zero": "shared"}
    assert "noise" not in measured  # the scatter is not published
    calculated = yaml.safe_load((DATA / "table2_calculated.yaml").read_text(encoding="utf-8"))
    sigma = calculated["noise"]["sigma"]
    assert sigma * np.sqrt(2) == pytest.approx(0.1 / np.sqrt(12), rel=0.01)
    for sidecar in (measured, calculated):
        assert sidecar["robot"] == "motoman_sk120"
        assert sidecar["point"] == {"xyz": [0.0, 0.0, 0.0], "unit": "mm"}
        assert (sidecar["base_frame"], sidecar["tool_frame"]) == ("base_link", "tool0")


def test_model_holds_the_papers_springs():
    model = yaml.safe_load((ROBOT / "model.yaml").read_text(encoding="utf-8"))
    found = {e["where"]: e["parameters"]["stiffness"] for e in model["effects"]}
    assert {e["name"] for e in model["effects"]} == {"joint_springs"}
    assert list(found) == ["joint_1_s", "joint_2_l", "joint_3_u"]
    # a YAML 1.1 reader takes 1.4e6 without a sign for a word
    assert all(isinstance(p["value"], float) and p["unit"] == "N*m/rad" for p in found.values())
    assert np.allclose([p["value"] for p in found.values()], SPRINGS / 1e3, rtol=1e-12)


def test_robot_yaml_names_what_the_urdf_has():
    robot = yaml.safe_load((ROBOT / "robot.yaml").read_text(encoding="utf-8"))
    text = (ROBOT / robot["urdf"]).read_text(encoding="utf-8")
    assert len(robot["actuated"]) == 6
    for name in robot["actuated"]:
        assert f'joint name="{name}"' in text
    for frame in (robot["base_frame"], robot["tool_frame"]):
        assert f'link name="{frame}"' in text
