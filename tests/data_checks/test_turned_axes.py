"""Axes of base and readings that are turned about z, and zeros of joints that are quarters off."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.data_checks import find_slip
from sk120stiff.errors import Refusal
from sk120stiff.explain import explain
from sk120stiff.measurements import Measurements
from tests.data_checks.readings import ARMS, ur5

BOTH = "force and displacement look stated in axes that are turned by"
FORCE = "the force looks stated in axes that are turned by"
ALONE = "the displacement looks stated in axes that are turned by"


def turned(readings: Measurements, degrees: float, *, loads: bool) -> Measurements:
    """As they are in axes that are turned by so much about z of the base."""
    turn = Rotation.from_euler("z", -degrees, degrees=True).as_matrix().T
    assert readings.displacement is not None
    d = readings.displacement @ turn
    if not loads:
        return replace(readings, displacement=d)
    both = [readings.wrench[:, part] @ turn for part in (slice(3), slice(3, 6))]
    return replace(readings, displacement=d, wrench=np.hstack(both))


def told(text: str, before: str) -> float:
    found = re.search(re.escape(before) + r" (-?[\d.]+) deg", text)
    assert found is not None, text
    return float(found[1])


@pytest.mark.parametrize(
    ("arm", "degrees"), zip(2 * [*ARMS], [180.0, -90.0, -21.0, 45.0], strict=True)
)
def test_a_base_frame_that_is_turned(arm: str, degrees: float) -> None:
    known = ARMS[arm]()
    found = find_slip(known.robot, turned(known.readings, degrees, loads=True))
    assert found is not None and found.after > 0.98
    assert abs(told(found.said, BOTH) - degrees) < 1.0
    assert "base_frame" in found.remedy


@pytest.mark.parametrize("degrees", [45.0, -30.0, 17.0])
def test_displacements_that_are_turned(degrees: float) -> None:
    known = ur5()
    found = find_slip(known.robot, turned(known.readings, degrees, loads=False))
    assert found is not None
    assert abs(told(found.said, ALONE) - degrees) < 1.0
    assert "Turn the displacement by as much" in found.remedy


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("degrees", [63.0, -40.0])
def test_forces_that_are_turned(arm: str, degrees: float) -> None:
    """As those in axes of a tracker that stands level, beside displacements in base axes."""
    known = ARMS[arm]()
    both = turned(known.readings, degrees, loads=True)
    found = find_slip(known.robot, replace(both, displacement=known.readings.displacement))
    assert found is not None and found.after > 0.98
    assert abs(told(found.said, FORCE) - degrees) < 1.0
    assert f"rpy: [0, 0, {told(found.said, FORCE):g}], rpy_unit: deg" in found.remedy


@pytest.mark.parametrize(("k", "degrees"), [(2, 90), (3, 180), (4, -90)])
def test_a_zero_that_is_quarters_off(k: int, degrees: int) -> None:
    known = ur5()
    off = np.radians(degrees) * np.eye(6)[k]
    wrong = replace(known.readings, joints=known.readings.joints - off)
    found = find_slip(known.robot, wrong)
    name = known.robot.actuated[k]
    assert found is not None and f"the zero of {name} seems to be {degrees} deg off" in found.said
    assert found.remedy.startswith(f"Add {degrees} deg to the column {name}.")
    mended = replace(wrong, joints=wrong.joints + off)
    assert find_slip(known.robot, mended) is None


@pytest.mark.parametrize(("one", "other"), [((1, 90), (2, -90)), ((1, -90), (3, 90))])
def test_two_zeros_that_are_quarters_off(one: tuple[int, int], other: tuple[int, int]) -> None:
    """As between a controller whose arm lies at zero and a URDF whose arm stands."""
    known = ur5()
    off = np.zeros(6)
    for k, degrees in (one, other):
        off[k] = np.radians(degrees)
    found = find_slip(known.robot, replace(known.readings, joints=known.readings.joints - off))
    assert found is not None and found.after > 0.98
    for k, degrees in (one, other):
        assert f"the zero of {known.robot.actuated[k]} seems to be {degrees} deg off" in found.said


@pytest.mark.parametrize(("arm", "axis"), list(zip(ARMS, [0, 1], strict=True)))
@pytest.mark.parametrize("what", ["displacement", "force"])
def test_axes_whose_z_points_down(arm: str, axis: int, what: str) -> None:
    known = ARMS[arm]()
    signs = np.where(np.arange(3) == axis, 1.0, -1.0)
    data = known.readings
    assert data.displacement is not None
    wrong = (
        replace(data, displacement=data.displacement * signs)
        if what == "displacement"
        else replace(data, wrench=data.wrench * np.tile(signs, 2))
    )
    found = find_slip(known.robot, wrong)
    assert found is not None and found.after > 0.98
    assert "by 180 deg" in found.said or "Two wrong signs are half a turn" in found.remedy


def test_explain_stops() -> None:
    known = ur5()
    with pytest.raises(Refusal, match=r"turned by 180 deg about z"):
        explain(known.model, turned(known.readings, 180.0, loads=True))


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("degrees", [1.5, -4.0])
def test_a_tracker_that_is_turned_by_little_is_no_slip(arm: str, degrees: float) -> None:
    """That is a cause, which `explain` names."""
    known = ARMS[arm]()
    assert find_slip(known.robot, turned(known.readings, degrees, loads=False)) is None


def test_one_axis_that_was_not_read_leaves_quarters() -> None:
    known = ur5()
    wrong = turned(known.readings, 180.0, loads=True)
    assert wrong.displacement is not None
    some = wrong.displacement.copy()
    some[::3, 2] = np.nan
    found = find_slip(known.robot, replace(wrong, displacement=some))
    assert found is not None and told(found.said, BOTH) == 180.0
    some[1::3, 0] = np.nan
    found = find_slip(known.robot, replace(wrong, displacement=some))
    assert found is not None and told(found.said, BOTH) == 180.0
