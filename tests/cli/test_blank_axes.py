"""Readings along one axis through the commands: a dial gauge along z, and cells that were lost."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.measurements import Measurements, read_measurements, write_measurements
from tests.cli.conftest import Run
from tests.explain.readings import hidden
from tests.hidden.generator.causes_elastic import BaseRocking, JointTilt

ROCKING = BaseRocking("base_link", {"x": 3e-7, "y": 3e-7})
TILT = JointTilt("joint_2_l", {"first": 5e-7, "second": 5e-7})
SPRINGS = {"joint_2_l": 4.0e5, "joint_3_u": 9.4e5}  # those that a gauge along z sees


def along_z(readings: Measurements) -> Measurements:
    only = np.where([False, False, True], readings.displacement, np.nan)
    return replace(readings, displacement=only)


@pytest.fixture
def gauge(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """20 poses of 3 loads each, read along z alone."""
    readings = hidden(*request.param, poses=20, loads=3, schedule="ascending")
    return str(write_measurements(along_z(readings), tmp_path / "gauge.csv"))


def cells(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.mark.parametrize("gauge", [()], indirect=True)
def test_springs_lie_within_their_intervals(run: Run, gauge: str) -> None:
    found = run("identify", gauge, "--json")
    assert found.code == 0, found.stderr
    told = {p["name"].split(":")[1].split(".")[0]: p for p in found.document["parameters"]}
    for joint, truth in SPRINGS.items():
        low, high = told[joint]["interval_95"]
        assert low < truth < high
        assert told[joint]["std"] < 0.05 * truth
    assert told["joint_1_s"]["interval_95"][1] is None  # it turns the point across z
    said = run("identify", gauge)
    assert "60 readings, 60 of their 180 axes read, at 20 poses" in said.stdout


@pytest.mark.parametrize("gauge", [(ROCKING,)], indirect=True)
def test_a_rocking_base_is_explained_with_its_report(run: Run, gauge: str, tmp_path: Path) -> None:
    out = tmp_path / "explained"
    done = run("explain", gauge, "--out", str(out), "--json")
    assert done.code == 0, done.stderr
    verdict = json.loads((out / "verdict.json").read_text(encoding="utf-8"))
    (found,) = verdict["effects"]
    assert "base_rocking" in (found["name"], *(a.split(":")[0] for a in found["alternatives"]))
    if found["name"] == "base_rocking":
        for p in found["parameters"]:
            assert abs(p["value"] - 1 / 3e-7) < 3.0 * p["std"]
    step = verdict["gap"]["steps"][-1]
    assert step["fit_rms"] == pytest.approx(8.0 * np.sqrt(2.0), rel=0.25)
    assert step["heldout_rms"] < 0.2 * verdict["gap"]["steps"][0]["heldout_rms"]
    assert {"report.html", "scene.html", "model.yaml"} <= {each.name for each in out.iterdir()}
    rows = cells(out / "gaps.csv")
    assert len(rows) == 60
    for row in rows:
        assert row["dx[mm]"] == row["gap_x[um]"] == row["dy[mm]"] == row["gap_y[um]"] == ""
        assert abs(float(row["gap_z[um]"])) < 60.0
        assert row["predicted_dx[mm]"] != ""
    scene = (out / "scene.html").read_text(encoding="utf-8")
    assert scene.count('"measured":null') == 60


@pytest.mark.parametrize("gauge", [(TILT,)], indirect=True)
def test_a_tilting_bearing_is_among_the_names(run: Run, gauge: str, tmp_path: Path) -> None:
    done = run("explain", gauge, "--out", str(tmp_path / "explained"), "--json")
    assert done.code == 0, done.stderr
    (found,) = done.document["effects"]
    ids = [f"{found['name']}:{found['where']}", *found["alternatives"]]
    assert "joint_tilt:joint_2_l" in ids


@pytest.mark.parametrize("gauge", [()], indirect=True)
def test_predict_leaves_blank_what_was_not_read(run: Run, gauge: str, tmp_path: Path) -> None:
    model, table = tmp_path / "model.yaml", tmp_path / "table.csv"
    assert run("identify", gauge, "--out", str(model)).code == 0
    done = run("predict", str(model), gauge, "--out", str(table), "--json")
    assert done.code == 0, done.stderr
    first, written = done.document["rows"][0], cells(table)[0]
    assert first["dx[mm]"] is None and first["gap_x[um]"] is None
    assert written["dx[mm]"] == written["gap_y[um]"] == ""
    gap = [row["gap_z[um]"] for row in done.document["rows"]]
    assert done.document["rms_um"] == pytest.approx(np.sqrt(np.mean(np.square(gap))))
    readings = read_measurements(gauge)
    for pose in done.document["per_pose"]:
        own = np.array(gap)[readings.rows_of(pose["pose"])]
        assert pose["rms_um"] == pytest.approx(np.sqrt(np.mean(own**2)))
    said = run("predict", str(model), gauge)
    assert "nan" not in said.stdout.lower()


@pytest.mark.parametrize("gauge", [()], indirect=True)
def test_a_row_without_any_axis_has_its_line_in_the_message(run: Run, gauge: str) -> None:
    file = Path(gauge)
    lines = file.read_text(encoding="utf-8").splitlines()
    place = lines[0].split(",").index("dz[mm]")
    row = lines[6].split(",")
    row[place] = ""
    lines[6] = ",".join(row)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    done = run("identify", gauge, "--json")
    assert done.code == 2
    assert done.error["message"] == "no axis of this displacement was read"
    assert done.error["where"] == f"{gauge}, line 7"
    assert "column use" in done.error["remedy"]
