import csv
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import pytest
import yaml

from tests.cli.conftest import Run
from tests.corpus.robots import example

MODEL = str(Path(__file__).resolve().parents[3] / "robots/motoman_sk120/model.yaml")
POSE = ("--pose", "0,20,-30,0,-60,0 deg")
SOFT = ["joint_1_s", "joint_2_l", "joint_3_u"]


@pytest.mark.parametrize(
    ("name", "options", "kind"),
    [("a.xml", (), "mjcf"), ("a.sdf", (), "sdf"), ("a.txt", ("--to", "mjcf"), "mjcf")],
)
def test_models_that_move(
    run: Run, tmp_path: Path, name: str, options: tuple[str, ...], kind: str
) -> None:
    out = tmp_path / name
    found = run("export", MODEL, *POSE, *options, "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    document = found.document
    assert document["format"] == kind
    assert [spring["joint"] for spring in document["springs"]] == SOFT
    assert document["springs"][1]["stiffness"] == pytest.approx(4.0076e5)
    assert [told["effect"] for told in document["carried"]] == [f"joint_springs:{j}" for j in SOFT]
    assert ET.fromstring(out.read_text()).tag == ("mujoco" if kind == "mjcf" else "sdf")
    if kind == "mjcf":
        arm = mujoco.MjModel.from_xml_path(str(out))
        assert (arm.nu, arm.neq) == (6, 8)  # four followers, each of a motor and of its spring


def test_geometry(run: Run, tmp_path: Path) -> None:
    for name, kind in (("a.urdf", "urdf"), ("a.csv", "dh")):
        found = run("export", MODEL, "--out", str(tmp_path / name), "--json")
        assert found.code == 0, found.stderr
        assert found.document["format"] == kind
        assert [told["effect"] for told in found.document["left_out"]] == [
            f"joint_springs:{joint}" for joint in SOFT
        ]
    assert ET.parse(tmp_path / "a.urdf").getroot().find("sk120stiff") is not None
    with (tmp_path / "a.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["convention"] for row in rows} == {"standard", "modified"}
    assert len(rows) == 2 * 9


def test_urs_own_file(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "k.yaml"
    found = run("export", str(example("ur5_robot.urdf")), "--out", str(out))
    assert found.code == 0, found.stderr
    assert "forearm" in found.stdout and "hash" in found.stdout
    assert yaml.safe_load(out.read_text())["kinematics"]["forearm"]["x"] == pytest.approx(-0.425)
    refused = run("export", MODEL, "--to", "kinematics_params", "--json")
    assert refused.code == 2
    assert "no arm of Universal Robots" in refused.document["error"]["message"]


def test_people_see_what_is_carried(run: Run, tmp_path: Path) -> None:
    found = run("export", MODEL, "--out", str(tmp_path / "a.xml"))
    assert found.code == 0, found.stderr
    assert "joint_2_l" in found.stdout and "4.0076e+05" in found.stdout
    assert "Carried (as springs): joint_springs:joint_1_s" in found.stdout


def test_without_out_nothing_is_written(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    found = run("export", MODEL, "--to", "urdf")
    assert found.code == 0, found.stderr
    assert "nothing is written" in found.stdout and "joint_springs:joint_2_l" in found.stdout
    assert not list(tmp_path.iterdir())


def test_meshes_are_written_beside_it_or_nothing_is(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "panda.xml"
    found = run("export", str(example("panda.urdf")), "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    written = {path.name for path in (tmp_path / "panda.meshes").iterdir()}
    assert written == {Path(name).name for name in found.document["files"]}
    assert len(written) == 10


def test_bad_input(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "a.obj"
    found = run("export", MODEL, "--out", str(out))
    assert found.code == 2
    assert ".obj" in found.stderr and ".urdf (urdf)" in found.stderr
    assert not out.exists()
    assert run("export", MODEL).code == 2
    assert run("export", MODEL, "--at", "elbow", "--out", str(tmp_path / "a.xml")).code == 2
    told = run("export", MODEL, *POSE, "--out", str(tmp_path / "a.urdf"))
    assert told.code == 2 and "--pose" in told.stderr
    assert run("export", str(tmp_path / "no.yaml"), "--out", str(tmp_path / "a.xml")).code == 2
    assert not list(tmp_path.iterdir())


def test_the_users_own_files_are_not_overwritten(run: Run, tmp_path: Path) -> None:
    urdf = tmp_path / "arm.urdf"
    urdf.write_bytes(example("ur5_robot.urdf").read_bytes())
    before = urdf.read_bytes()
    found = run("export", str(urdf), "--out", str(urdf))
    assert found.code == 2 and "an input" in found.stderr
    assert urdf.read_bytes() == before
