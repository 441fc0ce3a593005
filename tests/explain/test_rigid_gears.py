"""A law that takes a drive's spring away gives way to another law of the same name."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff import joint_spring_model, load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain.findings import Evidence, Finding
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.judge.confirm import UNTRIED
from sk120stiff.explain.judge.rigid_gears import UNLIKELY, _total, held_rigid, without_rigid_gears
from sk120stiff.explain.select.stepwise import Selection, select, with_effects
from sk120stiff.measurements import Measurements, NoiseModel, NoiseStatement
from tests.corpus.robots import example
from tests.explain.readings import SIGMA, base_fit, hidden
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


def test_every_rigid_gear_has_its_price():
    """Columns 0 and 1 are springs, 2 is a zero offset, 3 the effect's."""
    regression = SimpleNamespace(base=np.array([0, 1, 2]), lower=np.array([0, 0, -np.inf, 0]))

    def model(*columns: int, plausible: bool = True) -> SimpleNamespace:
        solved = SimpleNamespace(columns=np.array(columns))
        return SimpleNamespace(score=7.0, solved=solved, plausible=plausible)

    assert _total(regression, model(0, 1, 3)) == 7.0
    assert _total(regression, model(3, 0)) == 7.0 + UNLIKELY
    assert _total(regression, model(2, 3)) == 7.0 + 2.0 * UNLIKELY
    assert _total(regression, model(0, 1, 2, 3, plausible=False)) == np.inf


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
