"""The ideal observer on made-up columns, on its own draws, and on one case of the generator."""

from __future__ import annotations

import json
from argparse import Namespace
from pathlib import Path

import numpy as np

from tests.hidden.calibration import calibration
from tests.hidden.generator.build import build
from tests.hidden.generator.design import plan
from tests.hidden.generator.noise import Noise
from tests.hidden.generator.robots import six_axis
from tests.hidden.ideal import Bench, case_line, table
from tests.hidden.observer import LENIENT, Law, Whole, decide, posterior

COUNT = 40
STRENGTHS = np.geomspace(2.0, 40.0, 13)


def law(*columns: np.ndarray, mean: np.ndarray | None = None) -> Law:
    spread = np.array(columns).T / np.sqrt(len(columns))
    nowhere = np.zeros(COUNT) if mean is None else mean
    return Law(nowhere, spread, STRENGTHS, 1.0 / len(STRENGTHS))


AXES = np.eye(COUNT)
APART = {"one": [law(AXES[0])], "two": [law(AXES[1], AXES[2])], "ways": [
    Law(AXES[3], 0.3 * AXES[3:4].T, STRENGTHS, 0.5 / len(STRENGTHS)),
    Law(AXES[4], 0.3 * AXES[4:5].T, STRENGTHS, 0.5 / len(STRENGTHS)),
]}  # fmt: skip


def said(candidates: dict[str, list[Law]], signal: np.ndarray, draws: int = 300) -> list[frozenset]:  # type: ignore[type-arg]
    noise = np.random.default_rng(3).normal(size=(COUNT, draws))
    chances = posterior(candidates, signal[:, None] + noise)
    assert np.allclose(chances.sum(axis=0), 1.0)
    return [decide(list(candidates), column) for column in chances.T]


def test_strong_signal_is_named_alone() -> None:
    for name, signal in (("one", 12 * AXES[0]), ("two", 12 * AXES[2]), ("ways", 12 * AXES[4])):
        found = said(APART, signal)
        assert found.count(frozenset({name})) >= 297


def test_nothing_is_none() -> None:
    assert said(APART, np.zeros(COUNT)).count(frozenset()) >= 297


def test_two_parallel_columns_are_a_pair() -> None:
    near = AXES[0] + 0.05 * AXES[5]
    twins = {**APART, "twin": [law(near / np.linalg.norm(near))]}
    found = said(twins, 12 * AXES[0])
    assert found.count(frozenset({"one", "twin"})) >= 250
    # what is told apart when the signal is strong enough
    assert said(twins, 150 * AXES[0]).count(frozenset({"one"})) >= 295


def test_a_sign_tells_apart() -> None:
    one_way = {
        "up": [law(0.3 * AXES[0], mean=AXES[0])],
        "down": [law(0.3 * AXES[0], mean=-AXES[0])],
    }
    assert said(one_way, 10 * AXES[0]).count(frozenset({"up"})) >= 295


def test_what_is_known_is_no_evidence() -> None:
    cut = np.eye(COUNT) - np.outer(AXES[0], AXES[0])
    left = {name: [way.through(cut) for way in laws] for name, laws in APART.items()}
    assert said(left, 20 * AXES[0]).count(frozenset()) >= 297


def test_decide_covers_what_it_must() -> None:
    names = ["a", "b", "c"]
    assert decide(names, np.array([0.96, 0.02, 0.0, 0.02])) == {"a"}
    assert decide(names, np.array([0.70, 0.02, 0.26, 0.02])) == {"a", "c"}
    assert decide(names, np.array([0.90, 0.03, 0.0, 0.07])) == frozenset()
    assert decide(names, np.array([0.90, 0.03, 0.0, 0.07]), LENIENT) == {"a"}
    assert decide(names, np.array([0.20, 0.20, 0.0, 0.60]), LENIENT) == frozenset()


def test_posterior_is_a_frequency() -> None:
    rng = np.random.default_rng(5)
    near = (AXES[0] + 0.3 * AXES[5]) / np.hypot(1.0, 0.3)
    candidates = {**APART, "near": [law(near)]}
    names = [*candidates, "none"]
    count, true = 6000, []
    seen = rng.normal(size=(COUNT, count))
    for k in range(count):
        name = "none" if rng.random() < 0.5 else names[int(rng.integers(len(candidates)))]
        true.append(name)
        if name != "none":
            ways = candidates[name]
            way = ways[int(rng.integers(len(ways)))]
            z = rng.normal(size=way.spread.shape[1])
            seen[:, k] += rng.choice(way.strengths) * (way.mean + way.spread @ z)
    chances = posterior(candidates, seen)

    def gap(table: np.ndarray) -> float:
        pairs = [
            (float(table[i, k]), names[i] == true[k])
            for k in range(count)
            for i in range(len(names))
        ]
        found = calibration(pairs)
        assert found is not None
        for own in found.bins:
            if own.count > 100 and table is chances:
                spread = np.sqrt(own.stated * (1 - own.stated) / own.count)
                assert abs(own.stated - own.true) < 4 * spread + 0.002, own
        return found.error

    flatter = chances**0.5
    assert gap(chances) < 0.01 < 0.03 < gap(flatter / flatter.sum(axis=0))


def test_whole_noise_has_wander_and_warm_up() -> None:
    rng = np.random.default_rng(2)
    rows = plan(six_axis(), rng, poses=3, loads=2)
    own = {"wander": 4e-6, "warm_up": 3e-5, "warm_time": 5.0}
    noise, whole = Noise(5e-6, **own), Whole(5e-6, **own)  # type: ignore[arg-type]
    still, far = np.zeros((rows.count, 3)), np.ones((rows.count, 3))
    drawn = [np.subtract(*noise.sample(rows, still, far, rng)).ravel() for _ in range(6000)]
    found, said_ = np.cov(np.array(drawn).T), whole.covariance(rows, still, far)
    assert np.abs(found - said_).max() < 0.08 * said_.max()
    plain = noise.covariance(rows, still, far)
    assert np.abs(found - plain).max() > 0.3 * said_.max()


def test_a_strong_cause_of_the_generator(tmp_path: Path) -> None:
    case = build("L1", 880002, 0)
    truth = case.truth()
    (tmp_path / "case_0000.json").write_text(json.dumps(truth))
    line = case_line(tmp_path / "case_0000.json", Namespace(draws=20, none=0.5, seed=1))
    assert line["broad"] > 0.9 and line["alarm"] < 0.1 and line["none"] == 0.0
    assert f"| L1 | 1 | {100 * line['broad']:.1f}" in table([line])
    # the first-order columns stand for the whole change
    (entry,) = case.hidden
    assert (
        abs(np.linalg.norm(Bench(case).columns(entry.cause).sum(1)) / entry.visibility - 1) < 0.05
    )
