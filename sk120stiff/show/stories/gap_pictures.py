"""The gap of every pose, and on the arm: before and after what was named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.show.figures import gap_per_pose
from sk120stiff.show.report import Picture
from sk120stiff.show.stories.pictures import ArmView, exaggeration, gap_vectors
from sk120stiff.show.wording import counted, um

MANY = 40  # poses beyond which bars are no longer told apart


def per_pose(poses: Sequence[str], gaps: Mapping[str, Array], floor: float | None) -> Picture | str:
    """Bars of every pose, one for each model; of many poses a sentence.

    Args:
        poses: Their labels.
        gaps: Model → (poses,) rms gap [m].
        floor: What the noise alone makes [m], where that is known.
    """
    if len(poses) > MANY:
        worst = {name: um(float(values.max())) for name, values in gaps.items()}
        told = ", ".join(f"{size} µm {name}" for name, size in worst.items())
        if len(worst) == 1:  # a page with one model has no other to tell it from
            told = f"{next(iter(worst.values()))} µm"
        return f"There are {counted(len(poses), 'pose')}; the largest gap of one is {told}."
    told = "; ".join(
        f"{name} {um(float(values.min()))} to {um(float(values.max()))} µm"
        for name, values in gaps.items()
    )
    return Picture(
        lambda: gap_per_pose(poses, gaps, noise_floor=floor),
        alt=f"Bars of the rms gap of {len(poses)} poses: {told}.",
        caption="The gap of every pose.",
    )


def on_the_arm(views: Sequence[ArmView], at: str = "") -> Picture:
    """Gap vectors on the arm of every pose; of many poses of those with the largest gaps.

    Args:
        views: The poses; the first of their gaps ranks them.
        at: Which of its readings each pose shows, in words.
    """
    names = list(views[0].gaps)
    ranked = sorted(views, key=lambda view: -float(np.linalg.norm(view.gaps[names[0]])))
    shown = ranked[:MANY]
    largest = {
        name: um(max(float(np.linalg.norm(view.gaps[name])) for view in shown)) for name in names
    }
    told = ", ".join(f"up to {value} µm {name}" for name, value in largest.items())
    which = "every pose" if len(shown) == len(views) else f"the {MANY} poses with the largest gaps"
    times = f"{exaggeration(shown):,.0f}".replace(",", "\u00a0")
    return Picture(
        lambda: gap_vectors(shown),
        alt=f"The arm at {len(shown)} poses from above and from the side, with gap vectors {told}.",
        caption=f"Gap vectors{at} of {which}, drawn {times} times too long.",
    )


def rms_of_poses(gap: Array, pose: Index, count: int) -> Array:
    """(count,) rms of the numbers (M,) of each pose; 0 of a pose without any."""
    total = np.bincount(pose, gap**2, minlength=count)
    return np.asarray(np.sqrt(total / np.maximum(np.bincount(pose, minlength=count), 1)))
