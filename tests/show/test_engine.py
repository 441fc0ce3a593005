"""The page's own physics, run by Node, against `under_load`: every robot, every kind of effect."""

import json
import shutil
import subprocess
import warnings
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from sk120stiff.effects import Effect, Elongation, effect
from sk120stiff.effects.foundation import NonlinearRocking
from sk120stiff.effects.gear.friction import FrictionHysteresis
from sk120stiff.effects.gear.hardening import GearHardening
from sk120stiff.effects.gear.lost_motion import LostMotion
from sk120stiff.effects.joint_tilt import NonlinearTilt
from sk120stiff.effects.tool_compliance import NonlinearTool
from sk120stiff.errors import Refusal, ToolkitWarning
from sk120stiff.model import Model, base_model, joint_spring_model
from sk120stiff.robot import Robot, load_robot
from sk120stiff.show import Elastic, Scene
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.mechanism import HELD, follows_pose_and_load, serialised
from sk120stiff.show.scene.payload import frame_payload, scene_payload
from tests.effects.arms import arm
from tests.oracles.sample_urdfs import six_axis_arm
from tests.show.scenes import TWO_SLIDES, random_pose
from tests.stiffness.test_kernel import ROBOTS

RUN = """
const window = globalThis, lines = require("fs").readFileSync(0, "utf8").split("\\n");
%s
const out = lines.filter(Boolean).map((line) => {
  const { mechanism, requests } = JSON.parse(line), engine = SK.makeEngine(mechanism);
  return requests.map((request) => engine.compute(request));
});
console.log(JSON.stringify(out));
"""


def with_effects(robot: str | Robot, *names: str | Effect) -> Model:
    """Springs and effects at sizes that show."""
    loaded = load_robot(robot) if isinstance(robot, str) else robot
    model = base_model(loaded) if robot == "motoman_sk120" else None
    model = model or joint_spring_model(loaded, np.full(loaded.n, 2e5))
    for name in names:
        added = name
        if isinstance(name, str):
            kind, _, where = name.partition(":")
            added = effect(loaded, kind, where)
        values = np.array([*model.values, *(spec.typical for spec in added.parameters)])
        model = (model + added).with_values(values)
    return model


def soft(robot: str, stiffness: float) -> Model:
    loaded = load_robot(robot)
    return joint_spring_model(loaded, np.full(loaded.n, stiffness))


@dataclass(frozen=True)
class Bent(GearHardening):
    """A gear of the user's own, whose law the page cannot know."""

    name: ClassVar[str] = "bent"

    def elongation(self, torques, load_cases, values) -> Elongation:
        return super().elongation(np.sinh(1e-3 * torques), load_cases, values)


SK120 = "motoman_sk120"
COLUMN = (
    '<robot name="column"><link name="ground"/><link name="bar"><inertial><origin xyz="0 0 0.5"/>'
    '<mass value="10"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<link name="tip"/><joint name="hinge" type="revolute"><parent link="ground"/>'
    '<child link="bar"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/>'
    '</joint><joint name="end" type="fixed"><parent link="bar"/><child link="tip"/>'
    '<origin xyz="0 0 1"/></joint></robot>'
)
MODELS = {
    **{name: lambda make=make: with_effects(make()) for name, make in ROBOTS.items()},
    **{name: lambda name=name: with_effects(arm(name)) for name in ("telescope", "scara")},
    "ur5e": lambda: with_effects("ur5e", "joint_tilt:shoulder_lift_joint"),
    "scara and base": lambda: with_effects(arm("scara"), "base_rocking:base", "joint_tilt:elbow"),
    "gantry": lambda: with_effects(TWO_SLIDES),
    "tilt and base": lambda: with_effects(
        SK120, "joint_tilt:joint_2_l", "base_rocking:base_link", "base_sliding:base_link"
    ),
    "bending": lambda: with_effects(SK120, "link_bending:link_2_l"),
    "offset": lambda: with_effects(SK120, "joint_offset:joint_3_u"),
    "indefinite": lambda: with_effects(SK120, "closure_coupling:joint_2_l,joint_3_u").with_public(
        **{"closure_coupling:joint_2_l,joint_3_u.cross_stiffness": 2e5}
    ),
    "rod": lambda: with_effects(SK120, "closure_rod:rod"),
    "compensator": lambda: with_effects(SK120, "gravity_compensator:joint_2_l"),
    "rod, compensator, tool": lambda: with_effects(
        SK120, "closure_rod:rod", "gravity_compensator:joint_2_l", "tool_compliance:tool0"
    ),
    "gears": lambda: with_effects(
        SK120,
        "gear_hardening:joint_2_l",
        GearHardening("joint_3_u", 1.0, breaks=(40.0, 200.0)),
        GearHardening("joint_1_s", 1.0, sided=True),
        "lost_motion:joint_1_s",
        LostMotion("joint_2_l", 1.0, flanks=(0.0, 60.0), sided=True),
        FrictionHysteresis("joint_3_u", 1.0, reaches=(0.0, 80.0)),
        FrictionHysteresis("joint_2_l", 1.0, reaches=(30.0,), start="cycled"),
    ),
    "heavy gears": lambda: with_effects(
        six_axis_arm(),
        "gear_hardening:j2",
        LostMotion("j3", 1.0, flanks=(90.0,)),
        "friction_hysteresis:j2",
        "joint_tilt:j1",
    ),
    "out of proportion": lambda: with_effects(
        SK120,
        NonlinearRocking("base_link", full=(900.0, 1500.0)),
        NonlinearTilt("joint_3_u"),
        NonlinearTool("tool0", full=(60.0, 60.0, 60.0, 500.0, 500.0, 500.0)),
    ),
    "heavy and out of proportion": lambda: with_effects(
        six_axis_arm(), NonlinearRocking("base", full=(300.0, 300.0)), NonlinearTilt("j2")
    ),
    "heavy": lambda: soft(six_axis_arm(seed=5), 5e4),
    "heavy and bending": lambda: with_effects(
        six_axis_arm(), "link_bending:link_2", "joint_tilt:j1", "gravity_compensator:j2"
    ),
}


def numbers(payload: dict) -> dict[str, np.ndarray]:
    """Everything numerical of a frame; principal axes as the matrices that they make."""
    found: dict[str, np.ndarray] = {}
    for group in ("translation", "rotationAxes"):
        for name, axes in payload[group].items():
            D = np.array(axes["directions"])
            found[f"{group}.{name}"] = (D.T * np.array(axes["values"])) @ D
    for name, value in payload["deflection"].items():
        found[f"deflection.{name}"] = np.array(value)
    for name in ("links", "deflected", "position", "rotation", "softening", "stiffening"):
        if payload[name] is not None:
            found[name] = np.array(payload[name])
    return found


def played(scenes) -> list[list[dict]]:
    """What the page answers to requests at scenes, all by one run of Node."""
    if not shutil.which("node"):
        pytest.skip("node is needed")
    page = Path(str(files("sk120stiff.show.scene") / "page"))
    scripts = "\n".join((page / name).read_text("utf-8") for name in ("algebra.js", "engine.js"))
    lines = [
        json.dumps(
            {
                "mechanism": serialised(scene),
                "requests": [
                    {key: np.asarray(value).tolist() for key, value in vars(request).items()}
                    for request in requests
                ],
            }
        )
        for scene, requests in scenes
    ]
    done = subprocess.run(
        ["node", "-e", RUN % scripts],
        input="\n".join(lines),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def cases() -> dict[str, tuple[Scene, list[Request], list[dict]]]:
    """Scenes, requests, and what the page answers."""
    generator, scenes = np.random.default_rng(3), {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        for name, make in MODELS.items():
            model = make()
            robot = model.robot
            scene = Scene(robot, Elastic.of_model(model), a=random_pose(robot, generator))
            requests = [
                Request(
                    a=random_pose(robot, generator),
                    wrench=np.r_[generator.normal(size=3) * 300.0, generator.normal(size=3) * 50.0],
                    point=generator.normal(size=3) * 0.1,
                    exaggeration=30.0,
                )
                for _ in range(5)
            ]
            scenes[name] = scene, requests
    answers = played(scenes.values())
    return {name: (*scenes[name], answer) for name, answer in zip(scenes, answers, strict=True)}


@pytest.mark.parametrize("name", list(MODELS))
def test_the_page_computes_what_under_load_computes(cases, name: str) -> None:
    scene, requests, answers = cases[name]
    assert follows_pose_and_load(scene.elastic.arm)
    for request, ours in zip(requests, answers, strict=True):
        theirs = frame_payload(compute_frame(scene.tree, scene.elastic, request))
        assert ours["classes"] == theirs["classes"]
        found, expected = numbers(ours), numbers(theirs)
        assert set(found) == set(expected)
        for key, value in expected.items():
            bound = 2e-9 * np.abs(value).max() + (2e-9 if key in ("links", "deflected") else 1e-18)
            np.testing.assert_allclose(found[key], value, atol=bound, rtol=0.0, err_msg=key)


def test_what_falls_under_its_own_weight_is_refused_by_both() -> None:
    """An upright column of 10 kg on a spring of 1 N·m/rad."""
    column = load_robot(COLUMN)
    scene = Scene(column, Elastic.of_model(joint_spring_model(column, [1.0])))
    request = Request(np.zeros(1), np.zeros(6), np.zeros(3))
    with pytest.raises(Refusal, match="weight"):
        compute_frame(scene.tree, scene.elastic, request)
    assert played([(scene, [request])]) == [[None]]


def test_what_a_page_cannot_follow_it_says() -> None:
    """A law of the user's own that is not linear: its part under small loads is what is played."""
    own = with_effects(SK120, Bent("joint_2_l", 1.0))
    scene = Scene(own.robot, Elastic.of_model(own))
    assert not follows_pose_and_load(scene.elastic.arm)
    assert HELD in scene_payload(scene)["elastic"]["label"]
