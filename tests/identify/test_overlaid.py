"""Springs that lie on one another: the fit gives all to one and holds the others on a bound."""

import re

import numpy as np
import pytest

from sk120stiff.identify import Fit, fit, fit_report, weak_directions
from sk120stiff.model import TOGETHER, joint_spring_model
from tests.identify.conftest import readings_of
from tests.identify.upright import POINT, measured_at, pushed_upright, upright

SPRINGS = [1e5, 1e6, 1e5, 1e6, 1e5, 500.0]
ALIKE = {"joint_2", "joint_4", "joint_6"}


@pytest.fixture(scope="module")
def lying() -> Fit:
    arm = upright()
    return fit(joint_spring_model(arm), pushed_upright(arm, SPRINGS))


def members(found: Fit) -> set[str]:
    return {found.parameters[k].effect.where for group in found.overlays for k in group.members}


def test_they_are_named_together_though_some_are_on_their_bound(lying) -> None:
    assert members(lying) == ALIKE
    (group,) = lying.overlays
    assert group.held and lying.at_bound[list(group.held)].all()
    said = weak_directions(lying)[0]
    assert "springs of joint_2, joint_4 and joint_6 lie on one another" in said
    assert "no finding" in said


def test_no_standard_error_pretends_to_know_the_share_of_one(lying) -> None:
    """All six springs free of bounds tell each of the three to no better than itself."""
    for k in lying.overlays[0].members:
        parameter = lying.parameters[k]
        if not lying.at_bound[k]:
            assert parameter.internal_std is not None
            assert parameter.internal_std > 0.5 * parameter.internal
        assert parameter.origin == TOGETHER
    rows = fit_report(lying).splitlines()
    assert not any("joint_2" in row and "rigid fits best" in row for row in rows)


def test_the_sum_that_is_known_is_the_true_one(lying) -> None:
    said = weak_directions(lying)[0]
    share = float(re.search(r"known to ([\d.e+-]+) %", said)[1])
    terms = re.findall(r"(?:([\d.]+) x )?joint springs \((joint_\d)\)", said)
    truth = sum(float(r or 1.0) / SPRINGS[int(name[-1]) - 1] for r, name in terms)
    here = {p.effect.where: p.internal for p in lying.parameters}
    found = sum(float(r or 1.0) * here[name] for r, name in terms)
    assert share < 2.0
    assert found == pytest.approx(truth, rel=0.03)


def test_the_pose_that_is_proposed_separates_them(lying) -> None:
    said = weak_directions(lying)[0]
    proposal = re.search(r"as (p\d), with joint_(\d) at (-?\d+) deg", said)
    pose, joint, degrees = proposal[1], int(proposal[2]) - 1, float(proposal[3])
    measured = lying.problem.measurements
    rows = [*measured.rows_of(pose)]
    turned = np.array(measured.joints[rows[-1]])
    turned[joint] = np.radians(degrees)
    arm = lying.model.robot
    before = pushed_upright(arm, SPRINGS)
    first = [before.rows_of(label)[-1] for label in before.poses]
    joints = np.vstack([before.joints[first], turned])
    sideways = np.vstack([before.wrench[first, :2], before.wrench[rows[-1], :2]])
    found = fit(joint_spring_model(arm), measured_at(arm, SPRINGS, joints, sideways))
    assert not members(found) & ALIKE
    assert found.model.parameter("joint_springs:joint_6.stiffness").value == pytest.approx(
        500.0, rel=0.1
    )
    assert (found.problem.measurements.point == POINT).all()


def test_a_bound_that_the_readings_speak_for_stays_a_finding(robot, table2) -> None:
    found = fit(joint_spring_model(robot), table2)
    assert found.at_bound.any()
    assert found.overlays == ()
    bent = fit(joint_spring_model(robot), readings_of(joint_spring_model(robot, [1e6] * 6)))
    assert bent.overlays == ()
