"""Answers as strict JSON."""

import json
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.files.json_text import as_json_text


class Verdict(Enum):
    NAMED = "named"


@dataclass(frozen=True)
class Warned:
    code: str
    where: tuple[str, ...]


def test_every_type_that_answers_are_made_of() -> None:
    document = {
        "none": None,
        "flag": np.bool_(True),
        "count": np.int64(3),
        "third": np.float64(1.0 / 3.0),
        "single": np.float32(0.5),
        "lost": [float("nan"), np.inf, np.array([-np.inf, 1.0])],
        "matrix": np.arange(4.0).reshape(2, 2),
        "path": Path("a/b"),
        "names": ("a", "b"),
        "unordered": {"b", "a"},
        "verdict": Verdict.NAMED,
        "warnings": [Warned("no_mass", ("link_1",))],
        "by_pose": {1: {"rms_um": 0.25}},
        "unit": "µm",
    }
    assert json.loads(as_json_text(document)) == {
        "none": None,
        "flag": True,
        "count": 3,
        "third": 1.0 / 3.0,
        "single": 0.5,
        "lost": [None, None, [None, 1.0]],
        "matrix": [[0.0, 1.0], [2.0, 3.0]],
        "path": "a/b",
        "names": ["a", "b"],
        "unordered": ["a", "b"],
        "verdict": "named",
        "warnings": [{"code": "no_mass", "where": ["link_1"]}],
        "by_pose": {"1": {"rms_um": 0.25}},
        "unit": "µm",
    }


def test_numbers_keep_their_full_precision() -> None:
    values = np.random.default_rng(0).normal(size=100)
    read = json.loads(as_json_text({"values": values}))["values"]
    assert np.array_equal(np.array(read), values)


def test_one_line_per_key_in_ascii() -> None:
    text = as_json_text({"a": np.eye(3), "b": "µ"})
    assert text.isascii()
    assert len(text.splitlines()) == 4


@pytest.mark.parametrize("value", [1j, object(), b"bytes", int])
def test_what_has_no_json_form_is_refused(value: object) -> None:
    with pytest.raises(TypeError, match="no JSON form"):
        as_json_text({"value": value})
