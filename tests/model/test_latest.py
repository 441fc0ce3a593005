"""What was predicted last is not worked out again, and is not mixed up with anything else."""

from __future__ import annotations

import gc
import weakref

import numpy as np

import sk120stiff as sk
from sk120stiff.effects import load_case, load_cases_of
from sk120stiff.effects.latest import KEPT

HOME = sk.bundled_robots()["motoman_sk120"]
MODEL = sk.base_model(sk.load_robot("motoman_sk120"))
POSES = np.random.default_rng(1).uniform(-0.4, 0.4, (5, 6))
LOADS = np.tile([0.0, 0.0, -300.0, 0.0, 0.0, 0.0], (5, 1))


def test_a_second_call_gives_the_same_numbers_in_arrays_of_its_own() -> None:
    cases = load_case(MODEL.robot, POSES, LOADS)
    first, slopes = MODEL.predict_with_sensitivities(cases)
    kept = first.copy(), slopes.copy()
    first[:], slopes[:] = 0.0, 0.0
    again, slopes_again = MODEL.predict_with_sensitivities(cases)
    assert np.array_equal(again, kept[0])
    assert np.array_equal(slopes_again, kept[1])
    assert np.array_equal(MODEL.predict(cases), kept[0])


def test_other_values_other_effects_and_other_readings_are_other_predictions() -> None:
    cases = load_case(MODEL.robot, POSES, LOADS)
    first, _ = MODEL.predict_with_sensitivities(cases)
    softer, _ = MODEL.predict_with_sensitivities(cases, 2.0 * MODEL.values)
    assert np.allclose(softer, 2.0 * first, rtol=0.01)
    rocking = MODEL + sk.effect(MODEL.robot, "base_rocking")
    assert rocking.predict_with_sensitivities(cases)[1].shape[2] > len(MODEL.values)
    turned = load_case(MODEL.robot, -POSES, LOADS)
    assert not np.allclose(MODEL.predict_with_sensitivities(turned)[0], first, rtol=1e-3)


def test_few_are_kept_and_none_outlives_its_readings() -> None:
    cases = load_case(MODEL.robot, POSES, LOADS)
    for factor in range(1, KEPT + 3):
        MODEL.predict_with_sensitivities(cases, factor * MODEL.values)
    assert len(cases.latest.known) == KEPT
    assert cases.latest.get(MODEL.effects, MODEL.values) is None
    gone = weakref.ref(cases)
    del cases
    gc.collect()
    assert gone() is None


def test_readings_do_not_outlive_an_explanation() -> None:
    readings = sk.read(HOME / "data/table2_measured.csv")
    assert sk.explain(MODEL, readings).verdict == "none"
    gone = weakref.ref(readings), weakref.ref(load_cases_of(MODEL.robot, readings))
    del readings
    gc.collect()
    assert gone[0]() is None
    assert gone[1]() is None


def test_readings_have_the_same_load_cases_as_long_as_the_robot_is_the_same() -> None:
    readings = sk.read(HOME / "data/table2_measured.csv")
    own = load_cases_of(MODEL.robot, readings)
    assert load_cases_of(MODEL.robot, readings) is own
    other = sk.load_robot("motoman_sk120")
    assert load_cases_of(other, readings).robot is other
    assert own.blocks(4) is own.blocks(4)
    assert np.array_equal(np.concatenate([part.a for part in own.blocks(4)]), own.a)


def test_loads_at_one_pose_begin_where_each_alone_would() -> None:
    """An arm that sags: its rest without load is sought once for all loads of a pose."""
    robot = sk.load_robot("ur5e")
    model = sk.base_model(robot)
    assert robot.total_mass > 0.0
    poses = np.repeat(POSES, 3, axis=0)
    loads = np.tile([[50.0, 0, 0, 0, 0, 0], [0, 80.0, 0, 0, 0, 0], [0, 0, -90.0, 0, 0, 0]], (5, 1))
    together = model.predict_with_sensitivities(load_case(robot, poses, loads))
    alone = [
        model.predict_with_sensitivities(load_case(robot, poses[k : k + 1], loads[k : k + 1]))
        for k in range(len(poses))
    ]
    for part in (0, 1):
        expected = np.concatenate([each[part] for each in alone])
        assert np.allclose(together[part], expected, rtol=1e-9, atol=1e-15)
