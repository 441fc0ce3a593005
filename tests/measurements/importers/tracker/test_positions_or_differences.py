"""Positions of a pose under two loads stay positions or become differences, and either is said."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.errors import InputError
from sk120stiff.explain.positions.run import FEWEST
from sk120stiff.measurements.importers import Imported, Told, import_readings
from sk120stiff.measurements.importers.tracker.positions_or_differences import ENOUGH, TakenAs
from tests.measurements.importers.tracked import Campaign, campaign, ur5
from tests.measurements.importers.tracker.test_moved_or_bent import sagged

KEEP, DIFFER = "--as positions keeps the positions", "--as displacements makes differences"


def brought(
    folder: Path,
    loads: Sequence[float],
    *,
    count: int = 12,
    header: str = "payload [kg]",
    more: dict[str, Sequence[str]] | None = None,
    taken_as: TakenAs | None = None,
    told: Told | None = None,
) -> Imported:
    """A UR5 under each of the masses, one after the other, with further columns by the load."""
    seen = campaign(count)
    runs: list[Campaign] = [sagged(seen, mass, k) for k, mass in enumerate(loads)]
    lines = [",".join([*(f"q{k} [deg]" for k in range(1, 7)), "x [mm],y [mm],z [mm]", header,
                       *(more or {})])]  # fmt: skip
    for k, (mass, part) in enumerate(zip(loads, runs, strict=True)):
        load = mass if "kg" in header else -9.80665 * mass
        end = [f"{load:g}", *(cells[k] for cells in (more or {}).values())]
        for q, x in zip(part.q, part.x, strict=True):
            lines.append(",".join([*(f"{v:.5f}" for v in (*q, *x)), *end]))
    path = folder / "own.csv"
    path.write_text("\n".join(lines) + "\n")
    robot = load_robot(ur5(), tool="tool0")
    return import_readings(path, robot, told, taken_as=taken_as)


def test_positions_stay_from_as_many_poses_on_as_can_be_explained(tmp_path: Path) -> None:
    assert ENOUGH == FEWEST
    found = brought(tmp_path, (0, 5), count=ENOUGH)
    assert found.mode == "positions" and DIFFER in found.because
    assert dict(found.columns)["payload[kg]"] == ("0.0",) * ENOUGH + ("5.0",) * ENOUGH
    few = brought(tmp_path, (0, 5), count=ENOUGH - 1)
    assert few.mode == "load pairs" and KEEP in few.because and "Of 9 poses" in few.because
    np.testing.assert_array_equal(few.readings.force_point, 0.0)
    kept = brought(tmp_path, (0, 5), count=ENOUGH - 1, taken_as="positions")
    assert kept.mode == "positions" and kept.readings.absolute is not None


def test_the_weight_acts_where_it_is_told_to_hang(tmp_path: Path) -> None:
    found = brought(tmp_path, (0, 5), count=6, told=Told(payload_point=np.array([0.0, 0.0, 0.12])))
    np.testing.assert_allclose(found.readings.force_point, [0.0, 0.0, 0.12])
    np.testing.assert_allclose(found.readings.wrench[:, 2], -5 * 9.80665)


@pytest.mark.parametrize(
    ("loads", "more"),
    [((0, 5, 9, 5), {}), ((0, 5, 5.001), {"branch": ("load", "load", "unload")})],
)  # fmt: skip
def test_loads_that_were_taken_off_again_become_differences(
    tmp_path: Path, loads: tuple[float, ...], more: dict[str, Sequence[str]]
) -> None:
    found = brought(tmp_path, loads, more=more)
    assert found.mode == "load pairs" and "friction" in found.because and KEEP in found.because
    assert found.readings.branch is not None


def test_loads_that_only_rise_stay_positions(tmp_path: Path) -> None:
    assert brought(tmp_path, (0, 5, 9)).mode == "positions"


def test_of_known_forces_differences_are_made_unless_told(tmp_path: Path) -> None:
    found = brought(tmp_path, (0, 5), header="fz [N]")
    assert found.mode == "load pairs" and KEEP in found.because
    kept = brought(tmp_path, (0, 5), header="fz [N]", taken_as="positions")
    assert kept.mode == "positions" and kept.readings.absolute is not None
    np.testing.assert_allclose(kept.readings.wrench[12:, 2], -49.03325, rtol=1e-5)
    asked = brought(tmp_path, (0, 5), taken_as="displacements")
    assert asked.mode == "load pairs" and "--as displacements" in asked.because


def test_what_cannot_be_had_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="under two loads"):
        brought(tmp_path, (5,), taken_as="displacements")
    with pytest.raises(InputError, match="several markers no differences"):
        brought(tmp_path, (0, 5), more={"marker": ("A", "B")}, taken_as="displacements")
    with pytest.raises(InputError, match="several places of the tracker"):
        brought(tmp_path, (0, 5), more={"station": ("A", "B")}, taken_as="displacements")
    with pytest.raises(InputError, match="nothing says that one does"):
        brought(tmp_path, (0, 5), header="fz [N]", told=Told(payload_point=np.zeros(3)))
    robot = load_robot(ur5(), tool="tool0")
    path = tmp_path / "moved.csv"
    rows = [",".join([*(f"{v:.4f}" for v in q), "0,0,-0.5,5"]) for q in campaign(4).q]
    head = ",".join([*(f"q{k} [deg]" for k in range(1, 7)), "dx [mm],dy [mm],dz [mm],payload [kg]"])
    path.write_text("\n".join([head, *rows]) + "\n")
    with pytest.raises(InputError, match="holds displacements"):
        import_readings(path, robot, taken_as="positions")
