"""The arm in a Meshcat viewer: what is sent to it, and what stands in its scene in a browser."""

import json
import os
import signal
import socket
import subprocess
import sys

import meshcat
import numpy as np
import pytest
from meshcat.path import Path as MeshcatPath
from pinocchio.visualize import MeshcatVisualizer

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.show.meshcat.bridge import meshcat_on_loopback
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.scene import Scene
from sk120stiff.stiffness import POSITIONS
from tests.show.browser import browser, changed, colours
from tests.show.scenes import DATA, TWO_SLIDES

pytestmark = pytest.mark.timeout(180)
POSE, LOAD = np.array([0.2, 0.35, -0.5, 0.3, -1.0, 0.1]), np.array([0.0, 120.0, -490.0])


class Window:
    """Stands where a viewer would be, and keeps what it is told."""

    def __init__(self) -> None:
        self.said: list[dict] = []

    def send(self, command) -> None:
        self.said.append(command.lower())

    def of(self, kind: str) -> dict[str, dict]:
        """Path below the drawing → the last command of that kind."""
        top = "/meshcat/sk120stiff/"
        return {c["path"].removeprefix(top): c for c in self.said if c["type"] == kind}

    def matrix(self, path: str) -> np.ndarray:
        return np.reshape(self.of("set_transform")[path]["matrix"], (4, 4)).T


@pytest.fixture(scope="module")
def robot():
    return sk.load_robot("motoman_sk120")


def drawn(robot, **options):
    window = Window()
    viewer = meshcat.Visualizer.view_into(window, MeshcatPath(("meshcat",)))
    return window, sk.show.in_meshcat(viewer, robot, POSE, LOAD, **options)


def test_it_stands_where_stiffness_says(robot) -> None:
    """Ellipsoids and load by `stiffness`; after the first drawing everything only moves."""
    model = sk.base_model(robot)
    window, shown = drawn(robot, model=model)
    made = len(window.of("set_object"))
    second = np.array([-0.4, 0.1, -0.2, 0.0, -0.8, 0.0])
    window.said.clear()
    shown.update(second, LOAD)
    assert made > 12
    assert not window.of("set_object")
    assert not window.of("delete")
    found = sk.stiffness(model, second, LOAD)
    centre = window.matrix("compliance")[:3, 3]
    arm = next(p for p in window.of("set_transform") if p.startswith("arm") and "tool0" in p)
    np.testing.assert_allclose(window.matrix(arm)[:3, 3], centre, atol=1e-12)
    shape = window.matrix("compliance")[:3, :3]
    compliance = found.compliance_enhanced[POSITIONS, POSITIONS]
    inverse = window.matrix("stiffness")[:3, :3]
    # (directions · halves)² is C² up to the one scale of the picture
    squared = shape @ shape.T
    np.testing.assert_allclose(
        squared / np.trace(squared), compliance @ compliance / np.trace(compliance @ compliance),
        atol=2e-6,
    )  # fmt: skip
    lengths = np.sort(np.linalg.norm(inverse, axis=0))
    assert lengths[-1] > lengths[0] > 0.0
    softest = shape[:, np.argmax(np.linalg.norm(shape, axis=0))]
    stiffest = inverse[:, np.argmax(lengths)]
    assert abs(softest @ stiffest) < 0.9 * np.linalg.norm(softest) * np.linalg.norm(stiffest)
    arrow = window.matrix("load")[:3, 2]
    np.testing.assert_allclose(arrow / np.linalg.norm(arrow), LOAD / np.linalg.norm(LOAD))


def test_the_deflected_shape_is_the_equilibrium_exaggerated(robot) -> None:
    window, shown = drawn(robot)
    scene = Scene(robot, shown._scene.elastic)
    load = np.append(LOAD, np.zeros(3))
    request = Request(POSE, load, np.zeros(3), shown.exaggeration)
    frame = compute_frame(scene.tree, scene.elastic, request)
    for k, name in enumerate(scene.tree.names):
        np.testing.assert_allclose(window.matrix(f"arm/{k}_{name}"), frame.links[k], atol=1e-12)
        bent = window.matrix(f"deflected/{k}_{name}")
        np.testing.assert_allclose(bent, frame.deflected[k], atol=1e-12)
    shown.update(POSE, np.zeros(6))
    visible = window.of("set_property")
    assert not visible["load"]["value"]
    assert not visible[f"deflected/{len(scene.tree.names) - 1}_{scene.tree.names[-1]}"]["value"]


def test_gaps_stand_at_their_reading(robot) -> None:
    readings = sk.read(DATA)
    window, shown = drawn(robot, data=readings)
    assert not window.of("set_property")["gap"]["value"]  # nothing was measured at that pose
    poses = shown._scene.poses
    reading = poses[1].readings[-1]
    window.said.clear()
    shown.update(poses[1].a, reading.wrench)
    arrows = {name: window.matrix(name) for name in ("measured", "predicted", "gap")}
    grown = {name: T[:3, 2] / shown.exaggeration for name, T in arrows.items()}
    np.testing.assert_allclose(grown["measured"], reading.measured, atol=1e-12)
    np.testing.assert_allclose(grown["gap"], grown["measured"] - grown["predicted"], atol=1e-12)
    tips = [arrows[name][:3, 3] + arrows[name][:3, 2] for name in ("measured", "gap")]
    np.testing.assert_allclose(*tips, atol=1e-12)


def test_a_path_is_played_with_sizes(robot) -> None:
    window, shown = drawn(robot)
    path = np.linspace(POSE, POSE + 0.2, 4)
    shown.animate(path, LOAD, fps=20, steps=5)
    (told,) = [c for c in window.said if c["type"] == "set_animation"]
    clips = {each["path"]: each["clip"] for each in told["animations"]}
    tracks = {each["name"]: each for each in clips["/meshcat/sk120stiff/compliance"]["tracks"]}
    assert set(tracks) == {".visible", ".position", ".quaternion", ".scale"}
    assert [key["time"] for key in tracks[".position"]["keys"]] == [0, 5, 10, 15]
    shown.update(path[2], LOAD)
    T, key = window.matrix("compliance"), 2
    np.testing.assert_allclose(tracks[".position"]["keys"][key]["value"], T[:3, 3], atol=1e-12)
    np.testing.assert_allclose(
        tracks[".scale"]["keys"][key]["value"], np.linalg.norm(T[:3, :3], axis=0), rtol=1e-9
    )
    with pytest.raises(InputError, match="3 loads for 4 poses"):
        shown.animate(path, np.zeros((3, 6)))


def test_a_model_of_another_robot_is_refused(robot) -> None:
    other = sk.load_robot(TWO_SLIDES)
    with pytest.raises(InputError, match="belongs to"):
        drawn(robot, model=sk.base_model(other))
    with pytest.raises(InputError, match="shape"):
        sk.show.in_meshcat(Window(), robot, POSE[:3], LOAD)


# What stands in the viewer: names below a path, and the world matrix of a path.
NODE = """
const find = (path) => path.split('/').reduce(
  (node, name) => node && node.children[name], viewer.scene_tree.children['meshcat']);
"""


def test_in_pinocchios_visualizer_in_a_browser(robot, tmp_path) -> None:
    viewer = meshcat_on_loopback()
    port = int(viewer.url().split(":")[2].split("/")[0])
    outside = socket.gethostbyname(socket.gethostname())
    if not outside.startswith("127."):
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection((outside, port), timeout=2)
    theirs = MeshcatVisualizer(robot.tree._model)
    theirs.initViewer(viewer=viewer)
    shown = sk.show.in_meshcat(theirs, robot, POSE, LOAD, data=sk.read(DATA))
    place = NODE + "return find('sk120stiff/compliance').object.position.toArray()"
    count = NODE + "let n = 0; find('sk120stiff').object.traverse((o) => n += o.isMesh ? 1 : 0);"
    with browser(tmp_path) as page:
        page.open(viewer.url())
        page.wait("typeof viewer !== 'undefined'")
        page.wait(f"(() => {{{NODE} return find('sk120stiff/gap/head') }})()")
        found = shown.update(POSE, LOAD).found
        page.wait(f"(() => {{{NODE} return !find('sk120stiff/gap').object.visible }})()")
        np.testing.assert_allclose(page.js(place), found.position, atol=1e-9)
        before, meshes = page.pixels("meshcat_before"), page.js(count + "return n")
        assert colours(before) > 500
        assert meshes > 20
        pose = shown._scene.poses[0]
        found = shown.update(pose.a, pose.readings[-1].wrench).found
        page.wait(f"(() => {{{NODE} return find('sk120stiff/gap').object.visible }})()")
        np.testing.assert_allclose(page.js(place), found.position, atol=1e-9)
        assert changed(before, page.pixels("meshcat_after")) > 0.01
        assert page.js(count + "return n") == meshes  # moved, not drawn once more
        shown.animate([POSE, pose.a], LOAD, fps=30, steps=15)
        page.wait("viewer.animator.actions.length > 0")
        assert page.js("return viewer.animator.duration") == pytest.approx(0.5)


def test_view_opens_it_on_loopback() -> None:
    command = [sys.executable, "-m", "sk120stiff", "view", "motoman_sk120", "--meshcat"]
    running = subprocess.Popen(
        [*command, "--data", str(DATA), "--json", "--no-open"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    try:
        lines = iter(running.stdout.readline, "")
        text = ""
        for line in lines:
            text += line
            if line.startswith("}"):
                break
        told = json.loads(text)
        assert told["url"].startswith("http://127.0.0.1:")
        assert told["zmq_url"].startswith("tcp://127.0.0.1:")
        other = meshcat.Visualizer(zmq_url=told["zmq_url"])  # another program draws into it
        assert other.url() == told["url"]
        running.send_signal(signal.SIGINT)
        _, said = running.communicate(timeout=20)
        assert running.returncode == 0, said
        assert "Traceback" not in said
    finally:
        running.kill()
    refused = subprocess.run(
        [*command, "--host", "0.0.0.0"], capture_output=True, text=True, check=False
    )
    assert refused.returncode == 2
    assert "stays on loopback" in refused.stderr
