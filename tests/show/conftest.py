"""One browser for all tests that look at pages; every test opens its own page in it."""

from collections.abc import Iterator

import pytest

from tests.show.browser import Page, browser


@pytest.fixture(scope="session")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened
