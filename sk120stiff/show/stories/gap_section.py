"""The gap step by step, pose by pose, and on the arm."""

from __future__ import annotations

from sk120stiff.arrays import Array
from sk120stiff.explain import Explanation
from sk120stiff.explain.answer.words import held_out_words, plain_words
from sk120stiff.identify import Fit
from sk120stiff.model import Model
from sk120stiff.show.figures import gap_waterfall
from sk120stiff.show.report import Block, Picture, SceneFrame, Section, Table
from sk120stiff.show.stories.gap_pictures import on_the_arm, per_pose, rms_of_poses
from sk120stiff.show.stories.scenes import arm_views, models_of
from sk120stiff.show.wording import counted, percent, um


def gap_section(
    answer: Explanation, *, heldout: str, scene: str = "", scene_link: str = ""
) -> Section:
    """Table and waterfall of the steps, the gap of every pose, the gap vectors.

    Args:
        heldout: What the held-out gap was taken on, in words.
        scene, scene_link: Text of the scene's page, and its address beside the report.
    """
    floor = answer.noise_floor
    blocks: list[Block] = [
        "The gap is measured minus predicted displacement, root mean square over readings and "
        f"axes. The held-out gap is taken {heldout}: readings that had no part in the fit. "
        + (
            "The noise is unknown."
            if floor is None
            else f"Noise alone makes about {um(floor)} µm; a model that is right comes near that, "
            "by chance a little below or above."
        ),
        steps_table(answer),
        *plain_words(answer),
        *held_out_words(answer),
    ]
    if len(answer.steps) > 1:
        blocks.append(waterfall(answer))
    models = models_of(answer)
    poses = answer.base.problem.load_cases.poses
    gaps = {name: pose_rms(answer.base, model) for name, model in models.items()}
    views = arm_views(answer.base, models)
    blocks += [per_pose(poses, gaps, floor), on_the_arm(views, " at the largest load")]
    if scene:
        title = f"The arm at its {counted(len(answer.base.problem.load_cases.poses), 'pose')}"
        caption = "Choose a pose and a load: measured, predicted and gap vectors, before and after."
        blocks.append(SceneFrame(scene, title, caption if answer.findings else "", scene_link))
    return Section("The gap, step by step", blocks)


def steps_table(answer: Explanation) -> Table:
    """Fitted and held-out gap of every step, and the share of the first gap that is closed."""
    first = answer.steps[0]
    rows = [
        (
            step.label,
            1e6 * step.fit_rms,
            1e6 * step.heldout_rms,
            "–" if step is first else percent(1.0 - step.heldout_rms / first.heldout_rms),
        )
        for step in answer.steps
    ]
    width = 4 if len(rows) > 1 else 3  # a first step alone closes nothing
    return Table(
        ["model", "fitted", "held out", "closed, held out"][:width],
        [row[:width] for row in rows],
        "Gap rms per axis; every step is refitted at exact equilibrium.",
        units=["", "µm", "µm", ""][:width],
        digits=3,
    )


def waterfall(answer: Explanation) -> Picture:
    """The gap falling from step to step, fitted and held out, over what noise alone makes."""
    floor = answer.noise_floor
    steps = answer.steps
    first, last = steps[0], steps[-1]
    return Picture(
        lambda: gap_waterfall(steps, noise_floor=floor),
        alt=f"Bars of the gap of {len(steps)} models. Fitted: from {um(first.fit_rms)} to "
        f"{um(last.fit_rms)} µm. Held out: from {um(first.heldout_rms)} to "
        f"{um(last.heldout_rms)} µm." + ("" if floor is None else f" Noise floor {um(floor)} µm."),
        caption="Bars: readings that were fitted. Diamonds: poses left out.",
    )


def pose_rms(fit: Fit, model: Model) -> Array:
    """(poses,) rms gap per axis of a model on the readings of a fit [m]."""
    gap = (fit.problem.measured - model.predict(fit.problem.load_cases))[fit.problem.read]
    return rms_of_poses(gap, fit.problem.pose, len(fit.problem.load_cases.poses))
