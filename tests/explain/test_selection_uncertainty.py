"""Standard errors hold what other names make of a spring, if those names fit at all."""

from dataclasses import replace

import numpy as np

from sk120stiff.effects import Effect, effect
from sk120stiff.explain.findings import Evidence, Finding
from sk120stiff.explain.judge.confirm import UNTRIED
from sk120stiff.explain.judge.selection_uncertainty import with_selection_uncertainty
from sk120stiff.explain.select.stepwise import Selection, select, with_effects
from sk120stiff.identify import Fit
from tests.explain.readings import base_fit, hidden
from tests.hidden.generator.causes_joint import LostMotion
from tests.hidden.generator.causes_sensor import ReadingDrift


def with_play(schedule: str) -> tuple[Fit, Selection, list[Effect]]:
    """Springs fitted to a gear with play, what is selected, and play and friction of that gear."""
    joint = "joint_2_l"
    base = base_fit(hidden(LostMotion(joint, {"half_width": 2e-4}), schedule=schedule))
    laws = [
        effect(base.model.robot, name, joint) for name in ("lost_motion", "friction_hysteresis")
    ]
    settled = select(
        base.model, base.problem.measurements, base.problem.noise, laws, max_effects=1, alpha=0.01
    )
    return base, settled, laws


def test_a_name_that_does_not_fit_widens_no_error():
    """Under growing loads friction is play with the other sign, and neither is ever negative."""
    base, settled, (play, friction) = with_play("ascending")
    found = with_effects(settled, [play])
    evidence = Evidence(9.0, 9.0, None, np.inf, UNTRIED, {}, {})
    alone = Finding(play, (), (), evidence)
    beside = with_selection_uncertainty(found, [replace(alone, alternatives=(friction.id,))])
    assert (beside.selection_uncertainty == with_selection_uncertainty(
        found, [alone]).selection_uncertainty).all()  # fmt: skip
    moved = np.abs(base.x - beside.x[: len(base.x)]).max()  # friction leaves what springs alone do
    assert beside.selection_uncertainty.max() < 0.1 * moved


def test_a_law_with_more_terms_that_nothing_asks_for_widens_no_error():
    """A drift that goes on, and the same with three that die away: it leaves less in any case."""
    drift = {"x": 8e-6, "y": -6e-6, "z": 9e-6}
    base = base_fit(hidden(ReadingDrift("tracker", drift)))
    cause = effect(base.model.robot, "reading_drift", "tracker")
    settled = select(
        base.model, base.problem.measurements, base.problem.noise, [cause], max_effects=1,
        alpha=0.01,
    )  # fmt: skip
    found = with_effects(settled, [cause])
    evidence = Evidence(9.0, 9.0, None, np.inf, UNTRIED, {}, {})
    wide = with_selection_uncertainty(found, [Finding(cause, (), (), evidence)])
    own = [k for k, p in enumerate(wide.parameters) if p.effect == cause]
    assert len(own) == 3
    for k in own:
        p = wide.parameters[k]
        assert abs(p.internal - drift[p.spec.name[-1]]) < 4.0 * p.internal_std
        assert p.internal_std < 2.0 * found.final.parameters[k].internal_std


def test_two_names_that_may_stand_for_each_other_may_both_be_named():
    """Each is among the alternatives of the other: in its place there is nothing to add then."""
    _, settled, laws = with_play("up_and_down")
    found = with_effects(settled, laws)
    evidence = Evidence(9.0, 9.0, None, np.inf, UNTRIED, {}, {})
    pairs = zip(laws, laws[::-1], strict=True)
    both = [Finding(each, (other.id,), (), evidence) for each, other in pairs]
    wide = with_selection_uncertainty(found, both)
    assert [each.id for each in wide.model.effects][-2:] == [each.id for each in laws]
    assert np.isfinite(wide.selection_uncertainty).all()
