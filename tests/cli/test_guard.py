"""No output ever replaces an input, whichever command and whichever way it is named."""

import os
import shutil
from pathlib import Path

import pytest

SK120 = Path(__file__).resolve().parents[2] / "robots" / "motoman_sk120"
JOINTS = ",".join(f"joint_{k}_{c}[deg]" for k, c in enumerate("slurbt", start=1))
GRID = ("--grid", "joint_2_l=0:20:10 deg")

ATTACKS = [
    "predict mod.yaml m.csv --out m.csv",
    "predict mod.yaml m.csv --out m.yaml",
    "predict mod.yaml m.csv --out mod.yaml",
    "predict mod.yaml m.csv --out rob/sk120.urdf",
    "predict mod.yaml m.csv --out rob/robot.yaml",
    "predict mod.yaml m.csv --out hard.csv",
    "predict mod.yaml m.csv --out soft.csv",
    "predict mod.yaml m.csv --out rob/../m.csv",
    "identify m.csv --out rob/model.yaml",
    "identify m.csv --model mod.yaml --out mod.yaml",
    "identify m.csv --model mod.yaml --out rob/sk120.urdf",
    "identify m.csv --out m.yaml",
    "view rob --static rob/sk120.urdf",
    "view rob --static rob/robot.yaml",
    "view rob --static rob/model.yaml",
    "view rob/sk120.urdf --static rob/sk120.urdf",
    "view rob --data m.csv --static m.csv",
    "view meshed.urdf --static cube.stl",
    "explain m.csv --model result/model.yaml --out result",
    "explain inn/m.csv --out inn",
    "explain m.csv --out rob",
    "demo --out rob",
    "export mod.yaml --out mod.yaml --to mjcf",
    "export mod.yaml --out rob/sk120.urdf --to sdf",
    "compensate mod.yaml path.csv --out path.csv",
    "compensate mod.yaml path.csv --out mod.yaml",
    "compensate mod.yaml path.csv --against truth.yaml --out truth.yaml",
    "posture mod.yaml place.csv --out place.csv",
    "posture mod.yaml place.csv --out best.csv --page mod.yaml",
    "posture mod.yaml place.csv --out best.csv --page rob/sk120.urdf",
    "posture mod.yaml place.csv --out best.csv --page best.csv",
    "simulate mod.yaml m.csv --out m.csv",
    "simulate mod.yaml m.csv --out mod.csv",
    "plan --model mod.yaml --count 3 --data m.csv --out m.csv",
    "import marks.csv --robot rob --out marks.csv",
    "map rob GRID --out rob --overwrite",
    "map rob GRID --out . --overwrite",
    "map rob GRID --out new.zarr --page rob/model.yaml",
]


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder as users have it, and the working folder."""
    shutil.copytree(SK120, tmp_path / "rob", ignore=shutil.ignore_patterns("data"))
    model = (SK120 / "model.yaml").read_text(encoding="utf-8")
    for folder in (".", "inn", "result"):
        (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / folder / "m.csv").write_bytes(
            (SK120 / "data" / "table2_measured.csv").read_bytes()
        )
        settings = (SK120 / "data" / "table2_measured.yaml").read_text(encoding="utf-8")
        lines = [line for line in settings.splitlines() if not line.startswith("robot:")]
        robot = "rob" if folder == "." else "../rob"
        (tmp_path / folder / "m.yaml").write_text("\n".join([f"robot: {robot}", *lines]))
        (tmp_path / folder / "model.yaml").write_text(model, encoding="utf-8")
    (tmp_path / "result" / "verdict.json").write_text('{"verdict": "none"}')
    text = "\n".join(line for line in model.splitlines() if not line.startswith("robot:"))
    for name in ("mod.yaml", "truth.yaml"):
        (tmp_path / name).write_text(f"robot: rob\n{text}\n", encoding="utf-8")
    os.link(tmp_path / "m.csv", tmp_path / "hard.csv")
    (tmp_path / "soft.csv").symlink_to("m.csv")
    (tmp_path / "path.csv").write_text(f"{JOINTS},fx[N],fy[N],fz[N]\n0,0,0,0,0,0,0,0,-100\n")
    (tmp_path / "place.csv").write_text("x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1500,0,0,0,0,-1\n")
    (tmp_path / "marks.csv").write_text("x1,y1,z1,q1\n0,0,0,0\n")
    (tmp_path / "cube.stl").write_text("solid none\nendsolid none\n")
    shape = '<visual><geometry><mesh filename="cube.stl"/></geometry></visual>'
    (tmp_path / "meshed.urdf").write_text(
        f'<robot name="r"><link name="a">{shape}</link><link name="b"/><joint name="j" '
        'type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    )
    # A folder that somebody else's software would take for a map.
    (tmp_path / "zarr.json").write_text("{}")
    (tmp_path / "rob" / "zarr.json").write_text("{}")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def content(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


@pytest.mark.parametrize("attack", ATTACKS)
def test_an_input_is_never_replaced(run, desk: Path, attack: str) -> None:
    before = content(desk)
    words = [part for word in attack.split() for part in (GRID if word == "GRID" else (word,))]
    outcome = run(*words)
    assert (outcome.code, outcome.stdout) == (2, "")
    assert "Choose another" in outcome.stderr or "a name of its own" in outcome.stderr
    assert content(desk) == before


@pytest.mark.parametrize("target", ["/dev/null", "/dev/stdout", "pipe", "loop", "nowhere"])
def test_what_is_no_file_is_not_replaced(run, desk: Path, target: str) -> None:
    os.mkfifo(desk / "pipe")
    (desk / "loop").symlink_to("loop")
    (desk / "nowhere").symlink_to("gone")
    before = os.lstat(target).st_ino
    outcome = run("predict", "mod.yaml", "m.csv", "--out", target)
    assert outcome.code == 2
    assert target in outcome.stderr
    assert os.lstat(target).st_ino == before


def test_a_link_is_followed_and_that_is_said(run, desk: Path) -> None:
    (desk / "elsewhere").mkdir()
    (desk / "elsewhere" / "old.csv").write_text("old")
    (desk / "link.csv").symlink_to("elsewhere/old.csv")
    outcome = run("predict", "mod.yaml", "m.csv", "--out", "link.csv")
    assert outcome.code == 0
    assert outcome.stderr.count("link.csv is a link; ") == 1
    assert (desk / "link.csv").is_symlink()
    assert "predicted_dx" in (desk / "elsewhere" / "old.csv").read_text()


def test_a_file_keeps_its_permissions(run, desk: Path) -> None:
    (desk / "p.csv").write_text("old")
    (desk / "p.csv").chmod(0o640)
    assert run("predict", "mod.yaml", "m.csv", "--out", "p.csv").code == 0
    assert (desk / "p.csv").stat().st_mode & 0o777 == 0o640


def test_an_include_of_a_xacro_is_an_input(run, desk: Path) -> None:
    xacro = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
    inside = '<link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/>'
    inside += '<child link="b"/><axis xyz="0 0 1"/></joint>'
    (desk / "part.xacro").write_text(xacro.format(inside))
    (desk / "arm.xacro").write_text(xacro.format('<xacro:include filename="part.xacro"/>'))
    before = content(desk)
    outcome = run("view", "arm.xacro", "--static", "part.xacro")
    assert outcome.code == 2
    assert "would overwrite part.xacro" in outcome.stderr
    assert content(desk) == before
    assert run("view", "arm.xacro", "--static", "scene.html").code == 0


def test_a_second_run_may_read_what_the_first_has_written(run, desk: Path) -> None:
    assert run("identify", "m.csv", "--out", "found.yaml").code == 0
    assert run("predict", "found.yaml", "m.csv", "--out", "p.csv").code == 0
    assert run("identify", "m.csv", "--out", "found.yaml").code == 0
