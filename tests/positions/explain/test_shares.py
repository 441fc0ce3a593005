"""What each name takes off: in shares of their own, and of what the readings do not tell."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer import explained
from sk120stiff.explain.positions.answer.explained import Explained
from tests.positions.explain.test_balancer import balanced
from tests.positions.test_payload_place import robot_of


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Explained:
    path: Path = balanced(tmp_path_factory.mktemp("shares"), 120.0)
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    return found


def test_shares_that_add_up_to_more_than_all_say_why(answer: Explained) -> None:
    assert sum(item.gain.share for item in answer.findings) > 1.0
    (said,) = answer.shares()
    assert "more than 100 %" in said and said in answer.report().html()
    assert replace(answer, findings=answer.findings[:1]).shares() == ()


def test_what_a_name_takes_off_is_told_with_what_it_has_it_from(
    answer: Explained, monkeypatch: pytest.MonkeyPatch
) -> None:
    item = next(each for each in answer.findings if each.effect.id == "joint_springs:j2")
    share = f"takes off {100 * item.gain.share:.1f} %"
    assert answer.taken_off(item) == share
    assert answer.taken_off(item, " of it") == f"{share} of it"
    nothing, worse = (replace(item, gain=replace(item.gain, share=s)) for s in (1e-4, -0.05))
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
