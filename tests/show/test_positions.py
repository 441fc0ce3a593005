"""Scenes of positions: markers where they stand, payloads in kg, gaps of position."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.plan import Cell
from sk120stiff.show import static_scene
from sk120stiff.show.scene.building import scene_of_model
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.payload import scene_payload
from sk120stiff.show.stories import plan_scene
from tests.positions.arm import NAMES, Arm, poses, urdf, write
from tests.positions.loaded_arm import SPRINGS
from tests.show.browser import Page, clean

pytestmark = pytest.mark.timeout(180)

PLACES = {"A": np.array([0.05, -0.08, 0.12]), "B": np.array([-0.07, 0.15, 0.10])}
POINTS = "points: {A: {xyz: [50, -80, 120], unit: mm}, B: {xyz: [-70, 150, 100], unit: mm}}\n"
LOADS = (0.0, 40.0)  # kg, at the tool's origin
ARM = Arm(compliance=SPRINGS)


def at_rest(a: np.ndarray, marker: str, load: float) -> np.ndarray:
    """Marker (N, 3) of the independent arm under its own weight and a payload [m]."""
    return replace(ARM, marker=PLACES[marker], payload=load).stands(a)[0]


def written(folder: Path, *, read: bool, markers: str = "AB") -> Measurements:
    """Every marker under every payload, at three poses; blank cells are a plan."""
    a, rows, seen, cells = poses(3, 5), [], [], []
    for load in LOADS:
        for name in markers:
            rows.append(a)
            seen.append(at_rest(a, name, load) if read else np.full((3, 3), np.nan))
            cells += [f"{name},{load},p{k + 1}" for k in range(3)]
    path = write(folder, np.concatenate(rows), np.concatenate(seen), POINTS,
                 more=",marker,payload[kg],pose", cells=cells)  # fmt: skip
    return sk.read(path).with_joints(NAMES)


def model_of(folder: Path) -> Model:
    (folder / "six.urdf").write_text(urdf())
    robot = sk.load_robot(str(folder / "six.urdf"))
    return joint_spring_model(robot, 1.0 / SPRINGS)


def test_a_plan_of_positions_shows_what_the_payload_does_to_each_marker(tmp_path: Path) -> None:
    plan = written(tmp_path, read=False)
    scene = plan_scene(model_of(tmp_path), plan, Cell())
    asked = [(name, load) for load in LOADS for name in PLACES]
    for pose in scene.poses:
        for reading, (name, load) in zip(pose.readings, asked, strict=True):
            assert reading.point is not None
            np.testing.assert_allclose(reading.point, PLACES[name])
            request = Request(pose.a, reading.wrench, reading.point)
            seen = compute_frame(scene.tree, scene.elastic, request).found
            moved = at_rest(pose.a[None], name, load) - at_rest(pose.a[None], name, 0.0)
            np.testing.assert_allclose(
                seen.of("deflection_equilibrium"), moved[0], rtol=0, atol=2e-3 * 1e-3
            )
            assert reading.said == f"{load:g} kg, marker {name}"
    assert max(np.linalg.norm(at_rest(p.a[None], "B", 40) - at_rest(p.a[None], "B", 0))
               for p in scene.poses) > 5e-4  # fmt: skip


def test_a_plan_of_positions_counts_payloads_and_markers(tmp_path: Path) -> None:
    scene = plan_scene(model_of(tmp_path), written(tmp_path, read=False), Cell())
    assert scene.subtitle.startswith(
        "3 poses in their order, 2 payloads (0 kg, 40 kg), 2 markers (A, B). The straight ways"
    )
    assert "plan --check" in scene.subtitle and "plan --program" in scene.subtitle
    np.testing.assert_array_equal(scene.first_load, np.zeros(6))
    assert scene.path is not None and scene.path.mark == "the first pose's marker A"
    rigid = replace(ARM, marker=PLACES["A"])
    a = np.array([pose.a for pose in scene.poses])
    np.testing.assert_allclose(
        scene.path.after[list(scene.path.stops)], rigid.pose(a)[0], atol=1e-9
    )


def test_data_of_positions_open_at_their_first_marker(tmp_path: Path) -> None:
    scene = scene_of_model(model_of(tmp_path), written(tmp_path, read=True))
    assert scene.positions
    np.testing.assert_allclose(scene.point, PLACES["A"])
    page = scene_payload(scene)
    assert page["start"]["point"] == pytest.approx(PLACES["A"].tolist())
    assert page["limits"]["point"] >= 0.15


def test_the_page_of_a_plan_says_nothing_that_is_not_there(page: Page, tmp_path: Path) -> None:
    scene = plan_scene(model_of(tmp_path), written(tmp_path, read=False), Cell())
    page.open(static_scene(tmp_path / "plan.html", scene).as_uri())
    page.ready()
    said = page.js("return document.body.innerText")
    assert "measured" not in said and "Displacement at" not in said and "0 N" not in said
    assert page.js("return SK.state.reading") == 0
    chosen = "return [...document.querySelectorAll('option')].map((o) => o.textContent)"
    assert "reading 1: 0 kg, marker A" in page.js(chosen)
    assert "reading 4: 40 kg, marker B" in page.js(chosen)
    page.js("SK.actions.goToReading(3)")
    page.settled()
    a = scene.poses[0].a[None]
    moved = (at_rest(a, "B", 40.0) - at_rest(a, "B", 0.0))[0]
    np.testing.assert_allclose(
        page.js("return SK.frame().deflection.equilibrium"), moved, rtol=0, atol=2e-6
    )
    marker = page.js("return SK.frame().position")
    np.testing.assert_allclose(marker, at_rest(a, "B", 0.0)[0], atol=1e-5)
    assert "40 kg, marker B: (" in page.js("return document.body.innerText")
    clean(page)


def test_the_page_of_positions_tells_gaps_and_no_displacements(page: Page, tmp_path: Path) -> None:
    model = model_of(tmp_path)
    stiffer = joint_spring_model(model.robot, 2.0 / SPRINGS)
    both = {"before": stiffer, "after": model}
    scene = scene_of_model(model, written(tmp_path, read=True), models=both)
    page.open(static_scene(tmp_path / "gaps.html", scene).as_uri())
    page.ready()
    page.js("SK.actions.goToReading(2)")
    page.settled()
    said = page.js("return document.body.innerText")
    assert "Position at reading 3, as read less what the model says" in said
    assert "gap, before" in said and "gap, after" in said
    assert "as read 0" not in said and "measured" not in said and "predicted, after" not in said
    assert "gap of position" in said
    clean(page)
