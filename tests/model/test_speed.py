"""How long predictions take; the limits leave room for a busy machine."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from sk120stiff.effects import effect, situation_of_load
from sk120stiff.model import joint_spring_model
from sk120stiff.robot import load_robot
from tests.effects.arms import arm, readings, with_every_effect


def least(action: Callable[[], object], times: int) -> float:
    """Seconds of the fastest run."""
    found = []
    for _ in range(times):
        start = time.process_time()
        action()
        found.append(time.process_time() - start)
    return min(found)


def test_a_hundred_readings_against_the_whole_catalogue():
    """The goal is 0.2 s."""
    robot = arm("sk120")
    model, situation = with_every_effect(robot), readings(robot, 100)
    assert len(model.names) > 95
    assert least(lambda: model.predict_with_sensitivities(situation), 5) < 0.2


def test_many_readings_at_exact_equilibrium():
    """The goal is 20 s for 100 000 readings of a model of five effects, 0.2 ms each."""
    robot = load_robot("motoman_sk120")
    model = joint_spring_model(robot, [1.4e6, 4e5, 9.4e5, *[np.inf] * 3])
    for name, where in (("base_rocking", None), ("link_bending", "link_3_u")):
        found = effect(robot, name, where)
        model = model + found
    values = np.where(model.values == 0.0, 1e-7, model.values)
    rng = np.random.default_rng(0)
    count = 10_000
    poses = rng.uniform(-1, 1, (count, 6))
    wrench = 300 * rng.normal(size=(count, 6)) * [1, 1, 1, 0, 0, 0]
    situation = situation_of_load(robot, poses, wrench)
    assert least(lambda: model.predict(situation, values), 2) < 2.0
