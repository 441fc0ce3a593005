"""The running command in a real browser, and robots of other makers."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from sk120stiff.cli.main import main
from tests.corpus.robots import example
from tests.show.browser import INSIDE, PHONE, SMALL, changed, colours
from tests.show.scenes import DATA
from tests.show.test_browser import ELLIPSOID, slider
from tests.show.test_live import _address

pytestmark = pytest.mark.timeout(180)


@pytest.fixture(scope="module")
def live():
    """Address of `sk120stiff view` with the paper's data, and its process, which a test may end."""
    command = [sys.executable, "-m", "sk120stiff", "view", "motoman_sk120", "--data", str(DATA)]
    running = subprocess.Popen(
        [*command, "--json", "--no-open", "--port", "0"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    try:
        yield _address(running), running
        if running.poll() is None:
            running.send_signal(signal.SIGINT)
        _, said = running.communicate(timeout=10)
        assert running.returncode == 0
        assert "Traceback" not in said
    finally:
        running.kill()


def clean(page, address: str) -> None:
    assert page.console() == []
    mine = (*INSIDE, address, address.replace("http:", "ws:"))
    assert [url for url in page.requests() if not url.startswith(mine)] == []


def test_sliders_move_the_live_picture(page, live) -> None:
    address, _ = live
    page.open(address)
    page.ready()
    before, picture = page.js(ELLIPSOID), page.pane("live_before")
    assert colours(picture) > 2000
    spans = []
    for _ in range(7):
        slider(page, "joint_2_l in °").send_keys(Keys.PAGE_UP)
        page.settled()
        spans.append(page.js("return SK.roundTrip"))
    assert not np.allclose(before, page.js(ELLIPSOID), atol=1e-4)
    assert changed(picture, page.pane("live_after")) > 0.01
    print(f"slider to new numbers: {min(spans):.1f} to {max(spans):.1f} ms")
    # The software renderer draws on the same cores: the quickest of them is about the program.
    assert min(spans) < 50.0
    clean(page, address)


def test_two_windows_keep_their_own_pose(page, live) -> None:
    address, _ = live
    page.open(address)
    page.ready()
    first = page.driver.current_window_handle
    page.driver.switch_to.new_window("tab")
    page.open(address)
    page.ready()
    slider(page, "joint_1_s in °").send_keys(*[Keys.PAGE_UP] * 3)
    page.settled()
    moved = page.js("return SK.frame().position")
    page.driver.close()
    page.driver.switch_to.window(first)
    assert not np.allclose(page.js("return SK.frame().position"), moved, atol=1e-3)
    clean(page, address)


def test_the_page_says_when_the_program_is_gone(page, live) -> None:
    address, running = live
    page.open(address)
    page.ready()
    running.send_signal(signal.SIGINT)
    page.wait("!document.getElementById('connection').hidden")
    assert "connection" in page.driver.find_element(By.ID, "connection").text
    assert running.wait(timeout=10) == 0
    page.open("about:blank")


@pytest.mark.parametrize(
    ("file", "size"),
    [("ur5_robot.urdf", SMALL), ("panda.urdf", PHONE), ("double_pendulum_simple.urdf", SMALL)],
)
def test_robots_of_other_makers(page, tmp_path, file: str, size: tuple[int, int], capsys) -> None:
    scene = tmp_path / "scene.html"
    words = ["view", str(example(file)), "--wrench", "40,60,-120 N", "--static", str(scene)]
    assert main([*words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["scene"] == str(scene)
    assert scene.stat().st_size < 2.5e6
    page.open(scene.as_uri(), size)
    page.ready()
    picture = page.pane(f"{file}_{size[0]}")
    assert colours(picture) > 500
    assert "assumed" in page.driver.find_element(By.ID, "elastic").text
    first = page.driver.find_element(By.CSS_SELECTOR, "#panel .slider input[type=range]")
    first.send_keys(*[Keys.PAGE_UP] * 3)
    page.settled()
    assert changed(picture, page.pane()) > 0.005
    clean(page, scene.as_uri())
