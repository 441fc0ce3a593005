"""L11: its laws against another hand's, and a small share of it through the public command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.hidden import make_cases, run, score
from tests.hidden.answers import Answer
from tests.hidden.generator.arm import Typical
from tests.hidden.generator.build import build
from tests.hidden.generator.levels_positions import APART, SHOWS, visits_of
from tests.hidden.generator.position_case import PositionCase
from tests.hidden.generator.positions import Truth, Visits
from tests.hidden.generator.rotations import Array
from tests.hidden.generator.urdf_arm import urdf_arm
from tests.hidden.judge import mark
from tests.positions.arm import NAMES, Arm, poses, urdf

SIX = urdf_arm(
    urdf(), name="six", reference="six.urdf", base="base", tool="tool",
    typical=Typical(joint=dict.fromkeys(NAMES, 5e5)),
)  # fmt: skip


def visits(a: Array) -> Visits:
    count = len(a)
    return Visits(
        np.arange(count), dict(zip(NAMES, a.T, strict=True)), np.zeros(count), np.zeros(count),
        np.zeros(count), np.zeros(3),
    )  # fmt: skip


def test_geometry_sag_and_waves_agree_with_another_hand() -> None:
    rng = np.random.default_rng(1)
    other = Arm(
        compliance=1e-5 * rng.random(6), shift=1e-3 * rng.normal(size=(6, 3)),
        turn=1e-3 * rng.normal(size=(6, 3)), waves=1e-3 * rng.normal(size=(6, 2)),
    )  # fmt: skip
    a = poses(20, 2)
    truth = Truth(
        SIX, marker=other.marker,
        frames={n: np.r_[other.shift[k], other.turn[k]] for k, n in enumerate(NAMES)},
        compliance=dict(zip(NAMES, other.compliance * 9.80665 / 9.81, strict=True)),
        waves={n: np.r_[other.waves[k], 0.0, 0.0] for k, n in enumerate(NAMES)},
    )  # fmt: skip
    x = other.stands(a)[0]
    assert np.abs(x - Truth(SIX, marker=other.marker).positions(visits(a))).max() > 1e-3
    assert np.abs(truth.positions(visits(a)) - x).max() < 1e-8


def test_play_leans_to_the_side_of_the_weight() -> None:
    a = poses(20, 3)
    other = Arm(play=np.array([0, 0, 2e-4, 0, 0, 0]))
    truth = Truth(SIX, marker=other.marker, play={"j3": 2e-4})
    gap = np.linalg.norm(truth.positions(visits(a)) - other.stands(a)[0], axis=1)
    assert np.median(gap) < 1e-12  # teeth take hold within some newton metres


def test_encoders_jitter_by_less_than_a_milliradian() -> None:
    found = visits_of(
        SIX, np.random.default_rng(1), 30, loads=(0.0, 20.0), twice=False, warm=5.0, series=2,
        hung=np.zeros(3),
    )  # fmt: skip
    for q in found.values.values():
        apart = np.abs(np.diff(q.reshape(30, 2), axis=1))
        assert 0.0 < apart.max() < 1e-3
    assert set(found.payload) == {0.0, 20.0} and set(found.series) == {0, 1}


def test_a_case_keeps_its_promise() -> None:
    case = build("L11", 77, 1)
    assert isinstance(case, PositionCase)
    for seen in case.hidden:
        assert not seen.asked or (seen.left >= SHOWS and seen.rivals[0][0] >= APART)
    rigid = build("L11.rigid", 77, 1)
    assert isinstance(rigid, PositionCase) and not rigid.hidden


@pytest.mark.parametrize(
    ("effects", "right", "wrong"),
    [
        ([{"joint_springs:a"}, {"joint_frame:b"}], 1.0, 0),
        ([{"joint_springs:a", "joint_tilt:b"}], 0.5, 0),
        ([{"joint_springs:a"}, {"joint_springs:b"}], 1.0, 0),
        ([{"joint_springs:a"}, {"link_bending:l"}], 0.0, 1),
        ([{"joint_frame:b"}], 0.0, 0),
    ],
)
def test_marks(effects: list[set[str]], right: float, wrong: int) -> None:
    truth = {
        "level": "L11", "expected": "named", "accepted": ["joint_frame:b"],
        "effects": [
            {"name": "joint_springs", "where": "a", "asked": True},
            {"name": "joint_springs", "where": "b", "asked": False},
        ],
    }  # fmt: skip
    answer = Answer("named", effects=[frozenset(group) for group in effects])
    assert mark(truth, answer)[:2] == (right, wrong)


@pytest.mark.timeout(600)
def test_a_share_of_the_level(tmp_path: Path) -> None:
    """Small numbers show no percentage; the table is in README.md."""
    make_cases.main(["--levels", "L11=1,L11.rigid=1", "--seed", "5", "--out", str(tmp_path)])
    run.main([str(tmp_path), "--batch", "--jobs", "1", "--timeout", "300"])
    score.main([str(tmp_path), "--failures"])
    marks = json.loads((tmp_path / "score.json").read_text(encoding="utf-8"))["cases"].values()
    assert len(marks) == 2
    assert sum(entry["wrong"] for entry in marks) == 0
    assert all(entry["ratio"] < 1.2 for entry in marks)
