"""The whole suite runs on several cores; where everything must run, nothing may be skipped."""

import os
import signal
import sys
from collections.abc import Generator, Mapping
from typing import Any

import numpy as np
import pytest

# Of each module's RNG as it begins; a process holds many modules.
_BEGINNING: dict[str, Mapping[str, Any]] = {}


@pytest.fixture(autouse=True)
def _same_draws(request: pytest.FixtureRequest) -> None:
    """A test draws the same numbers from its module's RNG, whatever ran before it."""
    drawn = getattr(request.module, "RNG", None)
    if isinstance(drawn, np.random.Generator):
        state = _BEGINNING.setdefault(request.module.__name__, drawn.bit_generator.state)
        drawn.bit_generator.state = state


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--no-skips",
        action="store_true",
        default=os.environ.get("CI", "").lower() == "true",
        help="count a skipped test as failed (the default where CI=true)",
    )


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """`pytest` alone takes a process per core, four at most; what is named runs in one process."""
    # Hundreds of programs are started: what the first one compiled the others read.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:  # as in a job of a shell's background
        signal.signal(signal.SIGINT, signal.default_int_handler)
    asked = getattr(config.option, "numprocesses", 0)  # None: pytest-xdist is there, unasked
    whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    if asked is not None or not whole or hasattr(config, "workerinput"):
        return
    if config.option.usepdb or config.option.collectonly:
        return
    config.option.numprocesses = min(4, len(os.sched_getaffinity(0)))
    config.option.dist = "worksteal"  # neighbours share a process, and with it their fixtures
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # the cores are taken


def _forbid(
    report: pytest.TestReport | pytest.CollectReport, config: pytest.Config
) -> pytest.TestReport | pytest.CollectReport:
    expected_failure = hasattr(report, "wasxfail")
    if report.skipped and not expected_failure and config.getoption("--no-skips"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"{report.nodeid} was skipped, but here nothing may be: {reason}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    return _forbid(report, item.config)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    report = yield
    return _forbid(report, collector.config)
