"""The 3-D scene of a result: the arm at every pose, with the gap before and after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from sk120stiff.effects import LoadCases
from sk120stiff.explain import Explanation
from sk120stiff.identify import Fit
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.plan import Cell, Route, straight_on
from sk120stiff.show.scene.building import scene_of_model
from sk120stiff.show.scene.scene import Scene, ScenePath
from sk120stiff.show.scene.surroundings import surroundings_of
from sk120stiff.show.stories.pictures import ArmView
from sk120stiff.show.wording import counted, number

UNCHECKED = (
    "The straight ways from pose to pose were not checked for collisions: 'sk120stiff plan "
    "--check' of the written plan does, and 'plan --program' finds ways that are free."
)


def models_of(answer: Explanation) -> dict[str, Model]:
    """Models to compare, before and after; only one where nothing was added."""
    if not answer.findings:
        return {"model": answer.base.model}
    return {"before": answer.base.model, "after": answer.final.model}


def explain_scene(answer: Explanation, *, subtitle: str = "", model_file: str = "") -> Scene:
    """The arm of the final model at every pose, with measured, predicted and gap vectors."""
    return scene_of_model(
        answer.final.model,
        answer.base.problem.measurements,
        models=models_of(answer),
        title=answer.base.model.robot.name,
        subtitle=subtitle,
        model_file=model_file,
        named=[finding.effect for finding in answer.findings],
    )


def identify_scene(
    fit: Fit, before: Model, *, names: tuple[str, str], subtitle: str = "", model_file: str = ""
) -> Scene:
    """The arm with identified springs at every pose, beside what an earlier model predicts."""
    return scene_of_model(
        fit.model,
        fit.problem.measurements,
        models={names[0]: before, names[1]: fit.model},
        title=fit.model.robot.name,
        subtitle=subtitle,
        model_file=model_file,
    )


def plan_scene(model: Model, plan: Measurements, cell: Cell, driven: Route | None = None) -> Scene:
    """The arm at every pose of a plan, in its order, with the loads there and what stands around.

    The point's way between the poses, of several markers that of the first, is that of joints that
    go straight, by the via points of `driven` where there are any.
    """
    said = f"{counted(len(plan.poses), 'pose')} in their order, {_loads(plan)}"
    if cell.source:
        said += f"; around it what {Path(cell.source).name} states"
    if driven is None and len(plan.poses) > 1:
        said += f". {UNCHECKED}"
    scene = scene_of_model(model, plan, title=f"{model.robot.name}: plan", subtitle=said)
    stands = np.array([pose.a for pose in scene.poses]) if driven is None else driven.a
    a, reached = straight_on(model.robot, stands)
    planned = np.ones(len(stands), dtype=bool) if driven is None else driven.pose >= 0
    at = model.robot.screws(a, point=scene.point).position
    point = "point" if plan.absolute is None else f"marker {plan.absolute.markers[0]}".rstrip()
    path = ScenePath(
        at, at, 0, said=f"first: {plan.poses[0]}", freedom="", mark=f"the first pose's {point}",
        stops=tuple(int(k) for k in reached[planned]),
    )  # fmt: skip
    around = surroundings_of(cell, model.robot, scene.tree)
    return replace(scene, path=path, surroundings=around, listed="plan")


def _loads(plan: Measurements) -> str:
    """What acts at the poses, and on which markers: a payload counts once, whoever reads it."""
    told = plan.absolute
    if told is None:
        return counted(plan.n_readings, "load")
    masses = [f"{number(mass)} kg" for mass in sorted(set(told.payload.tolist()))]
    names = list(dict.fromkeys(told.markers))
    said = "no payload"
    if len(masses) > 1:
        said = f"{len(masses)} payloads ({', '.join(masses)})"
    elif told.payload.any():
        said = f"payload {masses[0]}"
    return f"{said}, {len(names)} markers ({', '.join(names)})" if len(names) > 1 else said


def largest_loads(load_cases: LoadCases) -> dict[str, int]:
    """Pose → its row with the largest force."""
    size = np.linalg.norm(load_cases.wrench[:, :3], axis=1)
    rows = {label: np.flatnonzero(load_cases.pose == k) for k, label in enumerate(load_cases.poses)}
    return {label: int(own[np.argmax(size[own])]) for label, own in rows.items() if len(own)}


def arm_views(fit: Fit, models: Mapping[str, Model]) -> list[ArmView]:
    """Every pose as a line through the arm, with the gaps of its largest load.

    A gap has only the axes that were read.
    """
    load_cases = fit.problem.load_cases
    measured, read = fit.problem.measured, fit.problem.read
    axes = load_cases.reading_axes
    gaps = {
        name: np.einsum(
            "nij,nj->ni", axes, np.where(read, measured - model.predict(load_cases), 0.0)
        )
        for name, model in models.items()
    }
    screws = load_cases.nominal
    views = []
    for label, row in largest_loads(load_cases).items():
        ends = [screws.frame_position[row], screws.position[row]]
        outline = np.vstack([np.zeros(3), screws.origins[row], *ends])
        views.append(ArmView(outline, {name: gap[row] for name, gap in gaps.items()}, label))
    return views
