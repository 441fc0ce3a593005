"""`sk120stiff check`: the contract of its JSON, defaults said aloud, refusals with a place."""

from pathlib import Path

import pytest

from tests.corpus.robots import example

TWO_LINKS = """
<robot name="two_links">
  <link name="ground"/><link name="upper"/><link name="fore"/><link name="tip"/>
  <joint name="shoulder" type="revolute"><parent link="ground"/><child link="upper"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="100" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="100" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="fore"/><child link="tip"/>
    <origin xyz="0.4 0 0"/></joint>
</robot>
"""


@pytest.fixture
def two_links(tmp_path: Path) -> str:
    path = tmp_path / "two_links.urdf"
    path.write_text(TWO_LINKS, encoding="utf-8")
    return str(path)


def test_the_bundled_robot(run) -> None:
    outcome = run("check", "motoman_sk120", "--json")
    document = outcome.document
    assert outcome.code == 0
    assert document["name"] == "motoman_sk120"
    assert document["actuated"] == [
        "joint_1_s",
        "joint_2_l",
        "joint_3_u",
        "joint_4_r",
        "joint_5_b",
        "joint_6_t",
    ]
    assert {"base_link", "tool0", "reflector"} <= set(document["frames"])
    assert document["coupled"]
    assert document["total_mass_kg"] == 0.0
    assert all(set(w) == {"code", "where", "message"} for w in document["warnings"])
    assert "no_mass" in {warning["code"] for warning in document["warnings"]}


def test_a_plain_urdf_says_which_frames_were_taken(run, two_links: str) -> None:
    document = run("check", two_links, "--json").document
    assert (document["base_frame"], document["tool_frame"]) == ("ground", "tip")
    assert document["actuated"] == ["shoulder", "elbow"]
    spoken = run("check", two_links).stdout
    assert "'ground'" in spoken
    assert "'tip'" in spoken
    shorter = run("check", two_links, "--tool", "upper", "--json").document
    assert shorter["actuated"] == ["shoulder"]


def test_the_other_arm_and_the_fingers_stand_in_the_document(run) -> None:
    document = run("check", str(example("baxter.urdf")), "--json").document
    assert document["tool_frame"] == "right_hand_link"
    assert {"frame": "left_hand_link", "joints": 7} in document["other_ends"]
    assert "r_gripper_l_finger_joint" in document["fingers"]


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        (b"", "empty"),
        (b"\xff\xfe\x00", ""),
        (b"<robot name='a'>", ""),
        (b"not xml", ""),
    ],
)
def test_what_is_no_urdf_is_refused(run, tmp_path: Path, content: bytes, hint: str) -> None:
    path = tmp_path / "broken.urdf"
    path.write_bytes(content)
    outcome = run("check", str(path), "--json")
    assert (outcome.code, outcome.answered) == (2, False)
    assert outcome.stderr.startswith("Error: ")
    assert str(path) in outcome.stderr
    assert hint in outcome.stderr
    assert "Traceback" not in outcome.stderr


def test_unknown_robots_and_frames_list_what_exists(run, two_links: str) -> None:
    outcome = run("check", "motoman_sk12")
    assert outcome.code == 2
    assert "motoman_sk120" in outcome.stderr
    outcome = run("check", two_links, "--tool", "tipp")
    assert outcome.code == 2
    assert "tip" in outcome.stderr
