"""What yields at one joint is summed: its parts trade with one another, and the sum is known."""

from dataclasses import replace
from types import SimpleNamespace
from unittest import mock

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.effects import effect
from sk120stiff.explain.judge.budget import error_budget, joint_budget
from sk120stiff.explain.judge.gear_curve import gear_curves
from sk120stiff.identify import fit
from sk120stiff.model.budget import at_joints
from sk120stiff.show.stories import sizes_sections
from tests.explain.readings import NOISE, hidden

JOINT, GEAR = "joint_1_s", "gear_hardening:joint_1_s"
SPRING = f"joint_springs:{JOINT}"


@pytest.fixture(scope="module")
def bent():
    """Springs, a gear that may stiffen, and a base that may rock."""
    springs = base_model(load_robot("motoman_sk120"))
    gear = effect(springs.robot, "gear_hardening", JOINT)
    model = springs + gear + effect(springs.robot, "base_rocking")
    return fit(model, hidden(poses=8, loads=3), noise=NOISE)


def test_spring_gear_and_bearing_belong_to_their_joint(bent):
    groups = at_joints(bent.model)
    assert groups[JOINT] == (SPRING, GEAR)
    assert "base_link" not in groups
    assert all(members[0].startswith("joint_springs:") for members in groups.values())


def test_the_sum_is_that_of_its_parts_and_surer_than_they_are(bent):
    parts = {share.name: share for share in error_budget(bent)}
    (whole,) = (share for share in joint_budget(bent) if share.name == JOINT)
    _, derivative = bent.model.predict_with_sensitivities(bent.problem.load_cases)
    own = [p.effect.id in (SPRING, GEAR) for p in bent.model.parameters]
    moved = derivative[:, :, own] @ bent.model.values[own]
    assert whole.rms == pytest.approx(np.sqrt(np.mean(moved**2)))
    assert whole.members == (SPRING, GEAR)
    assert whole.std < 0.4 * parts[SPRING].std
    alone = [share for share in joint_budget(bent) if len(share.members) == 1]
    for share in alone:
        assert share.std == pytest.approx(parts[share.members[0]].std)


def test_the_band_of_a_gear_is_that_of_spring_and_gear_together(bent):
    """What another law makes of the spring alone does not widen the curve of both."""
    moves = np.full(len(bent.x), 0.5 * np.abs(bent.x).max())
    wide = replace(bent, selection_uncertainty=moves)
    answer = SimpleNamespace(
        final=wide,
        remainder=SimpleNamespace(rms=0.0),
        findings=[SimpleNamespace(effect=SimpleNamespace(id=GEAR))],
    )
    drawn = []
    with mock.patch.object(sizes_sections, "_picture", drawn.append):
        sizes_sections.gear_section(answer)
    (curve,), (plain,) = drawn, gear_curves(bent, [GEAR])
    np.testing.assert_allclose(curve.band, plain.band, rtol=1e-6)
    assert gear_curves(wide, [GEAR])[0].band.max() > 2.0 * plain.band.max()


def test_what_another_law_makes_of_the_parts_is_not_in_their_sum(bent):
    """A spring that another law of its gear moves has a wide bar; what both bring stays."""
    free = [p.quantity for p in bent.parameters]
    moves = np.zeros(len(bent.x))
    moves[[k for k, name in enumerate(free) if name.startswith(SPRING)]] = (
        0.5 * np.abs(bent.x).max()
    )
    wide = replace(bent, selection_uncertainty=moves)
    (before,) = (share for share in joint_budget(bent) if share.name == JOINT)
    (after,) = (share for share in joint_budget(wide) if share.name == JOINT)
    assert after.std == pytest.approx(before.std)
    old, new = ({s.name: s.std for s in error_budget(f)}[SPRING] for f in (bent, wide))
    assert new > 2.0 * old
