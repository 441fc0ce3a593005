"""`verdict.json` has one form, whatever was read, and is read back as it was written."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain import Explained, Explanation, Verdict, read_verdict
from sk120stiff.explain.positions.answer.next_step import headline
from sk120stiff.files.json_text import as_json_text
from tests.positions.arm import NAMES, errors, poses, tracked, write

FIT = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 20, unit: um}\n"
)
FRAMES = sk.Options(only=("joint_frame",))


@pytest.fixture(scope="module")
def displacements() -> Explanation:
    """The paper's readings, explained."""
    data = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
    answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), sk.read(data))
    assert isinstance(answer, Explanation)
    return answer


@pytest.fixture(scope="module")
def positions(tmp_path_factory: pytest.TempPathFactory) -> Explained:
    """Where a marker of an arm stands whose joint frames are off; only frames are looked for."""
    arm, a = errors(3), poses(36, 8)
    seen = tracked(arm.stands(a)[0])
    seen += 2e-5 * np.random.default_rng(1).normal(size=seen.shape)
    data = sk.read(write(tmp_path_factory.mktemp("positions"), a, seen, FIT)).with_joints(NAMES)
    model = sk.Model(sk.load_robot(data.robot, base="base", tool="tool"))
    answer = sk.explain(model, data, options=FRAMES)
    assert isinstance(answer, Explained) and answer.findings
    return answer


def test_what_is_written_is_read_back(
    displacements: Explanation, positions: Explained, tmp_path: Path
) -> None:
    for answer in (displacements, positions):
        answer.save(tmp_path)
        found = read_verdict(tmp_path / "verdict.json")
        assert found.verdict == answer.verdict
        assert [f"{each.name}:{each.where}" for each in found.effects] == [
            finding.effect.id for finding in answer.findings
        ]
        assert found.gap.steps[0].fit_rms == pytest.approx(1e6 * answer.steps[0].fit_rms)
        own = answer.document()
        assert found.next_step == own.next_step and found.parameters == own.parameters


def test_a_file_of_another_version_of_schema_2_is_read(
    positions: Explained, tmp_path: Path
) -> None:
    """Keys come without a new schema: one may be missing, and one be of a later version."""
    keys = positions.document().as_keys()
    del keys["limits"]
    keys["of_later"] = 3
    for share in keys["budget"]:
        del share["members"]
    path = tmp_path / "verdict.json"
    path.write_text(as_json_text(keys), encoding="utf-8")
    found = read_verdict(path)
    assert found.limits == [] and found.budget[0].members == []


def test_positions_and_displacements_have_the_same_keys(
    displacements: Explanation, positions: Explained
) -> None:
    first, second = (answer.document().as_keys() for answer in (displacements, positions))
    assert list(first) == list(second) and first["schema"] == 2
    assert first["gap"].keys() == second["gap"].keys()
    assert first["remainder"].keys() == second["remainder"].keys()
    assert first["parameters"][0].keys() == second["parameters"][0].keys()


def test_a_limited_search_of_positions_says_so(positions: Explained) -> None:
    told = "Only these were looked for: joint_frame."
    assert positions.document().limits == [told]
    assert told in positions.report().html()


def test_an_arm_that_sags_elsewhere_comes_first(positions: Explained) -> None:
    """Names and springs rest on where gravity points: headline and advice begin with that."""
    askew = replace(positions, off_level=("The arm sags as if its base stood 3 deg off level.",))
    assert askew.document().next_step.startswith("First settle to which side the arm sags")
    assert "sags to another side" in headline(askew)
    assert "sags" not in positions.document().next_step + headline(positions)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema": 1}, "'schema'"),
        ({"verdict": "perhaps"}, "'verdict'"),
    ],
)
def test_another_form_is_refused(
    displacements: Explanation, tmp_path: Path, change: dict[str, object], said: str
) -> None:
    keys = displacements.save(tmp_path / "answer")
    path = tmp_path / "changed.json"
    path.write_text(json.dumps({**keys, **change}, default=str), encoding="utf-8")
    with pytest.raises(sk.InputError, match=said):
        read_verdict(path)


def test_what_is_no_json_is_refused(tmp_path: Path) -> None:
    (tmp_path / "verdict.json").write_text("{", encoding="utf-8")
    with pytest.raises(sk.InputError, match="no JSON"):
        read_verdict(tmp_path / "verdict.json")


def test_the_schema_names_every_key(positions: Explained) -> None:
    schema = Verdict.model_json_schema()
    assert set(schema["properties"]) == set(positions.document().as_keys())
    assert schema["properties"]["verdict"]["enum"] == ["none", "named", "ambiguous", "outside"]
