"""One thing under several names: computed from readings, and declared by the arm's build."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import permutations
from typing import ClassVar

import numpy as np
import pytest

from sk120stiff.effects import (
    LinearElastic,
    all_effects,
    effect,
)
from sk120stiff.effects.base import SPRINGS
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.model import joint_spring_model
from sk120stiff.robot import Robot, VirtualJoint, load_robot
from tests.effects.alias_classes import AliasClasses, alias_classes, generic_readings
from tests.effects.arms import FOLDER, arm
from tests.effects.declared import LOADS_GROW, ONE_WAY, PURE_FORCES, declared_aliases
from tests.effects.signatures import FirstOrder
from tests.robot.loop_arms import sk120_loop

BASE = ("joint_1_s", "joint_2_l", "joint_3_u")  # the SK120's springs; its wrist is rigid


@pytest.fixture(scope="module")
def arms(tmp_path_factory) -> dict[str, Robot]:
    return {
        "sk120": arm("sk120"),
        "skew": arm("six_axis"),
        "telescope": arm("telescope"),
        "scara": arm("scara"),
        "cobot": load_robot(FOLDER / "six_axis.urdf", base="base_link", tool="tool0"),
        "loop": sk120_loop(tmp_path_factory.mktemp("loop")),
    }


NAMES = ("sk120", "skew", "telescope", "scara", "cobot", "loop")


def base_of(robot: Robot) -> tuple[str, ...]:
    return BASE if "joint_3_u" in robot.actuated else robot.actuated


def groups(pairs, invisible) -> set[frozenset[str]]:
    """Classes of an equivalence given by pairs, what cannot be seen left out."""
    found: list[set[str]] = []
    for pair in pairs:
        joined = set(pair)
        for group in [g for g in found if g & joined]:
            joined |= group
            found.remove(group)
        found.append(joined)
    shown = [frozenset(g - set(invisible)) for g in found]
    return {group for group in shown if len(group) > 1}


def computed_and_declared(robot: Robot, moments: bool):
    computed = alias_classes(
        robot, base=base_of(robot), load_cases=generic_readings(robot, moments=moments)
    )
    return computed, declared_aliases(robot)


@pytest.mark.parametrize("moments", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_computed_twins_are_the_declared_ones(name, moments, arms):
    computed, declared = computed_and_declared(arms[name], moments)
    whole = [(a.name, a.other) for a in declared if not a.when and "[" not in a.name]
    pairs = [pair for pair in whole if pair[1] != SPRINGS]
    twins = {frozenset(group) for group in computed.twins}
    assert twins == groups(pairs, computed.invisible)


@pytest.mark.parametrize("moments", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_what_the_springs_take_is_declared(name, moments, arms):
    """Parts and sums that lie in the span of the springs, and parameters that are their twins."""
    robot = arms[name]
    computed, declared = computed_and_declared(robot, moments)
    springs = {f"{SPRINGS}:{joint}.stiffness" for joint in base_of(robot)}
    expected = set()
    for alias in declared:
        if alias.when == PURE_FORCES and moments:
            continue
        if alias.when not in ("", PURE_FORCES):
            continue
        for one, two in ((alias.name, alias.other), (alias.other, alias.name)):
            if (two in springs or two == SPRINGS) and one not in springs:
                expected.add(one)
    # twins of a twin of a spring
    for group in computed.twins:
        if springs & set(group):
            expected |= set(group) - springs
    assert set(computed.absorbed) == expected
    for alias in declared:
        if alias.other == SPRINGS and alias.name in computed.absorbed:
            assert set(computed.absorbed[alias.name]) == springs


def test_the_sk120s_list(arms):
    found = alias_classes(arms["sk120"], base=BASE)
    assert found.absorbed["link_bending:link_2_l.EI[in_plane]"] == (
        "joint_springs:joint_2_l.stiffness",
    )
    assert ("joint_springs:joint_4_r", "link_torsion:link_3_u") in found.same
    assert ("link_torsion:link_2_l", "joint_tilt:joint_2_l") in found.within
    assert ("link_length:link_6_t", "tool_offset:tool0") in found.within
    every = tuple(f"joint_springs:{joint}.stiffness" for joint in BASE)
    assert found.absorbed["reading_scale:tracker.scale"] == every
    assert found.absorbed["force_scale:sensor[scale_x+scale_y+scale_z]"] == every
    # a base that is as soft about either axis is a first bearing that is
    shared = {(o.first, o.second): o.shared for o in found.overlaps}
    assert shared["joint_tilt:joint_1_s", "base_rocking:base_link"] == 1
    # what must stay apart
    assert not any("link_bending:link_3_u" in group for group in found.same)
    assert "base_rocking:base_link" not in {name for pair in found.within for name in pair}
    assert found.invisible == ()


def test_narrow_effects_and_sentences(arms):
    found = alias_classes(arms["sk120"], base=BASE)
    alike = [pair for group in found.same for pair in permutations(group, 2)]
    wider = dict([*alike, *found.within])
    assert wider["link_torsion:link_2_l"] == "joint_tilt:joint_2_l"
    assert wider["joint_springs:joint_4_r"] == "link_torsion:link_3_u"
    assert "joint_tilt:joint_2_l" not in wider
    words = found.sentences()
    assert any("link_bending:link_2_l.EI[in_plane] cannot be seen beside" in s for s in words)
    assert all(s.endswith(".") for s in words)


@dataclass(frozen=True)
class BaseYaw(LinearElastic):
    """The base turns about its vertical: what `base_rocking` leaves out."""

    name: ClassVar[str] = "base_yaw"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        return (
            compliance("stiffness", softest=3e5, typical=1e7, scale=self.scale, meaning="test"),
        )

    def sentence(self) -> str:
        return "The base yaws."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        return (robot.base_frame,)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        placement = np.eye(4)
        placement[:3, 3] = robot.foundation
        return (VirtualJoint(f"{self.id}.yaw", -1, placement, np.eye(3)[2]),)

    def patterns(self, load_cases):
        return np.ones((1, 1, 1))


def test_base_yaw_is_the_first_joints_spring(arms):
    """Why `base_rocking` has no yaw; about another line it would be a thing of its own."""
    robot = arms["sk120"]
    found = alias_classes(robot, effects=[BaseYaw("base_link")], base=BASE)
    assert found.absorbed["base_yaw:base_link.stiffness"] == ("joint_springs:joint_1_s.stiffness",)
    aside = replace(robot, foundation=np.array([0.3, 0.0, 0.0]))
    assert alias_classes(aside, effects=[BaseYaw("base_link")], base=BASE).absorbed == {}


def test_a_shaft_far_from_the_next_axis_is_no_alias(arms):
    found = alias_classes(arms["skew"])
    assert not found.same and "link_torsion:link_3" not in str(found.within)


def test_lost_motion_is_friction_until_a_load_falls(arms):
    robot = arms["sk120"]
    rising = generic_readings(robot, unloading=False)
    apart = alias_classes(robot, base=BASE)
    together = alias_classes(robot, base=BASE, load_cases=rising)
    new = {frozenset(g) for g in together.twins} - {frozenset(g) for g in apart.twins}
    known = declared_aliases(robot)
    declared = {frozenset((a.name, a.other)) for a in known if a.when == LOADS_GROW}
    assert new == declared and len(new) == 6
    # an arm whose weight holds the gears on one flank tells them apart even so
    heavy = arms["skew"]
    assert not any(a.when == LOADS_GROW for a in declared_aliases(heavy))
    assert not alias_classes(heavy, load_cases=generic_readings(heavy, unloading=False)).twins


def test_sliding_is_drift_where_loads_grow_one_way(arms):
    robot = arms["sk120"]
    plain = generic_readings(robot)
    wrench = np.zeros((plain.count, 6))
    wrench[:, :3] = plain.order[:, None] * np.array([3.0, -5.0, 2.0])
    load_cases = replace(plain, wrench=wrench, time=None)
    found = alias_classes(robot, base=BASE, load_cases=load_cases)
    twins = {frozenset(group) for group in found.twins}
    for alias in declared_aliases(robot):
        if alias.when == ONE_WAY:
            assert any({alias.name, alias.other} <= group for group in twins)
    apart = alias_classes(robot, base=BASE, load_cases=replace(plain, time=None))
    assert not any("drift" in name for group in apart.twins for name in group)


def test_an_experiment_of_one_pose_tells_little(arms):
    robot = arms["sk120"]
    many = generic_readings(robot)
    one = replace(many, a=np.tile(many.a[:1], (many.count, 1)))
    one = replace(one, rotation=np.tile(many.rotation[:1], (many.count, 1, 1)))
    found = alias_classes(robot, base=BASE, load_cases=one)
    everywhere = alias_classes(robot, base=BASE)
    assert len(found.absorbed) + len(found.same) + len(found.within) > 3 * (
        len(everywhere.absorbed) + len(everywhere.same) + len(everywhere.within)
    )
    # six numbers describe the compliance of one pose: what has more parameters holds it all
    wide = {wide for _, wide in found.within}
    assert "tool_compliance:tool0" in wide


def weightless(robot: Robot) -> Robot:
    """The same arm without masses: signatures leave out how far it sags under its own weight."""
    if robot.total_mass == 0.0:
        return robot
    text = re.sub(r"<inertial>.*?</inertial>", "", robot.document.xml, flags=re.DOTALL)
    return load_robot(text, base=robot.base_frame, tool=robot.tool_frame)


@pytest.mark.parametrize("name", NAMES)
def test_signatures_are_the_models_sensitivities_at_small_loads(name, arms):
    robot = weightless(arms[name])
    plain = generic_readings(robot, count=12, moments=True)
    small = replace(plain, wrench=1e-5 * plain.wrench, reading_axes=plain.rotation)
    effects = all_effects(robot, timed=True)
    effects = [e for e in effects if e.parameters and e.name not in ("lost_motion", SPRINGS)]
    model = joint_spring_model(robot)
    springs = {joint: model.values[k] for k, joint in enumerate(robot.actuated)}
    first = FirstOrder(small, effects, springs)
    for item in effects:
        whole = model + item
        exact = whole.predict_with_sensitivities(small)[1][..., robot.n :]
        ours = first.of(item)
        sizes = np.abs(exact).max(axis=(0, 1))
        assert (np.abs(ours - exact).max(axis=(0, 1)) <= 2e-4 * sizes + 1e-18).all(), item.id


def test_classes_of_nothing():
    robot = arm("sk120")
    found = alias_classes(robot, effects=[effect(robot, "base_rocking")], base=BASE)
    assert isinstance(found, AliasClasses)
    assert not found.same and not found.within and not found.twins and not found.sentences()
