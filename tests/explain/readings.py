"""Readings of an SK120 with known hidden causes, made by the generator of the blind benchmark."""

from dataclasses import replace

import numpy as np

from sk120stiff import Model, base_model, load_robot
from sk120stiff.explain import Explanation, Options, explain
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import Measurements, NoiseModel, NoiseStatement
from tests.hidden.generator.design import plan
from tests.hidden.generator.noise import Noise
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import Cause, World

SIGMA = 8e-6
NOISE = NoiseModel(SIGMA, zero="shared")
POINT = np.array([-0.06, 0.04, 0.15])


def hidden(
    *causes: Cause,
    schedule: str = "scattered",
    poses: int = 20,
    loads: int = 5,
    sigma: float = SIGMA,
    stated: bool = True,
    seed: int = 7,
    force_error: float = 0.0,
) -> Measurements:
    """Readings with these causes and noise, in base axes, each pose with a zero of its own.

    Every component of a force is off the one that is written by a draw of `force_error` of it.
    """
    arm = sk120()
    rng = np.random.default_rng(seed)
    rows = plan(arm, rng, poses=poses, loads=loads, schedule=schedule, point=POINT)
    springs = {name: 1.0 / value for name, value in arm.typical.joint.items()}
    size = np.linalg.norm(rows.force, axis=1, keepdims=True)
    off = force_error * size * np.random.default_rng(seed + 1000).normal(size=rows.force.shape)
    pulled = replace(rows, force=rows.force + off)
    displacement, start, _ = World(arm, springs, causes).observe(pulled)
    error, zero_error = Noise(sigma, shared_zero=True).sample(rows, displacement, start, rng)
    return Measurements(
        pose=tuple(str(pose) for pose in rows.pose),
        joint_names=arm.actuated,
        joints=np.stack([rows.coordinates[name] for name in arm.actuated], axis=1),
        wrench=np.hstack([rows.force, rows.moment]),
        displacement=displacement + error - zero_error,
        robot="motoman_sk120",
        base_frame="base_link",
        tool_frame="tool0",
        point=POINT,
        zero="shared",
        noise=NoiseStatement(sigma=sigma if stated else None),
        order=rows.order,
        zero_order=rows.zero_order,
        branch=tuple("load" if way > 0 else "unload" for way in rows.branch),
    )


def base_fit(readings: Measurements, noise: NoiseModel | None = NOISE) -> Fit:
    """The paper's three springs, refitted; None lets the fit choose the noise model."""
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return fit(model, readings, noise=noise)


def answered(
    model: Model, readings: Measurements, options: Options | None = None, **given
) -> Explanation:
    """What `explain` says, but for the gap on poses left out in turn.

    That one is told on the same readings instead: nothing is learned anew in parts, which takes
    half of the time, and `test_steps.py` asks for it.
    """
    return explain(model, readings, holdout=readings, options=options, **given)
