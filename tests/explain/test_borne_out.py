"""A hold-out file that contradicts what was named is told, and one that bears it out is not."""

from __future__ import annotations

import importlib
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sk120stiff.explain.answer.document import borne_out_entry
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.answer.words import held_out_words
from sk120stiff.explain.findings import Step
from sk120stiff.explain.judge.borne_out import BorneOut, shown
from tests.explain.test_words import Answered

NOISE = 2e-5  # m
POSES = [f"p{k // 4}" for k in range(24)]
AGAINST = BorneOut("held.csv", 2.286e-5, 2.135e-5, 0.39, 0.23, 5)


def judged(there: float, poses: list[str] = POSES, seed: int = 0) -> BorneOut | None:
    """Names that add 20 µm, of which so much is really there."""
    rng = np.random.default_rng(seed)
    added = rng.normal(0.0, 2e-5, (len(poses), 3))
    before = there * added + rng.normal(0.0, NOISE, added.shape)
    before[3, 1] = np.nan
    return shown(before, before - added, poses, "held.csv")


@pytest.mark.parametrize("seed", range(5))
def test_a_share_is_what_is_there_of_what_the_names_add(seed: int) -> None:
    for there in (1.0, 0.0):
        found = judged(there, seed=seed)
        assert found is not None and found.poses == 6
        assert abs(found.share - there) < 4.0 * found.std
        assert 0.02 < found.std < 0.4
        assert found.contradicted == (there == 0.0)
        assert (found.gap > found.without) == (there == 0.0)


def test_how_sure_a_share_is_the_poses_tell() -> None:
    """Readings of one pose go together: many of them at few poses are few."""
    rng = np.random.default_rng(3)
    poses = [f"p{k // 40}" for k in range(240)]
    added = rng.normal(0.0, 2e-5, (240, 3))
    own = np.repeat(rng.normal(0.0, 1.0, 6), 40)[:, None] * added
    alike = shown(own, own - added, poses, "held.csv")
    each = shown(own, own - added, [str(k) for k in range(240)], "held.csv")
    assert alike is not None and each is not None
    assert alike.std > 4.0 * each.std


def test_too_few_poses_contradict_nothing() -> None:
    assert judged(0.0, poses=["one"] * 24) is None
    two = judged(0.0, poses=["one"] * 12 + ["two"] * 12)
    assert two is not None and two.gap > two.without and not two.contradicted


def test_names_that_add_nothing_there_are_not_judged() -> None:
    same = np.ones((8, 3))
    assert shown(same, same, list("aabbccdd"), "held.csv") is None


def test_no_better_within_chance_is_no_contradiction() -> None:
    assert AGAINST.contradicted
    assert not replace(AGAINST, std=0.4).contradicted
    assert not replace(AGAINST, gap=2.0e-5).contradicted


@pytest.mark.parametrize("verdict", ["named", "ambiguous", "outside"])
def test_what_to_do_now_says_it_first(verdict: str) -> None:
    said = next_step(Answered(verdict=verdict, borne_out=AGAINST))
    assert said.startswith(
        "At the readings of held.csv the model is off by no less with these names (22.86 µm) than "
        "without (21.35): the names, or their sizes, do not hold there."
    )
    assert "Use model.yaml where" not in said and "Use model.yaml:" not in said
    fine = replace(AGAINST, gap=2.0e-5)
    assert "held.csv" not in next_step(Answered(verdict=verdict, borne_out=fine))


def test_text_report_and_document_say_it() -> None:
    (said,) = held_out_words(Answered(borne_out=AGAINST))
    assert said.startswith(
        "At the readings of held.csv the model with these names is off by 22.86 µm rms per axis, "
        "without them by 21.35: of what they add there 0.39 ± 0.23 is seen"
    )
    told = borne_out_entry(AGAINST)
    assert told is not None and told.contradicted and told.poses == 5
    assert borne_out_entry(None) is None


def balancer(masses: float) -> Any:
    effect = SimpleNamespace(
        id="gravity_compensator:j2", name="gravity_compensator", where="j2", random_effects=False
    )
    finding = SimpleNamespace(effect=effect, others=(), alternatives=(), settled=True)

    class Weighed(Answered):
        @property
        def final(self) -> Any:
            plain = super().final
            plain.model.robot.total_mass = masses
            return plain

    return Weighed(findings=(finding,))


def test_without_masses_a_balancer_may_be_weight_on_a_gear() -> None:
    said = next_step(balancer(0.0))
    assert "gravity_compensator:j2 stands for a stiffness that goes with the posture." in said
    assert "the arm's own weight on a gear of j2 that is not linear brings the same" in said
    assert "gravity_compensator" not in next_step(balancer(120.0))


@pytest.mark.parametrize(("foretold", "trusted"), [(2e-5, True), (3.28e-4, False)])
def test_springs_of_two_poses_are_not_used_as_they_are(
    monkeypatch: pytest.MonkeyPatch, foretold: float, trusted: bool
) -> None:
    """Nothing is missing where two poses fit, and one foretells the other by twenty times worse."""
    module = importlib.import_module("sk120stiff.explain.answer.next_step")
    monkeypatch.setattr(module, "nothing", lambda _answer: 0.9)
    answer = Answered(
        verdict="none", understated=None, steps=(Step("joint_springs", 1.68e-5, foretold),),
        significant=False, goes_with=None,
    )  # fmt: skip
    said = next_step(answer)
    assert ("Use model.yaml as it is." in said) == trusted
    assert ("16.8 µm rms per axis, but without one of them it foretells it to 328 µm" in said) != (
        trusted
    )
    assert bool(held_out_words(answer)) != trusted
