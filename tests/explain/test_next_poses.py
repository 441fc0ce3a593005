"""What to measure next tells all open names apart, and says which and how far."""

from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain.advise.consequences import PAIRS, NextPoses, next_poses, open_pairs
from sk120stiff.explain.answer.next_step import told_apart
from sk120stiff.explain.findings import Apart, Finding
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import joint_spring_model
from sk120stiff.robot import load_robot
from tests.explain.readings import hidden

ROBOT = load_robot("motoman_sk120")
PLAY, BEND = "lost_motion:{}", "gear_hardening:{}"


def finding(where: str, *alternatives: str, exact: tuple[str, ...] = ()) -> Finding:
    return Finding(effect(ROBOT, "gear_hardening", where), alternatives, exact, evidence=None)


def open_answer(*wheres: str) -> SimpleNamespace:
    """Gears that may have play or stiffen, at each of these joints."""
    found = [finding(where, PLAY.format(where)) for where in wheres]
    model = joint_spring_model(ROBOT, np.full(len(ROBOT.actuated), 2e6))
    for each in found:
        model = model + each.effect
        specs = each.effect.parameters
        model = model.with_public({f"{each.effect.id}.{spec.name}": spec.typical for spec in specs})
    final = SimpleNamespace(
        problem=SimpleNamespace(load_cases=load_cases_of(ROBOT, hidden(poses=12, loads=2))),
        model=model,
        noise_factor=1.0,
    )
    return SimpleNamespace(
        findings=found,
        final=final,
        noise=NoiseModel(1e-6),
        effect=lambda name: effect(ROBOT, *name.split(":")),
    )


def apart(found: NextPoses | None) -> dict[str, float]:
    assert found is not None
    return {pair.name: pair.apart for pair in found.pairs}


def test_every_open_pair_has_its_share_of_the_readings() -> None:
    wheres = ("joint_1_s", "joint_2_l")
    both = apart(next_poses(open_answer(*wheres), seed=0))
    assert set(both) == {BEND.format(where) for where in wheres}
    for where in wheres:
        alone = apart(next_poses(open_answer(where), seed=0))[BEND.format(where)]
        assert both[BEND.format(where)] > 0.4 * alone


def test_the_nearest_rival_of_every_place_comes_first() -> None:
    friction, tilts = "friction_hysteresis:joint_1_s", [f"joint_tilt:j{k}" for k in range(9)]
    two = finding("joint_1_s", PLAY.format("joint_1_s"), friction, *tilts, exact=(friction,))
    one = finding("joint_2_l", PLAY.format("joint_2_l"))
    settled = finding("joint_3_u")
    found = open_pairs(SimpleNamespace(findings=(two, settled, one)))
    assert [rival for _, rival in found[:2]] == [PLAY.format("joint_1_s"), PLAY.format("joint_2_l")]
    assert len(found) == PAIRS
    assert not any(rival.startswith("friction") for _, rival in found)


@pytest.mark.parametrize(
    ("pairs", "said"),
    [
        ((("a", "b", 9.0),), "they tell the open names apart"),
        ((("a", "b", 9.0), ("c", "d", 1.0)), "they are too few to be sure of c from d"),
        ((("a", "b", 1.0),), "they are too few to be sure of a from b"),
    ],
)
def test_it_is_said_which_names_they_tell_apart(pairs, said) -> None:
    told = SimpleNamespace(
        next_pairs=tuple(Apart(*pair) for pair in pairs),
        findings=[
            SimpleNamespace(effect=SimpleNamespace(id=name), others=frozenset({rival}))
            for name, rival, _ in pairs
        ],
    )
    assert said in told_apart(told)
    more = SimpleNamespace(effect=SimpleNamespace(id="e"), others=frozenset({"f"}))
    told.findings.append(more)
    assert "for another pair of names run it again" in told_apart(told)
