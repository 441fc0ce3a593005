"""What a model knows of its own uncertainty: file, propagation, and what it does not claim."""

from __future__ import annotations

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
import yaml

from sk120stiff.effects import effect, load_case
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.model import (
    Model,
    Remainder,
    Uncertainty,
    joint_spring_model,
    model_from_text,
    model_text,
    predict_with_uncertainty,
)
from sk120stiff.model.uncertainty import spread
from sk120stiff.robot import load_robot

POSES = np.array([[0.3, 0.2, -0.4, 0.1, 0.5, 0.0], [-0.7, 0.5, -0.1, 1.0, -0.6, 0.3]])
LOADS = np.array([[200.0, -100.0, -350.0, 0, 0, 0], [-50.0, 300.0, 100.0, 0, 0, 0]])


@pytest.fixture(scope="module")
def model() -> Model:
    robot = load_robot("motoman_sk120")
    plain = joint_spring_model(robot, [1.4e6, 4e5, 9e5, np.inf, np.inf, np.inf])
    return plain.known(knowledge(plain))


def knowledge(model: Model, **changes: object) -> Uncertainty:
    std = 0.1 * model.values
    correlation = np.array([[1.0, 0.6, -0.3], [0.6, 1.0, 0.1], [-0.3, 0.1, 1.0]])
    parts = {
        "names": model.names,
        "values": model.values,
        "covariance": correlation * np.outer(std, std),
        "unseen": np.zeros((0, 3)),
        "noise": 10e-6,
        "remainder": Remainder(
            rms=np.array([1e-5, 2e-5, 1e-5]),
            upper=np.array([2e-5, 3e-5, 1e-5]),
            freedom=np.full(3, 40.0),
            load=250.0,
            length=2.0,
            grows=True,
            probability=0.0,
            significant=True,
        ),
        "source": "90 readings at 18 poses; noise stated, 10 µm per axis",
    }
    return Uncertainty(**{**parts, **changes})


def test_what_is_written_is_read(model: Model) -> None:
    again = model_from_text(model_text(model)).uncertainty
    known = model.uncertainty
    assert again.names == known.names and again.source == known.source
    np.testing.assert_allclose(again.covariance, known.covariance, rtol=1e-8)
    np.testing.assert_allclose(again.remainder.rms, known.remainder.rms, rtol=1e-8)
    assert again.remainder.grows and again.freedom is None
    assert np.isclose(again.noise, 1e-5, rtol=1e-8, atol=0.0)
    told = knowledge(model, unseen=np.array([[1e-7, 0.0, -1e-7]]), freedom=12.0, remainder=None)
    again = model_from_text(model_text(model.known(told))).uncertainty
    np.testing.assert_allclose(again.unseen, told.unseen)
    assert again.remainder is None and again.freedom == 12.0


def test_a_correlation_of_nearly_one_survives_the_file(model: Model) -> None:
    std = 0.2 * model.values
    near = np.full((3, 3), 0.9999999) + 1e-7 * np.eye(3)
    told = knowledge(model, covariance=near * np.outer(std, std))
    again = model_from_text(model_text(model.known(told))).uncertainty
    weights = np.array([1.0, -1.0, 0.0]) / std
    np.testing.assert_allclose(
        weights @ again.covariance @ weights, weights @ told.covariance @ weights, rtol=1e-3
    )


EDITS = {
    "a value changed": (r"value: (4000|3999)\S*", "value: 500000.0"),
    "an effect taken out": (r"- name: joint_springs\n  where: joint_3_u\n(  .*\n)+", ""),
    "an effect added": (
        r"provenance:",
        "- name: tool_compliance\n  where: tool0\n  parameters:\n"
        + "".join(
            f"    stiffness_{kind}_{axis}: {{value: .inf, unit: {unit}}}\n"
            for kind, unit in (("turn", "N*m/rad"), ("shift", "N/m"))
            for axis in "xyz"
        )
        + "provenance:",
    ),
}


@pytest.mark.parametrize("edit", EDITS)
def test_a_model_edited_by_hand_loads_without_its_uncertainty_and_says_so(
    model: Model, edit: str
) -> None:
    text, count = re.subn(*EDITS[edit], model_text(model))
    assert count == 1
    with pytest.warns(ToolkitWarning, match=r"uncertainty: dropped, because .*identified again"):
        read = model_from_text(text)
    assert read.uncertainty is None and read.parameters


def test_a_note_or_a_flag_by_hand_keeps_it(model: Model) -> None:
    text = model_text(model).replace("free: true", "free: false").replace("origin: given", "")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert model_from_text(text).uncertainty is not None


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (("correlation", 1, 0), 1.4, "between -1 and 1"),
        (("correlation", 1), [0.6, 1.0, 0.1], "lower triangle"),
        (("correlation",), [[1.0], [0.9, 1.0], [-0.9, 0.9, 1.0]], "positive semi-definite"),
        (("parameters", 0, "std"), -1.0, "greater than or equal to 0"),
        (("parameters", 0, "std"), None, "not named under 'unseen'"),
        (("parameters", 0, "unit"), "mrad", "not in 'rad/"),
        (("noise_um",), 0.0, "not positive"),
        (("remainder", "rms_um"), [1.0, 2.0], "at least 3"),
        (("unseen",), [{"joint_springs:joint_9.stiffness": 1.0}], "joint_9"),
    ],
)
def test_an_impossible_uncertainty_is_refused_by_name(
    model: Model, path: tuple[str | int, ...], value: object, said: str
) -> None:
    document = yaml.safe_load(model_text(model))
    place = document["uncertainty"]
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(InputError, match=said) as caught:
        model_from_text(yaml.safe_dump(document), where="m.yaml")
    assert "m.yaml" in str(caught.value)


def test_a_changed_model_keeps_no_uncertainty(model: Model) -> None:
    assert (model + effect(model.robot, "base_rocking")).uncertainty is None
    assert model.without("joint_springs:joint_1_s").uncertainty is None
    assert model.with_values(model.values).uncertainty is None
    assert model.physical().uncertainty is not None


def test_std_of_a_prediction_is_that_of_predictions_over_drawn_parameters(model: Model) -> None:
    """First order against exact predictions at 600 draws; springs known to a tenth."""
    load_cases = load_case(model.robot, POSES, LOADS)
    found = predict_with_uncertainty(model, load_cases)
    rng = np.random.default_rng(3)
    drawn = rng.multivariate_normal(model.values, model.uncertainty.covariance, size=600)
    exact = np.array([model.predict(load_cases, values) for values in drawn])
    np.testing.assert_allclose(found.std_parameters, exact.std(axis=0), rtol=0.1)
    np.testing.assert_allclose(found.displacement, model.predict(load_cases))


def test_the_remainder_turns_with_the_axes_of_the_readings_and_grows_with_the_load(
    model: Model,
) -> None:
    load_cases = load_case(model.robot, POSES, LOADS)
    base = predict_with_uncertainty(model, load_cases)
    size = np.linalg.norm(LOADS[:, :3], axis=1, keepdims=True)
    np.testing.assert_allclose(base.std_remainder, np.array([[2e-5, 3e-5, 1e-5]]) * size / 250.0)
    moments = np.concatenate([np.zeros((2, 3)), 2.0 * LOADS[:, :3]], axis=1)  # at a lever of 2 m
    found = predict_with_uncertainty(model, load_case(model.robot, POSES, moments))
    np.testing.assert_allclose(found.std_remainder, base.std_remainder)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = replace(load_cases, reading_axes=np.broadcast_to(quarter, (2, 3, 3)))
    found = predict_with_uncertainty(model, turned)
    np.testing.assert_allclose(found.std_remainder, base.std_remainder[:, [1, 0, 2]])
    steady = replace(model.uncertainty.remainder, grows=False)
    found = predict_with_uncertainty(model.known(knowledge(model, remainder=steady)), load_cases)
    np.testing.assert_allclose(found.std_remainder, np.tile([2e-5, 3e-5, 1e-5], (2, 1)))
    hidden = replace(model.uncertainty.remainder, significant=False, probability=0.6)
    found = predict_with_uncertainty(model.known(knowledge(model, remainder=hidden)), load_cases)
    np.testing.assert_allclose(found.std_remainder, base.std_remainder * np.sqrt(0.5))


def test_what_may_hide_counts_by_its_probability(model: Model) -> None:
    """Even odds beforehand; 1 / (-e p ln p), the most that a p value says, is 2.46 at 0.05."""
    left = model.uncertainty.remainder
    shares = [replace(left, probability=p).share for p in (1.0, 0.4, 0.05, 1e-4, 0.0)]
    np.testing.assert_allclose(shares, [0.5, 0.5, 0.7106, 0.9975, 1.0], atol=1e-4)


def test_what_does_not_show_is_unknown_only_where_it_matters(model: Model) -> None:
    """Springs 2 and 3 known by a combination alone: along it nothing is lost, across it all is."""
    size = model.values
    blind = np.array([[0.0, size[1], -size[2]]])
    told = model.known(knowledge(model, unseen=blind))
    load_cases = load_case(model.robot, POSES, LOADS)
    found = predict_with_uncertainty(told, load_cases)
    assert np.isinf(found.std_parameters).any(axis=1).all()
    assert found.blame[0] == tuple(model.names[1:])
    known = told.uncertainty
    L, B = known.factors(model.names)
    along = np.array([[0.0, 1.0 / size[1], 1.0 / size[2]], [1.0 / size[0], 0.0, 0.0]])
    assert np.isfinite(spread(along @ L, along @ B, 0.0)).all()
    np.testing.assert_allclose(spread(along @ L, along @ B, 0.0)[1], 0.1)


def test_what_does_not_show_and_moves_little_is_added() -> None:
    seen, unseen = np.array([[3.0, 4.0], [3.0, 4.0]]), np.array([[1.0], [2.0]])
    np.testing.assert_allclose(spread(seen, unseen, 0.0), [np.sqrt(26.0), np.inf])
    np.testing.assert_allclose(spread(seen, unseen, 4.0), np.sqrt([26.0, 29.0]))


def test_an_interval_is_wider_where_the_noise_is_estimated(model: Model) -> None:
    """Tables of the normal distribution and of Student's with five degrees of freedom."""
    assert knowledge(model).reach(0.95) == pytest.approx(1.95996, abs=1e-5)
    assert knowledge(model, freedom=5.0).reach(0.95) == pytest.approx(2.57058, abs=1e-5)


def test_a_model_without_uncertainty_predicts_as_before(model: Model) -> None:
    plain = model.with_values(model.values)
    found = predict_with_uncertainty(plain, load_case(model.robot, POSES, LOADS))
    assert found.std is None and found.std_parameters is None and found.std_remainder is None
    assert "uncertainty" not in yaml.safe_load(model_text(plain))
