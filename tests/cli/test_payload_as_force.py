"""Displacements under payloads: the message's own command makes readings under forces of them."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot, read_measurements
from sk120stiff.errors import InputError
from tests.measurements.importers.tracked import ur5

MASSES = (0.0, 10.0, 25.0)
SETTINGS = """robot: {robot}
base_frame: base_link
tool_frame: tool0
point: {{xyz: [30, -10.5, 90], unit: mm}}
payload: {{point: {{xyz: [0, 0, 0.15], unit: m}}}}
"""


def readings(folder: Path) -> Path:
    path = folder / "hung weights.csv"
    names = load_robot(ur5(), tool="tool0").actuated
    lines = [",".join(["pose", *(f"{n}[deg]" for n in names), "payload[kg],dx[mm],dy[mm],dz[mm]"])]
    lines += [
        f"P{p},{10 * p},-60,50,-20,{15 * p},5,{mass:g},0,0,{-0.01 * mass:g}"
        for p in range(3)
        for mass in MASSES
    ]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_the_command_of_the_message_does_it(run, tmp_path: Path) -> None:
    path = readings(tmp_path)
    path.with_suffix(".yaml").write_text(SETTINGS.format(robot=ur5()))
    refused = run("identify", str(path))
    assert refused.code == 2
    assert "--payload-point '0, 0, 0.15 m'" in " ".join(refused.stderr.split())
    told = re.search(r"sk120stiff (import .*?) \. ", " ".join(refused.stderr.split()))
    assert told is not None
    assert run(*shlex.split(told[1])).code == 0
    data = read_measurements(tmp_path / "hung weights_forces.csv")
    np.testing.assert_allclose(data.point, [0.03, -0.0105, 0.09])
    np.testing.assert_allclose(data.force_point, [0.0, 0.0, 0.15])
    np.testing.assert_allclose(data.wrench[:, 2], -9.80665 * np.tile(MASSES, 3))
    assert data.base_frame == "base_link" and not data.wrench[:, [0, 1, 3, 4, 5]].any()


def test_a_payload_whose_place_nobody_states_hangs_at_the_tool_not_at_the_marker(
    run, tmp_path: Path
) -> None:
    path, out = readings(tmp_path), tmp_path / "own.csv"
    words = ("import", str(path), "--robot", ur5(), "--point", "30,-10.5,90 mm", "--out", str(out))
    said = run(*words, "--json").document["assumed"][-1]
    assert "at the origin of the tool frame" in said and "--payload-point" in said
    data = read_measurements(out)
    np.testing.assert_allclose(data.point, [0.03, -0.0105, 0.09])
    np.testing.assert_array_equal(data.force_point, 0.0)


def test_what_the_settings_do_not_say_stands_in_capitals(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"--robot ROBOT --point 'X,Y,Z mm' --out .*-z of the"):
        read_measurements(readings(tmp_path))
