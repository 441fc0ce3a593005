"""The public verbs take positions as they take displacements."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain import Explained
from sk120stiff.identify import Calibration, known_model
from sk120stiff.model import Model
from sk120stiff.show import scene_of_model
from tests.positions.arm import Arm, Array, poses, tracked, write

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"
SIGMA = 2e-5


def read(tmp_path: Path, a: Array, arm: Arm | None = None) -> tuple[sk.Robot, sk.Measurements]:
    x = tracked((arm or Arm()).stands(a)[0])
    x = x + SIGMA * np.random.default_rng(7).normal(size=x.shape)
    data = sk.read(write(tmp_path, a, x, FIT + NOISE))
    return sk.load_robot(str(data.robot), base="base", tool="tool"), data


def test_fit_and_predict_say_where_the_marker_stands(tmp_path: Path) -> None:
    robot, readings = read(tmp_path, poses(40, 70))
    model = sk.base_model(robot)
    with pytest.raises(InputError, match="where the tracker stands"):
        sk.predict(model, readings)
    found = sk.fit(model, readings)
    assert isinstance(found, Calibration) and isinstance(found, sk.Fit)
    assert found.rms < 2.0 * SIGMA and found.misfit is not None
    assert repr(found).startswith("<Calibration: ") and len(repr(found)) < 300
    assert len(found.to_frame()) == len(found.parameters)
    said = sk.predict(found.model, readings)
    assert repr(said) == "<Predicted: 40 positions>"
    assert said.position is not None and said.rotation is not None
    assert said.rotation.shape == (40, 3, 3)
    gap = said.gap(readings)
    np.testing.assert_allclose(gap.ravel(), found.gap, atol=1e-9)
    told = known_model(found).uncertainty
    assert told is not None and told.noise == pytest.approx(SIGMA)
    kept = "joint_springs:j2.stiffness"
    held = sk.fit(model, readings, fix=[kept])
    assert kept not in {p.name for p in held.parameters}


def test_a_scene_shows_the_gap_of_every_position(tmp_path: Path) -> None:
    """In base axes, from where the last model has the marker; blank cells have no arrow."""
    robot, readings = read(tmp_path, poses(40, 70))
    before = sk.fit(sk.base_model(robot), readings.select(np.arange(20))).model
    found = sk.fit(sk.base_model(robot), readings)
    scene = scene_of_model(found.model, readings, models={"before": before, "model": found.model})
    shown = [reading for pose in scene.poses for reading in pose.readings]
    gap = np.array([reading.measured for reading in shown])
    lengths = np.linalg.norm(found.gap.reshape(-1, 3), axis=1)
    np.testing.assert_allclose(np.linalg.norm(gap, axis=1), lengths, rtol=1e-4, atol=1e-9)
    assert not any(reading.predicted["model"].any() for reading in shown)
    apart = np.array([reading.predicted["before"] for reading in shown])
    assert 0.0 < np.abs(apart).max() < 1e-3
    read_of = sk.predict(found.model, readings).position
    at = sk.predict(before, readings).position
    np.testing.assert_allclose(  # the frames of both differ by far less than what they tell
        np.linalg.norm(apart, axis=1), np.linalg.norm(at - read_of, axis=1), atol=3e-4
    )
    bare = scene_of_model(sk.base_model(robot), readings)  # where the tracker stands is not known
    assert all(reading.measured is None for pose in bare.poses for reading in pose.readings)


def test_explain_names_saves_and_reports(tmp_path: Path) -> None:
    waves = np.zeros((6, 2))
    waves[2] = 3e-4, 0.0
    robot, readings = read(tmp_path, poses(40, 70), Arm(waves=waves))
    rows = np.arange(readings.n_readings)
    answer = sk.explain(
        Model(robot), readings.select(rows[:34]), holdout=readings.select(rows[34:])
    )
    assert isinstance(answer, Explained)
    assert [item.effect.id for item in answer.findings] == ["transmission_error:j3"]
    assert repr(answer).startswith(f"<Explained: {answer.verdict} transmission_error:j3; gap ")
    assert answer.heldout is not None and answer.heldout.rms < 3.0 * SIGMA
    assert answer.next_readings() is None
    written = answer.save(tmp_path / "out")
    assert json.loads((tmp_path / "out" / "verdict.json").read_text()) == json.loads(
        json.dumps(written, default=float)
    )
    assert (tmp_path / "out" / "model.yaml").exists()
    answer.report(tmp_path / "report.html")
    assert "transmission" in (tmp_path / "report.html").read_text()


def test_what_does_nothing_for_such_readings_is_refused(tmp_path: Path) -> None:
    robot, readings = read(tmp_path, poses(12, 70))
    model = sk.base_model(robot)
    for wrong in ({"robust": True}, {"method": "lm"}, {"noise": sk.NoiseModel(1e-5)}):
        with pytest.raises(InputError, match="for displacements"):
            sk.fit(model, readings, **wrong)
    with pytest.raises(InputError, match="alpha is for displacements"):
        sk.explain(model, readings, options=sk.Options(alpha=0.1))
    loaded = sk.read(sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv")
    with pytest.raises(InputError, match="are displacements"):
        sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), loaded, waves=False)
    with pytest.raises(InputError, match="held-out readings are no positions"):
        sk.explain(model, readings, holdout=loaded)
