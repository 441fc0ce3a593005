import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import pytest

from tests.cli.conftest import Run

MODEL = str(Path(__file__).resolve().parents[2] / "robots/motoman_sk120/model.yaml")
POSE = ("--pose", "0,20,-30,0,-60,0 deg")


@pytest.mark.parametrize(
    ("name", "options", "kind"),
    [("a.xml", (), "mjcf"), ("a.sdf", (), "sdf"), ("a.txt", ("--to", "mjcf"), "mjcf")],
)
def test_the_file_is_written(
    run: Run, tmp_path: Path, name: str, options: tuple[str, ...], kind: str
) -> None:
    out = tmp_path / name
    found = run("export", MODEL, *POSE, *options, "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    document = found.document
    assert document["format"] == kind
    assert [spring["joint"] for spring in document["springs"]] == [
        "joint_1_s",
        "joint_2_l",
        "joint_3_u",
    ]
    assert set(document["held"]) == {"joint_4_r", "joint_5_b", "joint_6_t"}
    assert ET.fromstring(out.read_text()).tag == ("mujoco" if kind == "mjcf" else "sdf")
    if kind == "mjcf":
        assert mujoco.MjModel.from_xml_path(str(out)).nq == 4  # three springs and a follower


def test_people_see_the_springs(run: Run, tmp_path: Path) -> None:
    found = run("export", MODEL, "--out", str(tmp_path / "a.xml"))
    assert found.code == 0, found.stderr
    assert "joint_2_l" in found.stdout
    assert "4.0076e+05" in found.stdout
    assert "Held where the pose puts them: joint_4_r" in found.stdout


def test_bad_input(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "a.obj"
    found = run("export", MODEL, "--out", str(out))
    assert found.code == 2
    assert ".obj" in found.stderr
    assert not out.exists()
    assert run("export", MODEL, "--at", "elbow", "--out", str(tmp_path / "a.xml")).code == 2
    assert run("export", str(tmp_path / "no.yaml"), "--out", str(tmp_path / "a.xml")).code == 2
