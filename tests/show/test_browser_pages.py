"""Pages around a scene: reports, notebooks, windows of every size, dark screens, paper."""

import re

import numpy as np
import pytest

from sk120stiff.show import (
    Items,
    Picture,
    Report,
    SceneFrame,
    Section,
)
from sk120stiff.show.figures import gap_per_pose
from tests.show.browser import DESKTOP, PHONE, Page, clean, colours
from tests.show.scenes import sk120_scene

pytestmark = pytest.mark.timeout(180)


def test_a_dark_screen_gets_a_dark_page_and_paper_a_still(page: Page, files, tmp_path) -> None:
    figure = gap_per_pose(["1", "2"], {"before": [4e-5, 3e-5], "after": [1e-5, 1e-5]})
    frame = SceneFrame(files["sk120"].read_text(), "The arm")
    blocks = [Picture(figure, "Bars, one for each pose"), frame]
    report = Report("R", sections=[Section("S", blocks)]).write(tmp_path / "r.html")
    lightness = {}
    for dark in (False, True):
        page.open(report.as_uri(), dark=dark)
        words, paper = page.js(
            "const text = document.querySelector('svg g[id*=text] g[style], svg g[id*=text] path');"
            "return [getComputedStyle(text).fill,"
            " getComputedStyle(document.querySelector('main section')).backgroundColor]"
        )
        lightness[dark] = [sum(map(int, re.findall(r"\d+", c)[:3])) / 765 for c in (words, paper)]
    assert lightness[False][0] < 0.3 < 0.9 < lightness[False][1]
    assert lightness[True][1] < 0.3 < 0.8 < lightness[True][0]
    page.wait("document.querySelector('iframe').contentWindow.SK?.drawn")
    page.js("dispatchEvent(new Event('beforeprint'))")
    still = (
        "const sheet = document.querySelector('canvas'), brush = sheet.getContext('2d');"
        "const { data } = brush.getImageData(0, 0, sheet.width, sheet.height);"
        "return new Set(new Uint32Array(data.buffer)).size"
    )
    assert page.js(still) > 1000
    clean(page)
    page.open(files["sk120"].as_uri(), dark=True)
    page.ready()
    assert np.median(page.pane("sk120_dark")) < 80
    page.js("dispatchEvent(new Event('beforeprint'))")
    assert page.js(still.replace("'canvas'", "'#still'")) > 1000
    clean(page)


def test_the_notebook_cell_shows_the_scene(page: Page, tmp_path) -> None:
    cell = tmp_path / "cell.html"
    cell.write_text(f"<!doctype html><meta charset=utf-8>{sk120_scene()._repr_html_()}")
    page.open(cell.as_uri())
    page.driver.switch_to.frame(0)
    page.ready()
    page.driver.switch_to.default_content()
    assert colours(page.pixels("notebook")) > 2000
    clean(page)


@pytest.mark.parametrize("name", ["sk120", "capsules"])
@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_it_fits_the_window(page: Page, files, name: str, size: tuple[int, int]) -> None:
    page.open(files[name].as_uri(), size)
    page.ready()
    assert page.js("return document.documentElement.scrollWidth") <= size[0]
    box = page.js(
        "const r = document.getElementById('pane').getBoundingClientRect();"
        "return [r.width, r.height]"
    )
    assert box[0] >= min(size[0], 640)
    assert box[1] >= 300
    assert colours(page.pane(f"{name}_{size[0]}")) > 500
    clean(page)


def test_a_checksum_within_a_list_does_not_widen_the_page(page: Page, tmp_path) -> None:
    words = Items([f"Model: arm.yaml with SHA-256 {'0123456789abcdef' * 4}."])
    path = Report("Sheet", [Section("Assumed", [words])]).write(tmp_path / "sheet.html")
    page.open(path.as_uri(), PHONE)
    assert page.js("return document.documentElement.scrollWidth") <= PHONE[0]
    clean(page)


def test_a_report_with_a_scene_opens_from_disk(page: Page, tmp_path) -> None:
    path = Report("Motoman SK120", [Section("Scene", [SceneFrame(sk120_scene(), "SK120")])]).write(
        tmp_path / "report.html"
    )
    for size in (DESKTOP, PHONE):
        page.open(path.as_uri(), size)
        page.js("document.querySelector('iframe').scrollIntoView()")
        page.wait("document.querySelector('iframe').contentDocument")
        page.driver.switch_to.frame(0)
        page.ready()
        page.driver.switch_to.default_content()
        assert page.js("return document.documentElement.scrollWidth") <= size[0]
        assert colours(page.pixels(f"report_{size[0]}")) > 1000
    clean(page)
