"""A pulley that rubs takes a share of the load as it grows and leaves it on as it falls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import sk120stiff as sk
from sk120stiff.effects import load_cases_of
from sk120stiff.effects.force_sensor import FRICTION, ForceScale
from sk120stiff.effects.options import Options
from tests.explain.readings import answered, hidden

SHARE = 0.04


def ladder() -> sk.Measurements:
    """Every load twice, on the way up and on the way down; the arm feels less and more of it."""
    rising = replace(hidden(loads=4, sigma=1e-12), order=None, zero_order=None)
    model = sk.base_model(sk.load_robot("motoman_sk120"))
    both = rising.select(np.repeat(np.arange(rising.n_readings), 2))
    branch = tuple(("load", "unload")[k % 2] for k in range(both.n_readings))
    both = replace(both, branch=branch, repeat=None)
    cases = load_cases_of(model.robot, both)
    felt = replace(cases, wrench=cases.wrench * (1.0 - SHARE * cases.branch)[:, None])
    noise = 8e-6 * np.random.default_rng(3).normal(size=(both.n_readings, 3))
    return replace(both, displacement=model.predict(felt) + noise, zero="separate")


def test_the_load_is_less_as_it_grows_and_more_as_it_falls() -> None:
    readings = ladder()
    model = sk.base_model(sk.load_robot("motoman_sk120"))
    law = ForceScale.at(model.robot, "sensor", Options(shape=(FRICTION,)))
    assert law.rubs and law in ForceScale("sensor", law.scale).other_laws(
        load_cases_of(model.robot, readings)
    )
    only_up = replace(readings, branch=("load",) * readings.n_readings)
    laws = ForceScale("sensor", law.scale).other_laws(load_cases_of(model.robot, only_up))
    assert not any(each.rubs for each in laws)
    cases = load_cases_of(model.robot, readings)
    said = (model + law).predict(cases, np.append(model.values, SHARE))
    assert readings.displacement is not None
    assert np.abs(said - readings.displacement).max() < 5 * 8e-6
    assert np.abs(model.predict(cases) - readings.displacement).max() > 4e-5


def test_it_is_named_and_no_joint_is() -> None:
    """Hysteresis of all joints at once looks alike, and is none."""
    found = answered(sk.base_model(sk.load_robot("motoman_sk120")), ladder())
    assert [each.effect.id for each in found.findings] == ["force_scale:sensor"]
    (friction,) = [p for p in found.final.parameters if p.effect.name == "force_scale"]
    assert friction.spec.name == FRICTION
    assert friction.std is not None and abs(friction.value - SHARE) < 3.0 * friction.std
    assert "rubs" in found.findings[0].effect.sentence()
