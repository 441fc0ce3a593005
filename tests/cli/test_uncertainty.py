"""From readings to ± in every command: stored, propagated, unknown where nothing shows it."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from sk120stiff.effects import load_cases_of
from sk120stiff.measurements import Measurements, NoiseStatement, write_measurements
from sk120stiff.model import joint_spring_model, read_model, write_model
from sk120stiff.plan import random_poses
from sk120stiff.robot import load_robot
from tests.cli.conftest import Run

SIGMA = 10e-6
PATH = "x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1600,-200,-300,0,0,-490\n1600,200,-300,0,0,-490\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Readings on the last joint's axis, whose spring they cannot show, and one row beside it."""
    place = tmp_path_factory.mktemp("data")
    robot = load_robot("motoman_sk120")
    six = joint_spring_model(robot, [1.4e6, 4e5, 9e5, 3e5, 3e5, 3e5])
    rng = np.random.default_rng(8)
    count = 40
    wrench = np.concatenate([400.0 * rng.normal(size=(count, 3)) / 1.7, np.zeros((count, 3))], 1)
    plan = Measurements(
        pose=tuple(f"p{k}" for k in range(count)),
        joint_names=robot.actuated,
        joints=random_poses(robot, count, rng),
        wrench=wrench,
        displacement=None,
        robot="motoman_sk120",
        zero="separate",
        noise=NoiseStatement(sigma=SIGMA),
    )
    exact = six.predict(load_cases_of(robot, plan))
    noisy = exact + np.sqrt(2.0) * SIGMA * rng.normal(size=exact.shape)
    write_measurements(replace(plan, displacement=noisy), place / "readings.csv")
    aside = replace(plan, point=np.array([0.2, 0.0, 0.1]), force_point=np.array([0.2, 0.0, 0.1]))
    write_measurements(aside, place / "aside.csv")
    (place / "path.csv").write_text(PATH, encoding="utf-8")
    return place


@pytest.fixture
def model(folder: Path, run: Run) -> str:
    path = folder / "model.yaml"
    robot = load_robot("motoman_sk120")
    write_model(joint_spring_model(robot), folder / "start.yaml")
    if not path.exists():
        data = str(folder / "readings.csv")
        done = run("identify", data, "--model", str(folder / "start.yaml"), "--out", str(path))
        assert done.code == 0, done.stderr
    return str(path)


def test_predictions_state_what_they_do_not_know(run: Run, folder: Path, model: str) -> None:
    assert len(read_model(model).uncertainty.unseen) == 1
    out = folder / "predicted.csv"
    seen = run("predict", model, str(folder / "readings.csv"), "--out", str(out), "--json")
    rows = seen.document["rows"]
    assert all(0.0 < row["std_parameters_x[um]"] < 50.0 for row in rows)
    assert "std_reason" not in rows[0] and "std_remainder_x[um]" in rows[0]
    assert seen.document["uncertainty"]["stored"] is True
    aside = run("predict", model, str(folder / "aside.csv"), "--out", str(out), "--json")
    rows = aside.document["rows"]
    lost = [row for row in rows if row["std_reason"]]
    assert len(lost) > 30
    assert any(lost[0][f"std_parameters_{axis}[um]"] is None for axis in "xyz")
    assert "joint_6_t" in lost[0]["std_reason"]
    assert "inf" not in out.read_text(encoding="utf-8")
    assert pd.read_csv(out)["std_parameters_y[um]"].isna().any()
    assert "no known uncertainty" in run("predict", model, str(folder / "aside.csv")).stdout


def test_every_command_has_its_plus_minus(run: Run, folder: Path, model: str) -> None:
    common = ("--pose", "joint_2_l=20 deg", "--wrench", "0,0,-490 N", "--json")
    found = run("stiffness", "motoman_sk120", "--model", model, *common).document["uncertainty"]
    assert all(0.0 < x < 1e5 for x in found["principal_stiffness"]["std"])
    assert found["unknown_because"] is None
    assert max(found["deflection"]["std_parameters"]) < 50e-6
    out = folder / "corrected.csv"
    found = run("compensate", model, str(folder / "path.csv"), "--out", str(out), "--json")
    assert 0.0 < found.document["uncertainty"]["after_std_parameters_um"] < 50.0
    assert found.document["after_um"] < 1e-3
    with out.open(encoding="utf-8") as stream:
        assert all(
            0.0 < float(row["after_std_parameters[um]"]) < 50 for row in csv.DictReader(stream)
        )
    grid = ("--grid", "joint_2_l=-60:60:30; joint_3_u=-60:0:30 deg", "--wrench", "0,0,-490 N")
    store = ("--out", str(folder / "m.zarr"), "--page", str(folder / "m.html"))
    colour = ("--colour", "deflection_length", "--json")
    found = run("map", "motoman_sk120", "--model", model, *grid, *store, *colour)
    (load,) = found.document["loads"]
    assert 0.0 < load["deflection_std_parameters"] < 100e-6 < load["deflection"]
    assert "deflection over the workspace" in (folder / "m.html").read_text(encoding="utf-8")


def test_a_model_without_it_says_so_everywhere(run: Run, folder: Path) -> None:
    bundled = "robots/motoman_sk120/model.yaml"
    load = ("--wrench", "0,0,-490 N")
    told = [
        run("predict", bundled, "robots/motoman_sk120/data/table2_measured.csv"),
        run("stiffness", "motoman_sk120", *load),
        run("compensate", bundled, str(folder / "path.csv"), "--out", str(folder / "c.csv")),
    ]
    assert all("No uncertainty is stored" in outcome.stdout for outcome in told)
    found = json.loads(run("stiffness", "motoman_sk120", *load, "--json").stdout)
    assert found["uncertainty"] == {
        "stored": False,
        "reason": "no uncertainty is stored in this model",
    }


def test_a_colour_that_the_map_lacks_is_refused_before_the_work(run: Run, folder: Path) -> None:
    grid = ("--grid", "joint_2_l=-60:60:30; joint_3_u=-60:0:30 deg")
    page = ("--page", str(folder / "n.html"), "--colour", "deflection_std_parameters")
    found = run("map", "motoman_sk120", *grid, "--out", str(folder / "n.zarr"), *page)
    assert found.code == 2 and "minimum_stiffness" in found.stderr
    assert not (folder / "n.zarr").exists()
