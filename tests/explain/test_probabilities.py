"""Every number of `probabilities` says what it is of, and what rivals have is not that of none."""

from types import SimpleNamespace
from unittest import mock

import pytest

from sk120stiff.cli.explain_output import findings
from sk120stiff.explain.answer.probabilities import nothing_in_its_place, probabilities
from sk120stiff.explain.findings import likely
from sk120stiff.show.stories.probability_section import rows_of


def place(name: str, odds: dict[str, float]) -> SimpleNamespace:
    return SimpleNamespace(effect=SimpleNamespace(id=name), evidence=SimpleNamespace(odds=odds))


def answered(*findings: SimpleNamespace, odds: dict[str, float] | None = None, else_: float = 0.0):
    return SimpleNamespace(
        findings=findings,
        odds={"none": 0.9, "tilt:j1": 0.08} if odds is None else odds,
        remainder=SimpleNamespace(something_else=else_),
    )


PLAY = place("play:j3", {"play:j3": 0.9845, "bend:j3": 0.0155})
BEND = place("bend:j1", {"bend:j1": 0.7, "play:j1": 0.2, "bend:j3": 0.05})


def test_what_rivals_have_is_not_that_of_none() -> None:
    assert nothing_in_its_place(PLAY) == pytest.approx(0.0, abs=1e-12)
    assert nothing_in_its_place(BEND) == pytest.approx(0.05)
    told = {each.name: each for each in probabilities(answered(PLAY))}
    assert told["none"].probability == pytest.approx(0.0, abs=1e-12)
    alone = {each.name: each for each in probabilities(answered(BEND, else_=0.5))}
    assert alone["none"].probability == pytest.approx(0.9 * 0.5 * 0.05)


def test_every_number_says_what_it_is_a_probability_of() -> None:
    told = {each.name: each for each in probabilities(answered(PLAY, BEND, else_=0.02))}
    kinds = {name: (each.kind, each.place) for name, each in told.items()}
    assert kinds == {
        "play:j3": ("named", "play:j3"),
        "bend:j1": ("named", "bend:j1"),
        "play:j1": ("instead", "bend:j1"),
        "bend:j3": ("instead", "bend:j1"),
        "tilt:j1": ("further", None),
        "none": ("none", None),
        "something_else": ("something_else", None),
    }
    shares = [each.probability for each in probabilities(answered(PLAY, BEND))]
    assert shares == sorted(shares, reverse=True)


def test_a_named_effect_is_told_as_named_wherever_else_it_might_stand() -> None:
    elsewhere = place("tilt:j2", {"tilt:j2": 0.1, "play:j3": 0.9999})
    told = {each.name: each for each in probabilities(answered(PLAY, elsewhere))}
    assert (told["play:j3"].kind, told["play:j3"].probability) == ("named", 0.9845)


def test_lines_of_one_place_add_up_to_one() -> None:
    rows = rows_of(answered(PLAY, BEND))
    for name in ("play:j3", "bend:j1"):
        assert sum(row.probability for row in rows if row.place == name) == pytest.approx(1.0)
    assert [row.name for row in rows if row.named] == ["play:j3", "bend:j1"]
    assert {row.name for row in rows[-2:]} == {"nothing is missing", "something without a name"}


@pytest.mark.parametrize(
    ("share", "said"), [(0.9949, "P > 0.99"), (0.987, "P = 0.99"), (0.0, "P < 0.01")]
)
def test_no_name_is_certain(share: float, said: str) -> None:
    assert likely(share) == said


def test_a_set_is_told_as_a_set_on_the_terminal() -> None:
    effect = SimpleNamespace(name="play", id="play:j1", told=lambda _: "The gear of j1 has play.")
    one = SimpleNamespace(
        effect=effect, probability=0.9996, alternatives=("bend:j1", "loop:j1"), exact=("loop:j1",),
        others=("bend:j1",),
        evidence=SimpleNamespace(runner_up=None, odds={"play:j1": 0.7, "bend:j1": 0.2996}),
    )  # fmt: skip
    model = SimpleNamespace(parameters=())
    told = SimpleNamespace(findings=(one,), final=SimpleNamespace(model=model))
    with mock.patch("sk120stiff.cli.explain_output.unseen_reasons", return_value={}):
        lines = findings(told)
    assert "(P = 0.70; it or one of those below: P > 0.99)" in lines[0]
    assert "or bend:j1 (not told apart here; P = 0.30)" in lines[1]
    assert "or loop:j1 (always the same)" in lines[2]
    one.alternatives, one.others = ("loop:j1",), ()
    with mock.patch("sk120stiff.cli.explain_output.unseen_reasons", return_value={}):
        assert findings(told)[0].endswith("(P > 0.99)")
