"""Every effect in a position: exact derivatives against central differences, on several arms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import Effect, LinearElastic, LoadCases, Switching, all_effects
from sk120stiff.effects.base import Elastic
from sk120stiff.model import Model, model_from_text, model_text
from sk120stiff.model.pose_reading import PoseReading, read_poses
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import rotation_vector
from tests.effects.arms import ARMS, LOOPED, POSES, Array, arm, random_values, readings, sprung

SERIES = ("a", "b", "c")
STATIONS = ("left", "right")


def load_cases_of(robot: Robot, seed: int) -> LoadCases:
    rng = np.random.default_rng(seed)
    return replace(
        readings(robot, 8, seed=seed),
        absolute=True,
        point=0.1 * rng.normal(size=(8, 3)),
        payload_point=np.array([0.1, 0.0, 0.05]),
        temperature=5.0 * rng.normal(size=8),
        series=np.arange(8) % 3,
        series_names=SERIES,
        station=np.arange(8) // 3 % 2,
        station_names=STATIONS,
        side=rng.choice([-1.0, 1.0], (8, robot.n)),
    )


def smooth(effect: Effect) -> bool:
    """Its law has no jump that a small step could cross."""
    return not isinstance(effect, Switching) and (
        not isinstance(effect, Elastic) or isinstance(effect, LinearElastic)
    )


def with_everything(robot: Robot, seed: int) -> tuple[Model, Array]:
    model = sprung(robot)
    told = {
        "poses": POSES, "timed": True, "series": SERIES, "stations": STATIONS, "thermal": True
    }  # fmt: skip
    for effect in all_effects(robot, absolute=True, **told):
        if effect.name != "joint_springs" and smooth(effect):
            model = model + effect
    values = random_values(model, np.random.default_rng(seed), 0.3)
    values[: robot.n] = sprung(robot).values
    return model, values


def apart(one: PoseReading, other: PoseReading) -> Array:
    turned = one.rotation @ np.swapaxes(other.rotation, -1, -2)
    return np.concatenate([one.position - other.position, rotation_vector(turned)], axis=1)


@pytest.mark.parametrize(
    ("name", "follows"), [(name, k % 2 == 0) for k, name in enumerate([*ARMS, *LOOPED])]
)
def test_all_effects_together(name: str, follows: bool) -> None:
    robot = arm(name)
    load_cases, (model, values) = load_cases_of(robot, 2), with_everything(robot, 3)
    if follows:  # a sensor on the tool reads a force, and a mass hangs there besides
        load_cases = replace(load_cases, follows=True, payload=np.arange(8.0))
        load_cases = replace(load_cases, wrench=load_cases.wrench + load_cases.hanging)
    exact = read_poses(model, load_cases, values, derivative=True).columns
    typical = np.array([p.spec.typical for p in model.parameters])
    rng = np.random.default_rng(4)
    for _ in range(4):
        way = 0.005 * typical * rng.normal(size=len(typical))
        near = apart(*(read_poses(model, load_cases, values + s * way) for s in (1, -1)))
        far = apart(*(read_poses(model, load_cases, values + s * way) for s in (2, -2)))
        slope = (8.0 * near - far) / 12.0
        assert np.abs(exact @ way - slope).max() < 1e-8 * np.abs(slope).max()
    shown = np.abs(exact * typical).max(axis=(0, 1))
    told = {model.parameters[k].effect.name for k in np.flatnonzero(shown > 1e-9)}
    new = {p.effect.name for p in model.parameters if p.effect.only_absolute}
    assert len(new) == (11 if robot.total_mass else 10) and new <= told


def test_models_with_them_are_written_and_read_without_loss() -> None:
    robot = arm("six_axis")
    model, values = with_everything(robot, 5)
    model = model.with_values(values)
    again = model_from_text(model_text(model), robot=robot)
    assert again.effects == model.effects
    assert np.allclose(again.values, values, rtol=4e-16, atol=0)


def test_blocks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = arm("six_axis")
    load_cases, (model, values) = load_cases_of(robot, 6), with_everything(robot, 7)
    whole = read_poses(model, load_cases, values, derivative=True)
    monkeypatch.setattr("sk120stiff.model.pose_reading.BLOCK", 3)
    parts = read_poses(model, load_cases, values, derivative=True)
    assert np.abs(whole.position - parts.position).max() < 1e-14
    assert np.abs(whole.columns - parts.columns).max() < 1e-10
