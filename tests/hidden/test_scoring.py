"""The scorer on hand-made answers, and the runner on a stand-in program."""

from __future__ import annotations

import json
import shutil
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.hidden import run, score
from tests.hidden.answers import (
    identity,
    read_answer,
    read_prediction_errors,
    read_predictions,
)
from tests.hidden.discrimination import tells_apart
from tests.hidden.generator.build import build
from tests.hidden.generator.design import plan
from tests.hidden.judge import as_classes, coverage, foretold, heldout_ratio, mark, told_at_best
from tests.hidden.make_cases import counts, names

TILT = {
    "name": "joint_tilt",
    "where": "joint_2_l",
    "left": 30.0,
    "quantities": {"stiffness_along": 1.0e7},
    "rivals": [
        {"name": "link_torsion", "where": "link_2_l", "separation": 0.4, "angle_deg": 2.0},
        {"name": "base_rocking", "where": "base_link", "separation": 20.0, "angle_deg": 40.0},
    ],
}
ROCK = {
    "name": "base_rocking",
    "where": "base_link",
    "left": 12.0,
    "quantities": {"stiffness_x": 1e7},
    "rivals": [],
}


def truth(level: str, *effects: dict[str, Any], expected: str = "named") -> dict[str, Any]:
    return {
        "level": level, "robot": "sk120", "note": "", "expected": expected,
        "effects": list(effects), "springs": {"joint_2_l": 4e5}, "count": len(effects),
        "accepted": ["joint_tilt:joint_2_l", "link_torsion:link_2_l"],
        "pair": ["link_torsion:link_2_l"],
    }  # fmt: skip


def answered(tmp_path: Path, verdict: str, *effects: tuple[str, str, list[str]], **more: Any):  # type: ignore[no-untyped-def]
    document = {
        "verdict": verdict,
        "effects": [
            {"name": name, "where": where, "alternatives": others, "parameters": []}
            for name, where, others in effects
        ],
        **more,
    }
    (tmp_path / "verdict.json").write_text(json.dumps(document))
    (tmp_path / "run.json").write_text(json.dumps({"exit": 0, "seconds": 1.0}))
    return read_answer(tmp_path)


RIGHT = ("joint_tilt", "joint_2_l", [])
BOTH = ("joint_tilt", "joint_2_l", ["link_torsion:link_2_l"])
OTHER = ("joint_tilt", "joint_1_s", [])
ROCKS = ("base_rocking", "foundation", [])


@pytest.mark.parametrize(
    ("level", "hidden", "verdict", "effects", "share", "wrong"),
    [
        ("L0", (), "none", (), 1.0, 0),
        ("L0", (), "named", (RIGHT,), 0.0, 1),
        ("L0", (), "outside", (), 0.0, 0),
        ("L8", (), "ambiguous", (BOTH,), 0.0, 1),
        ("L1", (TILT,), "named", (RIGHT,), 1.0, 0),
        ("L1", (TILT,), "named", (OTHER,), 0.0, 1),  # right name, wrong joint
        ("L1", (TILT,), "ambiguous", (BOTH,), 0.5, 0),
        ("L1", (TILT,), "none", (), 0.0, 0),
        ("L1", (TILT,), "named", (RIGHT, ROCKS), 0.0, 1),
        ("L1", (ROCK,), "named", (ROCKS,), 1.0, 0),  # one base: any place is right
        ("L6", (TILT, ROCK), "named", (ROCKS, RIGHT), 1.0, 0),
        ("L6", (TILT, ROCK), "named", (RIGHT,), 0.0, 0),
        ("L6", (TILT, ROCK), "ambiguous", (ROCKS, BOTH), 0.5, 0),
        ("L6", (TILT, {**ROCK, "left": 2.0}), "named", (RIGHT,), 1.0, 0),
        ("L5", (TILT,), "ambiguous", (BOTH,), 1.0, 0),
        ("L5", (TILT,), "named", (RIGHT,), 0.0, 0),
        ("L7", (TILT,), "outside", (), 1.0, 0),
        ("L7", (TILT,), "outside", (ROCKS,), 0.0, 1),
        ("L7", (TILT,), "none", (), 0.0, 0),
        ("L4", (TILT,), "named", (RIGHT,), 0.0, 0),
        ("L4", (TILT,), "ambiguous", (BOTH,), 0.5, 0),  # no poses that settle it
        ("L4", (TILT,), "ambiguous", (OTHER,), 0.0, 1),
    ],
)
def test_marks(  # type: ignore[no-untyped-def]
    tmp_path, level, hidden, verdict, effects, share, wrong
) -> None:
    expected = "none" if level in {"L0", "L8"} else "named"
    answer = answered(tmp_path, verdict, *effects)
    assert mark(truth(level, *hidden, expected=expected), answer)[:2] == (share, wrong)


@pytest.mark.parametrize(
    ("others", "share", "classes"),
    [
        ([], 1.0, 1.0),
        (["link_torsion:link_2_l"], 0.5, 1.0),  # 0.4 of the noise apart: no reading tells
        (["base_rocking:base_link"], 0.5, 0.5),  # 20 apart
        (["link_torsion:link_2_l", "base_rocking:base_link"], 1.0 / 3.0, 0.5),
    ],
)
def test_a_set_of_what_no_reading_tells_apart_is_all_that_can_be_said(
    tmp_path: Path, others: list[str], share: float, classes: float
) -> None:
    case = truth("L9", TILT)
    answer = answered(tmp_path, "ambiguous", ("joint_tilt", "joint_2_l", others))
    found = mark(case, answer)[0]
    assert found == pytest.approx(share)
    assert as_classes(case, answer, found) == pytest.approx(classes)
    wrong = answered(tmp_path, "named", ("link_torsion", "link_2_l", []))
    assert as_classes(case, wrong, mark(case, wrong)[0]) == 0.0


def test_near_pair_with_poses_is_right(tmp_path: Path) -> None:
    (tmp_path / "next_poses.csv").write_text("pose\n1\n")
    answer = answered(tmp_path, "ambiguous", BOTH, next_poses="next_poses.csv")
    assert mark(truth("L4", TILT), answer)[0] == 1.0
    crowd = ("joint_tilt", "joint_2_l", ["link_torsion:link_2_l", "base_rocking:base_link"])
    answer = answered(tmp_path, "ambiguous", crowd, next_poses="next_poses.csv")
    assert mark(truth("L4", TILT), answer)[0] == 0.5


def test_absorbed_cause_may_stay_unnamed(tmp_path: Path) -> None:
    yaw = {**ROCK, "left": 0.0}
    assert mark(truth("L5", yaw, expected="none"), answered(tmp_path, "none"))[0] == 1.0
    named = answered(tmp_path, "named", ROCKS)
    assert mark(truth("L5", yaw, expected="none"), named)[0] == 0.0


def test_no_answer_is_no_point(tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text(json.dumps({"exit": None, "seconds": 300.0}))
    answer = read_answer(tmp_path)
    assert answer.verdict == "error"
    assert mark(truth("L0", expected="none"), answer)[0] == 0.0
    assert mark(truth("L7", TILT), answer)[0] == 0.0


def test_a_page_that_failed_is_no_point(tmp_path: Path) -> None:
    answered(tmp_path, "none")
    for pages, verdict in ((None, "none"), (True, "none"), (False, "error")):
        (tmp_path / "run.json").write_text(json.dumps({"exit": 0, "seconds": 9.0, "pages": pages}))
        answer = read_answer(tmp_path)
        assert answer.verdict == verdict
        assert mark(truth("L0", expected="none"), answer)[0] == float(verdict == "none")


def test_one_case_in_ten_draws_its_pages() -> None:
    names = [f"case_{k:04d}" for k in range(2000)]
    share = sum(run.drawn(name) for name in names) / len(names)
    assert 0.07 < share < 0.13


@pytest.mark.parametrize(
    ("pages", "told", "whole"),
    [
        (("report.html", "scene.html"), "Warning: few poses.", True),
        (("scene.html",), "", False),
        (("report.html", "scene.html"), "Warning: The picture 'x' could not be made", False),
    ],
)
def test_pages_are_looked_at(tmp_path: Path, pages, told: str, whole: bool) -> None:
    for page in pages:
        (tmp_path / page).write_text("<html>")
    (tmp_path / "stderr.txt").write_text(told)
    assert run.pages_are_whole(tmp_path) == whole


def test_one_spelling_per_name() -> None:
    assert identity("closure_coupling", "joint_3_u, joint_2_l") == identity(
        "closure_coupling", "joint_2_l+joint_3_u"
    )
    assert identity("force_bias", "sensor") == identity("force_bias", "tool0")
    assert identity("joint_tilt", "a") != identity("joint_tilt", "b")


def test_coverage_reads_intervals(tmp_path: Path) -> None:
    document = {
        "verdict": "named",
        "effects": [{
            "name": "joint_tilt", "where": "joint_2_l", "alternatives": [],
            "parameters": [{"name": "stiffness_along", "value": 1.1e7, "std": 0.06e7,
                            "unit": "N*m/rad"}],
        }],
    }  # fmt: skip
    (tmp_path / "verdict.json").write_text(json.dumps(document))
    (tmp_path / "model.yaml").write_text(
        "effects:\n- name: joint_springs\n  where: joint_2_l\n  parameters:\n"
        "    stiffness: {value: 410000.0, unit: N*m/rad, std: 1000.0}\n"
    )
    answer = read_answer(tmp_path)
    assert coverage(truth("L1", TILT), answer, 1.0) == ([True], [False])
    assert coverage(truth("L1", TILT), answer, 0.5) == ([], [])
    (tmp_path / "model.yaml").write_text(
        "effects:\n- name: joint_springs\n  where: joint_2_l\n  parameters:\n"
        "    stiffness: {value: .inf, unit: N*m/rad, std: null}\n"
    )
    rigid = read_answer(tmp_path)
    assert coverage(truth("L1", TILT), rigid, 1.0) == ([True], [False]), (
        "a gear that was made rigid"
    )
    assert coverage(truth("L11", TILT), rigid, 1.0) == ([True], []), "not named from positions"


@pytest.mark.parametrize(
    ("sizes", "law", "found", "holds"),
    [
        ({"first": 0.2, "second": 0.05}, "quadratic", 320000.0, [True]),  # 400000 / 1.25
        ({"first": 0.2, "second": 0.05}, "quadratic", 400000.0, [False]),
        ({"first": 0.2, "second": 0.05}, "extra_below_150", 400000.0, [True]),
        ({"cubic": 0.3}, "quadratic", 400000.0, [True]),
        ({"cubic": 0.3}, "extra_below_150", 400000.0, []),
    ],
)
def test_a_spring_is_what_the_law_of_its_gear_calls_so(
    tmp_path: Path, sizes: dict[str, float], law: str, found: float, holds: list[bool]
) -> None:
    gear = {
        "name": "gear_hardening", "where": "joint_2_l", "sizes": sizes, "quantities": {}, "left": 9,
    }  # fmt: skip
    (tmp_path / "verdict.json").write_text(json.dumps({
        "verdict": "named",
        "effects": [{
            "name": "gear_hardening", "where": "joint_2_l", "alternatives": [],
            "parameters": [{"name": law, "value": 1.0, "std": 0.1, "unit": "1"}],
        }],
    }))  # fmt: skip
    (tmp_path / "model.yaml").write_text(
        "effects:\n- name: joint_springs\n  where: joint_2_l\n  parameters:\n"
        f"    stiffness: {{value: {found}, unit: N*m/rad, std: 1000.0}}\n"
    )
    case = truth("L1", gear) | {"springs": {"joint_2_l": 400000.0}}
    assert coverage(case, read_answer(tmp_path), 1.0) == ([], holds)


def test_heldout_ratio(tmp_path: Path) -> None:
    oracle = np.zeros((4, 3))
    path = tmp_path / "predicted.csv"
    lines = ["pose,dx_predicted[um],dy_predicted[um],dz_predicted[um]"] + ["1,6,6,6"] * 4
    path.write_text("\n".join(lines))
    case = {"oracle": oracle.tolist(), "sealed_sigma_um": 8.0}
    assert heldout_ratio(case, read_predictions(path)) == pytest.approx(10.0 / 8.0)
    assert heldout_ratio(case, read_predictions(tmp_path / "none.csv")) is None


def test_intervals_of_predictions_hold_what_is_true_or_not(tmp_path: Path) -> None:
    path = tmp_path / "predicted.csv"
    stds = [f"std_{part}_{axis}[um]" for part in ("parameters", "remainder") for axis in "xyz"]
    head = ",".join(["predicted_dx[um]", "predicted_dy[um]", "predicted_dz[um]", *stds])
    path.write_text(f"{head}\n6,6,6,3,3,3,1,1,0\n6,6,6,,3,3,1,1,0\n")
    case = {"oracle": [[0.0, 0.0, 0.0]] * 2}
    errors = read_prediction_errors(path)
    assert errors is not None
    np.testing.assert_allclose(errors[0], 1e-6 * np.array([np.sqrt(10.0), np.sqrt(10.0), 3.0]))
    assert np.isnan(errors[1, 0])
    # 6 is within 1.96 root 10, not within 1.96 times 3; what has no error is not asked
    assert foretold(case, read_predictions(path), errors) == pytest.approx(3.0 / 5.0)
    assert foretold(case, None, None) is None


PROGRAM = """
import json, pathlib, sys
given = sys.argv[1:]
out = pathlib.Path(given[given.index("--out") + 1])
if given[0] == "explain":
    (out / "model.yaml").write_text("effects: []")
    (out / "verdict.json").write_text(json.dumps({"verdict": "none", "effects": []}))
    with open(LOG, "a") as log:
        log.write(given[1] + "\\n")
else:
    out.write_text("dx_predicted[m],dy_predicted[m],dz_predicted[m]\\n")
"""


def test_runner_resumes_and_freezes(  # type: ignore[no-untyped-def]
    tmp_path, monkeypatch, capsys
) -> None:
    log = tmp_path / "log.txt"
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.replace("LOG", repr(str(log))))
    monkeypatch.setattr(run, "COMMAND", [sys.executable, str(program)])
    folder = tmp_path / "bench"
    for name in ("case_0000", "case_0001"):
        (folder / "cases" / name).mkdir(parents=True)
        (folder / "cases" / name / "command.json").write_text("[]")
        (folder / "truth").mkdir(exist_ok=True)
        sealed = {**truth("L0", expected="none"), "oracle": [], "sealed_sigma_um": 1.0}
        (folder / "truth" / f"{name}.json").write_text(json.dumps(sealed))
    with pytest.raises(score.NotFrozen):
        score.main([str(folder)])
    run.main([str(folder), "--jobs", "1"])
    run.main([str(folder), "--jobs", "1"])  # nothing left to do
    assert len(log.read_text().splitlines()) == 2
    score.main([str(folder), "--failures"])
    assert "| L0 | clean | 2 | 100" in capsys.readouterr().out
    twin = shutil.copytree(folder, tmp_path / "twin")
    score.main([str(folder), str(twin)])
    assert "| L0 | clean | 4 | 100" in capsys.readouterr().out
    frozen = json.loads((twin / "frozen.json").read_text())
    (twin / "frozen.json").write_text(json.dumps({**frozen, "program": "another"}))
    with pytest.raises(score.NotFrozen, match="different programs"):
        score.main([str(folder), str(twin)])
    (folder / "answers/case_0000/verdict.json").write_text('{"verdict": "named"}')
    with pytest.raises(score.NotFrozen):
        score.main([str(folder)])


def test_good_poses_settle_a_near_pair(tmp_path: Path) -> None:
    case = build("L4", 11, 2)
    more = plan(case.arm, np.random.default_rng(1), poses=60, point=case.train.point)
    header = ["pose", *(f"{name}[rad]" for name in case.arm.actuated), "fx[N]", "fy[N]", "fz[N]"]
    table = np.column_stack([more.pose, *more.coordinates.values(), more.force])
    idle = np.column_stack([table[:1, :-3], 1e-3 * table[:1, -3:]])  # almost no load
    for rows, settled in ((idle, False), (table, True)):
        lines = [",".join(header), *(",".join(map(str, row)) for row in rows)]
        (tmp_path / "next_poses.csv").write_text("\n".join(lines))
        assert tells_apart(case.truth(), tmp_path) is settled
    (tmp_path / "next_poses.csv").write_text("pose\n1\n")
    assert not tells_apart(case.truth(), tmp_path)


def test_levels_may_have_counts_of_their_own():
    wished = counts("L0=3,L1", 2)
    assert wished == {"L0": 3, "L1": 2}
    listed = names(wished, 5)
    assert [name for name, _, _ in listed] == [f"case_{k:04d}" for k in range(5)]
    assert Counter(level for _, level, _ in listed) == wished


@pytest.mark.parametrize("twin", ["{}", "{1}", None])
def test_an_answer_that_depends_on_its_process_is_told(tmp_path, twin):
    """Batches count only as far as single processes say the same."""
    for answers, said in (("answers", "{}"), ("again", twin)):
        (tmp_path / answers / "case_0000").mkdir(parents=True)
        if said is not None:
            (tmp_path / answers / "case_0000" / "verdict.json").write_text(said)
    run.freeze(tmp_path, batched=True, again=["case_0000"])
    frozen = json.loads((tmp_path / "frozen.json").read_text())
    assert frozen["again"] == 1
    assert frozen["otherwise"] == ([] if twin == "{}" else ["case_0000"])


def test_at_best_a_set_is_told_where_readings_tell_no_more() -> None:
    assert told_at_best(truth("L9", TILT, ROCK)) == 0.5  # what lies 20 of the noise apart is told
    near = {**ROCK, "rivals": [{**TILT["rivals"][0], "separation": 3.2}] * 2}
    assert told_at_best(truth("L9", near)) == 0.5  # one name twice is one
    assert told_at_best(truth("L9", near, TILT)) == 0.25
