"""Pictures of where an arm stands beside where it was read: every pose, and on the arm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import load_cases_of
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.model.pose_reading import instrument_frames
from sk120stiff.model.predicted import predict_channels
from sk120stiff.show.report import Block, SceneFrame
from sk120stiff.show.stories.gap_pictures import on_the_arm, per_pose, rms_of_poses
from sk120stiff.show.stories.pictures import ArmView
from sk120stiff.show.wording import counted


def pictures_of_poses(answer: Explained) -> list[Block]:
    """The gap of every pose and on the arm, before and after; none where no vectors were read."""
    final = answer.final
    readings = replace(answer.readings, use=answer.readings.use & ~final.wild).masked()
    models = {"after" if answer.findings else "model": final.model}
    if answer.findings:
        models = {"before": answer.base.model, **models}
    gaps = {name: gap_in_base_axes(model, readings) for name, model in models.items()}
    if not all(np.isfinite(gap).any() for gap in gaps.values()):
        return []
    load_cases = load_cases_of(final.model.robot, readings)
    poses, pose = load_cases.poses, load_cases.pose
    sizes = {name: _rms(gap, pose, len(poses)) for name, gap in gaps.items()}
    first = next(iter(gaps.values()))
    shown = {k: _worst(first, np.flatnonzero(pose == k)) for k in range(len(poses))}
    screws = load_cases.nominal
    views = [
        ArmView(
            np.vstack([np.zeros(3), screws.origins[row], screws.frame_position[row],
                       screws.position[row]]),
            {name: np.nan_to_num(gap[row]) for name, gap in gaps.items()},
            poses[k],
        )
        for k, row in shown.items()
    ]  # fmt: skip
    several = " of the reading that is farthest off" if readings.n_readings > len(poses) else ""
    return [per_pose(poses, sizes, final.problem.stated_sigma), on_the_arm(views, several)]


def arm_at_poses(answer: Explained, scene: str, link: str) -> list[Block]:
    """The scene in its frame, with what is to be seen in it; none of angles alone."""
    if not scene or not len(answer.final.problem.lengths):
        return []
    title = f"The arm at its {counted(len(answer.readings.masked().poses), 'pose')}"
    return [SceneFrame(scene, title, "Choose a pose; the arrows are its gap vectors.", link)]


def gap_in_base_axes(model: Model, readings: Measurements) -> Array:
    """(N, 3) measured minus predicted [m], turned into the robot's axes; NaN: not read."""
    gap = predict_channels(model, readings).gap(readings)
    read: Mask = np.isfinite(gap)
    load_cases = load_cases_of(model.robot, readings)
    if readings.absolute is not None and readings.absolute.channels.displacement is None:
        into = np.swapaxes(instrument_frames(model, load_cases)[0], 1, 2)
    else:
        into = load_cases.reading_axes
    turned: Array = np.einsum("nij,nj->ni", into, np.where(read, gap, 0.0))
    turned[~read.any(axis=1)] = np.nan
    return turned


def _rms(gap: Array, pose: Index, count: int) -> Array:
    read: Mask = np.isfinite(gap)
    return rms_of_poses(gap[read], pose[np.nonzero(read)[0]], count)


def _worst(gap: Array, rows: Index) -> int:
    size = np.linalg.norm(np.nan_to_num(gap[rows]), axis=1)
    return int(rows[np.argmax(size)])
