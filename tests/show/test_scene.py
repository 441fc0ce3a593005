"""Scenes check their shapes at birth; payloads are JSON that cannot break out of the page."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.effects import effect
from sk120stiff.errors import InputError
from sk120stiff.measurements import read_measurements
from sk120stiff.model import base_model
from sk120stiff.show import (
    Elastic,
    Reading,
    Scene,
    ScenePose,
    scene_html,
    scene_of_model,
    static_scene,
)
from sk120stiff.show.scene.links import link_tree
from sk120stiff.show.scene.payload import scene_payload
from sk120stiff.show.scene.shapes import Mesh, bodies_of, capsules, simplified, welded
from sk120stiff.show.scene.static import json_for_script, viewer_script
from tests.show.scenes import DATA, TWO_SLIDES, sk120, sk120_scene


def test_what_was_named_is_marked_where_it_acts() -> None:
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    places = {"joint_tilt": "joint_3_u", "link_bending": "link_2_l", "force_scale": "sensor"}
    named = [effect(robot, name, where) for name, where in places.items()]
    scene = scene_of_model(model, named=named)
    assert scene.marks == {
        "link_3_u": "joint_tilt at joint_3_u",
        "link_2_l": "link_bending at link_2_l",
    }
    page = scene_payload(scene)
    assert [page["links"][link] for link, _ in page["marks"]] == list(scene.marks)
    with pytest.raises(InputError, match="no link 'elbow' to mark"):
        replace(scene, marks={"elbow": "joint_tilt"})


def test_a_scene_opens_where_the_gap_is_widest() -> None:
    data = read_measurements(DATA, load_robot("motoman_sk120").actuated)
    robot = load_robot("motoman_sk120")
    scene = scene_of_model(
        base_model(robot), data, named=[effect(robot, "joint_tilt", "joint_1_s")]
    )
    gaps = {
        (pose.label, reading.label): np.linalg.norm(reading.measured - reading.predicted["model"])
        for pose in scene.poses
        for reading in pose.readings
    }
    label, number = max(gaps, key=lambda key: gaps[key])
    pose = next(pose for pose in scene.poses if pose.label == label)
    wrench = next(r.wrench for r in pose.readings if r.label == number)
    np.testing.assert_array_equal(scene.first_pose, pose.a)
    np.testing.assert_array_equal(scene.first_load, wrench)


def test_payload_is_strict_json_with_the_data_in_it() -> None:
    payload = json.loads(json.dumps(scene_payload(sk120_scene()), allow_nan=False))
    assert [pose["label"] for pose in payload["poses"]] == ["pose 1", "pose 2", "pose 3"]
    assert payload["models"] == ["paper's springs", "stiffer springs"]
    last = payload["poses"][0]["readings"][-1]
    assert np.linalg.norm(last["measured"]) == pytest.approx(899e-6, rel=0.01)
    assert payload["start"]["wrench"] == last["wrench"]
    shapes = {body["kind"] for body in payload["bodies"]}
    assert shapes == {"box", "cylinder", "sphere"}


def test_controls_reach_every_pose_and_load_of_the_data() -> None:
    robot = sk120()
    beyond = robot.upper + 0.1
    reading = Reading(np.array([2000.0, 0, 0, 500.0, 0, 0]))
    scene = Scene(robot, sk120_scene().elastic, poses=[ScenePose("odd", beyond, [reading])])
    payload = scene_payload(scene)
    assert all(j["upper"] >= b for j, b in zip(payload["joints"], beyond, strict=True))
    assert payload["limits"]["force"] >= 2000.0
    assert payload["limits"]["moment"] >= 500.0


def test_titles_cannot_end_the_script() -> None:
    robot = sk120()
    evil = "</script><script>alert(1)</script>"
    scene = Scene(robot, sk120_scene().elastic, title=evil, subtitle=evil)
    page = scene_html(scene)
    assert evil not in page
    assert "</script" not in json_for_script({"a": evil})
    assert json.loads(json_for_script({"a": evil}))["a"] == evil


def test_the_page_is_one_file_and_names_no_server(tmp_path) -> None:
    path = static_scene(tmp_path / "scene.html", sk120_scene())
    ours = path.read_text().replace(viewer_script(), "")
    assert "http://" not in ours
    assert "https://" not in ours.replace('location.protocol === "https:"', "")
    assert "default-src 'none'" in ours
    assert [p.name for p in tmp_path.iterdir()] == ["scene.html"]


def test_shown_inline_in_a_notebook() -> None:
    cell = sk120_scene()._repr_html_()
    assert cell.startswith('<iframe title="Motoman SK120" srcdoc="')
    assert "<script" not in cell  # all of it is escaped inside the attribute


def test_a_robot_without_visuals_gets_capsules_along_its_joints() -> None:
    bare = load_robot(TWO_SLIDES.replace("<visual>", "<!--").replace("</visual>", "-->"))
    tree = link_tree(bare)
    bodies = bodies_of(bare, tree)
    limbs = [body for body in bodies if body.kind == "capsule"]
    tip = tree.origins[tree.names.index("tip"), :3, 3]
    end = limbs[-1].placement @ np.array([0.0, 0.0, 0.5 * limbs[-1].size[1], 1.0])
    np.testing.assert_allclose(end[:3], tip, atol=1e-12)
    assert any(body.kind == "cylinder" for body in bodies)


def test_a_missing_mesh_costs_only_its_own_link() -> None:
    text = TWO_SLIDES.replace(
        '<link name="arm"/>',
        '<link name="arm"><visual><geometry><mesh filename="gone.stl"/></geometry></visual></link>',
    )
    robot = load_robot(text)
    tree = link_tree(robot)
    drawn = {tree.names[body.link]: body.kind for body in bodies_of(robot, tree)}
    assert drawn["base"] == "box"
    assert drawn["arm"] in ("capsule", "cylinder")
    assert "carriage" not in drawn


def test_capsules_of_one_link_alone() -> None:
    robot = load_robot(TWO_SLIDES)
    tree = link_tree(robot)
    arm = tree.names.index("arm")
    assert {body.link for body in capsules(tree, 1.0, [arm])} == {arm}


def _ball(rings: int) -> Mesh:
    u, v = np.meshgrid(np.linspace(0, np.pi, rings), np.linspace(0, 2 * np.pi, 2 * rings))
    points = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1)
    index = np.arange(u.size).reshape(u.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[:-1, 1:], index[1:, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([b, d, c], -1)]).reshape(-1, 3)
    return Mesh(points.reshape(-1, 3).astype(np.float32), faces.astype(np.uint32))


def test_heavy_meshes_become_light_and_keep_their_shape() -> None:
    ball = _ball(120)
    light = simplified(ball, 3000)
    assert len(light.faces) <= 3000 < len(ball.faces)
    assert len(light.faces) > 300
    radii = np.linalg.norm(light.vertices, axis=1)
    assert radii.min() > 0.93
    assert radii.max() < 1.001


def test_welding_merges_only_corners_at_one_place() -> None:
    ball = _ball(20)
    loose = Mesh(
        ball.vertices[ball.faces].reshape(-1, 3),
        np.arange(3 * len(ball.faces), dtype=np.uint32).reshape(-1, 3),
    )
    tight = welded(loose)
    assert len(tight.vertices) <= len(ball.vertices)
    np.testing.assert_allclose(np.linalg.norm(tight.vertices, axis=1), 1.0, atol=1e-5)


@pytest.mark.parametrize(
    "change",
    [
        {"point": np.zeros(2)},
        {"wrench": np.zeros(3)},
        {"a": np.full(6, np.nan)},
        {"poses": [ScenePose("p", np.zeros(5))]},
        {"poses": [ScenePose("p", np.zeros(6), [Reading(np.zeros(6), np.zeros(2))])]},
    ],
)
def test_shapes_that_do_not_fit_are_refused(change) -> None:
    with pytest.raises(InputError):
        Scene(sk120(), sk120_scene().elastic, **change)


def test_springs_of_another_robot_are_refused() -> None:
    other = load_robot(TWO_SLIDES)
    with pytest.raises(InputError, match="another robot"):
        Scene(sk120(), Elastic.of_model(base_model(other)))
