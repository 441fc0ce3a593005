"""Sentences of an answer do not contradict one another, and say what their numbers mean."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sk120stiff.cli.explain_output import _gain, said
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.answer.words import (
    accounted,
    held_out_words,
    mostly_accounted,
    noise_words,
    plain_words,
    told_next,
)
from sk120stiff.explain.findings import Apart, Contender, Step
from sk120stiff.explain.judge.adequacy import Adequacy
from sk120stiff.explain.judge.goes_with import Foretold, GoesWith
from sk120stiff.explain.localise.localisation import Localisation
from sk120stiff.identify import LackOfFit
from sk120stiff.model import Share

PLACE = "the force that link_3 carries"
ALL = GoesWith(PLACE, 0.0, 2e-5, beside_names=True)
MOST = GoesWith(PLACE, 3e-6, 2e-5, beside_names=True)
BEYOND = LackOfFit("stated", 681.0, (292, None), 1e-30, 1.53)


def adequacy(understated: float | None = None) -> Adequacy:
    return Adequacy(1e-9, 30.0, 80.0, {"whole misfit": 1e-9}, BEYOND, understated, PLACE)


@dataclass
class Answered:
    """What `next_step` and the sentences ask of an answer."""

    goes_with: GoesWith | None = ALL
    closest: str | None = None
    understated: float | None = None
    verdict: str = "named"
    significant: bool = True
    steps: tuple[Step, ...] = (Step("joint_springs", 9e-5, 9.5e-5), Step("+ a:b", 3e-5, 3.2e-5))
    findings: tuple[Any, ...] = ()
    budget: tuple[Any, ...] = ()
    next_poses: Any = None
    next_pairs: tuple[Any, ...] = ()
    guess: Any = None
    units: str | None = None
    beyond: str | None = None
    borne_out: Any = None
    yardstick: Any = field(default_factory=lambda: SimpleNamespace(sigma=1e-5))
    softer: tuple[str, ...] = ()
    slips: dict[int, str] = field(default_factory=dict)
    far_off: tuple[tuple[str, float], ...] = ()

    @property
    def adequacy(self) -> Adequacy:
        return adequacy(self.understated)

    @property
    def remainder(self) -> Any:
        return SimpleNamespace(
            goes_with=self.goes_with, closest=self.closest, significant=self.significant, rms=2e-5
        )

    @property
    def noise_reasons(self) -> tuple[str, ...]:
        return ("Rows share a zero.", *self.adequacy.of_the_statement())

    @property
    def final(self) -> Any:
        readings = SimpleNamespace(
            repeat=None, branch=None, order=(1,), time=None, n_readings=100, poses=list("abcdefg")
        )
        robot = SimpleNamespace(total_mass=0.0, gravity=np.zeros(3))
        return SimpleNamespace(
            problem=SimpleNamespace(measurements=readings), model=SimpleNamespace(robot=robot)
        )


def test_what_has_a_place_is_not_called_noise() -> None:
    known, unknown = Answered(), Answered(goes_with=None, closest=PLACE)
    assert accounted(known) == PLACE and accounted(unknown) is None
    first, second = noise_words(known)
    assert first == "Rows share a zero."
    assert "it is no noise" in second and PLACE in second and "repeats" not in second
    assert noise_words(unknown) == unknown.noise_reasons
    assert "repeats" in noise_words(unknown)[1]


def test_readings_far_off_are_listed_before_anything_is_believed() -> None:
    few = tuple((f"line {k} (pose A)", 4e-4) for k in range(2, 5))
    said = next_step(Answered(verdict="outside", far_off=few))
    assert said.startswith(
        "3 readings lie far off what the model makes of the others: line 2 (pose A) "
    )
    assert "400 µm" in said and "a 0 in a column use leaves them out" in said
    assert "1 reading lies far off" in next_step(Answered(verdict="outside", far_off=few[:1]))
    many = next_step(Answered(verdict="outside", far_off=3 * few))
    assert "9 readings lie far off what the model makes of the others, the worst line 2" in many
    assert "far off what" not in next_step(Answered())


def test_what_to_do_now_sends_to_the_place_where_one_is_known() -> None:
    assert f"The rest goes with {PLACE}" in next_step(Answered())
    assert "repeat a few readings" not in next_step(Answered())
    assert "repeat a few readings" in next_step(Answered(goes_with=None, closest=PLACE))


def test_nobody_is_sent_to_mend_what_other_poses_do_not_show() -> None:
    worse, better = (
        replace(ALL, foretold=Foretold("Poses are", gap, without=1e-5)) for gap in (1.1e-5, 9e-6)
    )
    assert f"The rest goes with {PLACE}" in next_step(Answered(goes_with=better))
    said = next_step(Answered(goes_with=worse))
    assert (
        f"The rest shows most with {PLACE}, but poses left out are foretold hardly better" in said
    )
    assert "look there" not in said


def test_where_most_of_it_goes_with_one_place_it_is_sent_there_too() -> None:
    told = Answered(goes_with=MOST)
    assert mostly_accounted(told) == PLACE and accounted(told) is None
    assert mostly_accounted(Answered()) is None
    assert f"Most of the rest goes with {PLACE}: look there first" in next_step(told)
    assert f"and most of it is no noise: it goes with {PLACE}" in noise_words(told)[1]


@pytest.mark.parametrize("verdict", ["named", "ambiguous", "none"])
def test_what_to_do_now_says_that_sigma_looks_too_small(verdict: str) -> None:
    told = Answered(understated=2.9, verdict=verdict, significant=False)
    assert "Correct the stated σ to about 29.0 µm" in next_step(told)
    if verdict != "none":
        fine = Answered(verdict=verdict, significant=False)
        assert "Correct the stated σ" not in next_step(fine)


def test_an_open_answer_without_poses_says_what_to_do_about_the_rest() -> None:
    assert f"The rest goes with {PLACE}" in next_step(Answered(verdict="ambiguous"))


def test_readings_left_out_that_are_foretold_far_worse_are_explained() -> None:
    far = (Step("joint_springs", 9e-5, 9.5e-5), Step("+ a:b", 5.5e-5, 13e-5))
    (sentence,) = held_out_words(Answered(steps=far))
    assert sentence.startswith("a:b: poses that are left out are foretold worse")
    assert held_out_words(Answered()) == ()
    drawn = SimpleNamespace(effect=SimpleNamespace(id="zero_offset:tracker", random_effects=True))
    offsets = (SimpleNamespace(name="zero_offset:tracker", rms=10e-5),)
    (sentence,) = held_out_words(Answered(steps=far, findings=(drawn,), budget=offsets))
    assert sentence.startswith("Poses that are left out have offsets of their own, 100 µm rms")


def test_two_figures_of_one_gap_are_explained() -> None:
    found = SimpleNamespace(
        steps=(Step("joint_springs", 44.3e-6, 57e-6),),
        details={"localisation": localised(36.6e-6)},
    )
    (sentence,) = plain_words(found)
    assert "leaves 44.3 µm" in sentence and "leaves 36.6 µm" in sentence
    found.details = {"localisation": localised(44.2e-6)}
    assert plain_words(found) == () == plain_words(SimpleNamespace(details={}))


def localised(rms: float) -> Localisation:
    made = Localisation.__new__(Localisation)
    object.__setattr__(made, "rms", rms)
    return made


def test_a_finding_is_told_next_where_all_its_rivals_are() -> None:
    finding = SimpleNamespace(effect=SimpleNamespace(id="a"), others=frozenset({"b", "c"}))
    for far, told in ((5.0, True), (1.0, False)):
        answer = SimpleNamespace(next_pairs=(Apart("a", "b", 9.0), Apart("a", "c", far)))
        assert told_next(answer, finding) == told
    assert not told_next(SimpleNamespace(next_pairs=(Apart("x", "b", 9.0),)), finding)


def test_suspects_are_told_with_what_they_gain() -> None:
    assert _gain(Contender("joint_tilt:j1", 9.38e-6)) == (
        "joint_tilt:j1 (the held-out gap falls by 9.38 µm)"
    )
    assert "grows by 1.00 µm" in _gain(Contender("a:b", -1e-6))
    assert "do not hold it" in _gain(Contender("a:b", np.nan))


@pytest.mark.parametrize("others", [(), ("a:c",)])
def test_what_brings_the_most_has_its_error_and_all_its_names(others: tuple[str, ...]) -> None:
    named = (
        SimpleNamespace(
            effect=SimpleNamespace(id="a:b", bends_a_spring=False, random_effects=False),
            alternatives=others,
        ),
    )
    told = next_step(Answered(findings=named, budget=(Share("a:b", 4.61e-4, 1.35e-4),)))
    assert f"{' or '.join(('a:b', *others))} brings the most" in told
    assert "461 µm (± 135 µm) rms per axis" in told


@pytest.mark.parametrize(
    ("own", "others", "advice"),
    [
        ("force_scale:sensor", ("force_bias:sensor",), "how the force sensor was calibrated"),
        ("reading_rotation:tracker", (), "how the tracker stood"),
        ("force_scale:sensor", ("joint_tilt:j1",), "look there first if the arm is to be mended"),
        ("joint_tilt:j1", (), "look there first if the arm is to be mended"),
        ("gear_hardening:j1", (), "that is how such gears are, no fault of the arm"),
        ("gear_hardening:j1", ("lost_motion:j1",), "look there first if the arm is to be mended"),
    ],
)
def test_an_instrument_is_no_part_of_an_arm_to_be_mended(
    own: str, others: tuple[str, ...], advice: str
) -> None:
    named = (
        SimpleNamespace(
            effect=SimpleNamespace(
                id=own, bends_a_spring=own.startswith("gear_hardening"), random_effects=False
            ),
            alternatives=others,
        ),
    )
    told = next_step(Answered(findings=named, budget=(Share(own, 1e-5, 1e-6),)))
    assert advice in told
    assert ("no fault of the arm" in told) == ("mended" not in advice)


def test_a_part_that_may_stand_for_it_goes_before_the_arm() -> None:
    effect = SimpleNamespace(id="joint_tilt:j7", bends_a_spring=False, random_effects=False)
    named = (SimpleNamespace(effect=effect, alternatives=()),)
    budget = (Share(effect.id, 1e-5, 1e-6),)
    told = next_step(Answered(findings=named, budget=budget, softer=(effect.id,)))
    assert "make sure that what was put on is not as soft as told" in told
    assert "look there first" not in told


def test_the_first_line_says_that_part_has_no_name() -> None:
    assert "20.0 µm rms per axis have none" in said(Answered())
    assert said(Answered(significant=False)) == "Something was missing, and it has a name."
