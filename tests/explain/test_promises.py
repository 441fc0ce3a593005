"""What candidates promise, and the search that scores those alone that may lead."""

from __future__ import annotations

import numpy as np
import pytest

from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.select import beam
from sk120stiff.explain.select.promises import promises
from sk120stiff.explain.select.score import score_set
from tests.explain.test_regression import beside_form, regression, vars_of

SINGLES = 40


NOISE = {"stated": 1.0, "unknown": 0.2, "form": 1.0}


def many(seed: int, noise: str) -> Regression:
    """Readings that four of forty candidates make, with columns that resemble each other."""
    rng = np.random.default_rng(seed)
    form = noise == "form"
    plain = beside_form(0.2) if form else regression(seed, known=noise == "stated")
    common = rng.normal(size=(len(plain.y), 6)) @ rng.normal(size=(6, SINGLES + 2))
    X = rng.normal(size=(len(plain.y), SINGLES + 2)) + 0.5 * common
    true = np.zeros(SINGLES + 2)
    true[[0, 1, 5, 11, 23, 31]] = [4.0, -3.0, 1.5, 0.5, -0.3, 0.2]
    smaller = form & (np.arange(len(X)) % 3 < 2)  # its error is less than was thought
    y = X @ true + np.where(smaller, 0.6, NOISE[noise]) * rng.normal(size=len(X))
    columns = tuple(np.array([k]) for k in range(2, SINGLES + 2))
    law = plain.laws[0][0]
    own = {
        "y": y,
        "X": X,
        "candidates": (law,) * SINGLES,
        "columns": columns,
        "variants": tuple((each,) for each in columns),
        "laws": ((law,),) * SINGLES,
        "tied": (-1,) * SINGLES,
        "usual": (0,) * SINGLES,
        "lower": np.full(SINGLES + 2, -np.inf),
        "plausible": np.full(SINGLES + 2, 1e6),
        "compliances": np.zeros(SINGLES + 2, dtype=bool),
    }
    if plain.form is not None:
        rows = np.arange(len(y)) % 3 < 2
        own["form"] = type(plain.form)(y[rows], X[rows], plain.group[rows], 0.2)
    return Regression(**{**vars_of(plain), **own})


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_score_is_hardly_better_than_hoped(seed, noise):
    found = many(seed, noise)
    sums = found.sums()
    for effects in ((), (3,), (3, 9)):
        model = score_set(found, sums, effects)
        hopes = promises(found, sums, model.solved).hopes(model)
        real = [score_set(found, sums, (*effects, e)).score for e in range(12, SINGLES)]
        assert (hopes[12:] - real).max() < beam.SLACK
        assert np.abs(hopes[12:] - real).min() < beam.SLACK  # and some come true


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_search_finds_in_few_what_it_finds_in_all(monkeypatch, seed, noise):
    scored: list[int] = []
    plain = beam.score_sets

    def counted(regression, sums, sets, *more):
        scored.append(len(sets))
        return plain(regression, sums, sets, *more)

    monkeypatch.setattr(beam, "score_sets", counted)
    few = beam.beam_search(many(seed, noise))
    in_few, scored[:] = sum(scored), []
    monkeypatch.setattr(beam, "SLACK", np.inf)
    every = beam.beam_search(many(seed, noise))
    assert in_few < 0.7 * sum(scored)
    best = [(model.effects, model.score) for model in every[: beam.BEAM]]
    assert [(model.effects, model.score) for model in few[: beam.BEAM]] == best
    assert {3, 9, 21} <= set(few[0].effects)
