"""Nominal positions and deviations beside them: which sign they have."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.run import import_readings
from tests.measurements.importers.tracked import MARKER, SHIFT, TURN, campaign, ur5


@pytest.mark.parametrize("size", [1.0, 0.01])
def test_a_sign_that_positions_do_not_tell_is_told(size: float, tmp_path: Path) -> None:
    """Nominal ones are rigid; the arm is `size` of a tenth of a degree off in every joint."""
    seen, near = campaign(), campaign(sigma=0.0, seed=0)
    off = size * (near.x - rigid())
    lines = ["x_t,y_t,z_t,x_dif,y_dif,z_dif," + ",".join(f"joint_{k}" for k in range(1, 7))]
    noise = 0.5 * np.random.default_rng(2).normal(size=seen.x.shape)
    for q, x, d in zip(seen.q, rigid() + noise, off, strict=True):
        lines.append(",".join(f"{v:.6f}" for v in (*x, *d, *q)))
    path = tmp_path / "grid.csv"
    path.write_text("\n".join(lines) + "\n")
    told = Told(angle="deg", length="mm")
    doubts = " ".join(import_readings(path, load_robot(ur5(), tool="tool0"), told).doubts)
    assert ("do not tell the sign of the deviations" in doubts) == (size < 1.0)


def rigid() -> np.ndarray:
    """(N, 3) where the arm without errors has the marker, in the tracker's axes [mm]."""
    robot, seen = load_robot(ur5(), tool="tool0"), campaign()
    T = robot.placement(np.radians(seen.q))
    return np.asarray(1e3 * (TURN.apply(T[:, :3, 3] + T[:, :3, :3] @ MARKER) + SHIFT))
