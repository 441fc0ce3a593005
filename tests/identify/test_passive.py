"""No fit has a part that gives off energy: a coupling stays below what its springs allow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import Effect, load_cases_of
from sk120stiff.effects.foundation import BaseRocking
from sk120stiff.effects.joint_tilt import JointTilt
from sk120stiff.identify import Problem, solve_near
from sk120stiff.identify.solving import solve
from tests.explain.readings import NOISE, hidden

SOFT, STIFF = 4e-7, 1e-7


@pytest.mark.parametrize("part", [BaseRocking("base_link", askew=True),
                                  JointTilt("joint_2_l", askew=True, housing=True)])  # fmt: skip
@pytest.mark.parametrize("share", [0.6, 1.3, -1.3])
def test_a_coupling_is_held_where_the_part_is_just_passive(part: Effect, share: float) -> None:
    model = sk.base_model(sk.load_robot("motoman_sk120")) + part
    cross = share * np.sqrt(SOFT * STIFF)
    truth = np.append(model.values[:-3], [SOFT, STIFF, cross])
    readings = hidden()
    moved = model.predict(load_cases_of(model.robot, readings), truth)
    problem = Problem(model, replace(readings, displacement=moved), NOISE)
    far = solve(problem)
    near = solve_near(problem, truth[problem.free] / problem.scale)
    for found in (far, near):
        own = {p.spec.name: p.internal for p in found.parameters if p.effect == part}
        first, second, coupling = own.values()
        if abs(share) < 1.0:
            assert coupling == pytest.approx(cross, rel=1e-6)
            assert not found.at_bound[-1]
        else:
            assert coupling * share > 0.0 and found.at_bound[-1]
            assert 0.99 < coupling**2 / (first * second) < 1.0
    assert near.chi_square == pytest.approx(far.chi_square, rel=1e-3, abs=1e-3)
