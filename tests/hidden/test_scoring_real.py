"""The scorer on hand-made answers at L10 and L12, and what it makes of probabilities."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.hidden import score
from tests.hidden.answers import Answer, read_answer
from tests.hidden.calibration import calibration, reliability, stated
from tests.hidden.judge import Mark, at_work, coverage, mark
from tests.hidden.test_scoring import BOTH, OTHER, RIGHT, ROCK, ROCKS, TILT, answered, truth


def hidden(name: str, left: float = 30.0) -> dict[str, Any]:
    return {"name": name, "where": "joint_2_l", "left": left, "quantities": {}, "rivals": []}


PLAY, LOOP = hidden("lost_motion"), hidden("friction_hysteresis")


def gear(name: str, *others: str, joint: str = "joint_2_l") -> tuple[str, str, list[str]]:
    return name, joint, [f"{other}:{joint}" for other in others]


@pytest.mark.parametrize(
    ("effects", "named", "share", "wrong"),
    [
        ((PLAY,), (gear("lost_motion"),), 1.0, 0),
        ((PLAY,), (gear("gear_hardening"),), 1.0, 0),  # the family is right
        ((PLAY,), (gear("lost_motion", "gear_hardening"),), 1.0, 0),
        ((PLAY,), (gear("lost_motion", "friction_hysteresis"),), 0.5, 0),
        ((PLAY,), (gear("lost_motion", joint="joint_1_s"),), 0.0, 1),
        ((PLAY,), (gear("friction_hysteresis"),), 0.0, 1),
        ((PLAY,), (gear("lost_motion"), gear("gear_hardening")), 0.5, 0),  # one curve, two names
        ((PLAY,), (gear("lost_motion"), gear("friction_hysteresis")), 0.0, 1),
        ((PLAY,), (gear("lost_motion"), ROCKS), 0.0, 1),
        ((PLAY,), (), 0.0, 0),
        ((LOOP,), (gear("friction_hysteresis"),), 1.0, 0),
        ((LOOP,), (gear("friction_hysteresis"), gear("gear_hardening")), 0.5, 0),
        ((LOOP,), (gear("lost_motion"),), 0.0, 1),
        ((LOOP, ROCK), (ROCKS, gear("friction_hysteresis")), 1.0, 0),
        ((LOOP, ROCK), (ROCKS,), 0.0, 0),
        ((LOOP, {**ROCK, "left": 2.0}), (gear("friction_hysteresis"),), 1.0, 0),
        ((TILT,), (BOTH,), 0.5, 0),
    ],
)
def test_families_and_places(tmp_path: Path, effects, named, share: float, wrong: int) -> None:  # type: ignore[no-untyped-def]
    answer = answered(tmp_path, "named", *named)
    assert mark(truth("L10", *effects), answer)[:2] == (share, wrong)


REST = {"rms_um": 12.0, "interval_95": [9.0, 15.0], "p": 1e-6, "significant": True, "where": []}


@pytest.mark.parametrize(
    ("named", "rest", "share", "wrong", "note"),
    [
        ((RIGHT,), REST, 1.0, 0, ""),
        ((BOTH,), REST, 0.5, 0, "one of a set"),
        ((RIGHT,), None, 0.0, 0, "missing (true 13.0 um)"),
        ((RIGHT,), {"rms_um": 12.0, "interval_95": None, "significant": True}, 0.0, 0, "missing"),
        ((RIGHT,), {**REST, "significant": False}, 0.0, 0, "not significant"),
        ((RIGHT,), {**REST, "interval_95": [9.0, 12.0]}, 0.0, 0, "without 13.0"),
        ((OTHER,), REST, 0.0, 1, "joint_1_s"),
        ((RIGHT, ROCKS), REST, 0.0, 1, "base_rocking"),
        ((), REST, 0.0, 0, "outside"),
    ],
)
def test_known_beside_foreign(tmp_path: Path, named, rest, share, wrong, note) -> None:  # type: ignore[no-untyped-def]
    verdict = "named" if named else "outside"
    answer = answered(tmp_path, verdict, *named, **({} if rest is None else {"remainder": rest}))
    found = mark({**truth("L12", TILT), "remainder_um": 13.0}, answer)
    assert found[:2] == (share, wrong)
    assert note in found[2]


@pytest.mark.parametrize(
    ("named", "rest", "share", "wrong"),
    [
        ((RIGHT, ROCKS), REST, 1.0, 0),  # the foreign one by its kind and place
        ((RIGHT,), REST, 1.0, 0),
        ((RIGHT, ROCKS), {**REST, "interval_95": [14.0, 15.0]}, 0.0, 0),  # more is left than was
        ((RIGHT, ROCKS, OTHER), REST, 0.0, 1),
        ((ROCKS,), REST, 0.0, 0),
    ],
)
def test_a_foreign_cause_may_be_named_by_its_kind(
    tmp_path: Path, named, rest, share, wrong
) -> None:  # type: ignore[no-untyped-def]
    answer = answered(tmp_path, "named", *named, remainder=rest)
    foreign = {"remainder_um": 13.0, "foreign": "foreign_quadratic_mount:base_link"}
    case = {**truth("L12", TILT), **foreign}
    assert mark(case, answer)[:2] == (share, wrong)
    assert at_work(case, frozenset({"base_rocking"}))
    assert not at_work({**case, "foreign": "foreign_hose:base_link"}, frozenset({"base_rocking"}))


@pytest.mark.parametrize(
    ("rest", "share"),
    [(None, 1.0), ({**REST, "significant": False}, 1.0), ({**REST, "interval_95": [14, 15]}, 0.0)],
)
def test_one_name_says_two_causes_of_one_kind(tmp_path: Path, rest, share: float) -> None:  # type: ignore[no-untyped-def]
    mount = {"remainder_um": 13.0, "foreign": "foreign_quadratic_mount:base_link"}
    told = {} if rest is None else {"remainder": rest}
    answer = answered(tmp_path, "named", ROCKS, **told)
    assert mark({**truth("L12", ROCK), **mount}, answer)[:2] == (share, 0)


def test_what_the_catalogue_lacks_may_be_named_by_its_kind_alone(tmp_path: Path) -> None:
    mount = {**ROCK, "name": "foreign_quadratic_mount", "where": "base_link"}
    assert mark(truth("L7", mount), answered(tmp_path, "named", ROCKS))[:2] == (1.0, 0)
    assert mark(truth("L7", mount), answered(tmp_path, "named", OTHER))[:2] == (0.0, 1)
    hose = {**mount, "name": "foreign_hose"}
    assert mark(truth("L7", hose), answered(tmp_path, "named", ROCKS))[:2] == (0.0, 1)


def test_probabilities_are_read_where_they_stand(tmp_path: Path) -> None:
    document = {
        "verdict": "ambiguous",
        "effects": [
            {"name": "joint_tilt", "where": "joint_2_l", "probability": 0.97,
             "alternatives": ["link_torsion:link_2_l"], "parameters": []},
            {"name": "base_rocking", "where": "base_link", "alternatives": [], "parameters": []},
        ],
        "probabilities": [
            {"name": "joint_tilt:joint_2_l", "probability": 0.6},
            {"name": "link_torsion", "where": "link_2_l", "probability": 0.37},
            {"name": "base_rocking", "probability": 0.2},
            {"name": "none", "probability": 0.01},
        ],
    }  # fmt: skip
    (tmp_path / "verdict.json").write_text(json.dumps(document))
    answer = read_answer(tmp_path)
    assert answer.named == [(frozenset({"joint_tilt:joint_2_l", "link_torsion:link_2_l"}), 0.97)]
    assert [p for _, p in answer.listed] == [0.6, 0.37, 0.2]
    pairs = stated([(truth("L1", TILT), answer)])
    assert pairs["named effects"] == [(0.97, True)]
    assert pairs["listed candidates"] == [(0.6, True), (0.37, False), (0.2, False)]
    assert stated([(truth("L1", TILT), answered(tmp_path, "named", RIGHT))])["named effects"] == []


def test_what_counts_as_at_work() -> None:
    hardening = frozenset({"gear_hardening:joint_2_l"})
    assert at_work(truth("L10", PLAY), hardening)
    assert not at_work(truth("L1", PLAY), hardening)
    twist = frozenset({"link_torsion:link_2_l"})
    assert at_work(truth("L5", TILT), twist)
    assert not at_work(truth("L1", TILT), twist)


def test_calibration_by_hand() -> None:
    # a bin of 0.9 that holds in 3 of 4, and one of 0.25 that never holds
    found = calibration(
        [(0.9, True)] * 3 + [(0.9, False)] + [(0.25, False)] * 4 + [(1.0, True)] * 2
    )
    assert found is not None
    # 0.9 and 1.0 share the last bin: mean stated (3.6 + 2) / 6, true 5 / 6
    assert [(b.count, b.true) for b in found.bins] == [(4, 0.0), (6, pytest.approx(5 / 6))]
    assert found.error == pytest.approx((4 * 0.25 + 6 * (5.6 / 6 - 5 / 6)) / 10)
    assert found.brier == pytest.approx((3 * 0.01 + 0.81 + 4 * 0.0625) / 10)
    assert "| 0.2 to 0.3 | 4 | 0.25 | 0.00 |" in reliability("names", found)
    assert calibration([]) is None
    perfect = calibration([(0.0, False), (1.0, True)])
    assert perfect is not None
    assert (perfect.error, perfect.brier) == (0.0, 0.0)


def test_strength_is_counted_by_cause() -> None:
    weak, strong = hidden("lost_motion", 12.0), hidden("lost_motion", 90.0)
    right = Answer("named", [frozenset({"gear_hardening:joint_2_l"})])
    cases = [
        (truth("L10", weak), right, Mark()),
        (truth("L10", strong), Answer("outside"), Mark()),
        (truth("L10", strong), right, Mark()),
    ]
    assert [text.split(":")[1] for text in score.by_strength(cases)] == [
        " 1 of 1 named with family and place", " 1 of 2 named with family and place",
    ]  # fmt: skip


def test_only_plain_gears_are_asked_for_their_springs(tmp_path: Path) -> None:
    (tmp_path / "model.yaml").write_text(
        "effects:\n- name: joint_springs\n  where: joint_2_l\n  parameters:\n"
        "    stiffness: {value: 401000.0, unit: N*m/rad, std: 1000.0}\n"
        "- name: joint_tilt\n  where: joint_2_l\n  parameters:\n"
        "    stiffness_along: {value: 20000000.0, unit: N*m/rad, std: 1000.0}\n"
    )
    answer = answered(tmp_path, "named", RIGHT)
    assert coverage(truth("L1", TILT), answer, 1.0) == ([False], [True])
    assert coverage(truth("L10", TILT), answer, 1.0) == ([], [True])
    assert coverage(truth("L10", PLAY), answer, 1.0) == ([], [])  # its gear has a curve


def test_draws_together_are_calibrated_as_their_cases_are():
    """Bins of two draws, kept as numbers, against one calibration of all pairs."""
    script = runpy.run_path(str(Path(__file__).parents[2] / "scripts" / "reliability.py"))
    rng = np.random.default_rng(3)
    draws = [[(float(p), bool(rng.random() < p)) for p in rng.random(n)] for n in (300, 700)]
    rows = [
        dict(zip(script["COLUMNS"], (k, "", len(draw), "names", b.low, b.count, b.stated, b.true,
                                     found.brier), strict=True))
        for k, draw in enumerate(draws)
        if (found := calibration(draw)) is not None
        for b in found.bins
    ]  # fmt: skip
    whole, pooled = calibration(draws[0] + draws[1]), script["together"](rows)
    assert (pooled.count, pooled.error, pooled.brier) == pytest.approx(
        (whole.count, whole.error, whole.brier)
    )
