"""The guard of conftest.py itself: it must turn skips into failures, and only skips."""

from pathlib import Path

import pytest

pytest_plugins = ["pytester"]

SUITE = """
    import pytest
    def test_passes(): pass
    @pytest.mark.skip(reason="no browser")
    def test_marked(): pass
    def test_inside(): pytest.skip("no browser")
    @pytest.mark.xfail(reason="known", strict=True)
    def test_known(): assert False
"""


@pytest.fixture
def suite(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    monkeypatch.delenv("CI", raising=False)
    pytester.makeconftest(Path(__file__).with_name("conftest.py").read_text(encoding="utf-8"))
    pytester.makepyfile(SUITE)
    return pytester


def test_skips_are_allowed_at_home(suite: pytest.Pytester) -> None:
    suite.runpytest_subprocess().assert_outcomes(passed=1, skipped=2, xfailed=1)


def test_skips_fail_on_request(suite: pytest.Pytester) -> None:
    result = suite.runpytest_subprocess("--no-skips")
    result.assert_outcomes(passed=1, failed=1, errors=1, xfailed=1)
    result.stdout.fnmatch_lines(["*nothing may be: *no browser*"])


def test_skips_fail_where_ci_is_true(
    suite: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CI", "true")
    suite.runpytest_subprocess().assert_outcomes(passed=1, failed=1, errors=1, xfailed=1)


def test_a_skipped_file_fails(suite: pytest.Pytester) -> None:
    suite.makepyfile(test_other="import pytest\npytest.importorskip('no_such_library')")
    result = suite.runpytest_subprocess("--no-skips", "test_other.py")
    assert result.ret != 0
