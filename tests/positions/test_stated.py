"""What a file states beside its positions: payloads, places, turns of the tool, uncertainties."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.checks.payload_unit import pounds
from sk120stiff.identify.positions.words import findings
from tests.positions.arm import TURN, Arm, Array, errors, poses, tracked, write
from tests.positions.test_forms import FIT, NOISE, SIGMA, _with, calibrated, rows

A = poses(60, 2)
X, AXES = errors(1).stands(A)
READ = tracked(X) + SIGMA * np.random.default_rng(9).normal(size=X.shape)
HUNG = "payload: {point: {xyz: [0, 0, %s], unit: %s}}\n"


@pytest.mark.parametrize(
    ("mass", "settings", "massless", "said"),
    [
        (5000.0, FIT, "", "1000 times too large, as if in grams"),
        (5000.0, FIT, "massless", "an arm that reaches .* as if in grams"),
        (5.0, FIT + HUNG % (120, "m"), "", "the payload is stated 120 m .* arm that reaches"),
        (5.0, FIT.replace("[0, 0, 0], unit: mm", "[0, 0, 120], unit: m"), "", "the marker is stat"),
    ],
)
def test_sizes_that_no_arm_has_are_refused(
    mass: float, settings: str, massless: str, said: str, tmp_path: Path
) -> None:
    path = write(
        tmp_path, A, READ, settings + NOISE + massless, more=",payload[kg]", cells=[str(mass)] * 60
    )
    with pytest.raises(InputError, match=f"(?s){said}"):
        calibrated(path)


def test_sizes_that_are_much_too_small_are_told(tmp_path: Path) -> None:
    near = FIT.replace("[0, 0, 0]", "[0.05, -0.08, 0.12]") + HUNG % (0.12, "mm") + NOISE
    path = write(tmp_path, A, READ, near, more=",payload[kg]", cells=["0.05"] * 60)
    told = " ".join(calibrated(path).notes)
    for said in (
        "The marker is stated 0.153 mm",
        "The payload is stated 0.12 mm",
        "Are they tonnes",
    ):
        assert said in told
    usual = write(tmp_path, A, READ, FIT + NOISE, more=",payload[kg]", cells=["50"] * 60)
    assert not calibrated(usual).notes


def test_a_payload_heavier_than_the_arm_is_told_and_a_negative_one_refused(tmp_path: Path) -> None:
    """The arm weighs 159 kg. What is stated counts, and what is found."""

    def read(mass: str, settings: str = "") -> list[str]:
        path = write(
            tmp_path, A, READ, FIT + NOISE + settings, more=",payload[kg]", cells=[mass] * 60
        )
        readings = sk.read(path)
        return findings(calibrated(path), readings)

    told = "The heaviest payload is 200 kg on an arm that weighs 159 kg itself"
    assert any(said.startswith(told) and "in kg" in said for said in read("200"))
    assert not any("heaviest payload" in said for said in read("150"))
    with pytest.raises(InputError, match=r"line 2, column payload.* a payload of -5 kg"):
        read("-5")


@pytest.mark.parametrize(("true", "said"), [(260.0, "comes out as"), (-40.0, "no mass is neg")])
def test_a_payload_that_is_found_is_held_against_the_arm(
    true: float, said: str, tmp_path: Path
) -> None:
    stated = np.where(np.arange(60) % 2, 10.0, 0.0)
    x = tracked(_with(payload=(true + stated, np.zeros(3))).stands(A)[0])  # type: ignore[arg-type]
    fit = "payload: {point: {xyz: [0, 0, 0], unit: mm}, fit: true}\n"
    cells = [f"{m:g}" for m in stated]
    path = write(tmp_path, A, x, FIT + fit + NOISE, more=",payload[kg]", cells=cells)
    assert any(said in each for each in findings(calibrated(path), sk.read(path)))


TOOL = Rotation.from_matrix(TURN.as_matrix() @ AXES)
VECTOR, QUATERNION = ",rx[%s],ry[%s],rz[%s]", ",qw,qx,qy,qz"
SCALAR_FIRST = np.roll(TOOL.as_quat(), 1, axis=1)


@pytest.mark.parametrize(
    ("header", "cells", "said"),
    [
        (VECTOR % (("rad",) * 3), np.degrees(TOOL.as_rotvec()), r"more than a turn.*rx\[deg\]"),
        (VECTOR % (("deg",) * 3), TOOL.as_rotvec(), r"like radians, not degrees.*\[rad\]"),
        (VECTOR % (("rad",) * 3), TOOL.inv().as_rotvec(), "look inverted"),
        (QUATERNION, TOOL.as_quat(), "scalar part of the quaternions looks written last"),
        (QUATERNION, SCALAR_FIRST * [1, -1, -1, -1], "look inverted"),
        (
            VECTOR % (("rad",) * 3),
            (TOOL * Rotation.from_rotvec([0.3, 0.2, 0])).as_rotvec(),
            r"same 20.7 deg against the tool.*rotation: \{axes: target\}",
        ),
        (VECTOR % (("rad",) * 3), TOOL.as_rotvec()[::-1], "not those of the placed robot"),
    ],
)
def test_turns_of_the_tool_that_are_not_the_robots(
    header: str, cells: np.ndarray, said: str, tmp_path: Path
) -> None:
    tool = "rotation: {axes: tool}\n"
    path = write(tmp_path, A, READ, FIT + NOISE + tool, more=header, cells=rows(cells))
    with pytest.raises(InputError, match=f"(?s){said}"):
        calibrated(path)
    if "deg against the tool" in said:
        return
    path = write(tmp_path, A, READ, FIT + NOISE, more=header, cells=rows(cells))
    with pytest.raises(InputError, match=f"(?s){said}"):  # of a target, too
        calibrated(path)


@pytest.mark.parametrize("stated", ["sigma: 20, unit: um", "rotation: 20, rotation_unit: urad"])
def test_what_is_stated_of_one_kind_stays_the_yardstick(stated: str, tmp_path: Path) -> None:
    """Twice the stated noise is a misfit; the other kind's own is found from its gap."""
    rng = np.random.default_rng(4)
    large = np.where(np.array(["um" in stated, "rot" in stated]), 1.0, 2.0)
    arm = Arm(compliance=errors(1).compliance)
    x, axes = arm.stands(A)
    exact = Rotation.from_matrix(TURN.as_matrix() @ axes)
    turned = Rotation.from_rotvec(2e-5 * large[1] * rng.normal(size=x.shape)) * exact
    x = tracked(x) + SIGMA * large[0] * rng.normal(size=x.shape)
    for factor in (1.0, 0.5):
        number = stated.replace("20", str(20 * factor))
        settings = FIT + f"noise: {{{number}}}\n"
        path = write(
            tmp_path, A, x, settings, more=VECTOR % (("rad",) * 3), cells=rows(turned.as_rotvec())
        )
        data = sk.read(path)
        robot = sk.load_robot(data.robot, base="base", tool="tool")
        readings = data.with_joints(robot.actuated)
        found = calibrate(sk.base_model(robot), readings, geometry=False, waves=False)
        own, other = ("position", "rotation") if "um" in stated else ("rotation", "position")
        size = 4e-5
        kinds = dict(zip(found.problem.channels.present, found.problem.channels.kinds, strict=True))
        sigma = found.problem.of_channels.sigma
        assert sigma[kinds[own]][0] == pytest.approx(2e-5 * factor)
        assert sigma[kinds[other]][0] == pytest.approx(size, rel=0.3)
        assert found.sigma_known and found.exceeds == (factor < 1.0)
        assert found.noise_factor == pytest.approx(1.0 / factor, rel=0.15)


@pytest.mark.parametrize(
    ("noise", "weighs", "said"),
    [
        ("noise: {sigma: 1, unit: mm}\n", "", "times the stated uncertainty, on which"),
        (NOISE, "", "That agrees with the stated uncertainty"),
        (NOISE, "massless", "The URDF states no masses: what the arm's own weight does"),
    ],
)
def test_a_sigma_far_too_large_and_missing_masses_are_told(
    noise: str, weighs: str, said: str, tmp_path: Path
) -> None:
    path = write(tmp_path, A, READ, FIT + noise + weighs, more=",payload[kg]", cells=["5"] * 60)
    told = " ".join(findings(calibrated(path), sk.read(path)))
    assert said in told


@pytest.mark.parametrize(
    ("count", "said"),
    [
        (4, "4 positions cannot tell .* Measure more poses, or state where"),
        (5, "15 numbers at 5 poses, and as many values to estimate: nothing is left"),
    ],
)
def test_poses_that_leave_nothing_over_are_too_few(count: int, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        calibrated(write(tmp_path, A[:count], READ[:count], FIT))


def test_a_marker_stated_far_from_where_it_sits_is_refused_with_its_place(tmp_path: Path) -> None:
    here = FIT.replace(", fit: true", "")
    with pytest.raises(
        InputError, match=r"the marker seems to sit \(50.*Write 'point: {\.\.\., fit"
    ):
        calibrated(write(tmp_path, A, READ, here + NOISE))


def test_poses_too_few_for_waves_to_show_are_told(tmp_path: Path) -> None:
    for count, told in ((14, True), (60, False)):
        path = write(tmp_path, A[:count], READ[:count], FIT + NOISE)
        said = " ".join(findings(calibrated(path), sk.read(path)))
        assert ("(24 unknowns) could not show" in said) == told


def hung(masses: Array) -> Array:
    """Positions with these masses [kg] on the tool's origin, as a tracker sees them."""
    x = [
        _with(payload=(m, np.zeros(3))).stands(q[None])[0][0]
        for m, q in zip(masses, A, strict=True)
    ]
    return tracked(np.array(x)) + SIGMA * np.random.default_rng(3).normal(size=(60, 3))


@pytest.mark.parametrize("pound", [1.0, 2.2046226])
def test_payloads_in_pounds_are_told(pound: float, tmp_path: Path) -> None:
    masses = np.where(np.arange(60) % 2, 30.0, 0.0)
    cells = [f"{pound * m:.6g}" for m in masses]
    for settings in (FIT, FIT + NOISE):
        path = write(tmp_path, A, hung(masses), settings, more=",payload[kg]", cells=cells)
        assert any("look like pounds" in said for said in pounds(calibrated(path))) == (pound > 1)


def test_blank_cells_of_a_payload_are_told(tmp_path: Path) -> None:
    cells = ["10" if k % 3 else "" for k in range(60)]
    path = write(tmp_path, A, READ, FIT + NOISE, more=",payload[kg]", cells=cells)
    with pytest.warns(ToolkitWarning, match=r"line 2, column payload.*: 20 blank cells count"):
        sk.read(path)
