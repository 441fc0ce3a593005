"""A real browser without a screen, cut off from every network but this machine."""

import io
import json
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

from tests.show.scenes import ARTEFACTS

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",  # WebGL without a graphics card; --use-gl=egl gives blank pictures
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-quic",
    "--disable-sync",
    "--no-first-run",
    "--hide-scrollbars",
    "--force-color-profile=srgb",
)
INSIDE = ("file:", "data:", "blob:", "about:", "chrome:")  # the last: its own new-tab page
DESKTOP, PHONE, SMALL = (1280, 800), (390, 844), (940, 400)


def found() -> bool:
    return bool(shutil.which("chromium") and shutil.which("chromedriver"))


class Page:
    """One window, and what can be asked of it."""

    def __init__(self, driver: webdriver.Chrome) -> None:
        self.driver = driver

    def size(self, width: int, height: int) -> None:
        self.driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600},
        )

    def open(self, address: str, size: tuple[int, int] = SMALL, *, dark: bool = False) -> None:
        self.driver.get("about:blank")
        self.console()
        self.requests()  # what earlier pages said and asked for is not this page's
        self.size(*size)
        still = [
            {"name": "prefers-reduced-motion", "value": "reduce"},
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
        ]
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": still})
        self.driver.get(address)

    def js(self, script: str, *arguments: Any) -> Any:
        return self.driver.execute_script(script, *arguments)

    def wait(self, condition: str, *, seconds: float = 30.0) -> None:
        end = time.monotonic() + seconds
        while not self.js(f"return Boolean({condition})"):
            assert time.monotonic() < end, f"{condition}: not within {seconds} s {self.console()}"
            time.sleep(0.03)

    def ready(self) -> None:
        self.wait("document.documentElement.dataset.ready === 'yes'")
        self.settled()

    def settled(self) -> None:
        """Wait until all is computed, moved and drawn."""
        self.wait("!SK.busy()")

    def pixels(self, name: str = "") -> np.ndarray:
        data = self.driver.get_screenshot_as_png()
        if name:
            ARTEFACTS.mkdir(parents=True, exist_ok=True)
            (ARTEFACTS / f"{name}.png").write_bytes(data)
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))

    def pane(self, name: str = "") -> np.ndarray:
        """The part of a screenshot that Meshcat draws."""
        box = self.js(
            "const r = document.getElementById('pane').getBoundingClientRect();"
            "return [r.left, r.top, r.right, r.bottom]"
        )
        left, top, right, bottom = (round(v) for v in box)
        return self.pixels(name)[top:bottom, left:right]

    def console(self) -> list[str]:
        """What the page complained about since the last call."""
        return [
            entry["message"] for entry in self.driver.get_log("browser")
            if entry["level"] == "SEVERE" or "Error" in entry["message"]
        ]  # fmt: skip

    def requests(self) -> list[str]:
        """Addresses that the page asked for since the last call."""
        events = [json.loads(e["message"])["message"] for e in self.driver.get_log("performance")]
        return [
            event["params"]["request"]["url"] if "request" in event["params"]
            else event["params"]["url"]
            for event in events
            if event["method"] in ("Network.requestWillBeSent", "Network.webSocketCreated")
        ]  # fmt: skip


@contextmanager
def browser(profile: Path) -> Iterator[Page]:
    if not found():
        pytest.skip("chromium and chromedriver are needed (Debian: chromium, chromium-driver)")
    options = webdriver.ChromeOptions()
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, Service(shutil.which("chromedriver")))
    try:
        yield Page(driver)
    finally:
        driver.quit()


def colours(pixels: np.ndarray) -> int:
    """Number of different colours."""
    return len(np.unique(pixels.reshape(-1, 3), axis=0))


def changed(before: np.ndarray, after: np.ndarray) -> float:
    """Share of pixels that differ visibly."""
    difference = np.abs(before.astype(int) - after.astype(int)).max(axis=-1)
    return float((difference > 12).mean())


def clean(page: Page) -> None:
    """No complaint on the console, no request that leaves the machine."""
    assert page.console() == []
    outside = [u for u in page.requests() if not u.startswith(INSIDE)]
    assert outside == []
