"""Names beside an error of the model that nobody knows: evidence, and what falls."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

import sk120stiff as sk
from sk120stiff.explain.positions.judge.fallen import with_one_less
from sk120stiff.explain.positions.judge.posterior import Posterior, of_all
from sk120stiff.explain.positions.judge.smooth_error import SmoothError, beside_any, of_errors
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.explain.positions.select.choose import Chosen
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.noise.model_form import ModelForm
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from tests.positions.explain.test_linear import ROWS, linear
from tests.positions.shared import campaign
from tests.positions.unknown_error import drawn


def smooth(size: float) -> np.ndarray:
    """(ROWS, ROWS) unit noise, and an error over it that neighbours share."""
    at = np.linspace(0.0, 1.0, ROWS)
    return np.eye(ROWS) + size * np.exp(-((at[:, None] - at) ** 2) / 0.02)


def errors(made: Linear, sizes: tuple[float, ...]) -> SmoothError:
    return of_errors(made, (smooth(size) for size in sizes))


def dense(made: Linear, V: np.ndarray, chosen: tuple[int, ...]) -> float:
    """Log density of what of the readings the base does not take, by a dense Gaussian."""
    own = made.columns[:, list(chosen)]
    blind = np.linalg.svd(made.base)[0][:, made.base.shape[1] :]
    whole = blind.T @ (V + own @ own.T) @ blind
    return float(multivariate_normal(cov=whole).logpdf(blind.T @ made.residual))


@pytest.mark.parametrize("chosen", [(), (0,), (0, 2)])
def test_evidence_is_that_of_dense_gaussians_over_all_errors_alike(chosen: tuple[int, ...]) -> None:
    made, sizes = linear(2.0, 0.0, 1.0), (0.0, 1.0, 30.0)
    found, nothing = (errors(made, sizes).score(each) for each in (chosen, ()))
    meant = [
        logsumexp([dense(made, smooth(size), each) for size in sizes]) for each in (chosen, ())
    ]
    assert found - nothing == pytest.approx(meant[0] - meant[1], abs=1e-6)


def test_the_likeliest_errors_alone_say_the_same_but_for_their_number() -> None:
    made = linear(2.0)
    every = errors(made, tuple(np.geomspace(1e-3, 1e3, 20)))
    few = every.likeliest([(0,), ()])
    assert len(few.at) < len(every.at)
    gained = [each.score((0,)) - each.score(()) for each in (every, few)]
    assert gained[0] == pytest.approx(gained[1], abs=0.25)


def test_a_name_that_is_smooth_itself_is_less_likely_beside_a_smooth_error() -> None:
    """One that is not is as likely as it was."""
    made = linear(0.0)
    slow = np.cos(np.linspace(0.0, 4.0, ROWS))[:, None]
    rough = np.cos(np.arange(ROWS) * 2.5)[:, None]
    columns = np.hstack([slow, rough, made.columns[:, 2:]])
    columns -= made.base @ (made.base.T @ columns)
    made = replace(made, columns=columns, residual=made.residual + columns @ [1.2, 1.2, 0, 0])
    beside = replace(made, errors=errors(made, (0.0, 1.0, 10.0)), stated=False, independent=20.0)
    gained = [
        each.score((0, 1)) - each.score((1,)) for each in (errors(made, (0.0,)), beside.errors)
    ]
    assert gained[1] < 0.5 * gained[0]
    assert Posterior(beside, (0, 1)).names[1][1] > 0.99
    empty = replace(made, residual=0.0 * made.residual)
    empty = replace(empty, errors=errors(empty, (0.0, 1.0)))
    assert of_all(beside, (0, 1)) > 0.99 > 0.5 > of_all(empty, (0, 1))


def judged(made: Linear, found: Chosen) -> Posterior:
    return Posterior(made, found.order)


def test_names_fall_one_at_a_time_the_weakest_first(monkeypatch: pytest.MonkeyPatch) -> None:
    made = linear(3.0, 0.15, 0.1)
    made = replace(made, errors=errors(made, (0.0, 1.0)))
    nobody = SimpleNamespace(parameters=(), at_bound=())
    found, order = Chosen((0, 1, 2), {}), []
    while (less := with_one_less(judged(made, found), found, nobody)) is not None:  # type: ignore[arg-type]
        (gone,) = set(found.order) - set(less.order)
        order.append(gone)
        assert made.candidates[gone].id in less.dropped[gone]
        found = less
    assert found.order == (0,) and sorted(order) == [1, 2]


def test_names_that_stand_for_one_another_stay_together() -> None:
    """Each takes off hardly anything beside the other; both a lot of what is left otherwise."""
    made = linear(2.5, 0.0)
    twin = made.columns[:, 0] + 0.03 * made.columns[:, 3]
    made = replace(made, columns=np.column_stack([made.columns[:, 0], twin, made.columns[:, 2:]]))
    made = replace(made, errors=errors(made, (0.0, 1.0)))
    likely = [probability for _, probability in Posterior(made, (0, 1)).names.values()]
    assert of_all(made, (0, 1)) > max(likely) + 0.1


def test_a_station_of_which_no_row_is_asked_tells_nothing() -> None:
    """Columns of the base that are nothing, or one, among the rows that errors are judged at."""
    made = linear(2.0)
    none = np.column_stack([made.base, 0.0 * made.base[:, 0], made.base @ [1.0, 1.0]])
    problem = calibrated_problem(ROWS)
    form = ModelForm(0.5, 10.0, 10.0, 0.0, np.zeros(7), np.ones(6) / 6.0, 1.0)
    row = problem.rows
    scores = []
    for base in (made.base, none):
        there = replace(made, base=base, row=row)
        found = beside_any(there, problem, form)
        scores.append(found.score((0,)) - found.score(()))
    assert np.isfinite(scores).all() and scores[0] == pytest.approx(scores[1], abs=1e-6)


def test_a_name_that_comes_out_as_nothing_falls_though_it_fits_alone() -> None:
    made = linear(3.0, 3.0)
    own = [SimpleNamespace(effect=made.candidates[e], internal=v) for e, v in ((0, 1.0), (1, 0.0))]
    final = SimpleNamespace(parameters=own, at_bound=(False, True))
    found = Chosen((0, 1), {})
    less = with_one_less(judged(made, found), found, final)  # type: ignore[arg-type]
    assert less is not None and less.order == (0,)
    assert "comes out as nothing" in less.dropped[1]


@pytest.mark.parametrize("seed", [12, 20, 24])
def test_names_that_are_there_are_likely_beside_an_error_that_nobody_knows(
    seed: int, tmp_path: Path
) -> None:
    """They had P < 0.2 by a count of independent numbers, though they brought much elsewhere."""
    truth = drawn(seed)
    found = explain_positions(*truth.read(tmp_path))
    assert found.final.form is not None and found.findings
    for item in found.findings:
        if item.probability > 0.9:
            assert truth.holds(item.effect.id, *item.alternatives), item.effect.id
    assert sum(item.probability > 0.9 for item in found.findings) >= 2
    assert all(item.probability >= 0.5 for item in found.findings)


def test_errors_are_of_each_joint_and_of_all_and_go_with_the_load_where_that_differs(
    tmp_path: Path,
) -> None:
    counts = []
    for loads in ((0.0,), (0.0, 30.0)):
        found = calibrated(campaign(tmp_path, 3, 24, loads=loads, markers="A"))
        shown = linear(0.0)
        count = len(found.problem.rows)
        made = replace(
            shown, residual=np.ones(count), base=np.eye(count)[:, :2], row=found.problem.rows,
            columns=np.zeros((count, 4)), fold=np.zeros(count, dtype=np.intp),
        )  # fmt: skip
        form = ModelForm(0.5, 10.0, 10.0, 0.0, np.ones(7), np.ones(6) / 6.0, 1.0)
        every = beside_any(made, found.problem, form).each
        assert len({round(volume, 6) for _, volume in every}) == len(every)  # no two are one
        counts.append(len(every))
    assert counts == [1 + 3 * (1 + 6 + 1 + 1), 1 + 3 * (1 + 2 * (6 + 1) + 1)]


def calibrated_problem(numbers: int) -> PoseProblem:
    with TemporaryDirectory() as folder:
        found = calibrated(campaign(Path(folder), 3, numbers // 3, loads=(0.0,), markers="A"))
    return found.problem


def calibrated(readings: sk.Measurements) -> Calibration:
    model = sk.base_model(sk.load_robot(readings.robot, base="base", tool="tool"))
    return calibrate(model, readings, geometry=False, waves=False, shared=False)
