"""Dial gauges at a loaded arm: one number a reading, along a direction of its own."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.effects import load_case
from tests.cli.conftest import Run

POINT = np.array([0.0, 0.06, 0.08])
SIGMA = 5e-6


@pytest.fixture
def gauged(tmp_path: Path) -> str:
    robot = load_robot("ur5e")
    model, rng = base_model(robot), np.random.default_rng(1)
    joints = ",".join(f"{name}[rad]" for name in robot.actuated)
    rows = [f"pose,{joints},fx[N],fy[N],fz[N],d[mm],ux,uy,uz"]
    for pose in range(14):
        a = rng.uniform(-1.4, 1.4, 6)
        for _ in range(3):
            load = np.append(rng.uniform(-60.0, 60.0, 3), np.zeros(3))
            u = rng.normal(size=3)
            u /= np.linalg.norm(u)
            bent = model.predict(load_case(robot, a, load, point=POINT))[0] @ u
            d = 1e3 * (bent + SIGMA * rng.normal())
            rows.append(f"p{pose}," + ",".join(map(repr, map(float, [*a, *load[:3], d, *u]))))
    file = tmp_path / "gauge.csv"
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    file.with_suffix(".yaml").write_text(
        "robot: ur5e\npoint: {xyz: [0, 60, 80], unit: mm}\nnoise: {sigma: 5, unit: um}\n"
        "displacement: {zero: separate}\n"
    )
    return str(file)


def test_springs_come_of_one_number_a_reading(run: Run, gauged: str) -> None:
    found = run("identify", gauged, "--json")
    assert found.code == 0, found.stderr
    truth = base_model(load_robot("ur5e"))
    for p in found.document["parameters"]:
        if p["name"].startswith("joint_springs"):
            assert abs(p["value"] - truth.parameter(p["name"]).value) < 4.0 * p["std"]


def test_geometry_that_no_difference_shows_is_not_fitted(run: Run, gauged: str) -> None:
    said = run("identify", gauged).stdout
    assert "geometry" not in said and "joint_frame:" not in said


def test_the_gap_is_told_along_the_gauge(run: Run, gauged: str, tmp_path: Path) -> None:
    model = str(tmp_path / "model.yaml")
    assert run("identify", gauged, "--out", model).code == 0
    found = run("predict", model, gauged, "--json")
    assert found.code == 0, found.stderr
    rows = found.document["rows"]
    assert len(rows) == 42
    for row in rows:
        gap = 1e3 * (row["d[mm]"] - row["predicted_d[mm]"])
        assert row["gap_d[um]"] == pytest.approx(gap, abs=1e-9)
    assert found.document["rms_um"] == pytest.approx(5.0, rel=0.4)
    assert "Gap over 42 readings of gauges" in run("predict", model, gauged).stdout


@pytest.mark.parametrize(("words", "told"), [(("load", "unload"), True), (("load", "load"), False)])
@pytest.mark.parametrize("mass", [0.5, 0.0])
def test_a_branch_that_is_not_used_is_told(
    run: Run, gauged: str, words: tuple[str, str], told: bool, mass: float
) -> None:
    """Friction is sought of displacements alone, whatever the column promises; so are gauges."""
    head, *rows = Path(gauged).read_text("utf-8").splitlines()
    lines = [f"{head},payload[kg],branch"]
    lines += [f"{row},{mass},{words[k % 2]}" for k, row in enumerate(rows)]
    told = told and mass > 0.0
    Path(gauged).write_text("\n".join(lines) + "\n", "utf-8")
    found = run("identify", gauged)
    assert found.code == 0, found.stderr
    assert ("Friction is not sought of such readings" in " ".join(found.stdout.split())) == told
