"""The 3-D scene of a result: the arm at every pose, with the gap before and after."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sk120stiff.explain import Explanation
from sk120stiff.identify import Fit
from sk120stiff.model import Model
from sk120stiff.show.scene.building import scene_of_model
from sk120stiff.show.scene.scene import Scene
from sk120stiff.show.stories.pictures import ArmView


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
    size = np.linalg.norm(load_cases.wrench[:, :3], axis=1)
    screws = load_cases.nominal
    views = []
    for k, label in enumerate(load_cases.poses):
        rows = np.flatnonzero(load_cases.pose == k)
        if not len(rows):
            continue
        row = int(rows[np.argmax(size[rows])])
        ends = [screws.frame_position[row], screws.position[row]]
        outline = np.vstack([np.zeros(3), screws.origins[row], *ends])
        views.append(ArmView(outline, {name: gap[row] for name, gap in gaps.items()}, label))
    return views
