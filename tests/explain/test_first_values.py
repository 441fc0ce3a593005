"""From where a model with more effects is fitted: what shows nowhere must not spoil it."""

from dataclasses import replace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import load_cases_of
from sk120stiff.errors import Refusal
from sk120stiff.explain.select import stepwise
from sk120stiff.explain.select.stepwise import refit
from sk120stiff.identify import Problem, fit, solve
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import Model

SIGMA = 5e-6
NOISE = NoiseModel(SIGMA)


def readings_on_the_axis(model: Model, seed: int = 4) -> Measurements:
    """12 poses, three loads each; the point lies on the last joint's axis."""
    rng = np.random.default_rng(seed)
    robot = model.robot
    joints = np.repeat(rng.uniform(-1.4, 1.4, (12, robot.n)), 3, axis=0)
    force = rng.normal(size=(36, 3)) * 60.0
    plain = Measurements(
        pose=tuple(f"p{k // 3}" for k in range(36)),
        joint_names=robot.actuated,
        joints=joints,
        wrench=np.hstack([force, np.zeros_like(force)]),
        displacement=np.zeros((36, 3)),
        zero="separate",
    )
    moved = model.predict(load_cases_of(robot, plain))
    return replace(plain, displacement=moved + rng.normal(size=moved.shape) * SIGMA)


@pytest.fixture(scope="module")
def arm() -> Model:
    return sk.base_model(sk.load_robot("ur5e"))


def test_a_spring_about_whose_axis_the_point_turns_is_no_reason_to_start_elsewhere(
    arm, monkeypatch
) -> None:
    tilt = sk.effect(arm.robot, "joint_tilt", "elbow_joint")
    values = {f"{tilt.id}.stiffness_along": 8e4, f"{tilt.id}.stiffness_across": 5e4}
    base = fit(arm, readings_on_the_axis((arm + tilt).with_public(values)), noise=NOISE)
    last = next(k for k, p in enumerate(base.parameters) if "wrist_3" in p.name)
    assert np.abs(base.jacobian[:, last]).max() < 1e-20  # of the noise: rounding
    expected = solve(Problem(arm + tilt, base.problem.measurements, NOISE))
    monkeypatch.setattr(stepwise, "solve", None)  # the long way round
    found = refit(base, [tilt])
    assert found.chi_square == pytest.approx(expected.chi_square, rel=1e-9)
    seen = np.arange(len(found.x)) != last
    assert np.allclose(found.x[seen], expected.x[seen], rtol=1e-6)
    assert found.x[last] == found.problem.start[last]


def test_what_shows_only_elsewhere_is_sought_there(arm) -> None:
    """A misread displacement shows once there is one: not about an arm that does not move."""
    scale = sk.effect(arm.robot, "reading_scale")
    readings = readings_on_the_axis(arm)
    base = fit(arm, readings, noise=NOISE)
    problem = Problem(arm + scale, readings, NOISE)
    x, _ = stepwise._start(problem, None)
    assert x[: len(arm.values)] == pytest.approx(base.x, rel=0.05)
    # about a fit whose springs are rigid nothing is misread, so its values do not serve
    rigid = replace(base, model=arm.with_values(0.0 * arm.values))
    with pytest.raises(Refusal, match="does not show"):
        stepwise._start(problem, rigid)


def test_what_found_no_fit_alone_is_sought_about_another_fit_only(arm, monkeypatch) -> None:
    """Round after round the search asks for the same sets; what led nowhere leads nowhere again."""
    tilt = sk.effect(arm.robot, "joint_tilt", "elbow_joint")
    values = {f"{tilt.id}.stiffness_along": 8e4, f"{tilt.id}.stiffness_across": 5e4}
    base = fit(arm, readings_on_the_axis((arm + tilt).with_public(values)), noise=NOISE)
    near, refused = refit(base, [tilt]), set[tuple[sk.Effect, ...]]()

    def nowhere(*_: object, **__: object) -> None:
        raise Refusal("nowhere")

    with monkeypatch.context() as patched:
        patched.setattr(stepwise, "solve_near", nowhere)
        patched.setattr(stepwise, "solve", nowhere)
        with pytest.raises(Refusal, match="nowhere"):
            refit(base, [tilt], refused=refused)
    assert refused == {(tilt,)}
    with pytest.raises(Refusal, match="did not converge before"):
        refit(base, [tilt], refused=refused)
    again = refit(base, [tilt], near, refused=refused)
    assert again.chi_square == pytest.approx(near.chi_square, rel=1e-9)
    assert refit(base, [tilt], refused=set()).chi_square == pytest.approx(near.chi_square)
