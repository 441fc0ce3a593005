"""Numbers at readings that no fit saw: rows set aside are in none of them, and that is told."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.cli.positions import _parts
from sk120stiff.explain.judge.borne_out import BorneOut
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.answer.next_step import headline, next_step_of_positions
from sk120stiff.explain.positions.judge.accounts import numbers_told
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.show.stories.positions_report import _not_told
from tests.positions.arm import errors, poses, tracked, write
from tests.positions.test_forms import calibrated, rows

SIGMA = 2e-5
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"
WILD, HELD = (5, 17, 40), (3, 9)


def read(folder: Path, count: int, seed: int, wild: tuple[int, ...]) -> Path:
    """Positions of a soft, crooked arm, some of them millimetres off."""
    folder.mkdir()
    a, rng = poses(count, seed), np.random.default_rng(seed)
    x = tracked(errors(4).stands(a)[0]) + SIGMA * rng.normal(size=(count, 3))
    x[list(wild)] += np.array([2e-3, -1e-3, 1e-3])
    return write(folder, a, x, FIT + NOISE)


def opened(path: Path) -> tuple[Model, Measurements]:
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return Model(robot), data.with_joints(robot.actuated)


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Explained:
    folder = tmp_path_factory.mktemp("outliers")
    model, data = opened(read(folder / "own", 80, 41, WILD))
    others = opened(read(folder / "others", 40, 77, HELD))[1]
    return explain_positions(model, data, holdout=others)


def test_a_held_out_file_is_judged_without_its_outliers(answer: Explained) -> None:
    found = answer.heldout
    assert found is not None
    assert np.flatnonzero(found.set_aside).tolist() == list(HELD)
    assert found.rms < 1.5 * SIGMA and found.distance < 2.5 * SIGMA
    assert found.rms_of_all > 10.0 * SIGMA  # nothing is hidden: it is told too


def test_cross_validated_numbers_leave_out_what_was_set_aside(answer: Explained) -> None:
    assert np.flatnonzero(answer.final.wild).tolist() == list(WILD)
    assert answer.steps[-1].heldout_rms < 1.5 * SIGMA
    assert answer.not_counted() == (
        "Fitted and held-out numbers leave out the 3 rows that were set aside.",
    )
    seen = answer.base
    later = seen.wild.copy()
    later[[0, 1]] = True  # rows that only the last fit set aside
    final = replace(answer.final, wild=later)
    told = numbers_told(seen, final, answer.readings)
    assert len(told) == len(seen.problem.counted) - 6
    first = np.flatnonzero(~seen.wild)
    assert not {0, 1} & set(first[seen.problem.rows[told]])


def test_another_gap_fitted_exactly_than_step_by_step_is_told(answer: Explained) -> None:
    last = replace(answer.steps[-1], fit_rms=1.2 * answer.final.rms)
    said = replace(answer, steps=(*answer.steps[:-1], last)).not_counted()
    assert len(said) == 2
    assert f"fitted exactly the last model leaves {1e6 * answer.final.rms:.4g} µm" in said[1]


def test_alternatives_that_are_hardly_likely_share_a_line(answer: Explained) -> None:
    item = answer.findings[-1]
    several = replace(item, alternatives=("a:1", "b:2", "c:3", "d:4"), exact=("d:4",))
    odds = {**answer.probabilities, "a:1": 0.2, "b:2": 0.001, "d:4": 0.0}
    found = replace(answer, verdict="ambiguous", findings=(several,), probabilities=odds)
    assert found.rivals_of(several) == (["a:1", "d:4"], ["b:2", "c:3"])
    assert f"{item.effect.id} or a:1 or d:4 or one of 2 that are hardly" in headline(found)
    shown = [part for part in _parts(found, Path("out")) if isinstance(part, str)]
    assert "  or, each with P < 0.01 here: b:2 or c:3" in shown
    told = _not_told(found, several)
    assert told == " Not told from: a:1 (P = 0.20) and 2 others, each with P < 0.01."
    one = replace(several, alternatives=("a:1", "b:2"), exact=())
    assert found.rivals_of(one) == (["a:1", "b:2"], [])


def test_what_is_called_wild_took_no_part_in_the_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Round after round one row more."""
    module, calls = sys.modules[calibrate.__module__], []
    first = module.wild_beside

    def one_more(*given: Any) -> np.ndarray:
        calls.append(given)
        out = first(*given)
        out[: min(len(calls), 9)] = True
        return np.asarray(out)

    monkeypatch.setattr(module, "wild_beside", one_more)
    model, data = opened(read(tmp_path / "own", 60, 41, ()))
    found = calibrate(model, data, waves=False)
    assert len(calls) > module.ROUNDS
    used = found.problem.measurements
    assert used.line.tolist() == data.line[~found.wild].tolist()


def test_wires_have_no_axes(tmp_path: Path) -> None:
    """Positions have: their rms is per axis."""
    a, anchors = poses(70, 2), np.array([[3.0, 0, 0], [0, 3, 0.5], [-2, -2, 2], [0, 0, 3.5]])
    at = anchors[np.arange(70) % 4]
    x = errors(1).stands(a)[0]
    far = np.linalg.norm(x - at, axis=1) + SIGMA * np.random.default_rng(3).normal(size=70)
    point = "point: {xyz: [50, -80, 120], unit: mm}\n"
    cells = rows(np.column_stack([1e3 * far, at]))
    (tmp_path / "wires").mkdir()
    more = ",l[mm],ax[m],ay[m],az[m]"
    wires = calibrated(
        write(tmp_path / "wires", a, np.nan * x, point + NOISE, more=more, cells=cells)
    )
    tracker = calibrated(read(tmp_path / "tracker", 70, 41, ()))
    assert wires.problem.rms_unit == "µm rms" and tracker.problem.rms_unit == "µm rms per axis"
    for found, per_axis in ((wires, False), (tracker, True)):
        for said in (found._repr_html_(), *findings_of(found)):
            assert said is not None and ("rms per axis" in said) == per_axis, said


def findings_of(found: Any) -> list[str]:
    from sk120stiff.identify.positions.residuals.remainder import in_words
    from sk120stiff.identify.positions.words import gap_sentence

    sizes, unit = (1e-5, 5e-6, 2e-5), found.problem.rms_unit
    return [gap_sentence(found), *(in_words(sizes, unit, stated=way) for way in (True, False))]


def test_a_file_that_speaks_against_the_names_does_so_in_the_headline(answer: Explained) -> None:
    assert "does not bear" not in headline(answer)
    assert answer.heldout is not None
    kept = f"at the readings of readings.csv by {1e6 * answer.heldout.rms:.4g} (without what was"
    assert kept in next_step_of_positions(answer)
    against = BorneOut("other.csv", 5.0e-3, 4.0e-3, -0.57, 0.39, 9)
    told = replace(answer, heldout=replace(answer.heldout, borne_out=against))
    assert "; but other.csv speaks against the model with what was named" in headline(told)
    far = replace(answer, heldout=replace(answer.heldout, rms=5.0 * answer.heldout.rms))
    assert "much more than these readings foretell" in next_step_of_positions(far)
    assert "much more" not in next_step_of_positions(answer)
    assert kept not in next_step_of_positions(told)
    guessed = next_step_of_positions(replace(answer, guess=answer.final, guess_heldout=1e-9))
    assert "best_guess.yaml is off by 0.001000 µm at poses left out" in guessed  # of no file
    document = told.document().as_keys()
    assert document["gap"]["borne_out"]["contradicted"] is True
    assert document["holdout"]["rms_um"] == pytest.approx(1e6 * answer.heldout.rms)
    assert replace(answer, heldout=None).document().holdout is None
