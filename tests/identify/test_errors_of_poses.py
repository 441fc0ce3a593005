"""Loads of one pose are no witnesses of their own where the arm is off by as much under each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.identify import fit, fit_report
from sk120stiff.identify.estimate import fit_displacements
from tests.explain.readings import base_fit, hidden
from tests.explain.test_beside_form import roughened
from tests.hidden.generator.sk120 import sk120

TRUE = np.array(list(sk120().typical.joint.values()))


def held(fit) -> np.ndarray:
    """Which true springs the 95 % intervals hold."""
    low, high = np.array(fit.intervals()).T
    return (low <= TRUE) & (high >= TRUE)


def test_intervals_hold_springs_of_an_arm_that_keeps_to_no_law() -> None:
    """5 % of every pose's compliance are its own; eight poses of six loads, thirty campaigns."""
    plain, beside = [], []
    for seed in range(30):
        rough = roughened(hidden(poses=8, loads=6, seed=seed), 0.05, seed=seed)
        model = base_fit(rough).model
        plain.append(held(fit_displacements(model, rough)))
        beside.append(held(fit(model, rough)))
    assert np.mean(plain) < 0.75
    assert np.mean(beside) > 0.9


@pytest.mark.parametrize("share", [0.0, 0.05])
def test_what_does_not_show_or_has_no_company_changes_nothing(share: float) -> None:
    rough = roughened(hidden(poses=30, loads=1 if share else 5), share)
    model = base_fit(rough).model
    found, alone = fit(model, rough), fit_displacements(model, rough)
    assert not found.problem.noise.form
    assert (found.x == alone.x).all() and found.reasons == alone.reasons


def test_the_size_is_told_and_a_given_noise_is_kept() -> None:
    rough = roughened(hidden(poses=12, loads=6), 0.05)
    model = base_fit(rough).model
    found = fit(model, rough)
    assert found.problem.noise.form.proportional == pytest.approx(0.05, rel=0.3)
    said = fit_report(found)
    assert "off together by" in said and "Beside what readings of a pose have in common: χ²" in said
    given = replace(found.problem.noise, form=type(found.problem.noise.form)())
    assert not fit(model, rough, noise=given).problem.noise.form
