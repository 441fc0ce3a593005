"""How a plan is shown: as a table, as JSON, as a page."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.plan import Route
from sk120stiff.plan.route import SLIDE_STEP, STEP
from sk120stiff.robot import Robot

COARSER = 2.0  # than the steps in which a way is asked: enough for a picture


def as_keys(plan: Measurements) -> list[dict[str, object]]:
    """The rows in JSON."""
    return [
        {
            "pose": label,
            "joints": dict(zip(plan.joint_names, a.tolist(), strict=True)),
            "wrench": wrench.tolist(),
        }
        for label, a, wrench in zip(plan.pose, plan.joints, plan.wrench, strict=True)
    ]


def write_page(file: Path, model: Model, plan: Measurements, driven: Route | None = None) -> None:
    """The arm at every pose of a plan, in its order, with the loads there.

    The point's way between the poses is that of joints that go straight, by the via points of
    `driven` where there are any.
    """
    from sk120stiff.show import scene_of_model, static_scene
    from sk120stiff.show.scene.scene import ScenePath

    scene = scene_of_model(
        model,
        plan,
        title=f"{model.robot.name}: plan",
        subtitle=f"{len(plan.poses)} poses in their order, {plan.n_readings} loads",
    )
    stands = np.array([pose.a for pose in scene.poses]) if driven is None else driven.a
    a, reached = _between(model.robot, stands)
    planned = np.ones(len(stands), dtype=bool) if driven is None else driven.pose >= 0
    at = model.robot.screws(a, point=plan.point).position
    path = ScenePath(
        at, at, 0, said=f"first: {plan.poses[0]}", freedom="", mark="the first pose's point",
        stops=tuple(int(k) for k in reached[planned]),
    )  # fmt: skip
    static_scene(file, replace(scene, path=path))


def _between(robot: Robot, stops: Array) -> tuple[Array, Index]:
    """(M, n) poses along joints that go straight from stop to stop, and which of them are stops."""
    rows, reached = [stops[:1]], [0]
    for start, end in itertools.pairwise(stops):
        steps = np.abs(end - start) / np.where(robot.prismatic, SLIDE_STEP, STEP)
        count = max(int(np.ceil(steps.max() / COARSER)), 1)
        rows.append(start + np.linspace(0.0, 1.0, count + 1)[1:, None] * (end - start))
        reached.append(reached[-1] + count)
    return np.concatenate(rows), np.array(reached, dtype=np.intp)
