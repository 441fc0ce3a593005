"""The example that loads a UR10 and a Panda runs as printed in its head."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "04_any_robot.py"


@pytest.mark.parametrize(
    ("arguments", "names"), [([], ["ur10: 6 joints", "panda: 7 joints"]), (["motoman_sk120"], [])]
)
def test_it_prints_stiffness_under_load(arguments: list[str], names: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, str(SCRIPT), *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for name in names:
        assert name in done.stdout
    stiffness = re.findall(
        r"principal stiffness \[\s*([\d.]+)\s+([\d.]+)\s+([\d.]+)\s*\]", done.stdout
    )
    assert len(stiffness) == max(1, len(names))
    assert all(0.0 < float(row[0]) <= float(row[1]) <= float(row[2]) for row in stiffness)
