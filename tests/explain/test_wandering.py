"""A drift that comes and goes has no law: what stands beside it is named, its period is told."""

from dataclasses import replace

import numpy as np

from sk120stiff import base_model, load_robot
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.localise.suspects import TO_AND_FRO
from tests.explain.readings import answered, hidden
from tests.hidden.generator.causes_elastic import BaseRocking


def test_a_cause_beside_air_conditioning() -> None:
    readings = hidden(BaseRocking("base_link", {"x": 4e-7, "y": 4e-7}))
    order, zero = readings.order, readings.zero_order
    assert order is not None and zero is not None
    drift = np.zeros(readings.n_readings)
    for size, period, phase in ((4e-5, 22.0, 0.0), (1.2e-5, 51.0, 1.0)):
        pace = 2.0 * np.pi / period
        drift += size * (np.sin(pace * order + phase) - np.sin(pace * zero + phase))
    moved = readings.displacement + drift[:, None] * np.array([0.0, 0.0, 1.0])
    answer = answered(
        base_model(load_robot("motoman_sk120")), replace(readings, displacement=moved)
    )
    assert [finding.effect.id for finding in answer.findings] == ["base_rocking:base_link"]
    assert any(f"{TO_AND_FRO}2" in said for said in answer.remainder.where)
    assert "read the zero again before every load" in next_step(answer)
