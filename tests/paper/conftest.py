"""The paper is recomputed once for all tests of this folder."""

import pytest

from sk120stiff.paper import Reproduction, reproduce


@pytest.fixture(scope="session")
def found() -> Reproduction:
    return reproduce()
