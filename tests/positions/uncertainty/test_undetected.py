"""A spring that positions do not show is not rigid for that: who goes to other loads is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import effect, load_case
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.uncertainty.undetected import beside_not_named
from sk120stiff.model.predicted import predict_what_holds, unknown_reasons
from tests.positions.test_payload_place import hung, robot_of

NOT_TURNED = "joint_springs:j1.stiffness"  # its axis is upright, and masses pull down


def test_a_model_for_loads_sideways_knows_which_springs_it_does_not_know(tmp_path: Path) -> None:
    path = hung(tmp_path, [0.0, 30.0, 60.0], "payload: {point: {xyz: [60, -40, 250], unit: mm}}\n")
    robot, data = robot_of(path), sk.read(path)
    found = sk.explain(sk.Model(robot), data)
    assert isinstance(found, Explained)
    assert {each.id for each in found.rigid} >= {"joint_springs:j1", "joint_springs:j6"}
    assert not {each.id for each in found.rigid} & {each.id for each in found.final.model.effects}
    found.save(tmp_path)
    model = sk.read_model(tmp_path / "model.yaml")
    assert np.isinf(model.parameter(NOT_TURNED).value)
    down, sideways = [0, 0, -200, 0, 0, 0], [0, 200, 0, 0, 0, 0]
    pose = np.array(data.joints[0])
    for wrench, known in ((down, True), (sideways, False)):
        told = predict_what_holds(model, load_case(robot, pose, np.array(wrench, dtype=float)))
        (reason,) = unknown_reasons(told)
        assert (reason == "") == known
        assert known or NOT_TURNED in reason
        assert np.isfinite(told.std_parameters).all() == known


def test_what_was_named_keeps_its_value_and_its_errors(tmp_path: Path) -> None:
    path = hung(tmp_path, [0.0, 30.0, 60.0], "payload: {point: {xyz: [60, -40, 250], unit: mm}}\n")
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    before = {p.name: p for p in found.final.parameters}
    wide = beside_not_named(found.final, found.rigid)
    for p in wide.parameters:
        if p.name in before:
            own = before[p.name]
            assert p.internal == own.internal
            assert own.internal_std is not None and p.internal_std is not None
            assert 0.999 * own.internal_std <= p.internal_std < 1.5 * own.internal_std
    assert wide.rms == found.final.rms
    assert (wide.form, wide.notes) == (found.final.form, found.final.notes)


def test_what_stands_fixed_beside_keeps_its_value(tmp_path: Path) -> None:
    """It was set to zero where it could not be told apart: 1 mm of an axis, a gap 39 times σ."""
    path = hung(tmp_path, [0.0, 30.0, 60.0])
    robot, data = robot_of(path), sk.read(path)
    model = (sk.Model(robot) + effect(robot, "joint_frame", "j4")).with_public(
        {"joint_frame:j4.z": 1e-3}
    )
    found = sk.fit(model, data, fix=["joint_frame:j4.z"])
    assert isinstance(found, Calibration)
    wide = beside_not_named(found, [effect(robot, "joint_springs", "j1")])
    assert wide.model.parameter("joint_frame:j4.z").internal == 1e-3
    np.testing.assert_array_equal(wide.residual, found.residual)


def test_names_that_do_not_exist_are_refused_for_positions_too(tmp_path: Path) -> None:
    path = hung(tmp_path, [0.0, 30.0, 60.0])
    model, data = sk.Model(robot_of(path)), sk.read(path)
    for wish in (sk.Options(only=("joint_spring",)), sk.Options(exclude=("joint_springs:j9",))):
        with pytest.raises(sk.InputError, match="joint_spring"):
            sk.explain(model, data, options=wish)
    with pytest.raises(sk.InputError, match="no parameter 'nosuch'"):
        sk.fit(model, data, fix=["nosuch"])
