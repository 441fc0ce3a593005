"""`sk120stiff pilot`: a folder that is begun, left, taken up and ended."""

import io
import os
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff.cli.commands import pilot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.measurements import read_measurements
from sk120stiff.model import read_model
from sk120stiff.plan import feasible

MODEL = "robots/motoman_sk120/model.yaml"
POINT = "-60,40,150 mm"


class Arm(io.StringIO):
    """Standard input that reads what a rocking arm would show at the pose that is proposed."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self.folder, self.asked = folder, 0
        base = read_model(MODEL)
        rocking = base + effect(base.robot, "base_rocking")
        values = rocking.values.copy()
        values[-2:] = 1 / 6e5, 1 / 2e6
        self.truth, self.rng = rocking.with_values(values), np.random.default_rng(0)

    def readline(self, *_: object) -> str:
        self.asked += 1
        plan = read_measurements(self.folder / "next.csv")
        exact = self.truth.predict(load_cases_of(self.truth.robot, plan))[0]
        read = 1e3 * (exact + self.rng.normal(size=3) * 1.4e-5)
        return ",".join(f"{x:.5f}" for x in read) + " mm\n"


def begin(run, folder: Path):
    outcome = run("pilot", str(folder), "--model", MODEL, "--point", POINT, "--json")
    text = (folder / "pilot.yaml").read_text(encoding="utf-8")
    few = text.replace("poses: 150", "poses: 40").replace("directions: 6", "directions: 4")
    (folder / "pilot.yaml").write_text(few, encoding="utf-8")
    return outcome


def test_a_campaign_from_begin_to_end(run, tmp_path: Path, monkeypatch) -> None:
    folder = tmp_path / "campaign"
    first = begin(run, folder)
    assert first.code == 0, first.stderr
    assert first.document["readings"] == 0 and first.document["stop"] is None
    plan = read_measurements(folder / "next.csv")
    assert plan.displacement is None and plan.n_readings == 1
    assert " bit)" in first.document["next"]["decides"]
    arm = Arm(folder)
    robot = arm.truth.robot
    assert feasible(robot, _cell(), plan.joints, plan.wrench, point=plan.point).ok.all()
    monkeypatch.setattr(sys, "stdin", arm)
    ended = run("pilot", str(folder), "--type")
    assert ended.code == 0, ended.stderr
    assert "base_rocking" in ended.stdout and "Stop" in ended.stdout
    assert arm.asked < 30
    assert "). One bit answers one question of yes or no" in " ".join(ended.stdout.split())
    readings = read_measurements(folder / "readings.csv")
    assert readings.n_readings == arm.asked and readings.zero == "separate"
    again = run("pilot", str(folder), "--json")  # the folder is the state
    assert again.document["readings"] == arm.asked
    assert again.document["stop"]["final"]
    assert any("base_rocking" in name for name in again.document["stop"]["names"])


def _cell():
    from sk120stiff.plan import Cell

    return Cell()


def test_what_cannot_be_begun_or_read(run, tmp_path: Path, monkeypatch) -> None:
    folder = tmp_path / "campaign"
    assert "no campaign was begun" in run("pilot", str(folder)).stderr
    outcome = run("pilot", str(folder), "--model", MODEL, "--noise", "10")
    assert outcome.code == 2 and "unit" in outcome.stderr and not folder.exists()
    outcome = run("pilot", str(folder), "--model", MODEL, "--zero", "often")
    assert outcome.code == 2 and "zero" in outcome.stderr
    cell = tmp_path / "cell.yaml"
    cell.write_text("region: {low: [0, 0, 0], high: [0.1, 0.1, 0.1]}\n", encoding="utf-8")
    for named, code in ((tmp_path / "nowhere.yaml", 2), (cell, 1)):
        outcome = run("pilot", str(folder), "--model", MODEL, "--cell", str(named))
        assert outcome.code == code and named.name in outcome.stderr and not folder.exists()
    assert begin(run, folder).code == 0
    other = run("pilot", str(folder), "--model", MODEL, "--force", "100 N")
    assert other.code == 2 and "other settings" in other.stderr
    assert run("pilot", str(folder), "--force", "100 N").code == 2
    before = (folder / "readings.csv").read_text(encoding="utf-8")
    monkeypatch.setattr(sys, "stdin", io.StringIO("0.1,0.2\n0.1,0.2,0.3\n\n"))
    outcome = run("pilot", str(folder), "--type")
    assert outcome.code == 0 and outcome.stderr.count("Error:") == 2
    assert (folder / "readings.csv").read_text(encoding="utf-8") == before
    for text, said in (("modell: x", "'modell'"), ("model: x\nnoise: 10", "'10 um'")):
        (folder / "pilot.yaml").write_text(f"{text}\n", encoding="utf-8")
        outcome = run("pilot", str(folder))
        assert outcome.code == 2 and said in outcome.stderr


def test_a_reading_that_cannot_be_is_asked_about_before_it_counts(
    run, tmp_path: Path, monkeypatch
) -> None:
    folder = tmp_path / "campaign"
    assert begin(run, folder).code == 0
    typed = "120,300,50 mm\nn\n14,-13,5 mm\n\n0.12,-0.3,0.2 mm\n90,1,1 mm\nyes\n\n"
    monkeypatch.setattr(sys, "stdin", io.StringIO(typed))
    outcome = run("pilot", str(folder), "--type")
    assert outcome.code == 0, outcome.stderr
    assert outcome.stderr.count("mm were expected") == 3
    assert "After 1 reading\n" in outcome.stdout
    read = read_measurements(folder / "readings.csv")
    np.testing.assert_allclose(1e3 * read.displacement, [[0.12, -0.3, 0.2], [90, 1, 1]])
    settings = folder / "pilot.yaml"
    text = settings.read_text(encoding="utf-8")
    text = text.replace("10 um", "20 um").replace("separate", "shared").replace("-60,", "-61,")
    settings.write_text(text, encoding="utf-8")
    outcome = run("pilot", str(folder))
    assert outcome.code == 2
    for said in ("noise 20 um and 10 um", "zero shared and separate", "-61,40,150 mm"):
        assert said in outcome.stderr


@pytest.mark.parametrize("words", [("--most", "0"), ("--target", "2 mm"), ("--point", "1 mm")])
def test_bad_settings(run, tmp_path: Path, words) -> None:
    folder = tmp_path / "campaign"
    assert run("pilot", str(folder), "--model", MODEL, *words).code == 2
    assert not folder.exists()


def test_a_file_that_grows_with_a_bad_row_is_waited_for(run, tmp_path: Path, monkeypatch) -> None:
    """A row that cannot be read is told and may be mended; what came before the wait counts too."""
    folder = tmp_path / "campaign"
    begin(run, folder)
    file = folder / "readings.csv"
    header = file.read_text(encoding="utf-8")
    row = (folder / "next.csv").read_text(encoding="utf-8").splitlines()[1]
    looked = pilot._looked

    def written_meanwhile(*given: object) -> object:
        state = looked(*given)  # type: ignore[arg-type]
        if file.read_text(encoding="utf-8") == header:
            file.write_text(f"{header}{row},0.1,oops,0.1\n", encoding="utf-8")
            os.utime(file, ns=(1, 1))
        return state

    waits = iter([None, f"{header}{row},0.11,0.02,-0.31\n"])

    def wait(_: float) -> None:
        text = next(waits, "")
        if text == "":
            raise KeyboardInterrupt
        if text:
            file.write_text(text, encoding="utf-8")

    monkeypatch.setattr(pilot, "_looked", written_meanwhile)
    monkeypatch.setattr(pilot, "time", SimpleNamespace(sleep=wait))
    outcome = run("pilot", str(folder), "--watch")
    assert "line 2" in outcome.stderr and "oops" in outcome.stderr
    assert "Correct the file" in outcome.stderr
    assert "After 1 reading" in outcome.stdout
