"""Draws the two pictures of the README anew, from what the commands themselves write.

    python scripts/make_readme_pictures.py [FOLDER]      default: docs

scene.png    the page of `sk120stiff view motoman_sk120 --data ... --static`, photographed
springs.png  the figure of Table II that `sk120stiff paper` writes

Needs Chromium and its driver (Debian: chromium, chromium-driver) and `pip install selenium`.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "robots" / "motoman_sk120" / "data" / "table2_measured.csv"
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--hide-scrollbars",
)
SIZE = (1280, 800)


def command(*words: str) -> None:
    subprocess.run([sys.executable, "-m", "sk120stiff", *words], check=True)


def photograph(page: Path, picture: Path) -> None:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    for flag in (*FLAGS, f"--window-size={SIZE[0]},{SIZE[1]}"):
        options.add_argument(flag)
    driver = webdriver.Chrome(options, Service(shutil.which("chromedriver")))
    try:
        metrics = {"width": SIZE[0], "height": SIZE[1], "deviceScaleFactor": 1, "mobile": False}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        still = [{"name": "prefers-reduced-motion", "value": "reduce"}]
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": still})
        driver.get(page.as_uri())
        _until(driver, "document.documentElement.dataset.ready === 'yes'")
        driver.execute_script("SK.actions.step(1)")  # the second pose shows the arm stretched out
        time.sleep(0.5)
        _until(driver, "!SK.busy()")
        driver.save_screenshot(str(picture))
    finally:
        driver.quit()


def _until(driver, condition: str) -> None:  # type: ignore[no-untyped-def]
    end = time.monotonic() + 60.0
    while not driver.execute_script(f"return Boolean({condition})"):
        if time.monotonic() > end:
            raise SystemExit(f"the page never came to: {condition}")
        time.sleep(0.1)


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs"
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        page = Path(scratch) / "scene.html"
        command("view", "motoman_sk120", "--data", str(DATA), "--static", str(page))
        photograph(page, folder / "scene.png")
        command("paper", "--out", str(Path(scratch) / "paper"))
        shutil.copyfile(Path(scratch) / "paper" / "table2.png", folder / "springs.png")
    print(f"{folder / 'scene.png'}\n{folder / 'springs.png'}")


if __name__ == "__main__":
    main()
