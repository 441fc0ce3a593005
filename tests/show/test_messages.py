"""The live server takes numbers in range and nothing else, whatever is thrown at it."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.errors import InputError
from sk120stiff.show.live.messages import Bounds, read_request

BOUNDS = Bounds(
    a=np.array([[-1.0, 1.0], [0.0, 2.0]]),
    wrench=np.array([[-100.0, 100.0]] * 6),
    point=np.array([[-0.5, 0.5]] * 3),
    exaggeration=np.array([[1.0, 1e4]]),
)
GOOD = {"id": 3, "a": [0.5, 1], "wrench": [0] * 6, "point": [0, 0, 0.25], "exaggeration": 10}

numbers = st.floats(-1.0, 1.0)
anything = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=12,
)


def test_a_good_request_arrives_as_it_was_sent() -> None:
    number, request = read_request(json.dumps(GOOD), BOUNDS)
    assert number == 3
    assert request.a.tolist() == [0.5, 1.0]
    assert request.point.tolist() == [0.0, 0.0, 0.25]
    assert request.exaggeration == 10.0


@given(st.text() | st.binary())
def test_garbage_is_refused(text: str | bytes) -> None:
    with pytest.raises(InputError):
        read_request(text, BOUNDS)


@given(anything)
def test_json_of_another_form_is_refused(content: object) -> None:
    with pytest.raises(InputError):
        read_request(json.dumps(content), BOUNDS)


@settings(max_examples=300)
@given(st.sampled_from(sorted(GOOD)), anything)
def test_one_wrong_value_is_refused_or_is_in_range(key: str, value: object) -> None:
    try:
        _, request = read_request(json.dumps({**GOOD, key: value}), BOUNDS)
    except InputError:
        return
    for name in ("a", "wrench", "point"):
        limits, values = getattr(BOUNDS, name), getattr(request, name)
        assert np.isfinite(values).all()
        assert ((limits[:, 0] <= values) & (values <= limits[:, 1])).all()
    assert 1.0 <= request.exaggeration <= 1e4


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("a", [0.5, 2.1], "outside 0 .. 2"),
        ("a", [0.5], "list of 2 numbers"),
        ("a", [0.5, True], "no number"),
        ("a", [0.5, float("nan")], "outside"),
        ("a", [0.5, float("inf")], "outside"),
        ("a", [0.5, 10**400], "outside"),
        ("wrench", [0, 0, 0, 0, 0, "1"], "no number"),
        ("point", None, "list of 3"),
        ("exaggeration", 0, "outside 1 .. 10000"),
        ("exaggeration", [1], "no number"),
        ("id", -1, "whole number"),
        ("id", True, "whole number"),
        ("id", 1.5, "whole number"),
    ],
)
def test_the_refusal_says_why(key: str, value: object, says: str) -> None:
    with pytest.raises(InputError, match=says):
        read_request(json.dumps({**GOOD, key: value}), BOUNDS)


def test_keys_nobody_asked_for_are_refused() -> None:
    with pytest.raises(InputError, match="has the keys"):
        read_request(json.dumps({**GOOD, "more": 1}), BOUNDS)


def test_a_deep_nest_is_refused() -> None:
    with pytest.raises(InputError):
        read_request("[" * 5000 + "]" * 5000, BOUNDS)


@given(numbers)
def test_the_end_of_a_slider_survives_degrees(value: float) -> None:
    there_and_back = float(np.radians(np.degrees(value)))
    limits = Bounds(
        np.array([[value, value]] * 2), BOUNDS.wrench, BOUNDS.point, BOUNDS.exaggeration
    )
    _, request = read_request(json.dumps({**GOOD, "a": [there_and_back] * 2}), limits)
    assert request.a.tolist() == [value, value]
