"""An effect from outside the package, from the truth that holds it to the file with its value."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sk120stiff.effects import CATALOGUE, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.explain import Explanation, Options, localise
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, base_model, read_model, write_model
from sk120stiff.robot import load_robot
from sk120stiff.show.stories import explain_report
from tests.effects.outside import EVERYTHING, JointCreep, LinkStretch
from tests.explain.readings import POINT, answered, hidden
from tests.hidden.generator.causes_foreign import AxialLink
from tests.hidden.generator.rows import Rows
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import World

STIFFNESS = 1.2e7  # N/m
RATE = 4e-6  # rad from one reading to the next


@pytest.fixture(scope="module")
def model() -> Model:
    found = base_model(load_robot("motoman_sk120"))
    assert found is not None
    return found


@pytest.fixture(scope="module")
def stretched() -> Measurements:
    """Made by the benchmark's generator, in which a link that stretches is none of ours."""
    return hidden(AxialLink("link_3_u", {"compliance": 1.0 / STIFFNESS}))


def named(answer: Explanation) -> list[str]:
    return [finding.effect.id for finding in answer.findings]


@pytest.fixture(scope="module")
def answer(model: Model, stretched: Measurements) -> Explanation:
    return answered(model, stretched, catalogue=EVERYTHING)


def test_it_is_found_by_name_with_its_value(answer: Explanation) -> None:
    assert answer.verdict == "named" and named(answer) == ["link_stretch:link_3_u"]
    (value,) = [p for p in answer.final.model.parameters if p.effect.name == "link_stretch"]
    assert abs(value.value - STIFFNESS) < 3.0 * value.std
    assert value.std < 0.1 * STIFFNESS
    assert answer.catalogue == EVERYTHING


def test_without_it_the_catalogue_has_no_such_name(model: Model, stretched: Measurements) -> None:
    with pytest.raises(InputError, match="there is no effect 'link_stretch'"):
        answered(model, stretched, options=Options(only=("link_stretch",)))


def test_where_it_is_not_looked_for_it_still_says_where_the_gap_lives(
    model: Model, stretched: Measurements
) -> None:
    """A suspect is a free form of every elastic effect, those from outside among them."""
    kept = Options(exclude=("link_stretch",))
    found = answered(model, stretched, catalogue=EVERYTHING, options=kept)
    assert localise(found.base).strongest.name == "the force that stretches link_3_u"
    assert "link_stretch" not in {each.effect.name for each in found.findings}


def test_the_report_speaks_of_it(answer: Explanation, stretched: Measurements) -> None:
    page = explain_report(answer, stretched, data="readings.csv").html()
    assert LinkStretch("link_3_u").sentence() in page


def test_the_file_is_written_and_read_with_it(answer: Explanation, tmp_path: Any) -> None:
    final = answer.final.model
    path = write_model(final, tmp_path / "model.yaml")
    assert "against stretching along the link" in path.read_text(encoding="utf-8")
    again = read_model(path, catalogue=EVERYTHING)
    assert again.names == final.names
    np.testing.assert_allclose(again.values, final.values, rtol=1e-12)
    with pytest.raises(InputError, match="there is no effect 'link_stretch'"):
        read_model(path)


def test_it_is_simulated_as_elsewhere(model: Model, stretched: Measurements) -> None:
    """A virtual joint of the program against finite motions of the benchmark's generator."""
    still = hidden(sigma=1e-12)
    moved = hidden(AxialLink("link_3_u", {"compliance": 1.0 / STIFFNESS}), sigma=1e-12)
    assert still.displacement is not None and moved.displacement is not None
    more = model + EVERYTHING.effect(model.robot, "link_stretch", "link_3_u")
    load_cases = load_cases_of(model.robot, still)
    made = more.with_public(**{"link_stretch:link_3_u.stiffness": STIFFNESS}).predict(load_cases)
    theirs = moved.displacement - still.displacement
    assert np.abs(theirs).max() > 2e-5
    ours = made - model.predict(load_cases)
    np.testing.assert_allclose(ours, theirs, atol=2e-4 * np.abs(theirs).max())


def crept(rate: float) -> Measurements:
    """A joint that turns on between zero and reading, by the generator's own kinematics."""
    readings = hidden(schedule="ascending")
    arm = sk120()
    springs = {name: 1.0 / value for name, value in arm.typical.joint.items()}
    assert readings.order is not None and readings.zero_order is not None
    count = readings.n_readings
    coordinates = {name: readings.joints[:, k] for k, name in enumerate(arm.actuated)}
    rows = Rows(
        pose=np.arange(count),
        coordinates=coordinates,
        force=readings.wrench[:, :3],
        moment=readings.wrench[:, 3:],
        order=readings.order,
        zero_order=readings.zero_order,
        branch=np.ones(count),
        repeat=np.zeros(count, dtype=np.int64),
        point=POINT,
        force_point=POINT,
    )
    steps = rows.order - rows.zero_order
    moved = {**coordinates, "joint_2_l": coordinates["joint_2_l"] + rate * steps}
    world = World(arm, springs)
    plain, start, _ = world.observe(rows)
    loaded, elsewhere, _ = world.observe(replace(rows, coordinates=moved))
    assert readings.displacement is not None
    return replace(
        readings, displacement=readings.displacement + (elsewhere + loaded) - (start + plain)
    )


def test_a_movement_that_no_load_makes_is_simulated_as_elsewhere(model: Model) -> None:
    """The law of `Imposed` against finite rotations of the benchmark's generator."""
    still, moved = crept(0.0), crept(RATE)
    assert still.displacement is not None and moved.displacement is not None
    load_cases = load_cases_of(model.robot, still)
    creep = EVERYTHING.effect(model.robot, "joint_creep", "joint_2_l")
    more = model + creep
    values = np.append(model.values, RATE)
    ours = more.predict(load_cases, values) - model.predict(load_cases)
    theirs = moved.displacement - still.displacement
    assert np.abs(theirs).max() > 1e-5
    np.testing.assert_allclose(ours, theirs, atol=2e-4 * np.abs(theirs).max())


def test_a_movement_that_no_load_makes_is_found(model: Model) -> None:
    found = answered(
        model, crept(RATE), catalogue=CATALOGUE + JointCreep, options=Options(max_effects=2)
    )
    assert found.verdict == "named" and named(found) == ["joint_creep:joint_2_l"]
    (rate,) = [p for p in found.final.model.parameters if p.effect.name == "joint_creep"]
    assert rate.std is not None
    assert abs(rate.value - RATE) < 3.0 * rate.std
