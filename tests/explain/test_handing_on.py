"""An answer hands itself on from Python as the command does: its report, and what to measure."""

import re
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.cli.main import main

DATA = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
ROCKING = tuple(f"base_rocking:base_link.stiffness_{axis}" for axis in "xy")


def body(page: str) -> str:
    """A page without what differs from run to run: ids, scene, and how it was made."""
    page = re.sub(r"<iframe.*?</iframe>|<svg.*?</svg>", "", page, flags=re.DOTALL)
    return page.partition("SHA-256")[0].partition("Command")[0]


def test_the_report_is_that_of_the_command(tmp_path: Path) -> None:
    answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), sk.read(DATA))
    report = answer.report(tmp_path / "mine.html")
    assert main(["explain", str(DATA), "--out", str(tmp_path / "told")]) == 0
    mine = (tmp_path / "mine.html").read_text(encoding="utf-8")
    theirs = (tmp_path / "told/report.html").read_text(encoding="utf-8")
    assert report.title in mine and "<iframe" in mine and "<svg" in mine
    first, second = body(mine).splitlines(), body(theirs).splitlines()
    assert len(first) > 100
    # the command's page links to the scene beside it
    assert [line for line in second if line not in first and "scene.html" not in line] == []


def test_what_is_measured_next_is_added_to_what_was() -> None:
    robot = sk.load_robot("motoman_sk120")
    base = sk.base_model(robot)
    truth = (base + sk.effect(robot, "base_rocking")).with_public(dict.fromkeys(ROCKING, 1e7))
    assert truth.parameter(ROCKING[1]).value == pytest.approx(1e7)
    with pytest.raises(sk.InputError, match="no parameter"):
        truth.with_public({"base_rocking:base_link.stiffnes_x": 1e7})
    noise, steps = sk.NoiseModel(10e-6), sk.Schedule("ascending", levels=3)
    first = sk.simulate(truth, sk.plan(base, 20), noise=noise, schedule=steps, seed=1).measurements
    among = sk.Options(only=("base_rocking", "link_bending", "joint_tilt", "base_sliding"))
    answer = sk.explain(base, first, options=among)
    assert answer.verdict == "ambiguous"
    following = answer.next_readings()
    assert following is not None and answer.next_poses is not None
    assert (following.zero, following.noise) == (first.zero, first.noise)
    np.testing.assert_array_equal(following.wrench, answer.next_poses[1])
    more = sk.simulate(truth, following, noise=noise, schedule=steps, seed=2).measurements
    both = first + more
    assert both.n_readings == first.n_readings + more.n_readings
    assert not set(both.zero_group[: first.n_readings]) & set(both.zero_group[first.n_readings :])
