"""What a fit says it does not know."""

from dataclasses import replace

import numpy as np

from sk120stiff.effects import effect
from sk120stiff.identify import Problem, fit, known_together, solve, weak_directions
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import CALIBRATED, joint_spring_model
from tests.identify.conftest import readings_of

NOISE = NoiseModel(10e-6)
TILT = "joint_tilt:joint_2_l"


def test_a_good_fit_has_nothing_to_say(springs, table2) -> None:
    assert weak_directions(fit(springs, table2)) == ()


def test_a_joint_that_carries_nothing(robot, table2) -> None:
    said = weak_directions(fit(joint_spring_model(robot), table2))
    assert sum("does not show in these readings" in sentence for sentence in said) == 2
    assert any("joint_4_r" in sentence for sentence in said)
    assert any(s.startswith("joint_springs:joint_5_b.stiffness lies on its") for s in said)


def test_an_exact_alias_is_one_sum(springs, robot) -> None:
    """The twist of the upper arm about itself and the second joint's tilt about the arm."""
    model = springs + effect(robot, "link_torsion", "link_2_l")
    model = model + effect(robot, "joint_tilt", "joint_2_l")
    truth = model.with_public(
        **{
            "link_torsion:link_2_l.GJ": 4e6,
            "joint_tilt:joint_2_l.stiffness_along": 1e7,
            "joint_tilt:joint_2_l.stiffness_across": 8e6,
        }
    )
    readings = readings_of(truth, poses=15, sigma=5e-6)
    found = fit(model, readings)
    said = weak_directions(found)
    pair = [s for s in said if "move together: only" in s and "link torsion" in s]
    assert len(pair) == 1
    assert "joint tilt along (joint_2_l)" in pair[0]
    told = known_together(replace(found, selection_uncertainty=found.problem.span), {TILT})
    assert [s for s in told if "move together: only" in s] == pair
    assert known_together(found, {"joint_springs:joint_1_s"}) == ()
    lost = {p.name for p, ok in zip(found.parameters, found.identifiable, strict=True) if not ok}
    assert lost == {"link_torsion:link_2_l.GJ", "joint_tilt:joint_2_l.stiffness_along"}
    # what is known of them: tilt compliance + length / GJ
    tilt = model.names.index("joint_tilt:joint_2_l.stiffness_along")
    twist = model.names.index("link_torsion:link_2_l.GJ")
    both = [x.values[tilt] + 1.1 * x.values[twist] for x in (found.model, truth)]
    assert abs(both[0] / both[1] - 1.0) < 0.05
    # the rest of the model is none the worse
    np.testing.assert_allclose(
        [p.value for p in found.parameters[:3]],
        [p.value for p in truth.parameters[:3]],
        rtol=0.03,
    )


def test_an_alias_is_the_same_by_both_algorithms(springs, robot) -> None:
    model = springs + effect(robot, "force_scale") + effect(robot, "reading_scale")
    readings = readings_of(springs, poses=10)
    one, two = (fit(model, readings, method=method) for method in ("trf", "lm"))
    np.testing.assert_allclose(one.x, two.x, rtol=1e-8, atol=1e-8)
    assert {p.origin for p in one.parameters} == {CALIBRATED}
    assert any("move together" in sentence for sentence in weak_directions(one))


def test_hardly_known_values_carry_their_interval(springs, robot) -> None:
    wrist = joint_spring_model(robot, [1.4e6, 4e5, 9e5, np.inf, 3e5, np.inf])
    few = readings_of(wrist, poses=2, sigma=1e-4, seed=1)
    said = weak_directions(solve(Problem(wrist, few, NoiseModel(1e-4))))
    assert any("hardly known" in s and "joint_5_b" in s for s in said)


def test_what_fits_but_explains_nothing(springs, robot) -> None:
    """A foundation softer than any: the fit gives it, and says that it cannot be."""
    model = springs + effect(robot, "reading_rotation")
    truth = model.with_public(**{"reading_rotation:tracker.angle_z": 0.2})
    said = weak_directions(fit(model, readings_of(truth, poses=10)))
    assert any("larger than is plausible" in s and "angle_z" in s for s in said)
