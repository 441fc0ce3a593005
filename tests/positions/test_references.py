"""From where effects count that go with warmth or a clock: what one row says, every file says."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.explain.positions.judge.accounts import heldout_on
from sk120stiff.identify import known_model
from sk120stiff.identify.positions.calibrate import calibrate
from tests.positions.arm import ORIGINS, SHIFT, Arm, Array, errors, poses, tracked, write
from tests.positions.test_files import fitted
from tests.positions.test_forms import FIT, NOISE, SIGMA

A = poses(60, 2)
SPRINGS = errors(1).compliance
RATE = 1.1e-5 * 0.9  # m/K of a link of 0.9 m
WARM = 20.0 + 8.0 * (1.0 - np.exp(-np.arange(60) / 20.0))  # degC
STEADY = 20.0 + np.arange(60.0)  # min, or numbers of readings

GROWTH = """robot: six.urdf
base_frame: base
tool_frame: tool
effects:
- name: thermal_growth
  where: l2
  REFERENCE
  parameters: {growth: {value: 9.9e-6, unit: m/K, std: 1.0e-6}}
uncertainty:
  noise_um: 10
  parameters: [{name: "thermal_growth:l2.growth", value: 9.9e-6, std: 1.0e-6, unit: m/K}]
  correlation: [[1.0]]
"""
DRIFT = """robot: six.urdf
base_frame: base
tool_frame: tool
effects:
- {name: reading_drift, where: tracker, reference: {order: 11, last: 50}, parameters: {
    rate_x: {value: 1.0e-6, unit: m}, rate_y: {value: 0, unit: m}, rate_z: {value: 0, unit: m},
    rate_x_over_8: {value: 4.0e-6, unit: m}, rate_y_over_8: {value: 0, unit: m},
    rate_z_over_8: {value: 0, unit: m}}}
"""
AT_20 = "reference: {temperature: 20, unit: degC}"


def grown(a: Array, kelvin: Array, compliance: Array = SPRINGS) -> Array:
    """Where the marker stands while the upper arm is longer along its own line, base axes."""
    along = ORIGINS[2] / np.linalg.norm(ORIGINS[2])
    at = (np.outer(np.arange(6) == 2, RATE * k * along) for k in kelvin)
    arms = (Arm(compliance=compliance, shift=shift) for shift in at)
    return np.array([arm.stands(q[None])[0][0] for arm, q in zip(arms, a, strict=True)])


def readings_of(folder: Path, a: Array, x: Array, settings: str, clock: str, at: Array):
    folder.mkdir(exist_ok=True)
    path = write(folder, a, x, settings, more=f",{clock}", cells=[f"{t:.6f}" for t in at])
    return sk.read(path)


def hand_model(folder: Path, text: str) -> sk.Model:
    write(folder, A[:1], np.zeros((1, 3)), "massless\n")
    (folder / "model.yaml").write_text(text)
    return sk.read_model(folder / "model.yaml")


def in_base(folder: Path, model: sk.Model, clock: str, at: list[float]) -> Array:
    """Predicted positions of one pose at some temperatures or times, in one file."""
    a, x = np.repeat(A[:1], len(at), axis=0), np.zeros((len(at), 3))
    settings = "massless\npoint: {xyz: [50, -80, 120], unit: mm}\n"
    return sk.predict(model, readings_of(folder, a, x, settings, clock, np.array(at))).position


def test_an_arm_of_known_growth_at_20_40_and_60_degrees(tmp_path: Path) -> None:
    """Each in a file of its own, of one row, and all in one: what the arm does by hand."""
    model = hand_model(tmp_path, GROWTH.replace("REFERENCE", AT_20))
    true = grown(A[[0, 0, 0]], np.array([0.0, 20.0, 40.0]), np.zeros(6))
    alone = [in_base(tmp_path / f"{t:g}", model, "temperature[degC]", [t])[0] for t in (20, 40, 60)]
    together = in_base(tmp_path / "all", model, "temperature[degC]", [20, 40, 60])
    np.testing.assert_allclose(alone, true, atol=1e-12)
    np.testing.assert_allclose(together, true, atol=1e-12)
    assert np.linalg.norm(true[2] - true[0]) == pytest.approx(40.0 * RATE, rel=1e-9)


def test_its_error_is_that_of_the_growth_at_that_temperature(tmp_path: Path) -> None:
    model = hand_model(tmp_path, GROWTH.replace("REFERENCE", AT_20))
    per_kelvin = np.diff(grown(A[[0, 0]], np.array([0.0, 1.0]), np.zeros(6)), axis=0)[0]
    for t in (20.0, 40.0, 60.0):
        folder = tmp_path / f"{t:g}"
        x = np.zeros((1, 3))
        data = readings_of(folder, A[:1], x, "massless\n", "temperature[degC]", np.array([t]))
        std = sk.predict(model, data).std_parameters[0]
        np.testing.assert_allclose(std, np.abs(per_kelvin) / RATE * 1e-6 * (t - 20.0), rtol=2e-3,
                                   atol=1e-12)  # fmt: skip


@pytest.mark.filterwarnings("ignore:.*the readings behind this model do not show joint_springs")
@pytest.mark.parametrize(
    ("clock", "effect", "entry"),
    [
        ("temperature[degC]", "thermal_growth:l2", f"{{temperature: {np.mean(WARM):.4f}"),
        ("time[min]", "thermal_growth:l2", "{time: 1200.0, last: 4740.0, unit: s}"),
        ("time[min]", "reading_drift:tracker", "{time: 1200.0, last: 4740.0, unit: s}"),
        ("order", "reading_drift:tracker", "{order: 20.0, last: 79.0}"),
    ],
)
def test_rows_are_predicted_alike_in_every_file(
    clock: str, effect: str, entry: str, tmp_path: Path
) -> None:
    """A model that was fitted, written and read: all rows, the last twenty, and one alone."""
    warm = clock.startswith("temperature")
    at = WARM if warm else STEADY
    kelvin = at - at[0] if warm else (at - at[0]) / 8.0
    x = tracked(grown(A, kelvin if "growth" in effect else np.zeros(60)))
    if "drift" in effect:
        x += np.outer(at - at[0], [3e-6, -2e-6, 1e-6])
    x += SIGMA * np.random.default_rng(7).normal(size=x.shape)
    data = readings_of(tmp_path, A, x, FIT + NOISE, clock, at)
    found = fitted(data.path, effect)
    file = sk.write_model(known_model(found), tmp_path / "model.yaml")
    text = file.read_text(encoding="utf-8")
    assert f"reference: {entry[:22]}" in text
    model = sk.read_model(file)
    assert model.effects == found.model.effects
    assert sk.model.model_text(model, folder=tmp_path) == text
    with warnings.catch_warnings():
        warnings.simplefilter("error", ToolkitWarning)
        whole = sk.predict(model, data)
        for rows in (np.arange(40, 60), np.array([59])):
            part = readings_of(tmp_path / "part", A[rows], x[rows], FIT + NOISE, clock, at[rows])
            said = sk.predict(model, part)
            np.testing.assert_allclose(said.position, whole.position[rows], atol=2e-10)
            np.testing.assert_allclose(said.std_parameters, whole.std_parameters[rows], rtol=1e-5)
    with pytest.warns(ToolkitWarning, match="as files of earlier versions do not"):
        earlier = sk.predict(without_reference(text, tmp_path), part).position
    assert np.linalg.norm(earlier - whole.position[rows], axis=1).max() > SIGMA


def without_reference(text: str, folder: Path) -> sk.Model:
    """The model as an earlier version wrote it."""
    lines = [line for line in text.splitlines() if not line.startswith("  reference:")]
    (folder / "earlier.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return sk.read_model(folder / "earlier.yaml")


@pytest.mark.filterwarnings("error::sk120stiff.errors.ToolkitWarning")
def test_a_held_out_file_of_another_temperature_is_met(tmp_path: Path) -> None:
    """It is 12 K warmer throughout, so its own mean says nothing of it."""
    noise = SIGMA * np.random.default_rng(7).normal(size=(2, 60, 3))
    x = tracked(grown(A, WARM - 20.0)) + noise[0]
    data = readings_of(tmp_path, A, x, FIT + NOISE, "temperature[degC]", WARM)
    found, other = fitted(data.path, "thermal_growth:l2"), poses(60, 5)
    x = tracked(grown(other, np.full(60, 20.0))) + noise[1]
    path = tmp_path / "held"
    held = readings_of(path, other, x, FIT + NOISE, "temperature[degC]", np.full(60, 40.0))
    told = heldout_on(found, found, held.with_joints(found.model.robot.actuated))
    assert told.rms < 1.3 * SIGMA
    assert told.anew is None


def test_a_model_of_an_earlier_campaign_keeps_its_temperature(tmp_path: Path) -> None:
    """The lengths of an arm stay those at 20 degC when it is fitted to warmer readings."""
    model = hand_model(tmp_path, GROWTH.replace("REFERENCE", AT_20))
    x = tracked(grown(A, WARM - 20.0, np.zeros(6)))
    data = readings_of(tmp_path, A, x, "massless\n" + FIT + NOISE, "temperature[degC]", WARM)
    found = calibrate(model, data.with_joints(model.robot.actuated), geometry=False, waves=False)
    (growth,) = [e for e in found.model.effects if e.name == "thermal_growth"]
    assert growth.reference == model.effects[0].reference
    frame = [found.model.parameter(f"tracker_frame:tracker.{axis}").value for axis in "xyz"]
    np.testing.assert_allclose(frame, SHIFT, atol=1e-6)


def test_a_drift_goes_on_by_its_clock_and_begins_anew_by_another(tmp_path: Path) -> None:
    model = hand_model(tmp_path, DRIFT)

    def drift(after: Array) -> Array:
        return 1e-6 * after + 4e-6 * 8.0 * (1.0 - np.exp(-np.maximum(after, 0.0) / 8.0))

    def said(folder: str, order: list[float]) -> Array:
        x = in_base(tmp_path / folder, model, "order", order)
        still = in_base(tmp_path / "still", model, "order", [11.0])
        return (x - still)[:, 0]

    with warnings.catch_warnings():
        warnings.simplefilter("error", ToolkitWarning)
        for folder, order in (("in", [31.0, 32.0]), ("on", [51.0, 70.0]), ("before", [1.0, 9.0])):
            got = said(folder, order)
            np.testing.assert_allclose(got, drift(np.array(order) - 11.0), atol=1e-12)
    for folder, order in (("later", [2000.0, 2005.0]), ("earlier", [-900.0, -895.0])):
        with pytest.warns(ToolkitWarning, match="another clock"):
            got = said(folder, order)
        np.testing.assert_allclose(got, drift(np.array([0.0, 5.0])), atol=1e-12)


def test_files_of_earlier_versions_count_as_they_did(tmp_path: Path) -> None:
    model = hand_model(tmp_path, GROWTH.replace("  REFERENCE\n", ""))
    with pytest.warns(ToolkitWarning, match=r"reference: \{temperature: 20, unit: degC\}"):
        x = in_base(tmp_path / "old", model, "temperature[degC]", [40.0, 60.0])
    np.testing.assert_allclose(
        x, grown(A[[0, 0]], np.array([-10.0, 10.0]), np.zeros(6)), atol=1e-12
    )


def test_rows_without_a_temperature_are_as_warm_as_the_reference(tmp_path: Path) -> None:
    model = hand_model(tmp_path, GROWTH.replace("REFERENCE", AT_20))
    with pytest.warns(ToolkitWarning, match="state no temperature; they count as read at 20 degC"):
        x = in_base(tmp_path / "cold", model, "order", [1.0, 2.0])
    np.testing.assert_allclose(x, grown(A[[0, 0]], np.zeros(2), np.zeros(6)), atol=1e-12)


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ("reference: {temperature: 20}", "no unit"),
        ("reference: {temperature: 293, unit: K}", "'K'"),
        ("reference: {time: 20, unit: s}", "states time, and this effect goes with the temp"),
        ("reference: {unit: degC}", "states nothing"),
        ("reference: {temperature: 20, time: 3, unit: degC}", "states temperature and time"),
    ],
)
def test_a_reference_that_cannot_be(entry: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said) as error:
        hand_model(tmp_path, GROWTH.replace("REFERENCE", entry))
    assert "model.yaml, effect thermal_growth:l2" in str(error.value.where)
    assert AT_20 in error.value.remedy


def test_what_counts_from_nothing_has_no_reference(tmp_path: Path) -> None:
    text = DRIFT.replace("reading_drift", "tool_offset").replace("tracker", "tool")
    with pytest.raises(InputError, match="counts from no reference"):
        hand_model(tmp_path, text)
