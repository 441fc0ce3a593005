"""Maps as coloured points: where they stand, what they say, and what a browser draws."""

import base64
import json
import re

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.model import base_model
from sk120stiff.robot import load_robot
from sk120stiff.show import Cloud, cloud_html, cloud_of_map, cloud_page, palette, scene_of_model
from sk120stiff.show.wording import number
from sk120stiff.workspace import Axis, Grid, MapJob, PositionGrid, open_map, write_map
from tests.show.browser import changed, colours
from tests.workspace.arms import LOADS, joint_job, sk120

pytestmark = pytest.mark.timeout(180)


def scene():
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return scene_of_model(model, title="Map")


@pytest.fixture(scope="module")
def joint_map(tmp_path_factory):
    path = tmp_path_factory.mktemp("map") / "joints.zarr"
    write_map(joint_job(12, 10, 8), path)
    return open_map(path)


def test_points_of_a_joint_map_stand_where_the_tool_does(joint_map) -> None:
    robot = load_robot("motoman_sk120")
    cloud = cloud_of_map(joint_map, robot, load=1)
    assert len(cloud.values) == 12 * 10 * 8
    a = np.tile(joint_map.attrs["rest"], (3, 1))
    corners = ((0, 0, 0), (11, 9, 7), (3, 5, 2))
    for row, corner in zip(a, corners, strict=True):
        for name, k in zip(("joint_2_l", "joint_3_u", "joint_5_b"), corner, strict=True):
            row[robot.actuated.index(name)] = joint_map[name][k]
    flat = [np.ravel_multi_index(corner, (12, 10, 8)) for corner in corners]
    np.testing.assert_allclose(cloud.position[flat], robot.placement(a)[:, :3, 3], atol=1e-12)
    stiffness = joint_map["minimum_stiffness"].isel(load=1).values.ravel()
    np.testing.assert_allclose(cloud.values, 1e-6 * stiffness)
    assert "10, -20, 30 N·m" in cloud.subtitle


def test_large_maps_are_thinned_out(joint_map) -> None:
    cloud = cloud_of_map(joint_map, load_robot("motoman_sk120"), points=150)
    assert 50 <= len(cloud.values) <= 150


def test_points_of_a_position_map_that_were_not_reached_are_left_out(tmp_path) -> None:
    axes = (
        Axis("x", np.array([1.6, 2.0, 9.0])),
        Axis("y", np.array([0.0, 0.1])),
        Axis("z", np.array([0.3])),
    )
    write_map(MapJob(sk120(), PositionGrid(Grid(axes), np.zeros(6)), LOADS), tmp_path / "p.zarr")
    cloud = cloud_of_map(open_map(tmp_path / "p.zarr"), load_robot("motoman_sk120"))
    assert sorted(set(cloud.position[:, 0])) == [1.6, 2.0]


def test_bad_input(joint_map) -> None:
    robot = load_robot("motoman_sk120")
    with pytest.raises(InputError, match="no load 2"):
        cloud_of_map(joint_map, robot, load=2)
    with pytest.raises(InputError, match="not shown"):
        cloud_of_map(joint_map, robot, variable="weight")
    with pytest.raises(InputError, match="finite"):
        Cloud(np.zeros((1, 3)), np.array([np.nan]), "", "")
    with pytest.raises(InputError, match="shape"):
        Cloud(np.zeros((2, 3)), np.zeros(1), "", "")


def test_the_page_holds_the_numbers(joint_map) -> None:
    cloud = cloud_of_map(joint_map, load_robot("motoman_sk120"))
    text = cloud_html(scene(), cloud)
    found = re.search(r'<script type="application/json" id="scene">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    payload = json.loads(found.group(1))["cloud"]
    position = np.frombuffer(base64.b64decode(payload["position"]), dtype="<f4").reshape(-1, 3)
    np.testing.assert_allclose(position, cloud.position, atol=1e-6)
    values = np.frombuffer(base64.b64decode(payload["values"]), dtype="<f4")
    assert payload["range"] == [values.min(), values.max()]
    assert "http" not in text.split("<script>")[0].replace("http-equiv", "")


def test_thinning_keeps_the_extremes_that_the_map_names(joint_map) -> None:
    cloud = cloud_of_map(joint_map, load_robot("motoman_sk120"), points=30)
    every = 1e-6 * joint_map["minimum_stiffness"].isel(load=0).compute()
    assert cloud.values.min() == pytest.approx(float(every.min()))
    assert cloud.values.max() == pytest.approx(float(every.max()))
    softest = every.where(every == every.min(), drop=True)
    names = [name for name, _ in cloud.axes]
    at = dict(zip(names, cloud.told[cloud.weakest], strict=True))
    assert at == pytest.approx({name: np.degrees(softest[name].values[0]) for name in names})
    assert cloud.lead().startswith(f"Softest {float(every.min()):.4g} N/µm at {names[0]} ")


def test_a_browser_names_the_softest_point_and_hides_what_is_not_asked_for(
    window, joint_map, tmp_path
) -> None:
    page, cloud = window, cloud_of_map(joint_map, load_robot("motoman_sk120"))
    path = cloud_page(tmp_path / "map.html", scene(), cloud)
    page.open(path.as_uri())
    page.ready()
    count = "document.getElementById('count').textContent"
    page.wait(f"{count} === '960 of 960 points'")
    said = f"softest {number(cloud.values.min())} N/µm"
    labels = "return [...document.querySelectorAll('.label')].map((each) => each.textContent)"
    assert said in page.js(labels)
    before = page.pane("map")
    assert colours(before) > 500
    write = (
        "const field = document.querySelectorAll('#panel input[type=number]')[arguments[0]];"
        "field.value = arguments[1]; field.dispatchEvent(new Event('change'))"
    )
    page.js(write, 0, float(np.median(cloud.values)))
    page.settled()
    left = int(page.js(f"return {count}").split()[0])
    assert 400 <= left <= 560
    assert changed(before, page.pane("map_half")) > 0.003
    page.js(write, 0, float(cloud.values.max()))  # one point is left, and the pointer reads it
    page.settled()
    page.js(
        "const [x, y] = SK.screenOf(arguments[0]), pane = document.getElementById('pane');"
        "const { left, top } = pane.getBoundingClientRect();"
        "const place = { clientX: left + x, clientY: top + y };"
        "pane.dispatchEvent(new PointerEvent('pointermove', place))",
        cloud.best,
    )
    told = page.js("return document.getElementById('told').textContent")
    assert told.startswith(f"{cloud.values.max():.4g} N/µm at {cloud.axes[0][0]} ")
    assert page.console() == []


@pytest.mark.parametrize("background", [palette.PAPER, palette.DARK[palette.PAPER]])
def test_no_colour_of_a_map_is_lost_on_its_background(background: str) -> None:
    """3:1, what graphics need (WCAG 1.4.11); 2.5:1 between the stops, where the rim helps."""
    for colour in palette.SOFT_TO_STIFF:
        assert contrast(colour, background) > 2.5, colour


def contrast(one: str, other: str) -> float:
    """Ratio of luminances by WCAG 2."""

    def luminance(colour: str) -> float:
        linear = [
            c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
            for c in palette.channels(colour)
        ]
        return float(np.dot([0.2126, 0.7152, 0.0722], linear))

    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)
