"""What each name takes off: in shares of their own, and of what the readings do not tell."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer import explained
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.judge.accounts import Account, numbers_told
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.explain.positions.select.choose import Chosen
from tests.positions.explain.test_balancer import balanced
from tests.positions.shared import OFF, campaign
from tests.positions.test_payload_place import robot_of


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Explained:
    path: Path = balanced(tmp_path_factory.mktemp("shares"), 120.0)
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    return found


def test_shares_that_add_up_to_more_than_all_say_why(answer: Explained) -> None:
    assert sum(item.share for item in answer.findings) > 1.0
    (said,) = answer.shares()
    assert "more than 100 %" in said and said in answer.report().html()
    assert replace(answer, findings=answer.findings[:1]).shares() == ()


def test_a_share_is_that_of_the_table(answer: Explained) -> None:
    """The last that joined takes off what the last two rows say, and so it is written."""
    before, after = (step.heldout_rms for step in answer.steps[-2:])
    last = answer.findings[-1]
    assert last.effect.id == answer.steps[-1].label.removeprefix("+ ")
    assert last.share == pytest.approx(1.0 - after / before, rel=1e-9)
    written = answer.document().effects[-1].evidence["heldout_gain"]
    assert written == last.share


def test_a_model_that_nobody_fits_counts_as_it_foretells_better(tmp_path: Path) -> None:
    """Beside what poses have in common a model with fewer names is off by more than it need be."""
    m = campaign(tmp_path, 14, 18, loads=(0.0,), markers="ABC", off=5 * OFF)
    found = explain_positions(sk.Model(sk.load_robot(m.robot, base="base", tool="tool")), m)
    assert found.final.problem.common > 0.0 and len(found.findings) > 1
    linear = found.linear
    order = tuple(
        next(e for e, each in enumerate(linear.candidates) if each == item.effect)
        for item in found.findings
    )
    account = Account(
        linear, Chosen(order, {}), found.final, numbers_told(found.final, found.final, m)
    )
    assert account.held_out(order) < account.left - 1e-6  # with every reading alike
    steps = found.steps
    last = found.findings[-1]
    assert last.share == pytest.approx(1.0 - steps[-1].heldout_rms / steps[-2].heldout_rms)
    grown = (*steps[:-1], replace(steps[-1], fit_rms=2.0 * steps[-2].fit_rms))
    assert "So a gap may grow." in " ".join(replace(found, steps=grown).not_counted())
    assert abs(last.share - last.gain.share) > 0.01  # as readings weigh it is another number


def test_probabilities_are_told_of_each_name_and_of_one_of_them(answer: Explained) -> None:
    (item, *_) = answer.findings
    own = item.effect.id
    both = replace(item, alternatives=("a:j1", "b:j1"), exact=("b:j1",), probability=0.99)
    told = replace(answer, findings=(both,), probabilities={own: 0.37, "a:j1": 0.63, "b:j1": 0.2})
    assert told.chance_of(both) == "P = 0.37; it or one of those not told from it: P = 0.99"
    more = "more than of the one that model.yaml has"
    assert told.rival(both, "a:j1") == f"not told apart here; P = 0.63, {more}"
    assert told.rival(both, "b:j1") == "always the same; P = 0.20"
    page = told.report().html()
    assert "add up to more" in told.sums()[0] and told.sums()[0] in page
    assert "a:j1 (P = 0.63)" in page and "b:j1 (P = 0.20)" in page
    shared = replace(told, probabilities={own: 0.5, "a:j1": 0.3, "b:j1": 0.19})
    assert shared.sums() == ()


def test_values_that_are_known_together_alone_say_so(
    answer: Explained, monkeypatch: pytest.MonkeyPatch
) -> None:
    item = next(each for each in answer.findings if each.effect.name == "transmission_error")
    assert answer.only_together(item) == ()
    own = [k for k, p in enumerate(answer.final.model.parameters) if p.effect == item.effect]
    value = answer.final.model.values[own]

    def with_errors(along: float, across: float) -> None:
        """Known along the values by so many errors, and across them."""
        unit = value / np.linalg.norm(value)
        wide = across**2 * np.eye(len(own)) + (along**2 - across**2) * np.outer(unit, unit)
        whole = np.zeros((len(answer.final.model.values),) * 2)
        whole[np.ix_(own, own)] = wide * (value @ value)
        monkeypatch.setattr(explained, "internal_covariance", lambda _fit: whole)

    with_errors(0.1, 10.0)
    (said,) = answer.only_together(item)
    assert said.startswith("None of its values is known by itself") and "χ² = 100 on 4" in said
    with_errors(3.0, 10.0)
    (said,) = answer.only_together(item)
    assert said.endswith("nor all together.") and said in answer.report().html()


def test_what_a_name_takes_off_is_told_with_what_it_has_it_from(
    answer: Explained, monkeypatch: pytest.MonkeyPatch
) -> None:
    item = next(each for each in answer.findings if each.effect.id == "joint_springs:j2")
    share = f"takes off {100 * item.share:.1f} %"
    assert answer.taken_off(item) == share
    assert answer.taken_off(item, " of it") == f"{share} of it"
    nothing, worse = (replace(item, share=s) for s in (1e-4, -0.05))
    assert answer.taken_off(nothing) == "takes nothing off beside the others"
    assert answer.taken_off(worse, " of it") == "beside the others adds 5.0 % of it"
    own = [p.effect == item.effect for p in answer.final.parameters]
    rigid = replace(answer, final=replace(answer.final, at_bound=np.array(own)))
    assert (
        rigid.taken_off(item) == f"alone {share}; beside the others its value comes out as nothing"
    )
    names = {p.name: "so" for p, it in zip(answer.final.parameters, own, strict=True) if it}
    monkeypatch.setattr(explained, "unseen", lambda _found: names)
    assert answer.taken_off(item).endswith("errors of geometry, from which its size is not told")
