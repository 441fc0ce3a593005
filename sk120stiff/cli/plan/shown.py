"""How a plan is shown: as a table, as JSON, and how low the arm comes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from sk120stiff.cli.tables import table
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model


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


def write_page(file: Path, model: Model, plan: Measurements) -> None:
    """The arm at every pose of a plan, in its order, with the loads there."""
    from sk120stiff.show import scene_of_model, static_scene
    from sk120stiff.show.scene.path import ScenePath

    scene = scene_of_model(
        model,
        plan,
        title=f"{model.robot.name}: plan",
        subtitle=f"{len(plan.poses)} poses in their order, {plan.n_readings} loads",
    )
    stands = np.array([pose.a for pose in scene.poses])
    at = model.robot.screws(stands, point=plan.point).position
    path = ScenePath(
        at, at, 0, said=f"first: {plan.poses[0]}", freedom="", mark="the first pose's point"
    )
    static_scene(file, replace(scene, path=path))


def plan_table(plan: Measurements) -> object:
    """The rows for people: degrees, mm, N."""
    scale = [180.0 / np.pi if kind == "angle" else 1e3 for kind in plan.joint_kinds]
    unit = ["deg" if kind == "angle" else "mm" for kind in plan.joint_kinds]
    columns = ["pose", *(f"{n} [{u}]" for n, u in zip(plan.joint_names, unit, strict=True))]
    rows = [
        (label, *(f"{x:.1f}" for x in a * scale), *(f"{x:.0f}" for x in w[:3]))
        for label, a, w in zip(plan.pose, plan.joints, plan.wrench, strict=True)
    ]
    return table("Measure", [*columns, "fx [N]", "fy [N]", "fz [N]"], rows)
