"""scripts/15_mujoco_path.py: what compensation brings, judged by MuJoCo."""

import runpy
from pathlib import Path

import numpy as np

from sk120stiff.workspace import standing

SCRIPT = Path(__file__).resolve().parents[2] / "scripts/15_mujoco_path.py"


def test_compensation_keeps_mujocos_tool_on_the_line(tmp_path: Path) -> None:
    script = runpy.run_path(str(SCRIPT))
    script["main"].__globals__["FEED"] = 0.2  # m/s
    before, after = script["main"](tmp_path)
    assert 8e-4 < before < 1.5e-3
    assert after < 2e-5
    assert (tmp_path / "path.png").stat().st_size > 10_000
    model = script["arm_on_its_foundation"]()
    a = np.radians([0.0, 30.0, -30.0, 0.0, -60.0, 0.0])
    off = standing(model, a, a, [0.0, -150.0, -490.0, 0.0, 0.0, 0.0]).distance[0]
    assert 0.5 < off / before < 2.0
