"""Where positions were explained: pictures, scene and gaps tell one gap for every pose."""

from __future__ import annotations

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain import Explained
from sk120stiff.model.predicted import predict_channels
from sk120stiff.show.report import Picture, SceneFrame
from sk120stiff.show.scene.building import scene_of_model
from sk120stiff.show.stories.positions_pictures import (
    arm_at_poses,
    gap_in_base_axes,
    pictures_of_poses,
)
from tests.positions.arm import NAMES, errors, poses, tracked, write

FIT = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 20, unit: um}\n"
)
COUNT = 36


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Explained:
    """An arm whose joint frames are off, read by a tracker that stands anywhere."""
    arm, a = errors(3), poses(COUNT, 8)
    seen = tracked(arm.stands(a)[0])
    seen += 2e-5 * np.random.default_rng(1).normal(size=seen.shape)
    data = sk.read(write(tmp_path_factory.mktemp("positions"), a, seen, FIT)).with_joints(NAMES)
    found = sk.explain(sk.Model(sk.load_robot(data.robot, base="base", tool="tool")), data)
    assert isinstance(found, Explained) and found.findings
    return found


def lengths(model: sk.Model, answer: Explained) -> np.ndarray:
    """(N,) how far the instrument reads the marker from where a model says [m]."""
    said = predict_channels(model, answer.readings).position
    assert answer.readings.absolute is not None
    return np.linalg.norm(answer.readings.absolute.channels.position - said, axis=1)


def test_the_gap_turns_into_the_axes_of_the_base(answer: Explained) -> None:
    for model in (answer.base.model, answer.final.model):
        gap = gap_in_base_axes(model, answer.readings)
        np.testing.assert_allclose(
            np.linalg.norm(gap, axis=1), lengths(model, answer), rtol=1e-9, atol=1e-12
        )


def test_the_scene_has_the_gap_that_each_model_leaves(answer: Explained) -> None:
    """Both place the tracker themselves: from one frame the first would be millimetres off."""
    models = {"before": answer.base.model, "after": answer.final.model}
    scene = scene_of_model(answer.final.model, answer.readings, models=models)
    for name, model in models.items():
        shown = [
            np.linalg.norm(reading.measured - reading.predicted[name])
            for pose in scene.poses
            for reading in pose.readings
            if reading.measured is not None
        ]
        np.testing.assert_allclose(shown, lengths(model, answer), rtol=1e-6, atol=1e-9)


def test_the_report_shows_every_pose_and_the_arm(answer: Explained) -> None:
    bars, arm = pictures_of_poses(answer)
    assert isinstance(bars, Picture) and isinstance(arm, Picture)
    assert f"{COUNT} poses" in bars.alt and "before" in bars.alt and "after" in bars.alt
    largest = 1e6 * lengths(answer.base.model, answer).max()
    assert f"up to {largest:.0f} µm before" in arm.alt.replace("\u00a0", "")
    for picture in (bars, arm):
        assert picture.figure() is not None


def test_the_scene_stands_in_the_report_where_there_is_one(answer: Explained) -> None:
    assert arm_at_poses(answer, "", "") == []
    (frame,) = arm_at_poses(answer, "<html></html>", "scene.html")
    assert isinstance(frame, SceneFrame) and f"{COUNT} poses" in frame.title
    page = answer.report(scene="<html></html>", scene_link="scene.html").html()
    assert 'href="scene.html"' in page
