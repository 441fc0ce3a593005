"""Verdicts follow from numbers: change the number and the verdict changes."""

import re
from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.paper import Reproduction, Verdict
from sk120stiff.paper.formulation import printed_minors
from sk120stiff.stiffness import definiteness


def verdict(found: Reproduction, where: str, begins: str) -> Verdict:
    (claim,) = [c for c in found.claims if c.where == where and c.claim.startswith(begins)]
    return claim.verdict


EXPECTED = [
    ("II", "The five-bar", Verdict.REPRODUCED),
    ("III, eq. (10)", "The stiffness of a loaded arm", Verdict.REPRODUCED),
    ("III, eq. (8)", "Without K_C", Verdict.REPRODUCED),
    ("IV, A", "Interior-reflective", Verdict.REPRODUCED),
    ("IV, B", "K_θ = diag", Verdict.NOT_REPRODUCIBLE),
    ("IV, Table II", "Deflections calculated", Verdict.REPRODUCED),
    ("IV, Table II", "The load acts on the fixture", Verdict.NOT_REPRODUCIBLE),
    ("IV, Table II", "The difference of calculated", Verdict.WRONG),
    ("IV, Table III", "With K_C the works", Verdict.REPRODUCED),
    ("IV, Table III", "The unequal works", Verdict.WRONG),
    ("IV, Table III", "The works are in joule", Verdict.WRONG),
    ("IV, Table III", "The printed works", Verdict.NOT_REPRODUCIBLE),
    ("IV, Table III", "Pose 3, row 3", Verdict.WRONG),
    ("IV, C", "The conventional formulation violates", Verdict.REPRODUCED),
    ("IV, eqs. (14), (15)", "The work of a load", Verdict.WRONG),
    ("IV, Figs. 4–6", "Force-deflection", Verdict.NOT_REPRODUCIBLE),
    ("VI, Table IV", "Counts of PD", Verdict.WRONG),
    ("VI, Table IV", "The counts of opposite", Verdict.WRONG),
    ("VI", "Forces as large as 10 kN", Verdict.WRONG),
    ("VI", "K_θ − K_C, and so K_X", Verdict.REPRODUCED),
    ("Appendix I", "The Jacobian", Verdict.WRONG),
    ("Appendix II", "K_X has", Verdict.REPRODUCED),
]


@pytest.mark.parametrize(("where", "begins", "expected"), EXPECTED)
def test_verdict(found, where, begins, expected):
    assert verdict(found, where, begins) is expected


def test_every_claim_has_a_reason(found):
    assert len(found.claims) > 30
    assert {claim.verdict for claim in found.claims} == set(Verdict)
    for claim in found.claims:
        assert claim.where and claim.claim.endswith((".", ")"))
        assert claim.evidence.endswith(".") and len(claim.evidence) > 40
        assert not re.search(r"\b(nan|inf)\b", claim.evidence)
    assert len({(c.where, c.claim) for c in found.claims}) == len(found.claims)


def test_verdicts_turn_with_the_numbers(found):
    near = replace(found, critical=replace(found.critical, smallest=11e3))
    assert verdict(near, "VI", "Forces as large as 10 kN") is Verdict.REPRODUCED
    clean = replace(found.appendix, printed_error=found.appendix.mended_error)
    assert (
        verdict(replace(found, appendix=clean), "Appendix I", "The Jacobian") is Verdict.REPRODUCED
    )
    table = replace(found.table4, printed=found.table4.counts)
    right = replace(found, table4=table)
    assert verdict(right, "VI, Table IV", "Counts of PD") is Verdict.REPRODUCED
    moved = replace(found.table2, calculated=found.table2.calculated + 1e-6)
    off = replace(found, table2=moved)
    assert verdict(off, "IV, Table II", "Deflections calculated") is Verdict.WRONG
    leaky = replace(found.formulation, enhanced_error=1e-3)
    assert verdict(replace(found, formulation=leaky), "III, eq. (10)", "The") is Verdict.WRONG


def test_formulation(found):
    form = found.formulation
    assert form.enhanced_error < 1e-6 < 0.01 < form.conventional_error
    assert form.enhanced_cycle < 1e-6 < 0.01 < form.conventional_cycle
    assert form.unloaded_difference == 0.0
    assert form.force_asymmetry < 1e-12 < 0.1 < form.moment_asymmetry
    assert form.negative_cases > 1000 and form.negative_failures == 0
    assert form.congruent_cases > 10_000 and form.congruence_failures == 0
    assert form.loop_error < 1e-12


def test_printed_minors_are_sylvesters(found):
    rng = np.random.default_rng(0)
    C = rng.normal(size=(400, 3, 3)) * 6e5
    C = C + np.swapaxes(C, 1, 2)
    positive = (printed_minors(found.setting.K_theta, C) > 0).all(axis=1)
    assert np.array_equal(positive, definiteness(found.setting.K_theta - C) == 0)
    assert 10 < positive.sum() < 390


def test_postures(found):
    assert np.degrees(found.posture.tool_error) < 0.01
    assert (found.posture.force_share > 0.5).all() and (found.posture.force_share < 1.0).all()
    assert set(found.posture.softest_of_figures) == {"4", "5", "6"}
    low, high = found.posture.softest[[0, -1]]
    assert all(low * 0.99 < x < high * 1.01 for x in found.posture.softest_of_figures.values())


def test_curves_of_figures_4_to_6(found):
    assert [(p.figure, p.axis) for p in found.pulls] == [(f, a) for f in "456" for a in "xyz"]
    for pull in found.pulls:
        assert pull.force[-1] == pytest.approx(50 * 9.80665)
        paper, ours = pull.displacement.values()
        assert (paper[0] == 0).all() and (ours[0] == 0).all()
        # softer springs: more along the pull; and nearly straight lines
        along = "xyz".index(pull.axis)
        assert ours[-1, along] > paper[-1, along] > 0
        assert paper[3, along] == pytest.approx(0.6 * paper[-1, along], rel=0.01)
