"""Derivatives of laws that jump and remember: what changes a torque changes what came of it."""

from __future__ import annotations

import numpy as np
import pytest

from sk120stiff.arrays import Array
from sk120stiff.effects import CATALOGUE, LoadCases, load_cases_of
from sk120stiff.effects.options import Options
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, joint_spring_model
from tests.effects.arms import arm

JOINT = 1
LAWS = {
    "friction_hysteresis": {
        "half_width_presliding_20": 2e-4, "half_width_presliding_90": 4e-4
    },
    "friction, after the weight": {"half_width_weighed_20": 2e-4, "half_width_weighed_90": 4e-4},
    "friction, on and off before": {
        "half_width_cycled_20": 2e-4, "half_width_cycled_90": 4e-4
    },
    "lost_motion": {"half_width_flank_15": 3e-4, "half_width": 1e-4},
    "lost motion, by sides": {
        "half_width_positive_flank_15": 3e-4, "half_width_negative_flank_15": 1e-4
    },
}  # fmt: skip
KINDS = {
    "friction, after the weight": "friction_hysteresis",
    "friction, on and off before": "friction_hysteresis",
    "lost motion, by sides": "lost_motion",
}
LADDER = (0.3, 1.0, 0.7, 0.25, -0.4, 0.5)  # of the largest load
BESIDE = ("force_bias", "force_scale", "force_rotation", "joint_offset")


def ladders(name: str, sensed: bool) -> tuple[Model, LoadCases]:
    """An arm under loads that come and go, in tool axes where a sensor read them."""
    robot, rng = arm(name), np.random.default_rng(4)
    a = np.repeat(rng.uniform(-1.0, 1.0, (5, robot.n)), len(LADDER), axis=0)
    wrench = np.repeat(rng.normal(size=(5, 6)) * [300, 300, 300, 60, 60, 60], len(LADDER), axis=0)
    readings = Measurements(
        pose=tuple(f"p{k}" for k in range(5) for _ in LADDER),
        joint_names=robot.actuated,
        joint_kinds=robot.kinds,
        joints=a,
        wrench=wrench * np.tile(LADDER, 5)[:, None],
        displacement=None,
        branch=tuple("load" if k < 2 else "unload" for k in range(len(LADDER))) * 5,
        force_frame="tool" if sensed else "base",
    )
    model = joint_spring_model(robot, np.full(robot.n, 2e5))
    return model, load_cases_of(robot, readings)


def differences(model: Model, load_cases: LoadCases, values: Array, step: Array) -> Array:
    """(N, 3, P) central differences of what is predicted."""
    columns = []
    for k, h in enumerate(step):
        by = np.zeros(len(values))
        by[k] = h
        ends = (model.predict(load_cases, values + way * by) for way in (1.0, -1.0))
        columns.append(np.subtract(*ends) / (2.0 * h))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("sensed", [False, True])
def test_the_derivative_is_that_of_finite_differences(law: str, sensed: bool) -> None:
    model, load_cases = ladders("six_axis", sensed)
    robot, kind = model.robot, KINDS.get(law, law)
    where = CATALOGUE["lost_motion"].places(robot)[JOINT]
    model = model + CATALOGUE[kind].at(robot, where, Options(shape=tuple(LAWS[law])))
    model = model.with_public(**{f"{kind}:{where}.{k}": v for k, v in LAWS[law].items()})
    for name in BESIDE:
        effect = CATALOGUE[name]
        model = model + effect.at(robot, effect.places(robot)[0], Options())
    values = model.values.copy()
    beside = [k for k, p in enumerate(model.parameters) if p.effect.name in BESIDE]
    typical = np.array([model.parameters[k].spec.typical for k in beside])
    values[beside] = typical * np.random.default_rng(8).normal(size=len(beside))
    step = np.full(len(values), 1e-9)
    step[beside] = 1e-4 * typical
    _, exact = model.predict_with_sensitivities(load_cases, values)
    found = differences(model, load_cases, values, step)
    for k in beside:
        size = np.abs(exact[..., k]).max()
        np.testing.assert_allclose(exact[..., k], found[..., k], rtol=0, atol=2e-5 * size)
