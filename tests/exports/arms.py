"""Arms with random errors of their geometry, and where their models say that they stand."""

from pathlib import Path

import numpy as np

from sk120stiff.effects import CATALOGUE, effect, load_case
from sk120stiff.exports import FORMATS, Exported, Request
from sk120stiff.model import Model, base_model
from sk120stiff.robot import Robot, load_robot
from tests.corpus.robots import example

RIGID = ("joint_offset", "joint_frame", "link_length", "tool_offset")
PUBLIC = ("motoman_sk120", "ur5_robot.urdf", "panda.urdf")


def public(name: str) -> Robot:
    return load_robot(example(name) if name.endswith(".urdf") else name)


def with_random(model: Model, *names: str, seed: int = 0) -> Model:
    """Effects `name` at every place, or `name:where`, several times as large as is typical."""
    rng, robot = np.random.default_rng(seed), model.robot
    for name in names:
        kind, _, where = name.partition(":")
        for place in [where] if where else CATALOGUE[kind].places(robot):
            added = effect(robot, kind, place)
            model = model + added
            values = model.values.copy()
            sizes = np.array([spec.typical for spec in added.parameters])
            values[-len(sizes) :] = 5.0 * sizes * rng.standard_normal(len(sizes))
            model = model.with_values(values)
    return model


def miscalibrated(name: str, seed: int = 0) -> Model:
    return with_random(base_model(public(name)), *RIGID, seed=seed)


def exported(model: Model, kind: str, out: Path | str = "arm", **request: object) -> Exported:
    return FORMATS[kind].make(model, Request(Path(out), **request))


def standing(model: Model, a: np.ndarray) -> np.ndarray:
    """(N, 4, 4) measured frame of the unloaded arm, by the model's own mechanism."""
    start = model.assembly.start(load_case(model.robot, a, np.zeros(6)), model.values)
    screws = model.assembly.mechanism.screws(start)
    T = np.tile(np.eye(4), (len(a), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = screws.rotation, screws.position
    return T
