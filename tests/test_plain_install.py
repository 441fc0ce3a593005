"""The plain install: what it brings does the main work, and what is missing names its command.

The libraries that `pip install .` would not bring are hidden from a process of its own.
"""

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from sk120stiff.errors import EXTRA_OF

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
MODEL = ROOT / "robots" / "motoman_sk120" / "model.yaml"
DATA = ROOT / "robots" / "motoman_sk120" / "data" / "table2_measured.csv"

# Runs commands one after the other where libraries are not there, and prints what each said.
RUN = """
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout
from importlib.machinery import PathFinder

hidden, commands = json.loads(sys.argv[1])

class Plain(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        if name.partition(".")[0] in hidden:
            return None
        return PathFinder.find_spec(name, path, target)

sys.meta_path[sys.meta_path.index(PathFinder)] = Plain
from sk120stiff.cli.main import main

said = []
for command in commands:
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        code = main(command)
    said.append((code, out.getvalue(), err.getvalue()))
print(json.dumps(said))
"""


def brought(requirements: list[str]) -> Iterator[str]:
    """Names of the distributions that these requirements bring, all the way down."""
    for text in requirements:
        requirement = Requirement(text)
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            yield canonicalize_name(requirement.name)
            yield from brought(requires(requirement.name) or [])


def hidden() -> list[str]:
    """Top-level modules of everything that is installed here and is no part of a plain install."""
    plain = {*brought(PROJECT["dependencies"]), "sk120stiff"}
    return [
        module
        for module, owners in packages_distributions().items()
        if not plain & {canonicalize_name(owner) for owner in owners}
    ]


def plainly(folder: Path, *commands: list[str]) -> list[tuple[int, str, str]]:
    job = json.dumps([hidden(), commands])
    done = subprocess.run(
        [sys.executable, "-c", RUN, job], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return [tuple(each) for each in json.loads(done.stdout)]


def command_for(extra: str) -> str:
    return f'pip install "sk120stiff[{extra}]"'


def test_what_is_optional_stands_in_the_extra_that_is_named() -> None:
    extras = PROJECT["optional-dependencies"]
    for library, extra in EXTRA_OF.items():
        assert library in {Requirement(each).name for each in extras[extra]}
        assert library not in {Requirement(each).name for each in PROJECT["dependencies"]}
    (everything,) = extras["all"]
    for_the_house = {"all", "corpus", "bench", "test", "docs"}
    assert Requirement(everything).extras == set(extras) - for_the_house


def test_the_plain_install_is_small() -> None:
    """The goal is 45 packages; pip and sk120stiff itself are the two more."""
    try:
        found = set(brought(PROJECT["dependencies"]))
    except PackageNotFoundError as error:  # a version pinned by .ci/lowest brings others
        pytest.fail(f"{error} is not installed")
    assert 20 < len(found) <= 43, sorted(found)


def test_the_main_work_is_done_plainly(tmp_path: Path) -> None:
    (tmp_path / "path.csv").write_text(
        "x[m],y[m],z[m],fx[N],fy[N],fz[N]\n1.6,0.1,0.6,0,0,-300\n1.6,0.2,0.6,0,0,-300\n"
    )
    (tmp_path / "marks.csv").write_text(
        "x[m],y[m],z[m],q1[deg],q2[deg],q3[deg],q4[deg],q5[deg],q6[deg]\n1,2,3,0,0,0,0,0,0\n"
    )
    pose = ["--pose", "0,20,-30,0,-60,0 deg"]
    start = ["--start", "0,20,-30,0,-60,0 deg"]
    few = ["--candidates", "40", "--directions", "3"]
    work = {
        "check": ["check", "motoman_sk120"],
        "stiffness": ["stiffness", "motoman_sk120", *pose, "--wrench", "0,0,-490 N"],
        "identify": ["identify", str(DATA), "--out", "model.yaml"],
        "predict": ["predict", "model.yaml", str(DATA), "--out", "predicted.csv"],
        "explain": ["explain", str(DATA), "--out", "told"],
        "effects": ["effects", "base_rocking"],
        "new": ["new", "motoman_sk120", "--out", "mine"],
        "plan": ["plan", "--model", str(MODEL), "--count", "3", *few, "--out", "plan.csv"],
        "simulate": ["simulate", str(MODEL), "plan.csv", "--out", "made.csv"],
        "compensate": ["compensate", str(MODEL), "path.csv", *start, "--out", "new.csv"],
        "export": ["export", str(MODEL), *pose, "--out", "arm.xml"],
        "posture": ["posture", str(MODEL), "path.csv", "--out", "best.csv"],
        "import": ["import", "marks.csv", "--robot", "motoman_sk120", "--out", "own.csv"],
    }
    for name, (code, out, err) in zip(work, plainly(tmp_path, *work.values()), strict=True):
        assert code == 0, (name, err)
        assert out, name
        told = command_for("view") in err
        assert told == (name == "explain"), (name, err)  # it alone draws without being asked
        assert "Traceback" not in err
        if told:
            assert err.count("pip install") == 2  # one sentence for pictures, one for the scene
    report = (tmp_path / "told" / "report.html").read_text(encoding="utf-8")
    assert "Left out: the picture" in report
    assert "<svg" not in report
    assert "Parameters" in report
    assert not (tmp_path / "told" / "scene.html").exists()
    assert json.loads((tmp_path / "told" / "verdict.json").read_text())["verdict"] == "none"
    rows = (tmp_path / "predicted.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("pose,predicted_dx[mm]")
    assert len(rows) == 16


def test_what_is_missing_names_its_command(tmp_path: Path) -> None:
    arm = tmp_path / "arm.xacro"
    arm.write_text(
        '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:property name="l" value="1"/></robot>',
        "utf-8",
    )
    book, bag = tmp_path / "book", tmp_path / "bag"
    book.write_bytes(b"PK\x03\x04 xl/workbook.xml")
    bag.write_bytes(b"\x89MCAP0\r\n")
    reading = ["--robot", "motoman_sk120", "--out", "own.csv"]
    grid = ["--grid", "joint_2_l=0:10:5 deg; joint_3_u=0:10:5 deg", "--out", "sk.zarr"]
    asked = [
        ("view", ["view", "motoman_sk120"]),
        ("view", ["view", "motoman_sk120", "--static", "scene.html"]),
        ("view", ["paper", "--out", "paper"]),
        ("view", ["posture", str(MODEL), "path.csv", "--out", "b.csv", "--picture", "b.svg"]),
        ("view", ["map", "motoman_sk120", *grid, "--page", "map.html"]),
        ("map", ["map", "motoman_sk120", *grid]),
        ("cluster", ["map", "motoman_sk120", *grid, "--scheduler", "tcp://127.0.0.1:9"]),
        ("xacro", ["check", str(arm)]),
        ("import", ["import", str(book), *reading]),
        ("import", ["import", str(bag), *reading]),
    ]
    said = plainly(tmp_path, *(arguments for _, arguments in asked))
    for (extra, arguments), (code, out, err) in zip(asked, said, strict=True):
        assert (code, out) == (2, ""), (arguments, err)
        assert re.search(r"needs the library '\w+', which is not installed", err)
        assert command_for(extra) in err, arguments
    assert {path.name for path in tmp_path.iterdir()} == {"arm.xacro", "book", "bag"}  # no more


def test_modules_import_plainly_but_for_the_live_page_and_the_compiled_kernel() -> None:
    code = RUN.partition("from sk120stiff")[0] + (
        "import pkgutil, sk120stiff\n"
        "lost = {}\n"
        "for each in pkgutil.walk_packages(sk120stiff.__path__, 'sk120stiff.', onerror=str):\n"
        "    if each.name.endswith(('__main__', 'xacro_child')): continue\n"
        "    try: __import__(each.name)\n"
        "    except Exception as error: lost[each.name] = type(error).__name__\n"
        "print(json.dumps(lost))\n"
    )
    job = json.dumps([hidden(), []])
    done = subprocess.run(
        [sys.executable, "-c", code, job], capture_output=True, text=True, check=True
    )
    for module, error in json.loads(done.stdout).items():
        live = module.startswith("sk120stiff.show.live") and error == "MissingPart"
        compiled = module.startswith("sk120stiff.stiffness.kernel.")
        assert live or compiled, (module, error)
