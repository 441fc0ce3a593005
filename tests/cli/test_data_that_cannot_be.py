"""Slips of the pen and garbage, through the public commands."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from sk120stiff.measurements import write_measurements
from tests.data_checks.readings import ARMS
from tests.data_checks.test_wild import with_wild

DATA = Path("robots/motoman_sk120/data/table2_measured.csv")
MODEL = "robots/motoman_sk120/model.yaml"


@pytest.fixture
def spoilt(tmp_path: Path):
    """Writes the paper's readings with changed columns, or more settings."""

    def write(change=None, more: str = "") -> str:
        frame = pd.read_csv(DATA, comment="#", dtype=str)
        if change is not None:
            change(frame)
        frame.to_csv(tmp_path / "d.csv", index=False)
        settings = DATA.with_suffix(".yaml").read_text(encoding="utf-8")
        assert "noise:" not in settings
        (tmp_path / "d.yaml").write_text(settings + more, encoding="utf-8")
        return str(tmp_path / "d.csv")

    return write


def shuffle(frame: pd.DataFrame) -> None:
    names = [name for name in frame if name.startswith(("dx", "dy", "dz"))]
    frame[names] = frame[names].sample(frac=1.0, random_state=3).to_numpy()


@pytest.mark.parametrize("command", ["identify", "explain"])
def test_shuffled_rows_end_in_a_refusal(run, spoilt, tmp_path: Path, command: str) -> None:
    out = tmp_path / ("m.yaml" if command == "identify" else "folder")
    outcome = run(command, spoilt(shuffle), "--out", str(out))
    assert outcome.code == 1
    assert "this arm explains only" in outcome.stderr
    assert "belong together" in outcome.stderr
    assert not out.exists()


@pytest.mark.parametrize("command", ["identify", "explain"])
def test_a_sigma_in_another_unit_ends_in_a_refusal(
    run, spoilt, tmp_path: Path, command: str
) -> None:
    data = spoilt(more="\nnoise: {sigma: 10, unit: m}\n")
    out = tmp_path / ("m.yaml" if command == "identify" else "folder")
    outcome = run(command, data, "--out", str(out))
    assert outcome.code == 1
    assert "larger than the readings themselves" in outcome.stderr
    assert not out.exists()


def test_a_sign_is_told_by_identify_and_predict_and_stops_explain(
    run, spoilt, tmp_path: Path
) -> None:
    def negate(frame: pd.DataFrame) -> None:
        name = next(name for name in frame if name.startswith("joint_2_l"))
        frame[name] = -frame[name].astype(float)

    data = spoilt(negate)
    said = "joint_2_l seems to have the wrong sign"
    for arguments in (("identify", data), ("predict", MODEL, data)):
        outcome = run(*arguments)
        assert outcome.code == 0
        assert said in outcome.stderr and "Negate the column joint_2_l." in outcome.stderr
    outcome = run("explain", data, "--out", str(tmp_path / "folder"))
    assert outcome.code == 1
    assert said in outcome.stderr
    assert not (tmp_path / "folder").exists()


def test_identify_fits_the_others_and_says_so(run, tmp_path: Path) -> None:
    known = ARMS["ur5"]()
    wild = write_measurements(with_wild(known, [7], 0.02), tmp_path / "wild.csv")
    clean = known.readings.select(np.setdiff1d(np.arange(known.readings.n_readings), [7]))
    sound = write_measurements(clean, tmp_path / "sound.csv")
    found = [run("identify", str(path), "--json") for path in (wild, sound)]
    assert all(each.code == 0 for each in found), found[0].stderr
    assert "set aside" in found[0].stderr and "set aside" not in found[1].stderr
    springs = [[p["value"] for p in each.document["parameters"]] for each in found]
    np.testing.assert_allclose(springs[0], springs[1], rtol=1e-6)
