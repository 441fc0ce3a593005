"""`sk120stiff paper` as a user runs it."""

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest


def run(*arguments: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "sk120stiff", "paper", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        stdin=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])},
        cwd=cwd,
    )


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    out = tmp_path_factory.mktemp("paper") / "new" / "folder"
    return out, run("--json", "--out", out)


def test_json_is_all_there_is_on_stdout(written):
    out, done = written
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert {"table2", "table3", "table4", "identified"} <= set(document)
    assert {Path(f).name for f in document["files"]} == {path.name for path in out.iterdir()}


def test_report_figures_and_csv_files(written):
    out, _ = written
    names = {path.name for path in out.iterdir()}
    figures = {f"figure_{k}" for k in range(4, 10)} | {
        "table2",
        "table2_gaps",
        "table4",
        "identified",
        *(f"figure_{k}_surface" for k in (7, 8, 9)),
    }
    assert {f"{f}.{end}" for f in figures for end in ("svg", "png")} <= names
    assert {"table2.csv", "table3.csv", "table4.csv", "claims.csv", "report.html"} <= names
    for path in out.glob("*.png"):
        assert path.read_bytes().startswith(b"\x89PNG")
    for path in out.glob("*.csv"):
        with open(path, encoding="utf-8", newline="") as file:
            assert len(list(csv.reader(file))) > 2


def test_the_report_is_whole(written):
    out, _ = written
    page = (out / "report.html").read_text(encoding="utf-8")
    for heading in ("Every claim", "Table II", "Table IV", "Figs. 4 to 6", "Appendix I"):
        assert heading in page
    assert page.count("<svg") >= 10
    assert not re.search(r'(?:src|href)="https?://', page)


def test_tables_for_people():
    done = run()
    assert done.returncode == 0
    assert "Traceback" not in done.stderr
    for text in ("Table II", "2785", "364.3", "J21", "not reproducible", "claims:"):
        assert text in done.stdout


def test_a_file_in_the_way_of_the_folder(tmp_path):
    (tmp_path / "taken").write_text("mine", encoding="utf-8")
    done = run("--out", tmp_path / "taken")
    assert done.returncode == 2
    assert "this is a file, not a folder" in done.stderr and "taken" in done.stderr
    assert done.stdout == ""
    assert (tmp_path / "taken").read_text(encoding="utf-8") == "mine"


def test_an_unknown_option():
    done = run("--nonsense")
    assert done.returncode == 2 and "--nonsense" in done.stderr
