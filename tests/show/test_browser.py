"""Static scenes and reports in a real browser: they move, they compute what Python computes."""

import json

import numpy as np
import pytest
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from sk120stiff.effects import load_case
from sk120stiff.plan import Pool
from sk120stiff.plan.planned import to_be_taken
from sk120stiff.show import static_scene
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.payload import frame_payload
from sk120stiff.show.stories import plan_scene
from sk120stiff.stiffness import POSITIONS
from tests.show.browser import Page, changed, clean, colours
from tests.show.scenes import random_pose, sk120, sk120_scene, springs, walled_cell
from tests.show.shown import SCENES

pytestmark = pytest.mark.timeout(180)


def agree(ours: object, theirs: object, place: str) -> None:
    """Nested numbers agree; matrices stand for eigenvectors, which may point either way."""
    if isinstance(ours, dict) and "directions" in ours:
        one, other = (
            np.transpose(axes["directions"]) @ np.diag(axes["values"]) @ axes["directions"]
            for axes in (ours, theirs)
        )
        np.testing.assert_allclose(one, other, atol=1e-9 * np.abs(other).max(), err_msg=place)
    elif isinstance(ours, dict):
        assert isinstance(theirs, dict)
        assert set(ours) == set(theirs), place
        for key, value in ours.items():
            agree(value, theirs[key], f"{place}.{key}")
    elif isinstance(ours, str) or ours is None:
        assert ours == theirs, place
    else:
        size = float(np.max(np.abs(ours), initial=0.0))
        rounded = 1e-9 if place.endswith(("links", "deflected")) else 0.0  # to nanometres
        bound = 1e-9 * size + rounded + 1e-18
        np.testing.assert_allclose(ours, theirs, atol=bound, rtol=0.0, err_msg=place)


def test_the_page_computes_what_python_computes(page: Page, files) -> None:
    """In the browser too; `test_engine` has every kind of arm and effect."""
    name = "gears"
    scene = SCENES[name]()
    page.open(files[name].as_uri())
    page.ready()
    generator = np.random.default_rng(7)
    for _ in range(4):
        request = Request(
            a=random_pose(scene.robot, generator),
            wrench=np.r_[generator.normal(size=3) * 300.0, generator.normal(size=3) * 50.0],
            point=generator.normal(size=3) * 0.1,
            exaggeration=30.0,
        )
        expected = frame_payload(compute_frame(scene.tree, scene.elastic, request))
        sent = {
            "a": request.a.tolist(),
            "wrench": request.wrench.tolist(),
            "point": request.point.tolist(),
            "exaggeration": request.exaggeration,
        }
        script = (
            "const scene = JSON.parse(document.getElementById('scene').textContent);"
            "return JSON.stringify(SK.makeEngine(scene.kinematics).compute(arguments[0]))"
        )
        agree(json.loads(page.js(script, sent)), expected, name)
    clean(page)


def slider(page: Page, label: str):
    return page.driver.find_element(By.CSS_SELECTOR, f'input[type=range][aria-label="{label}"]')


ELLIPSOID = (
    "const node = SK.stage.viewer.scene_tree.find(['ellipsoid', 'enhanced', 'surface']).object;"
    "node.updateMatrix(); return node.matrix.toArray()"
)


def link_matrix(page: Page, name: str) -> list[float]:
    return page.js(
        "const tree = SK.stage.viewer.scene_tree.find(['robot']).children;"
        "const key = Object.keys(tree).find((k) => k.endsWith(' ' + arguments[0]));"
        "tree[key].object.updateMatrix(); return tree[key].object.matrix.toArray()",
        name,
    )


def test_a_joint_slider_moves_robot_ellipsoid_and_pixels(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    before, picture = page.js(ELLIPSOID), page.pane("sk120_before")
    crank, rod = link_matrix(page, "crank"), link_matrix(page, "rod")
    assert colours(picture) > 2000
    handle = slider(page, "joint_3_u in °")
    handle.send_keys(*[Keys.ARROW_RIGHT] * 3, *[Keys.PAGE_UP] * 2)
    page.settled()
    after = page.js(ELLIPSOID)
    assert not np.allclose(before, after, atol=1e-4)
    assert not np.allclose(crank, link_matrix(page, "crank"), atol=1e-3)  # a coupled joint follows
    assert not np.allclose(rod, link_matrix(page, "rod"), atol=1e-3)
    assert changed(picture, page.pane("sk120_after")) > 0.01
    assert page.js("return SK.state.pose") == -1
    clean(page)


def test_the_drawn_ellipsoid_is_the_compliance(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    scene = sk120_scene()
    request = Request(scene.first_pose, scene.first_load, scene.point)
    axes = compute_frame(scene.tree, scene.elastic, request).found.axes("enhanced", POSITIONS)
    matrix = np.array(page.js(ELLIPSOID)).reshape(4, 4).T
    drawn = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    np.testing.assert_allclose(drawn / drawn[0], axes.values / axes.values[0], rtol=1e-6)
    np.testing.assert_allclose(matrix[:3, 3], sk120().screws(scene.first_pose).position, atol=1e-9)


def test_load_sliders_and_ellipsoid_choices_change_the_picture(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    picture = page.pane()
    slider(page, "Force z in N").send_keys(*[Keys.PAGE_DOWN] * 6)
    page.settled()
    loaded = page.pane()
    assert changed(picture, loaded) > 0.002
    for value in ("stiffness", "turnCompliance", "turnStiffness"):
        page.js(f"document.querySelector('input[value={value}]').click()")
        page.settled()
        now = page.pane(f"sk120_{value}")
        assert changed(loaded, now) > 0.002
        loaded = now
    slider(page, "Exaggeration in ×").send_keys(Keys.HOME)
    page.settled()
    assert page.js("return SK.state.exaggeration") == pytest.approx(1.0)
    clean(page)


def test_poses_of_the_data_are_visited_with_their_arrows(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    visible = (
        "return ['measured','predicted','gap'].map((k) => "
        "SK.stage.viewer.scene_tree.find(['marks', k]).object.visible)"
    )
    assert page.js(visible) == [True, True, True]
    page.driver.find_element(By.CSS_SELECTOR, 'button[aria-label="Next pose"]').click()
    page.settled()
    expected = np.asarray(sk120_scene().poses[1].a)
    np.testing.assert_allclose(page.js("return SK.state.a"), expected, atol=1e-12)
    text = page.driver.find_element(By.ID, "panel").text
    assert "measured" in text
    assert "gap" in text
    page.pixels("sk120_pose_2")
    slider(page, "joint_1_s in °").send_keys(Keys.ARROW_RIGHT)
    page.settled()
    assert page.js(visible) == [False, False, False]  # no longer the pose that was measured
    clean(page)


def test_a_bending_gear_deflects_the_page_as_it_was_predicted(page: Page, files) -> None:
    """One question, one number: under every load of the data, and what was named moves violet."""
    page.open(files["gears"].as_uri())
    page.ready()
    for pose, number in ((0, 4), (1, 2), (2, 4)):
        page.js("SK.actions.goToPose(arguments[0])", pose)
        page.js("SK.actions.goToReading(arguments[0])", number)
        page.settled()
        found = page.js("return SK.frame().deflection.equilibrium")
        reading = SCENES["gears"]().poses[pose].readings[number]
        np.testing.assert_allclose(found, reading.predicted["model"], atol=1e-10)
    colour = (
        "let found; const { children } = SK.stage.viewer.scene_tree.find(['deflected']);"
        "const key = Object.keys(children).find((k) => k.endsWith(arguments[0]));"
        "const look = ({ material }) => { if (material) found = material.color.getHex(); };"
        "children[key].object.traverse(look);"
        "return found"
    )
    assert page.js(colour, "link_2_l") != page.js(colour, "link_3_u")
    clean(page)


def test_a_path_is_drawn_with_what_was_free(page: Page, files) -> None:
    page.open(files["path"].as_uri())
    page.ready()
    corners = (
        "const box = new MeshCat.THREE.Box3().setFromObject("
        "SK.stage.viewer.scene_tree.find(['path', arguments[0]]).object);"
        "return [...SK.stage.fromWorld(box.min), ...SK.stage.fromWorld(box.max)]"
    )
    for name, moved in (("before", 0.0), ("after", 0.1)):
        x = page.js(corners, name)[0::3]
        np.testing.assert_allclose(x, 1.5 + moved, atol=0.03)  # as thick as its dots
    x = sorted(page.js(corners, "freedom")[0::3])
    np.testing.assert_allclose(x, [1.3, 1.7], atol=1e-6)
    ring = page.js(corners, "turn")
    middle = 0.5 * (np.array(ring[:3]) + ring[3:])
    np.testing.assert_allclose(middle, page.js("return SK.frame().position"), atol=1e-6)
    assert "weakest: 0.25 N/µm" in page.js("return document.getElementById('pane').textContent")
    legend = page.driver.find_element(By.ID, "legend").text
    assert all(said in legend for said in ("path as placed", "path as given", "free: x"))
    clean(page)


def test_the_way_through_a_plan_is_driven_and_all_of_it_seen(page: Page, tmp_path) -> None:
    """Joints go straight, so the point does not; no part of its way lies outside the picture."""
    stops = np.deg2rad([[-150, 60, 10, 0, 0, 0], [0, 60, 10, 0, 0, 0], [150, 60, 10, 0, 0, 0]])
    load = np.tile([0.0, 0.0, -300.0, 0.0, 0.0, 0.0], (3, 1))
    pool = Pool(load_case(sk120(), stops, load, point=np.array([0.0, 0.0, 0.1])))
    plan = to_be_taken(sk120(), pool, [0, 1, 2], zero="separate")
    static_scene(tmp_path / "plan.html", plan_scene(springs(), plan, walled_cell()))
    page.open((tmp_path / "plan.html").as_uri())
    page.ready()
    path = json.loads(page.js("return document.getElementById('scene').textContent"))["path"]
    at, middle = np.array(path["after"]), 0.5 * (stops[0] + stops[1])
    marked = at[path["stops"]]
    for a, where in ((stops, marked), (middle[None], at)):
        met = sk120().screws(a, point=plan.point).position
        np.testing.assert_allclose(
            np.linalg.norm(met[:, None] - where, axis=2).min(axis=1), 0, atol=1e-6
        )
    shown = page.js(
        "const { toWorld, viewer } = SK.stage;"
        "return arguments[0].map((p) => toWorld(p).project(viewer.camera).toArray())",
        path["after"],
    )
    assert np.abs(np.array(shown)[:, :2]).max() < 1.0
    assert "what cell.yaml states" in page.js("return document.body.textContent")
    corners = page.js(  # of what stands around, in base axes
        "const group = SK.stage.viewer.scene_tree.find(['around']).object;"
        "SK.stage.viewer.scene.updateMatrixWorld(true);"
        "const box = new MeshCat.THREE.Box3().setFromObject(group);"
        "return [box.min, box.max].map((p) => SK.stage.fromWorld(p))",
    )
    low, high = np.sort(np.array(corners), axis=0)
    np.testing.assert_allclose(high[2] - low[2], 5.0, atol=0.1)  # the wall is no part of the arm
    clean(page)


def test_typed_numbers_are_taken_within_the_limits(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    field = page.driver.find_element(
        By.CSS_SELECTOR, 'input[type=number][aria-label="joint_2_l, value in °"]'
    )
    for typed, radians in (("20", np.radians(20.0)), ("999", np.radians(70.0)), ("", None)):
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys(Keys.DELETE, typed, Keys.TAB)
        page.settled()
        if radians is not None:
            assert page.js("return SK.state.a[1]") == pytest.approx(radians, abs=1e-9)
    clean(page)


def test_everything_can_be_reached_and_is_named(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    unnamed = page.js(
        "return [...document.querySelectorAll('input, select, button, iframe, [role=application]')]"
        ".filter((e) => e.getClientRects().length && !(e.labels && e.labels.length)"
        " && !e.getAttribute('aria-label')"
        " && !e.textContent.trim()).map((e) => e.outerHTML)"
    )
    assert unnamed == []
    reached = set()
    for _ in range(60):
        page.driver.switch_to.active_element.send_keys(Keys.TAB)
        reached.add(page.js("return document.activeElement.getAttribute('aria-label')"))
    assert {"joint_1_s in °", "Force x in N", "Next pose", "Camera: tool"} <= reached
    pane = page.driver.find_element(By.ID, "pane")
    picture = page.pane()
    pane.send_keys(*[Keys.ARROW_LEFT] * 4, "+")
    page.settled()
    assert changed(picture, page.pane()) > 0.05
    clean(page)


def test_camera_presets_and_screenshot(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    seen = []
    for name in ("overview", "front", "side", "top", "tool"):
        page.driver.find_element(By.CSS_SELECTOR, f'button[aria-label="Camera: {name}"]').click()
        page.settled()
        seen.append(page.pane(f"sk120_camera_{name}"))
        assert colours(seen[-1]) > 1000
    assert min(changed(seen[0], other) for other in seen[1:]) > 0.03
    address = page.js("return SK.picture()")
    assert address.startswith("data:image/png;base64,")
    assert len(address) > 20_000


def test_what_is_copied_runs(page: Page, files) -> None:
    page.open(files["sk120"].as_uri())
    page.ready()
    scene = "const scene = JSON.parse(document.getElementById('scene').textContent);"
    command = page.js(scene + "return SK.words.command(scene, SK.state)")
    assert command.startswith("sk120stiff stiffness motoman_sk120 --pose '-33.2004,15.9,-55.5957")
    assert " --wrench '" in command
    source = page.js(scene + "return SK.words.python(scene, SK.state)")
    space: dict[str, object] = {}
    exec(source, space)
    np.testing.assert_allclose(space["a"], sk120_scene().first_pose, atol=1e-9)
    np.testing.assert_allclose(space["wrench"], sk120_scene().first_load, atol=1e-6)
