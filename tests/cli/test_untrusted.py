"""A model that holds values which no readings stand behind: every command that uses it says so."""

from pathlib import Path

import pytest

from sk120stiff.model import TOGETHER, UNSEEN

DATA = "robots/motoman_sk120/data/table2_measured.csv"
POSE = ("--pose", "0,20,0,0,0,0 deg", "--wrench", "0,0,-400 N")


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """The paper's model with a wrist that its readings do not show."""
    text = Path("robots/motoman_sk120/model.yaml").read_text(encoding="utf-8")
    for joint, origin in (("joint_4_r", UNSEEN), ("joint_5_b", TOGETHER)):
        text += (
            f"  - name: joint_springs\n    where: {joint}\n    parameters:\n"
            f"      stiffness: {{value: 4.79e+2, unit: N*m/rad, std: null, origin: '{origin}'}}\n"
        )
    file = tmp_path / "model.yaml"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize("command", ["predict", "stiffness"])
def test_it_is_told_once_on_stderr_and_in_the_document(run, model, command) -> None:
    arguments = {
        "predict": ("predict", str(model), DATA),
        "stiffness": ("stiffness", "motoman_sk120", *POSE, "--model", str(model)),
    }[command]
    outcome = run(*arguments, "--json")
    assert outcome.code == 0, outcome.stderr
    told = outcome.document["warnings"]
    for name, words in (("joint_4_r", "do not show"), ("joint_5_b", "together only")):
        (said,) = (text for text in told if name in text)
        assert words in said
        assert outcome.stderr.count(said) == 1


def test_a_model_that_can_be_trusted_is_used_without_a_word(run) -> None:
    outcome = run("stiffness", "motoman_sk120", *POSE, "--json")
    assert outcome.document["warnings"] == []


def test_identify_writes_what_the_next_command_warns_of(run, tmp_path) -> None:
    written = tmp_path / "all_six.yaml"
    springs = [f"joint_springs:{joint}" for joint in ("joint_4_r", "joint_5_b", "joint_6_t")]
    options = [word for name in springs for word in ("--with", name)]
    assert run("identify", DATA, *options, "--out", str(written)).code == 0
    outcome = run("predict", str(written), DATA, "--json")
    assert "joint_springs:joint_4_r.stiffness" in " ".join(outcome.document["warnings"])
