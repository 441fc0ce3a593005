"""A case of every level through the public command; bounds from EVIDENCE.md.

Small numbers cannot show 95 %; the full table is printed by the scripts (README.md). These bounds
are those that a program at its goals misses in less than one run out of a hundred.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.hidden import make_cases, run, score

SEED = 20
LEVELS = "L0=1,L1=1,L2=1,L3=1,L4=1,L5=1,L6=1,L7=1,L8=1,L9=1"


@pytest.fixture(scope="module")
def scored(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[dict[str, Any]]]:
    """Level -> marks of its cases."""
    folder: Path = tmp_path_factory.mktemp("hidden")
    make_cases.main(["--levels", LEVELS, "--seed", str(SEED), "--out", str(folder)])
    run.main([str(folder), "--batch", "--jobs", "2", "--timeout", "120"])
    score.main([str(folder), "--failures"])
    document = json.loads((folder / "score.json").read_text(encoding="utf-8"))
    marks: dict[str, list[dict[str, Any]]] = {}
    for entry in document["cases"].values():
        marks.setdefault(entry["level"][:2], []).append(entry)
    return marks


pytestmark = pytest.mark.timeout(1200)


def test_every_case_gets_an_answer(scored: dict[str, list[dict[str, Any]]]) -> None:
    verdicts = [entry["verdict"] for entries in scored.values() for entry in entries]
    assert len(verdicts) == 10
    assert set(verdicts) <= {"none", "named", "ambiguous", "outside"}


@pytest.mark.parametrize("level", ["L0", "L8"])
def test_no_false_alarm(scored: dict[str, list[dict[str, Any]]], level: str) -> None:
    assert [entry["right"] for entry in scored[level]] == [1.0]


def test_strong_effects_are_named(scored: dict[str, list[dict[str, Any]]]) -> None:
    entries = scored["L1"] + scored["L2"]
    assert sum(entry["right"] for entry in entries) >= 2
    assert sum(entry["wrong"] for entry in entries) == 0


def test_weak_effects_are_not_misnamed(scored: dict[str, list[dict[str, Any]]]) -> None:
    assert sum(entry["wrong"] for entry in scored["L3"]) == 0


def test_what_cannot_be_told_apart_stays_together(
    scored: dict[str, list[dict[str, Any]]],
) -> None:
    assert [entry["right"] for entry in scored["L5"]] == [1.0]
    assert sum(entry["wrong"] for entry in scored["L4"]) == 0


def test_several_effects(scored: dict[str, list[dict[str, Any]]]) -> None:
    assert sum(entry["right"] for entry in scored["L6"]) >= 1


def test_unlisted_effects_are_not_named(scored: dict[str, list[dict[str, Any]]]) -> None:
    assert sum(entry["wrong"] for entry in scored["L7"]) == 0


def test_unknown_robot_is_predicted(scored: dict[str, list[dict[str, Any]]]) -> None:
    ratios = [entry["ratio"] for entry in scored["L9"]]
    assert None not in ratios
    assert min(ratios) <= 1.2
