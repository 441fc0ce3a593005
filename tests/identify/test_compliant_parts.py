"""Springs from displacements beside links that may bend by less than asks for a name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import CATALOGUE
from sk120stiff.identify.uncertainty.compliant_parts import beside_parts, if_parts_yield
from sk120stiff.identify.uncertainty.parts import mostly_parts
from sk120stiff.model import Parameter

SIGMA = 1e-5
BEND = "link_bending:link_3_u"


@pytest.fixture(scope="module")
def springs() -> sk.Model:
    return sk.base_model(sk.load_robot("motoman_sk120"))


def read_at(truth: sk.Model, springs: sk.Model, poses: int, loads: int) -> sk.Fit:
    plan = sk.plan(springs, poses, loads=loads, candidates=60)
    made = sk.simulate(truth, plan, noise=sk.NoiseModel(SIGMA), seed=1)
    return sk.fit(springs, made.measurements)


def bent(springs: sk.Model, share: float) -> sk.Model:
    """With a link that bends by a share of what is usual."""
    effect = CATALOGUE.effect(springs.robot, *BEND.split(":"))
    more = (Parameter(effect, spec, share * spec.usual) for spec in effect.parameters)
    return replace(springs, parameters=(*springs.parameters, *more))


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_springs_know_of_a_link_that_may_bend(springs: sk.Model, share: float) -> None:
    narrow = read_at(bent(springs, share), springs, 4, 3)
    wide = beside_parts(narrow, CATALOGUE)
    off = np.abs([p.internal for p in narrow.parameters] - springs.values)
    before, after = (np.array([p.internal_std for p in f.parameters]) for f in (narrow, wide))
    assert (off / before).max() > 10.0
    assert (off / after).max() < 2.0
    (said,) = if_parts_yield(narrow, CATALOGUE)
    assert f"joint_springs:joint_3_u ({BEND}: " in said and "'sk120stiff explain' counts it" in said
    (most,) = mostly_parts(wide)
    assert f"joint_springs:joint_3_u ({BEND})" in most
    np.testing.assert_array_equal(wide.x, narrow.x)


def test_readings_that_tell_them_apart_leave_nothing_open(springs: sk.Model) -> None:
    few, many = (read_at(springs, springs, *count) for count in ((4, 3), (20, 5)))
    ratio = []
    for found in (few, many):
        pairs = zip(found.parameters, beside_parts(found, CATALOGUE).parameters, strict=True)
        ratio.append([(wide.internal_std or 0.0) / (p.internal_std or 1.0) for p, wide in pairs])
    assert max(ratio[0]) > 2.0
    assert max(ratio[1]) < 1.1
    assert if_parts_yield(many, CATALOGUE) == ()


def test_parts_that_are_known_to_be_rigid_count_nothing(springs: sk.Model) -> None:
    found = read_at(bent(springs, 0.3), springs, 4, 3)
    names = {"link_bending", "link_torsion", "joint_tilt", "tool_compliance", "rod_compliance"}
    rigid = beside_parts(found, CATALOGUE, {*names, "base_rocking", "base_sliding"})
    assert [p.internal_std for p in rigid.parameters] == pytest.approx(
        [p.internal_std for p in found.parameters], rel=1e-2
    )


def test_explain_counts_them(springs: sk.Model) -> None:
    """Of readings that leave a link open the answer has the wider errors, and says by what."""
    plan = sk.plan(springs, 4, loads=3, candidates=60)
    made = sk.simulate(springs, plan, noise=sk.NoiseModel(SIGMA), seed=1).measurements
    answer = sk.explain(springs, made)
    assert answer.verdict == "none"
    alone = sk.fit(springs, made)
    ratio = []
    for name in springs.names:
        wide, narrow = (f.model.parameter(name).internal_std for f in (answer.final, alone))
        assert wide is not None and narrow is not None
        ratio.append(wide / narrow)
    assert max(ratio) > 1.5 and min(ratio) > 0.9
    assert any("the part in brackets" in said for said in answer.unnamed)
    told = sk.explain(springs, made, options=sk.Options(exclude=("joint_tilt", "link_bending")))
    first = springs.names[0]
    shut, wide = (each.final.model.parameter(first).internal_std for each in (told, answer))
    assert shut is not None and wide is not None and shut < 0.5 * wide
