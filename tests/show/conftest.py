"""One browser for all tests that look at pages; every test opens its own page in it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from sk120stiff.show import static_scene
from tests.show.browser import Page, browser
from tests.show.shown import SCENES


@pytest.fixture(scope="session")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture
def page(window: Page) -> Page:
    return window


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("scenes")
    return {name: static_scene(folder / f"{name}.html", make()) for name, make in SCENES.items()}
