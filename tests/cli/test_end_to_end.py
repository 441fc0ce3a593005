"""From a URDF to a corrected path and a page, every option at its default, on public arms."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from sk120stiff import load_robot, read_model
from sk120stiff.robot.anatomy import sample_poses
from tests.corpus.robots import example

# URDF of example-robot-data, base and tool frame where the arm is a part of a larger robot, axes.
ARMS = {
    "Universal Robots UR5": ("ur5_robot.urdf", (), 6),
    "Franka Panda": ("panda.urdf", (), 7),
    "Kinova Jaco": ("kinova.urdf", (), 6),
    "Rethink Baxter, one arm": ("baxter.urdf", (), 7),
    "PAL TIAGo": ("tiago_no_hand.urdf", ("--base", "torso_lift_link"), 7),
}
PATH = "0,100,50"  # N on the tool along the path


def path_of(folder: Path) -> Path:
    """Three loaded points of a path by joints."""
    robot = load_robot(folder)
    a = sample_poses(robot, 3)
    units = ["mm" if slides else "deg" for slides in robot.prismatic]
    scale = np.array([1e3 if slides else 180.0 / np.pi for slides in robot.prismatic])
    head = [f"{n}[{u}]" for n, u in zip(robot.actuated, units, strict=True)]
    rows = [",".join([*(f"{x:.6f}" for x in pose * scale), PATH]) for pose in a]
    file = folder / "path.csv"
    file.write_text("\n".join([",".join([*head, "fx[N]", "fy[N]", "fz[N]"]), *rows]) + "\n")
    return file


@pytest.mark.parametrize("name", ARMS)
def test_every_step_at_its_defaults(name: str, run, tmp_path: Path, monkeypatch) -> None:
    urdf, frames, axes = ARMS[name]
    monkeypatch.chdir(tmp_path)

    def done(*words: str) -> dict:
        outcome = run(*words, "--json")
        assert outcome.code == 0, (words, outcome.stderr)
        assert outcome.document["schema"] == 2
        return outcome.document

    made = done("new", str(example(urdf)), "--out", "arm", *frames)
    assert [Path(file).name for file in made["files"]] == [
        "robot.yaml", "model.yaml", "readings.csv", "readings.yaml",
    ]  # fmt: skip
    assert len(made["springs"]) == axes
    planned = done(*made["next"].split()[1:])
    assert len(planned["poses"]) == 15
    blind = {p["name"] for p in planned["expected"] if p["std"] is None}
    assert all(p["reason"] for p in planned["expected"] if p["std"] is None)
    done("simulate", "arm/model.yaml", "arm/plan.csv", "--out", "arm/read.csv")
    told = done("explain", "arm/read.csv", "--model", "arm/model.yaml", "--out", "told")
    assert not [said for said in told["warnings"] if "could not be made" in said]
    assert told["effects"] == []
    for parameter in told["parameters"]:  # the springs come back, but those that cannot be seen
        truth = read_model("arm/model.yaml").parameter(parameter["name"]).value
        if parameter["name"] in blind:
            assert parameter["value"] is None and "on the axis of" in parameter["reason"]
        else:
            assert parameter["value"] == pytest.approx(truth, rel=1e-3)
    page = Path("told/report.html").read_text(encoding="utf-8")
    assert len(page) < 3e6  # with the arm's meshes
    assert page.count("<svg") >= 2 and "could not be made" not in page
    assert all(name in page for name in blind)
    verdict = Path("told/verdict.json").read_text(encoding="utf-8")
    assert json.loads(verdict, parse_constant=pytest.fail)["schema"] == 2
    assert yaml.safe_load(Path("told/model.yaml").read_text(encoding="utf-8"))["effects"]
    corrected = done("compensate", "told/model.yaml", str(path_of(Path("arm"))), "--out", "c.csv")
    assert corrected["after_um"] < 0.01 * corrected["before_um"]
    exported = done("export", "told/model.yaml", "--out", "arm.xml")
    assert len(exported["springs"]) >= axes - len(blind)
    done("view", "told/model.yaml", "--static", "scene.html")
    scene = re.search(
        r'<script type="application/json" id="scene">(.*?)</script>',
        Path("scene.html").read_text(encoding="utf-8"), re.DOTALL,
    )  # fmt: skip
    assert scene is not None and len(json.loads(scene.group(1))["joints"]) == axes


@pytest.mark.parametrize("urdf", ["ur3_robot.urdf"])
def test_a_named_effect_is_drawn_where_a_spring_cannot_be_seen(
    urdf: str, run, tmp_path: Path, monkeypatch
) -> None:
    """The picture of all springs before and after, one of them with an infinite error."""
    monkeypatch.chdir(tmp_path)
    assert run("new", str(example(urdf)), "--out", "arm").code == 0
    assert run("plan", "--model", "arm", "--count", "15", "--out", "plan.csv").code == 0
    model = yaml.safe_load(Path("arm/model.yaml").read_text(encoding="utf-8"))
    soft = {"value": 2e4, "unit": "N*m/rad"}
    rocking = {"name": "base_rocking", "where": model["base_frame"]}
    rocking["parameters"] = {"stiffness_x": soft, "stiffness_y": soft}
    model["effects"].append(rocking)
    Path("arm/true.yaml").write_text(yaml.safe_dump(model), encoding="utf-8")
    assert run("simulate", "arm/true.yaml", "plan.csv", "--noise", "10 um",
               "--out", "read.csv").code == 0  # fmt: skip
    told = run("explain", "read.csv", "--model", "arm", "--out", "told", "--json")
    assert told.code == 0, told.stderr
    assert [effect["name"] for effect in told.document["effects"]] == ["base_rocking"]
    assert not [said for said in told.document["warnings"] if "could not be made" in said]
    page = Path("told/report.html").read_text(encoding="utf-8")
    assert "cannot be seen" in page and "the point lies on the axis of" in page
