"""A law that takes a drive's spring away gives way to another law of the same name."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff import joint_spring_model, load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain.candidates.sums import Solved, sums_of
from sk120stiff.explain.findings import Evidence, Finding
from sk120stiff.explain.judge import rigid_gears
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.judge.confirm import UNTRIED
from sk120stiff.explain.judge.rigid_gears import (
    OUT_OF_LINE,
    UNLIKELY,
    held_rigid,
    prices_of_drives,
    without_rigid_gears,
)
from sk120stiff.explain.select.stepwise import Selection, select, with_effects
from sk120stiff.measurements import Measurements, NoiseModel, NoiseStatement
from tests.corpus.robots import example
from tests.explain.readings import SIGMA, base_fit, hidden
from tests.hidden.generator.causes_elastic import JointTilt
from tests.real_arms import fanuc


def named(found: Selection) -> Named:
    (law,) = found.effects
    return Named((Finding(law, (), (), Evidence(9.0, 9.0, None, np.inf, UNTRIED, {}, {})),))


def springs(found: Selection) -> list[float]:
    return [p.value for p in found.final.parameters if p.effect.joint_spring]


if fanuc.FOLDER.is_dir():

    def test_a_beam_leaves_a_real_arm_all_its_gears(tmp_path):
        """One bending axis takes joint 3 away from the arm; two of them fit nearly as well."""
        arm = fanuc.robot(tmp_path, 1, 1, 1, 1, 1, 1)
        beam = effect(arm, "link_bending", "link_3")
        settled = select(
            joint_spring_model(arm), fanuc.readings(fanuc.MAPPED), NoiseModel(150e-6),
            (beam,), max_effects=1, alpha=0.01,
        )  # fmt: skip
        found = with_effects(settled, [replace(beam, taper=-0.5, roll=True, planes=False)])
        assert np.isinf(springs(found)[2])
        other, said = without_rigid_gears(found, named(found))
        assert np.isfinite(springs(other)).all()
        assert said.findings[0].effect == other.effects[0] != found.effects[0]
        assert said.findings[0].effect.id == beam.id
        assert other.final.chi_square < found.final.chi_square + UNLIKELY

    def test_a_rival_that_leaves_all_gears_goes_first(tmp_path):
        """Readings hardly tell tilt of joint 3 from the beam that takes its gear away."""
        arm = fanuc.robot(tmp_path, 1, 1, 1, 1, 1, 1)
        beam, tilt = (
            effect(arm, *name) for name in (("link_bending", "link_3"), ("joint_tilt", "joint_3"))
        )
        settled = select(
            joint_spring_model(arm), fanuc.readings(fanuc.MAPPED), NoiseModel(150e-6),
            (beam, tilt), max_effects=1, alpha=0.01,
        )  # fmt: skip
        found = with_effects(settled, [replace(beam, taper=-0.5, roll=True, planes=False)])
        alone = named(found)
        odds = {beam.id: 0.9, tilt.id: 0.09}
        said = replace(alone.findings[0].evidence, odds=odds, rivals={tilt.id: 4.6})
        asked = Named((replace(alone.findings[0], evidence=said),))
        other, after = without_rigid_gears(found, asked)
        assert np.isfinite(springs(other)[:3]).all()
        assert after.findings[0].effect.id == tilt.id == other.effects[0].id
        assert after.findings[0].alternatives == (beam.id,)


def test_a_law_that_leaves_all_springs_stays(tmp_path):
    base = base_fit(hidden())
    robot = base.model.robot
    tilt = effect(robot, "joint_tilt", "joint_2_l")
    found = select(
        base.model, base.problem.measurements, base.problem.noise, (tilt,),
        max_effects=1, alpha=0.01,
    )  # fmt: skip
    found = with_effects(found, [tilt])
    assert np.isfinite(springs(found)).all()
    assert without_rigid_gears(found, named(found)) == (found, named(found))


def test_the_name_with_the_cheaper_gears_goes_first(monkeypatch):
    """Readings of a tilt, named as a bending link whose gears are said to cost more."""
    base = base_fit(hidden(JointTilt("joint_2_l", {"first": 4e-7, "second": 3e-7})))
    robot = base.model.robot
    tilt, beam = effect(robot, "joint_tilt", "joint_2_l"), effect(robot, "link_bending", "link_2_l")
    settled = select(
        base.model, base.problem.measurements, base.problem.noise, (tilt, beam),
        max_effects=1, alpha=0.01,
    )  # fmt: skip
    found = with_effects(settled, [beam])

    def by_name(regression, model):
        ids = [regression.candidates[e].id for e in model.effects]
        return np.array([0.0, 9.0 * (beam.id in ids)])

    monkeypatch.setattr(rigid_gears, "prices_of_drives", by_name)
    (alone,) = named(found).findings
    odds = {beam.id: 0.9, tilt.id: 0.09}
    asked = Named((replace(alone, evidence=replace(alone.evidence, odds=odds)),))
    other, after = without_rigid_gears(found, asked)
    assert other.effects[0].id == after.findings[0].effect.id == tilt.id
    assert after.findings[0].alternatives == (beam.id,)


def priced(compliances, errors, *, held=()) -> float:
    """Price of springs that readings tell one by one, each with its own standard error."""
    errors = np.array(errors)
    X, y = np.diag(1.0 / errors), np.array(compliances) / errors
    moving = np.array([k for k in range(len(errors)) if k not in held])
    model = SimpleNamespace(solved=Solved(moving, np.array(compliances)[moving], 0.0))
    regression = SimpleNamespace(
        springs=np.arange(len(errors)), X=X, plausible=np.full(len(errors), 1e9),
        sigma_known=True, sums=lambda: sums_of(X, y),
    )  # fmt: skip
    return float(prices_of_drives(regression, model).max())


def test_drives_in_line_cost_little():
    """Springs of a KUKA KR 240 (Dumas et al. 2011), joint by joint, well measured."""
    springs = 1.0 / np.array([1.41, 0.40, 0.94, 0.36, 0.37, 0.38])
    assert priced(springs, 0.02 * springs) < OUT_OF_LINE


def test_a_drive_out_of_line_has_its_price():
    """Twenty times stiffer than the others: ln(20)² where the readings are sure of it."""
    assert priced([0.05, 1.0, 1.0, 1.0], [1e-4] * 4) == pytest.approx(np.log(20.0) ** 2, rel=0.02)
    assert priced([0.05, 1.0, 1.0, 1.0], [0.3, *[1e-4] * 3]) < 3.0


def test_a_rigid_drive_costs_as_much_as_readings_are_against_its_yielding():
    assert priced([-0.3, 1.0, 1.0], [0.1] * 3, held=(0,)) > OUT_OF_LINE
    assert priced([-0.3, 1.0, 1.0], [1.0] * 3, held=(0,)) < 1.5
    assert priced([0.0, 1.0, 1.0], [50.0, 0.1, 0.1], held=(0,)) < 0.01


def test_a_rival_that_goes_first_keeps_the_set_and_its_evidence():
    robot = load_robot("motoman_sk120")
    tilt, beam = effect(robot, "joint_tilt", "joint_2_l"), effect(robot, "link_bending", "link_2_l")
    odds = {beam.id: 0.9, tilt.id: 0.08}
    told = Evidence(20.0, 30.0, "base_rocking:base_link", 9.0, UNTRIED, odds, {tilt.id: 4.8})
    before = Finding(beam, (tilt.id,), (), told)
    after = before.headed_by(tilt)
    assert (after.effect, after.alternatives) == (tilt, (beam.id,))
    assert after.probability == pytest.approx(before.probability)
    assert after.evidence.rivals == {beam.id: -4.8}
    assert after.evidence.score_gain == pytest.approx(15.2)
    assert after.gain == pytest.approx(before.gain, abs=0.1)  # odds and scores say the same
    assert before.headed_by(replace(beam, taper=0.6)).effect.taper == 0.6


def test_a_tilt_about_the_next_joint_leaves_that_joint_its_spring():
    """The tilt of panda_joint2 along its link turns about the axis of panda_joint3."""
    robot = load_robot(example("panda.urdf"), base="panda_link0", tool="panda_link8")
    rng = np.random.default_rng(2)
    joints = np.repeat(rng.uniform(-1.0, 1.0, (20, 7)) + [0, 0, 0, -1.5, 0, 1.5, 0], 3, axis=0)
    tilt = effect(robot, "joint_tilt", "panda_joint2")
    true = joint_spring_model(robot, np.full(7, 3e4)) + tilt
    true = true.with_public({f"{tilt.id}.stiffness_along": 6e4, f"{tilt.id}.stiffness_across": 4e4})
    silent = Measurements(
        pose=tuple(str(k // 3) for k in range(60)),
        joint_names=robot.actuated,
        joints=joints,
        wrench=np.hstack([rng.normal(0.0, 20.0, (60, 3)), np.zeros((60, 3))]),
        displacement=np.zeros((60, 3)),
        point=np.array([0.05, 0.02, 0.1]),
        zero="separate",
        noise=NoiseStatement(sigma=SIGMA),
    )
    moved = true.predict(load_cases_of(robot, silent)) + rng.normal(0.0, SIGMA, (60, 3))
    settled = select(
        joint_spring_model(robot), replace(silent, displacement=moved), NoiseModel(SIGMA),
        (tilt,), max_effects=1, alpha=0.01,
    )  # fmt: skip
    other, _ = without_rigid_gears(settled, named(settled))
    assert np.isinf(springs(settled)[2])
    assert springs(other)[2] == pytest.approx(1.0 / (1.0 / 3e4 + 1.0 / 6e4), rel=0.05)
    assert other.final.chi_square < settled.final.chi_square + UNLIKELY
    (said,) = held_rigid(other.final)
    assert said.startswith("joint_tilt:panda_joint2.stiffness_along is held rigid")
