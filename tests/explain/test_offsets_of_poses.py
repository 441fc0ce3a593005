"""Zero readings that are off: named though σ was understated, and told from a sensor's bias."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff import Model, base_model, load_robot
from sk120stiff.effects.tracker import ZeroOffset
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.candidates.aliases import exact_aliases
from sk120stiff.measurements import Measurements, NoiseStatement
from tests.explain.readings import answered, hidden
from tests.hidden.generator.causes_sensor import ForceBias
from tests.hidden.generator.world import Cause

SIGMA, SIZE = 4e-6, 1.2e-5
BIAS = {"x": 9.0, "y": -12.0, "z": 7.0}


@pytest.fixture(scope="module")
def springs() -> Model:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return model


def with_offsets(*causes: Cause, factor: float = 1.0, loads: int = 6) -> Measurements:
    """Each row with a zero reading of its own, all of a pose off alike; σ is stated / factor."""
    exact = hidden(*causes, poses=15, loads=loads, sigma=1e-12, seed=31)
    rng = np.random.default_rng(32)
    assert exact.displacement is not None
    poses = {pose: rng.normal(0.0, SIZE, 3) for pose in exact.poses}
    error = rng.normal(0.0, np.sqrt(2.0) * SIGMA, (exact.n_readings, 3))
    return replace(
        exact,
        displacement=exact.displacement + error + np.array([poses[p] for p in exact.pose]),
        zero="separate",
        noise=NoiseStatement(sigma=SIGMA / factor),
    )


def test_offsets_that_go_with_the_order_of_rows_may_be_a_drift(springs: Model) -> None:
    """Without a column of order no drift is sought; whoever took the readings knows theirs."""
    plain = replace(with_offsets(), order=None, time=None)
    drift = np.array([6e-6, 0.0, -8e-6]) * plain.pose_index[:, None]
    steady = answered(springs, replace(plain, displacement=plain.displacement + drift))
    assert "zero_offset:tracker" in {f.effect.id for f in steady.findings}
    said = next_step(steady)
    assert "go steadily with the order of the rows" in said and "column order (1, 2, 3" in said
    chance = next_step(answered(springs, plain))
    assert "a drift was not looked for" in chance and "steadily" not in chance
    known = replace(plain, order=np.arange(1.0, plain.n_readings + 1.0))
    assert "column order" not in next_step(answered(springs, known))


@pytest.mark.parametrize("factor", [1.0, 1.4])
def test_offsets_are_named_whatever_was_stated(springs: Model, factor: float) -> None:
    """Model-form error that is constant at single poses is what offsets are; a name comes first."""
    answer = answered(springs, with_offsets(factor=factor))
    assert answer.verdict == "named"
    assert [finding.effect.id for finding in answer.findings] == ["zero_offset:tracker"]
    assert not answer.remainder.significant
    if factor > 1.0:
        assert answer.adequacy.understated == pytest.approx(factor, rel=0.1)


def test_what_offsets_have_in_common_is_the_sensors(springs: Model) -> None:
    answer = answered(springs, with_offsets(ForceBias("sensor", BIAS)))
    names = {finding.effect.id for finding in answer.findings}
    assert names == {"zero_offset:tracker", "force_bias:sensor"}
    told = {p.spec.name: p for p in answer.final.parameters if p.effect.name == "force_bias"}
    for axis, true in BIAS.items():
        found = told[f"offset_{axis}"]
        assert found.std is not None and found.std < 3.0
        # reported minus true; the generator's is what the arm feels beside the report
        assert abs(found.value + true) < 3.0 * found.std


def test_what_shows_at_no_other_poses_is_called_no_alias() -> None:
    """A drift goes by the order of readings, which other poses have not: nothing is told of it."""
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    drift = sk.effect(robot, "reading_drift", "tracker")
    tilt = sk.effect(robot, "joint_tilt", "joint_2_l")
    typical = [spec.typical for spec in drift.parameters]
    drifting = (model + drift).with_values(np.array([*model.values, *typical]))
    assert exact_aliases(drifting, drift, [tilt], point=np.array([0.0, 0.1, 0.2])) == ()


def test_a_saved_model_knows_its_readings(springs: Model, tmp_path: Path) -> None:
    """Whoever saves an answer from Python need not say so."""
    readings = replace(hidden(), data_hash="a")
    answered(springs, readings).save(tmp_path)
    assert sk.read_model(tmp_path / "model.yaml").provenance["data_hash"] == "sha256:a"


def test_offsets_are_those_of_the_file_they_were_found_in(springs: Model) -> None:
    """Another file calls other poses by the same labels; its zero readings are others, too."""
    readings = replace(hidden(), data_hash="a")
    offsets = springs + ZeroOffset("tracker", poses=readings.poses)
    values = np.append(springs.values, np.full(3 * len(readings.poses), 2e-4))
    model = replace(offsets.with_values(values), provenance={"data_hash": "sha256:a"})
    bare = sk.predict(springs, readings).displacement
    own = sk.predict(model, readings).displacement
    other = sk.predict(model, replace(readings, data_hash="b")).displacement
    np.testing.assert_allclose(own - bare, 2e-4, rtol=1e-9)
    np.testing.assert_allclose(other, bare, atol=1e-12)
