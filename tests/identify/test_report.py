"""The report in plain text."""

from dataclasses import replace

import numpy as np

from sk120stiff.effects import effect
from sk120stiff.identify import fit, fit_report, profile_intervals
from sk120stiff.model import joint_spring_model
from tests.identify.conftest import readings_of


def test_the_paper_fit_in_words(springs, table2) -> None:
    text = fit_report(fit(springs, table2))
    assert "[[Parameters]]" in text
    first = next(line for line in text.splitlines() if "joint_1_s.stiffness" in line)
    for part in ("1.3573e+06", "±", "(1.1 %)", "1.328e+06 .. 1.388e+06", "N*m/rad", "1.4098e+06"):
        assert part in first
    assert "15 readings of three axes at 3 poses, 3 values estimated" in text
    assert "9.66 µm, by the scatter within poses (18 degrees of freedom)" in text
    assert "AIC" in text
    assert "do not tell" not in text


def test_bounds_blanks_and_correlations(robot, table2) -> None:
    model = joint_spring_model(robot) + effect(robot, "base_rocking")
    found = fit(model, table2)
    text = fit_report(found, profile=profile_intervals(found))
    assert "95 % (profile)" in text
    assert "not identifiable" in text
    assert "on its bound" in text
    assert "[[What these readings do not tell]]" in text
    assert "[[Correlations beyond 0.3]]" in text


def test_down_weighted_readings_are_listed(springs) -> None:
    readings = readings_of(springs, poses=8, seed=5, outliers=0.1)
    found = fit(springs, readings, robust=True)
    text = fit_report(found)
    assert "[[Trusted less than the others]]" in text
    assert f"{len(found.down_weighted)} of 32 readings" in text
    assert "χ²" not in text
    worst = int(np.argmin(found.problem.weights))
    assert f"(pose {readings.pose[worst]})" in text
    lines = replace(readings, line=np.arange(2, 34))
    assert f"line {worst + 2} (pose" in fit_report(fit(springs, lines, robust=True))


def test_readings_far_off_a_plain_fit_are_named(springs) -> None:
    readings = readings_of(springs, poses=12, seed=5)
    spoilt = readings.displacement.copy()
    spoilt[[7, 30]] += [[6e-4, 0.0, -5e-4], [0.0, 9e-4, 0.0]]
    found = fit(springs, replace(readings, displacement=spoilt))
    text = fit_report(found)
    assert "[[Far off the others]]" in text and "2 readings are far off" in text
    for row in (7, 30):
        assert f"reading {row + 1} (pose {readings.pose[row]})" in text
    for seed in range(10):
        clean = readings_of(springs, poses=12, seed=seed)
        assert "Far off" not in fit_report(fit(springs, clean))
    rocks = springs + effect(springs.robot, "base_rocking")
    values = rocks.values.copy()
    values[-2:] = 2e-7
    lacking = readings_of(rocks.with_values(values), poses=12, seed=3)
    assert "Far off" not in fit_report(fit(springs, lacking))  # a cause is no slip
