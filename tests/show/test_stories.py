"""Reports of results: every verdict tells its numbers, honestly and without a network."""

import re
from dataclasses import replace
from functools import cache
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.errors import listed
from sk120stiff.explain import Detectable, Explanation, Finding, explain
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.candidates.absorbed import absorbed
from sk120stiff.explain.findings import Contender
from sk120stiff.identify import LackOfFit
from sk120stiff.model import base_model
from sk120stiff.robot import load_robot
from sk120stiff.show import scene_html
from sk120stiff.show.stories import (
    explain_report,
    explain_scene,
    limits_section,
    sizes_sections,
)
from sk120stiff.show.stories.explain_report import _left
from sk120stiff.show.stories.pictures import ArmView, exaggeration, gap_vectors, suspect_panels
from sk120stiff.show.stories.verdicts import lead_of, title_of
from sk120stiff.show.wording import number, percent, said_as, um, unit_of, with_error
from tests.explain.readings import base_fit, hidden
from tests.hidden.generator.causes_elastic import JointTilt
from tests.show.test_report import Outline

VERDICTS = ("named", "ambiguous", "outside", "none")
TILT = JointTilt("joint_2_l", {"first": 5e-7, "second": 5e-7})


@cache
def named() -> Explanation:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return explain(model, hidden(TILT, schedule="ascending", poses=16))


@cache
def answer(verdict: str) -> Explanation:
    """The named answer, told as if the verdict were another."""
    found = named()
    finding = found.findings[0]
    if verdict == "named":
        return found
    if verdict == "ambiguous":
        rival = replace(finding, alternatives=("link_torsion:link_1_s",), exact=())
        a = found.base.problem.load_cases.a[:3]
        return replace(
            found, verdict="ambiguous", findings=(rival,), next_poses=(a, np.full((3, 6), 10.0))
        )
    plain = replace(found, verdict=verdict, findings=(), final=found.base, steps=found.steps[:1])
    return (
        replace(plain, suspects=(Contender("joint_tilt:joint_1_s", 2e-6),))
        if verdict == "outside"
        else plain
    )


@cache
def page(verdict: str) -> str:
    found = answer(verdict)
    return explain_report(
        found,
        found.base.problem.measurements,
        data="readings.csv",
        scene=scene_html(explain_scene(found)),
        scene_link="scene.html",
        next_poses="next_poses.csv" if verdict == "ambiguous" else "",
        reproducibility={"Command": "sk120stiff explain readings.csv"},
    ).html()


def plain(html: str) -> str:
    """What a reader sees, without the scene's page."""
    shown = re.sub(r'srcdoc="[^"]*"', "", html)
    shown = re.sub(r"<(style|svg)\b.*?</\1>", " ", shown, flags=re.DOTALL)
    text = unescape(re.sub(r"<[^>]+>", " ", shown)).replace("\u00a0", " ")
    return re.sub(r"\s+", " ", text)


def test_the_cause_is_found_at_all() -> None:
    found = named()
    assert found.verdict in ("named", "ambiguous")
    assert found.findings[0].effect.id == "joint_tilt:joint_2_l"


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_page_is_whole(verdict: str) -> None:
    outline = Outline(page(verdict))
    assert not outline.open
    assert len(outline.of("h1")) == 1
    assert all(a["aria-label"] for a in outline.of("svg") if a.get("role") == "img")
    assert all(len(a["aria-label"] or "") > 30 for a in outline.of("svg") if a.get("role"))
    assert all(a["title"] for a in outline.of("iframe"))
    ids = [a["id"] for _, a in outline.tags if a.get("id")]
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("verdict", VERDICTS)
def test_nothing_comes_from_elsewhere(verdict: str) -> None:
    outline = Outline(page(verdict))
    for tag, attributes in outline.tags:
        assert tag not in ("link", "object", "embed", "img")
        assert tag != "script" or not attributes
        for name in ("src", "href", "xlink:href", "action", "poster"):
            target = attributes.get(name)
            assert target is None or target.startswith(("#", "data:")) or target == "scene.html"
        assert "url(http" not in (attributes.get("style") or "")
    inner = Outline(outline.of("iframe")[0]["srcdoc"] or "")
    assert not [a for _, a in inner.tags if (a.get("src") or "").startswith("http")]
    assert not [a for _, a in inner.tags if (a.get("href") or "").startswith("http")]


def test_a_named_cause_is_told_with_its_size_and_evidence() -> None:
    found, text = named(), plain(page("named"))
    finding = found.findings[0]
    assert finding.effect.sentence() in text
    for p in found.final.model.parameters:
        if p.effect == finding.effect:
            assert said_as(p.value, p.std, p.spec.unit).rpartition(" ")[0] in text
    first, last = found.steps[0], found.steps[-1]
    assert f"falls from {um(first.heldout_rms)} to {um(last.heldout_rms)} µm" in text
    confirmation = finding.evidence.confirmation
    assert f"better in {confirmation.folds_improved} of {confirmation.folds} folds" in text
    assert f"same name in {percent(confirmation.frequency)}" in text
    assert f"χ² larger by {finding.evidence.misfit_gain:.0f}" in text
    if finding.evidence.runner_up:
        lost = f"{finding.evidence.runner_up} loses by {finding.evidence.runner_up_gap:.1f}"
        assert lost in text
    for sentence in found.where:
        assert sentence in text


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_page_tells_how_probable_every_name_is(verdict: str) -> None:
    found, text = answer(verdict), plain(page(verdict))
    told = text[text.rindex("How probable it is") :]
    for finding in found.findings:
        assert f"{finding.effect.id} {finding.effect.id}" in told  # its place, its name
        assert "none of them" in told
    assert "nothing is missing" in told and "something without a name" in told


def test_springs_before_and_after_are_told() -> None:
    found, text = named(), plain(page("named"))
    before = {p.name: p for p in found.base.parameters}
    for p in found.final.parameters:
        if p.name in before:
            old = before[p.name]
            assert said_as(old.value, old.std, p.spec.unit).rpartition(" ")[0] in text
            assert said_as(p.value, p.std, p.spec.unit).rpartition(" ")[0] in text
    assert "Springs fitted alone cover up for what is missing" in text


def test_a_spring_that_came_out_at_a_quarter_is_75_percent_too_soft() -> None:
    """One that is not known beside the effect is no yardstick, and a rigid one is none."""
    values = {"a": (11.76, 1.0), "b": (3.0, 0.5), "c": (9.0, 8.0), "d": (np.inf, None)}
    after = [SimpleNamespace(name=n, value=v, std=std) for n, (v, std) in values.items()]
    for p in after:
        p.effect = SimpleNamespace(where=p.name, joint_spring=True)
    before = {
        n: SimpleNamespace(value=v) for n, v in zip("abcd", (2.94, 12.0, 1.0, 1.0), strict=True)
    }
    told = sizes_sections._told(before, after)
    assert told.endswith("too soft: a 75 %; too stiff: b 300 %.")
    assert "told well enough" in sizes_sections._told(before, after[2:])


def test_a_size_without_a_unit_has_no_blank_behind_it() -> None:
    sizes = [Detectable(f"gain.scale_{axis}", 0.0043, "1") for axis in "xy"]
    assert limits_section._written(sizes) == "scale_x 0.0043, scale_y 0.0043"
    assert limits_section._written(4 * sizes) == "0.0043 to 0.0043"


def test_an_open_question_names_both_and_what_to_measure() -> None:
    text = plain(page("ambiguous"))
    assert "These readings cannot tell which" in text
    assert "`" not in text
    assert "The link link_1_s twists along its length." in text
    assert "next_poses.csv" in text
    assert "What to measure next" in text


def test_a_crowd_of_rivals_does_not_flood_the_first_lines() -> None:
    found = answer("ambiguous")
    names = tuple(f"joint_offset:{joint}" for joint in found.base.model.robot.actuated)
    crowd = replace(found, findings=(replace(found.findings[0], alternatives=names),))
    lead = lead_of(crowd)
    assert lead.count("The zero of") == 2
    assert "4 others" in lead
    text = plain(explain_report(crowd, found.base.problem.measurements).html())
    assert all(name in text for name in names)


def test_outside_gives_no_name() -> None:
    found, text = answer("outside"), plain(page("outside"))
    assert "no effect of the catalogue explains it" in text
    assert "Nearest, and not confirmed" in text
    assert "falls from" not in text
    assert found.where[0] in text


def test_none_does_not_claim_a_gap_closed() -> None:
    text = plain(page("none"))
    assert "falls from" not in text
    assert "closed" not in text
    test = LackOfFit("stated", 300.0, (290, None), 0.5, 1.0)
    sure = replace(answer("none"), adequacy=replace(named().adequacy, whole=test))
    little = replace(test, probability=0.02)
    doubt = replace(answer("none"), adequacy=replace(named().adequacy, whole=little))
    assert lead_of(sure).startswith("Nothing is missing that these readings could show.")
    assert "not enough to claim" in lead_of(doubt)
    open_ = replace(sure, odds={"none": 0.4, "friction_hysteresis:joint_2_l": 0.55})
    assert "nothing is missing is not sure" in lead_of(open_)
    assert "friction_hysteresis:joint_2_l 0.55" in next_step(open_)
    assert title_of(open_) == "No effect can be named"


def test_detectable_sizes_are_grouped_by_effect() -> None:
    text = plain(page("named"))
    assert text.count("zero_offset:tracker") <= 1
    assert "base_rocking:base_link stiffness_x" in text


def test_rows_set_aside_are_named() -> None:
    found = replace(named(), set_aside=(3,))
    used = found.base.problem.measurements
    text = plain(explain_report(found, used).html())
    assert f"1 reading of {used.n_readings} no smooth cause can have made" in text
    assert f"pose {used.pose[3]}" in text


def test_scene_shows_before_and_after() -> None:
    scene = explain_scene(named())
    assert scene.models == ("before", "after")
    assert len(scene.poses) == 16
    gap = named().base.gap
    reading = scene.poses[0].readings[0]
    assert reading.measured is not None
    assert np.allclose(reading.measured - reading.predicted["before"], gap[0], atol=1e-12)
    assert explain_scene(answer("none")).models == ("model",)


def test_gap_vectors_keep_one_scale() -> None:
    outline = np.array([[0.0, 0, 0], [0, 0, 1.0], [1.0, 0, 1.0]])
    views = [ArmView(outline, {"before": np.array([1e-4, 0, 0]), "after": np.array([0, 0, 5e-5])})]
    assert exaggeration(views) == pytest.approx(0.22 * 1.0 / 1e-4)
    figure = gap_vectors(views)
    assert [panel.get_title(loc="left") for panel in figure.axes] == ["from above", "from the side"]


def test_panels_mark_the_strongest_suspect_alone() -> None:
    found = named().details["localisation"]
    figure = suspect_panels(found)
    assert figure is not None
    titles = [panel.get_title(loc="left") for panel in figure.axes]
    assert [k for k, title in enumerate(titles) if "strongest" in title] == [0]


def test_absorbed_is_what_a_refit_leaves() -> None:
    """A gain of the force is other springs; a tilt at the shoulder is not."""
    fitted = base_fit(hidden(schedule="ascending"))
    robot = fitted.model.robot
    chosen = [effect(robot, "force_scale"), effect(robot, "joint_tilt", "joint_2_l")]
    scale, tilt = absorbed(fitted, chosen)
    assert scale.share > 0.9999 and scale.visible < 1e-2
    assert 0.3 < tilt.share < 0.99
    assert tilt.visible > 5.0


def test_numbers_are_written_as_people_do() -> None:
    assert with_error(1.4115e7, 1.13e6, "N*m/rad") == "(1.41 ± 0.11)·10⁷ N·m/rad"
    assert with_error(-0.0031, 0.0006) == "−0.00310 ± 0.00060"
    assert with_error(float("inf"), None, "N/m") == "rigid"
    assert with_error(0.0248, 0.001, "1") == "0.0248 ± 0.0010"
    assert with_error(8.0e5, 4.3e8, "N*m/rad") == "(8.0 ± 4300)·10⁵ N·m/rad"
    assert with_error(118.74, 19803.0) == "119 ± 20000"
    assert with_error(62604.0, 7756.0) == "62604 ± 7756"
    assert said_as(1.357e6, 1.5e4, "N*m/rad") == "1357 ± 15 kN·m/rad"
    assert said_as(-2.1e-4, 3e-6, "rad") == "−210.0 ± 3.0 µrad"
    assert said_as(0.0121, None, "m") == "12.1 mm"
    assert number(1105.2, 3) == "1105"
    assert number(0.0, 3) == "0"
    assert number(-3.2e-11, 2) == "−3.2·10⁻¹¹"
    assert number(float("inf")) == "∞"
    assert (um(1.2e-5), um(9.996e-5), um(8.57e-6)) == ("12.0", "100", "8.57")
    assert (percent(0.351), percent(0.0351)) == ("35 %", "3.5 %")
    assert unit_of("rad/(N*m)**2") == "rad/(N·m)²"
    assert listed(["a", "b", "c"], "or") == "a, b or c"


def test_a_finding_is_settled_only_by_exact_aliases() -> None:
    finding: Finding = answer("ambiguous").findings[0]
    assert not finding.settled


def test_what_is_left_stands_in_the_report_with_its_size() -> None:
    for verdict in ("none", "named", "outside"):
        found, text = answer(verdict), plain(page(verdict))
        assert found.remainder.sentence() in text


@pytest.mark.parametrize(("significant", "told"), [(True, ("117", "µm")), (False, ("?", ""))])
def test_what_poses_have_of_their_own_is_told_where_the_noise_is_unknown(significant, told) -> None:
    remainder = SimpleNamespace(rms=1.17e-4, significant=significant)
    answered = SimpleNamespace(adequacy=SimpleNamespace(chance=None), remainder=remainder)
    assert _left(answered)[:2] == told
    assert "the noise is unknown" in _left(answered)[2]


@pytest.mark.parametrize(
    ("p", "lacking", "word"), [(0.4, False, "no"), (0.004, False, "not sure"), (1e-5, True, "yes")]
)
def test_a_little_more_than_noise_is_not_called_none(p: float, lacking: bool, word: str) -> None:
    adequacy = SimpleNamespace(chance=p, understated=None, lacking=lacking)
    answered = SimpleNamespace(adequacy=adequacy, remainder=SimpleNamespace(significant=False))
    assert _left(answered)[0] == word
