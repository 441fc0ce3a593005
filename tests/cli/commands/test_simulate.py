"""`sk120stiff simulate`: files that identify and predict take back."""

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.measurements import read_measurements
from tests.positions.arm import poses, write

MODEL = "robots/motoman_sk120/model.yaml"
PLAN = "robots/motoman_sk120/data/table2_measured.csv"


def test_rows_and_seed(run, tmp_path: Path) -> None:
    out = tmp_path / "made.csv"
    options = ("--noise", "10 um", "--schedule", "up-down", "--levels", "3", "--repeats", "2")
    outcome = run("simulate", MODEL, PLAN, *options, "--seed", "7", "--out", str(out), "--json")
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert (found["rows"], found["seed"], found["poses"]) == (15 * 5 * 2, 7, 3)
    made = read_measurements(out)
    assert made.n_readings == 150
    assert made.noise.sigma == pytest.approx(1e-5)
    assert made.zero == "shared"
    assert set(made.branch) == {"load", "unload"}
    assert "simulated" in made.source
    assert "seed 7" in made.source
    again = tmp_path / "again.csv"
    run("simulate", MODEL, PLAN, *options, "--seed", "7", "--out", str(again))
    assert again.read_text(encoding="utf-8") == out.read_text(encoding="utf-8")


def test_the_springs_come_back(run, tmp_path: Path) -> None:
    for extra in ((), ("--positions",)):
        out = str(tmp_path / "made.csv")
        options = ("--noise", "2 um", "--growth", "0.002", *extra)
        run("simulate", MODEL, PLAN, *options, "--out", out)
        found = run("identify", out, "--json").document
        for parameter, true in zip(
            found["parameters"], [1.4098e6, 4.0076e5, 9.3528e5], strict=True
        ):
            low, high = parameter["interval_95"]
            assert 0.97 * true < parameter["value"] < 1.03 * true
            assert low < true < high
        assert found["lack_of_fit"]["probability"] > 1e-3


def test_noise_as_the_plan_states_it(run, tmp_path: Path) -> None:
    plan, out = tmp_path / "plan.csv", tmp_path / "made.csv"
    run("simulate", MODEL, PLAN, "--out", str(plan))
    silent = run("simulate", MODEL, str(plan), "--noise", "stated", "--out", str(out), "--json")
    assert silent.code == 2
    assert "states no noise" in silent.document["error"]["message"]
    assert not out.exists()
    settings = plan.with_suffix(".yaml")
    said = settings.read_text(encoding="utf-8")
    ray = "{xyz: [3.4, -2.7, 0.9], unit: m, along: 4, across: 9, across_per_m: 3}"
    settings.write_text(f"{said}noise: {{unit: um, instrument: {ray}}}\n", encoding="utf-8")
    run("simulate", MODEL, str(plan), "--noise", "stated", "--seed", "3", "--out", str(out))
    made = read_measurements(out)
    assert made.noise.instrument is not None
    assert made.noise.instrument.across_per_m == pytest.approx(3e-6)
    found = run("identify", str(out), "--json").document
    assert found["lack_of_fit"]["probability"] > 1e-3
    header, *rows = plan.read_text(encoding="utf-8").splitlines()
    told = [f"{header},sx[um],sy[um],sz[um]", *(f"{row},5,5,20" for row in rows)]
    columns = tmp_path / "columns.csv"
    columns.write_text("\n".join(told) + "\n", encoding="utf-8")
    columns.with_suffix(".yaml").write_text(said, encoding="utf-8")
    drawn = run("simulate", MODEL, str(columns), "--noise", "stated", "--out", str(out))
    assert drawn.code == 0, drawn.stderr
    assert (read_measurements(out).sigma[:, 2] > 3 * read_measurements(out).sigma[:, 0]).all()
    both = run("simulate", MODEL, str(plan), "--noise", "stated", "--growth", "0.01",
               "--out", str(out))  # fmt: skip
    assert both.code == 2


def test_without_noise_the_gap_is_nothing(run, tmp_path: Path) -> None:
    out = str(tmp_path / "made.csv")
    run("simulate", MODEL, PLAN, "--out", out)
    assert run("predict", MODEL, out, "--json").document["rms_um"] < 1e-6


def test_positions_carry_zero_rows(run, tmp_path: Path) -> None:
    out = tmp_path / "made.csv"
    found = run(
        "simulate", MODEL, PLAN, "--positions", "--zero", "separate", "--out", str(out), "--json"
    ).document
    assert (found["rows"], found["readings"], found["zero_rows"]) == (30, 15, 15)
    header, *rows = out.read_text(encoding="utf-8").splitlines()
    assert "x[mm],y[mm],z[mm]" in header
    assert len(rows) == 30
    made = read_measurements(out)
    assert len(np.unique(made.zero_group)) == 15


def test_outliers_are_listed(run, tmp_path: Path) -> None:
    out = tmp_path / "made.csv"
    options = ("--noise", "10 um", "--outliers", "0.2", "--schedule", "ascending")
    found = run("simulate", MODEL, PLAN, *options, "--out", str(out), "--json").document
    assert 5 <= len(found["outliers"]) <= 30


@pytest.mark.parametrize(
    ("options", "hint"),
    [
        (("--noise", "10"), "unit"),
        (("--noise", "-3 um"), "positive"),
        (("--noise", "3 N"), "--noise"),
        (("--growth", "0.1"), "--noise"),
        (("--outliers", "0.1"), "--noise"),
        (("--schedule", "sideways"), "sideways"),
        (("--repeats", "0"), "repeats"),
    ],
)
def test_bad_options(run, tmp_path: Path, options, hint: str) -> None:
    out = tmp_path / "made.csv"
    outcome = run("simulate", MODEL, PLAN, *options, "--out", str(out), "--json")
    assert (outcome.code, outcome.answered) == (2, False)
    assert hint in outcome.stderr
    assert not out.exists()


def test_out_must_be_a_csv(run, tmp_path: Path) -> None:
    outcome = run("simulate", MODEL, PLAN, "--out", str(tmp_path / "made.txt"))
    assert outcome.code == 2
    assert ".csv" in outcome.stderr


def test_a_plan_of_positions_is_read_row_by_row(run, tmp_path: Path) -> None:
    """Of a tracker's campaign positions come back, rows without load among them."""
    empty = np.full((12, 3), np.nan)
    plan = write(
        tmp_path, poses(12, 1), empty, "noise: {sigma: 20, unit: um}\n",
        more=",qw,qx,qy,qz", cells=[",,,"] * 12,
    )  # fmt: skip
    options = ("--noise", "stated", "--noise-rotation", "50 urad", "--seed", "2")
    out = tmp_path / "made.csv"
    found = run("simulate", str(tmp_path / "six.urdf"), str(plan), *options, "--out", str(out))
    assert found.code == 0, found.stderr
    assert "12 rows at 12 poses, read as the plan has them, seed 2" in found.stdout
    made = sk.read(out).absolute
    assert made is not None and made.channels.present == ("position", "rotation")
    assert made.channels.sigma["rotation"] == pytest.approx(5e-5)
    refused = run("simulate", "six.urdf", str(plan), "--positions", "--out", str(out))
    assert refused.code == 2
