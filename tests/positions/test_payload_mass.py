"""One of several payloads weighs otherwise than stated, by positions of another hand."""

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects.payload_mass import PayloadMass
from sk120stiff.explain.findings import sentence_in
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.answer.next_step import next_step_of_positions
from tests.positions.arm import errors, poses, tracked, write
from tests.positions.test_forms import _with
from tests.positions.test_link_masses import SAID, SIGMA

STATED = (0.0, 40.0, 80.0)
SPRINGS = {"j2": 8e5, "j3": 5e5}


def explained(folder: Path, true: tuple[float, ...], *, geometry: bool = False) -> Explained:
    """Of three readings at each of 30 poses, payloads stated as `STATED`."""
    a = np.repeat(poses(30, 4), 3, axis=0)
    arm = _with(payload=(np.tile(true, 30), np.zeros(3)))
    if geometry:
        arm.shift, arm.turn = errors(3).shift, errors(3).turn
    arm.compliance = np.array([0.0, 1 / 8e5, 1 / 5e5, 0.0, 0.0, 0.0])
    x = tracked(arm.stands(a)[0]) + SIGMA * np.random.default_rng(1).normal(size=(90, 3))
    cells = [f"{m:g}" for m in np.tile(STATED, 30)]
    path = write(folder, a, x, SAID, more=",payload[kg]", cells=cells)
    robot = sk.load_robot(folder / "six.urdf", base="base", tool="tool")
    return sk.explain(sk.Model(robot), sk.read(path))


@pytest.mark.parametrize(("true", "name"), [((0.0, 40.0, 88.0), "mass_80"),
                                            ((0.0, 36.0, 80.0), "mass_40")])  # fmt: skip
def test_it_is_named_with_what_it_weighs(
    tmp_path: Path, true: tuple[float, ...], name: str
) -> None:
    found = explained(tmp_path, true)
    other = {each.effect.id for each in found.findings if each.effect.name != "joint_frame"}
    assert other == {"joint_springs:j2", "joint_springs:j3", "payload_mass:tool"}
    model = found.final.model
    off = model.parameter(f"payload_mass:tool.{name}")
    assert off.value == pytest.approx(sum(true) - sum(STATED), abs=3.5 * off.std)
    assert off.std < 0.5
    for joint, stiffness in SPRINGS.items():
        spring = model.parameter(f"joint_springs:{joint}.stiffness")
        assert spring.value == pytest.approx(stiffness, abs=3.5 * spring.std)
        assert spring.std < 0.02 * stiffness


def test_payloads_that_are_right_are_not_doubted(tmp_path: Path) -> None:
    found = explained(tmp_path, STATED, geometry=True)
    assert "payload_mass" not in {each.effect.name for each in found.findings}
    assert "payload_mass:tool" in {effect.id for effect in found.linear.candidates}


def test_its_file_says_which_it_is(tmp_path: Path) -> None:
    """And the rows of other payloads are as they were."""
    found = explained(tmp_path, (0.0, 40.0, 88.0))
    sk.write_model(found.final.model, tmp_path / "model.yaml")
    again = sk.read_model(tmp_path / "model.yaml")
    (law,) = [effect for effect in again.effects if isinstance(effect, PayloadMass)]
    assert law.stated == 80.0
    rows = found.final.problem.load_cases
    weight = law.offsets(rows)[:, :3, 0]
    hangs = np.tile(STATED, 30) == 80.0
    assert np.allclose(np.linalg.norm(weight[hangs], axis=1), 9.80665)
    assert not weight[~hangs].any()


def test_a_payload_hung_from_some_row_on_is_no_tracker_that_moved(tmp_path: Path) -> None:
    """All poses under one payload, then all under the next, which is heavier than stated."""
    mass = np.repeat(STATED, 30)
    arm = _with(payload=(np.where(mass == 80.0, 88.0, mass), np.zeros(3)))
    arm.compliance = np.array([0.0, 1 / 8e5, 1 / 5e5, 0.0, 0.0, 0.0])
    a = np.tile(poses(30, 4), (3, 1))
    x = tracked(arm.stands(a)[0]) + SIGMA * np.random.default_rng(1).normal(size=(90, 3))
    path = write(tmp_path, a, x, SAID, more=",payload[kg]", cells=[f"{m:g}" for m in mass])
    robot = sk.load_robot(tmp_path / "six.urdf", base="base", tool="tool")
    found = sk.fit(sk.base_model(robot), sk.read(path))
    assert not any("looks moved" in note for note in found.notes)
    assert "payload_mass:tool" in found.lacks


def test_what_it_weighs_and_what_to_do_is_said(tmp_path: Path) -> None:
    found = explained(tmp_path, (0.0, 40.0, 88.0))
    (named,) = [each for each in found.findings if each.effect.name == "payload_mass"]
    said = sentence_in(found.final.model, named.effect)
    assert said.startswith("The payload that is stated as 80 kg weighs 8")
    assert float(said.partition("weighs ")[2].partition(" kg")[0]) == pytest.approx(88.0, abs=0.5)
    assert "Weigh the payload" in next_step_of_positions(found)
