"""Force sensors whose zero drifts: the load is less by what they add, reading by reading."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import load_cases_of
from sk120stiff.effects.force_sensor import ForceBias
from sk120stiff.effects.options import Options
from sk120stiff.effects.reference import ORDER, TIME
from sk120stiff.errors import InputError
from tests.explain.readings import hidden


@pytest.mark.parametrize("clock", [TIME, ORDER])
def test_what_a_sensor_adds_goes_on_about_the_middle_of_the_series(clock: str) -> None:
    readings = hidden()
    assert readings.order is not None and readings.zero_order is not None
    if clock == TIME:
        readings = replace(
            readings, order=None, zero_order=None, time=60.0 * readings.order,
            zero_time=60.0 * readings.zero_order,
        )  # fmt: skip
    model = sk.base_model(sk.load_robot("motoman_sk120"))
    cases = load_cases_of(model.robot, readings)
    (law,) = [each for each in ForceBias("sensor").other_laws(cases)
              if isinstance(each, ForceBias) and each.drifts]  # fmt: skip
    assert law.drifts == clock
    units = {spec.name: spec.unit for spec in law.parameters}
    again = ForceBias.at(model.robot, "sensor", ForceBias.options_of(units))
    assert (again.drifts, again.about) == (clock, law.about)
    with pytest.raises(InputError, match="about which moment"):
        ForceBias.at(model.robot, "sensor", Options(shape=("rate_x_about_3", "rate_y_about_4")))
    bias, rate = np.array([5.0, -3.0, 2.0]), np.array([0.2, 0.1, -0.3])
    if clock == TIME:
        rate = rate / 60.0
    said = (model + law).predict(cases, np.concatenate([model.values, bias, rate]))
    step = cases.order if clock == ORDER else cases.time
    begun = cases.order_at_zero if clock == ORDER else cases.time_at_zero
    assert step is not None and begun is not None
    when = step + begun
    assert law.about == pytest.approx(0.5 * when.max(), rel=1e-2)
    added = bias + (when - law.about)[:, None] * rate
    true = cases.wrench.copy()
    true[:, :3] -= np.einsum("nij,nj->ni", cases.rotation, added)
    np.testing.assert_allclose(said, model.predict(replace(cases, wrench=true)), atol=1e-12)
    assert np.abs(said - model.predict(cases)).max() > 1e-5
