"""Poses for a calibration by positions: as good as is promised, on an arm of nobody's physics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError, Refusal
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.plan import Cell, Places, PlanOfPositions
from tests.positions.arm import Arm, bound, errors, tracked, urdf

SIGMA, FEW = 2e-5, 60  # m; poses to choose from
AT = np.array([0.05, -0.08, 0.12])  # of the marker
COMPLIANCE = np.array([0.0, 2e-6, 3e-6, 1e-5, 1.2e-5, 0.0])


def arm_file(folder: Path, *, effort: str = "4000", weighs: bool = True) -> Path:
    path = folder / "six.urdf"
    path.write_text(urdf(weighs).replace('effort="1"', f'effort="{effort}"'))
    return path


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> sk.Model:
    robot = sk.load_robot(arm_file(tmp_path_factory.mktemp("six")), base="base", tool="tool")
    found = sk.joint_spring_model(robot)
    values = {f"j{k + 1}": c for k, c in enumerate(COMPLIANCE) if c}
    return replace(
        found,
        parameters=tuple(
            replace(p, internal=values.get(p.effect.where, p.internal)) for p in found.parameters
        ),
    )


@pytest.fixture(scope="module")
def thirty(model: sk.Model) -> PlanOfPositions:
    """The arm's own plan: thirty poses for its marker and the noise of its tracker."""
    return sk.plan_positions(model, 30, point=AT, sigma=SIGMA, candidates=FEW)


def springs_of(made: PlanOfPositions, rigid: bool = False) -> dict[str, float]:
    """Standard errors of springs; `rigid`: of an arm whose links are known not to yield."""
    return {
        each.parameter.effect.where: each.if_rigid if rigid else each.std
        for each in made.expected
        if each.parameter.effect.joint_spring and each.reason is None
    }


def test_what_is_promised_is_the_bound_of_the_poses(
    model: sk.Model, thirty: PlanOfPositions
) -> None:
    assert thirty.is_plan and thirty.n_readings == 30 and thirty.absolute is not None
    least = bound(Arm(compliance=COMPLIANCE, marker=AT), thirty.joints, SIGMA)
    found = springs_of(thirty, rigid=True)
    assert set(found) == {"j2", "j3", "j4", "j5"}
    for name, std in found.items():
        assert std == pytest.approx(least[int(name[1]) - 1], rel=0.06), name
    why = {e.parameter.effect.where: e.reason for e in thirty.expected if e.reason is not None}
    assert "neither weight nor payload" in (why["j1"] or "") and "j6" in why
    others = sk.plan_positions(model, 30, point=AT, sigma=2.0 * SIGMA, candidates=FEW)
    assert others.standard == 2.0 * SIGMA
    duller = bound(Arm(compliance=COMPLIANCE, marker=AT), others.joints, 2.0 * SIGMA)
    assert springs_of(others, rigid=True)["j4"] == pytest.approx(duller[3], rel=0.06)


def test_links_that_may_bend_are_promised_as_a_fit_will_count_them(
    model: sk.Model, thirty: PlanOfPositions
) -> None:
    """Of springs by readings of an arm whose links do not, over draws of the noise."""
    promised, alone = springs_of(thirty), springs_of(thirty, rigid=True)
    squares = dict.fromkeys(promised, 0.0)
    for seed in range(8):
        read = sk.simulate(model, thirty, noise=sk.NoiseModel(SIGMA), seed=seed).measurements
        found = sk.fit(model, read).model
        for name in promised:
            std = found.parameter(f"joint_springs:{name}.stiffness").internal_std
            assert std is not None
            squares[name] += std**2 / 8
    for name, std in promised.items():
        assert 0.7 * std < np.sqrt(squares[name]) < 1.4 * std, name
    assert promised["j2"] > 5.0 * alone["j2"] and promised["j4"] < 1.2 * alone["j4"]
    mostly = {e.parameter.effect.id: e.mostly for e in thirty.expected}
    assert mostly["joint_springs:j2"].startswith("link_bending") and not mostly["joint_springs:j4"]


def test_what_a_fit_of_the_plan_foretells_is_as_far_off_as_was_promised(
    model: sk.Model, thirty: PlanOfPositions
) -> None:
    rng = np.random.default_rng(3)
    elsewhere = thirty.candidates.problem.measurements.joints
    off: list[float] = []
    for seed in range(12):
        arm = replace(errors(seed), compliance=COMPLIANCE, marker=AT + 1e-3 * rng.normal(size=3))
        x = tracked(arm.stands(thirty.joints)[0])
        x = x + SIGMA * rng.normal(size=x.shape)
        channels = replace(thirty.absolute.channels, position=x, sigma={"position": SIGMA})
        read = replace(thirty, absolute=replace(thirty.absolute, channels=channels))
        found = calibrate(model, read, waves=False, shared=False)
        asked = thirty.candidates.problem.measurements
        seen = sk.predict(found.model, asked).position
        off.append(float(np.mean((seen - tracked(arm.stands(elsewhere)[0])) ** 2)))
    assert np.sqrt(np.mean(off)) == pytest.approx(thirty.foretold, rel=0.2)


def test_it_is_better_than_poses_without_a_design(model: sk.Model) -> None:
    made = sk.plan_positions(model, 20, point=AT, candidates=150)
    assert made.gain[0] > 1.1 and made.gain[1] > 1.05
    one = "joint_springs:j4.stiffness"
    for_one = sk.plan_positions(model, 20, parameters=[one], point=AT, candidates=150)
    assert springs_of(for_one)["j4"] < springs_of(made)["j4"]
    assert [each.parameter.name for each in for_one.expected] == [one]


def test_payloads_are_chosen_among_and_have_to_be_held(model: sk.Model, tmp_path: Path) -> None:
    both = sk.plan_positions(
        model, 10, loads=2, payloads=[20, 0], payload_point=[0, 0, 0.1], point=AT, candidates=40
    )
    assert both.n_readings == 20 and len(both.poses) == 10
    assert sorted(both.absolute.payload.tolist()) == [0.0] * 10 + [20.0] * 10
    np.testing.assert_array_equal(both.absolute.payload_point, [0, 0, 0.1])
    heavy = sk.plan_positions(model, 10, payloads=[0, 20], point=AT, candidates=40)
    bare = sk.plan_positions(model, 10, point=AT, candidates=40)
    assert springs_of(heavy)["j5"] < springs_of(bare)["j5"]
    with pytest.raises(Refusal, match="at no pose of 40 do the motors hold 5000 kg"):
        sk.plan_positions(model, 10, payloads=[5000], point=AT, candidates=40)
    weak = sk.load_robot(arm_file(tmp_path, effort="1000"), base="base", tool="tool")
    some = sk.plan_positions(sk.joint_spring_model(weak), 8, payloads=[30], candidates=80)
    assert any("motors do not hold" in said for said in some.remarks)
    hung = np.tile([0.0, 0.0, -30.0 * 9.80665, 0.0, 0.0, 0.0], (8, 1))
    torque = weak.gravity_torque(some.joints) + weak.screws(some.joints).torques(hung)
    assert 700.0 < np.abs(torque).max() <= 1000.0


def test_an_arm_without_weight_has_its_geometry_planned_alone(tmp_path: Path) -> None:
    robot = sk.load_robot(arm_file(tmp_path, weighs=False), base="base", tool="tool")
    light = sk.joint_spring_model(robot)
    made = sk.plan_positions(light, 12, point=AT, candidates=40)
    assert not springs_of(made) and any("no masses" in said for said in made.remarks)
    assert {each.parameter.effect.name for each in made.expected} == {"joint_frame"}
    with pytest.raises(InputError, match=r"nothing to plan for.*no masses"):
        sk.plan_positions(light, 12, parameters=[light.names[0]], candidates=40)
    hung = sk.plan_positions(light, 12, payloads=[10], point=AT, candidates=40)
    assert "j2" in springs_of(hung) and hung.n_readings == 12
    both = sk.plan_positions(light, 12, payloads=[0, 10], point=AT, candidates=40)
    assert both.n_readings == 24 and len(both.poses) == 12  # each pose under both
    assert (np.diff(both.absolute.payload) >= 0.0).all()  # hung once
    assert any("in no difference" in said for said in both.remarks)


def test_readings_there_are_give_markers_payloads_and_labels(
    model: sk.Model, tmp_path: Path
) -> None:
    first = sk.plan_positions(model, 25, payloads=[0, 15], loads=2, point=AT, candidates=40)
    known = sk.simulate(model, first, noise=sk.NoiseModel(SIGMA)).measurements
    made = sk.plan_positions(model, 5, known=known, candidates=40)
    assert set(made.absolute.payload) <= {0.0, 15.0} and made.n_readings == 5
    assert made.standard == pytest.approx(SIGMA)
    assert made.poses[0] == "next_1" and np.isfinite(made.cell.floor)
    alone = sk.plan_positions(model, 5, payloads=[0, 15], point=AT, sigma=SIGMA, candidates=40)
    assert not any("numbers cannot tell" in said for said in made.remarks)  # with those before
    assert np.isfinite(made.foretold) and any("numbers cannot" in s for s in alone.remarks)
    mine, bare = springs_of(made), springs_of(alone)
    assert all(mine[name] < bare.get(name, np.inf) for name in mine)
    file = sk.write_measurements(made, tmp_path / "next.csv")
    again = sk.read(file)
    assert again.is_plan and again.absolute is not None and again.absolute.fit_point
    np.testing.assert_allclose(again.joints, made.joints, atol=1e-12)
    pulled = sk.read(sk.bundled_robots()["motoman_sk120"] / "data/table2_measured.csv")
    with pytest.raises(InputError, match="no positions"):
        sk.plan_positions(model, 5, known=pulled)


def test_two_effects_are_told_apart_by_poses(model: sk.Model) -> None:
    pair = sk.effect(model.robot, "joint_tilt", "j4"), sk.effect(model.robot, "base_rocking")
    made = sk.plan_positions(model, 25, between=pair, payloads=[20], point=AT, candidates=60)
    assert made.chosen.evidence is not None and made.expected == () and np.isnan(made.foretold)
    before, after = made.chosen.evidence
    assert after > 3.0 > before and made.gain[0] > 1.0


def test_they_stand_at_places_and_are_driven(model: sk.Model) -> None:
    a = np.random.default_rng(0).uniform(-1.0, 1.0, (6, 6))
    places = Places(a, ("A", "A", "B", "B", "C", "C"), ())
    made = sk.plan_positions(model, places=places, point=AT)
    assert sorted(made.pose) == ["A", "B", "C"]
    paired = sk.plan_positions(model, places=places, loads=2, payloads=[0, 9], point=AT)
    postures = {name: paired.joints[[p == name for p in paired.pose]] for name in "ABC"}
    assert all(len(a) == 2 and np.array_equal(*a) for a in postures.values())  # one at each
    driven = sk.plan_positions(model, 5, point=AT, candidates=20, drive=True, cell=Cell(floor=-2.0))
    assert driven.way is not None and driven.poses == ("p1", "p2", "p3", "p4", "p5")


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        ({}, "how many poses"),
        ({"count": 5, "sigma": -1.0}, "sigma"),
        ({"count": 5, "payloads": [-1.0]}, "payload of -1 kg"),
        ({"count": 500, "candidates": 20}, "500 poses of 20 to choose from"),
    ],
)
def test_what_cannot_be_planned_is_refused(
    model: sk.Model, asked: dict[str, object], why: str
) -> None:
    with pytest.raises(InputError, match=why):
        sk.plan_positions(model, **asked)
