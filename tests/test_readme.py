"""README and docs say what is so: their commands run, their numbers are those of the program."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from sk120stiff.cli.main import COMMANDS, main
from sk120stiff.effects import CATALOGUE
from sk120stiff.measurements import read_measurements
from sk120stiff.model import read_model
from sk120stiff.paper import reproduce
from sk120stiff.robot import load_robot
from tests.pages import blocks

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
FILES = (ROOT / "docs" / "FILES.md").read_text(encoding="utf-8")
VENV = "python3 -m venv .venv && "


def section(title: str) -> str:
    return README.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def in_the_table(row: str) -> str:
    """The rows of the README that hold this text."""
    return "\n".join(line for line in README.splitlines() if line.startswith("|") and row in line)


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files that README and docs show, and the checkout's robots."""
    folder = tmp_path_factory.mktemp("desk")
    (folder / "robots").symlink_to(ROOT / "robots")
    for block in (*blocks(README), *blocks(FILES)):
        if block.file:
            (folder / block.file).write_text(block.text, encoding="utf-8")
    return folder


def test_the_two_commands_are_those_that_ci_runs() -> None:
    lines = [line for line in README.splitlines() if line.startswith("python3 -m venv")]
    demo, tests = lines
    assert demo == f'{VENV}.venv/bin/pip install ".[view]" && .venv/bin/sk120stiff demo'
    assert tests == f'{VENV}.venv/bin/pip install -e ".[test]" && .venv/bin/python -m pytest'
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    patterns = re.findall(r"grep -E '(.*?)' README\.md", script)
    for pattern, line in zip(patterns, lines, strict=True):
        assert [other for other in lines if re.search(pattern, other)] == [line]


@pytest.mark.parametrize("page", ["README.md", "docs/FILES.md", "tests/hidden/README.md"])
def test_links_lead_somewhere(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    links = [link for link in re.findall(r"\]\(([^)]+)\)", text) if "://" not in link]
    missing = [link for link in links if not (ROOT / page).parent.joinpath(link).is_file()]
    assert not missing
    assert links or page != "README.md"


def test_files_and_folders_that_are_named_exist() -> None:
    for name in re.findall(r"`((?:scripts|tests|sk120stiff|effects)/[\w./]*)`", README):
        home = ROOT / "sk120stiff" if name.startswith("effects/") else ROOT
        assert (home / name).exists(), name


def test_the_lines_of_python_run(desk: Path) -> None:
    (block,) = blocks(README, "python")
    assert len(block.text.strip().splitlines()) <= 12
    done = subprocess.run(
        [sys.executable, "-c", block.text],
        cwd=desk,
        env={"MPLBACKEND": "agg", "PYTHONPATH": str(ROOT), "PATH": "", "HOME": str(desk)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "joint_springs:joint_1_s.stiffness = 1.357e+06 ± 1.5e+04 N*m/rad" in done.stdout
    assert (desk / "fit.png").stat().st_size > 5000


def test_the_files_that_are_shown_can_be_read(desk: Path) -> None:
    robot = load_robot("motoman_sk120")
    readings = read_measurements(desk / "own.csv", robot.actuated)
    assert readings.poses == ("A", "B")
    assert len(readings.pose) == 3
    (desk / "every_key.csv").write_text((desk / "own.csv").read_text(encoding="utf-8"), "utf-8")
    assert read_measurements(desk / "every_key.csv", robot.actuated).force_point[2] == 0.1
    assert len(read_model(desk / "model_by_hand.yaml").parameters) == 2


def test_of_the_readings_that_are_shown_nothing_is_missing(desk: Path) -> None:
    """Three rows are too few to doubt how they were written."""
    done = subprocess.run(
        [sys.executable, "-m", "sk120stiff", "explain", "own.csv", "--out", "own", "--json"],
        cwd=desk, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["verdict"] == "none" and "Warning" not in done.stderr


@pytest.fixture(scope="module")
def explained(desk: Path) -> str:
    """What the README's own example prints, run as written."""
    (example,) = (block for block in blocks(README, "bash") if "sk120stiff plan" in block.text)
    for line in example.text.splitlines():
        words = [sys.executable, "-m", *shlex.split(line)]
        done = subprocess.run(words, cwd=desk, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_example_prints_what_is_shown(explained: str) -> None:
    shown = next(block for block in blocks(README, "text") if "rocks" in block.text)
    assert explained.startswith(shown.text.removesuffix("…\n").rstrip())


def test_every_command_has_an_example_that_runs(
    explained: str, desk: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """And docs/FILES.md names every key of its JSON."""
    examples = re.findall(r"`(sk120stiff [a-z]+ [^`]+)` \|", section("Commands"))
    assert sorted(line.split()[1] for line in examples) == sorted(COMMANDS)
    page = FILES.partition("\n## JSON of the commands\n")[2].partition("\n## ")[0]
    of_all, _, table = page.partition("\n| command |")
    monkeypatch.chdir(desk)
    for line in examples:
        command, *arguments = shlex.split(line)[1:]
        if command not in ("demo", "paper", "explain"):  # they have tests of their own
            capfd.readouterr()
            assert main([command, *arguments, "--json"]) == 0, line
            (row,) = re.findall(rf"^\| `{command}` \| (.*) \|$", table, re.MULTILINE)
            keys = set(json.loads(capfd.readouterr().out))
            assert keys <= set(re.findall(r"`(\w+)`", row + of_all)), command


def test_every_effect_is_listed() -> None:
    listed = set(re.findall(r"`(\w+)`", "\n".join(
        line for line in section("Effects").splitlines() if line.startswith("|")
    )))  # fmt: skip
    assert listed == {effect.name for effect in CATALOGUE}


def test_the_numbers_of_the_paper_are_those_of_the_program() -> None:
    found = reproduce()
    from sk120stiff.paper.tables import as_document

    document = as_document(found)
    table2, identified = document["table2"], document["identified"]
    ours = " / ".join(f"{v:.2f}" for v in table2["calculated_rms_um"]["equilibrium"].values())
    assert f"within {ours} µm rms" in in_the_table("Table II, calculated")
    paper = table2["measured_rms_um"]["paper_springs"]
    after = table2["measured_rms_um"]["identified"]
    assert " / ".join(f"{v:.1f}" for v in paper.values()) in in_the_table("Table II, measured")
    for pose in paper:
        assert f"| pose {pose} | {paper[pose]:.1f} | {after[pose]:.1f} |" in README
    springs = ", ".join(
        f"{p['value'] / 1e6:.3f} ± {p['std'] / 1e6:.3f}" for p in identified["parameters"]
    )
    assert springs in in_the_table("springs [10⁶")
    assert f"by {max(table2['K_C_effect_rms_um'].values()):.2f} µm" in in_the_table("K_C in Table")
    for case, row in ((2, "case 2"), (4, "case 4")):
        (counted,) = (c for c in document["table4"]["cases"] if c["case"] == case)
        theirs, definite = counted["paper PD"], counted["true PD"]
        assert f"| {theirs} | {definite}; {counted['det > 0']} " in in_the_table(row)
    assert f"{document['critical']['smallest'] / 1e3:.0f} kN" in in_the_table("loses definiteness")
    assert f"{len(document['claims'])} statements" in README
