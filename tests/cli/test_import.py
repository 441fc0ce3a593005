"""`sk120stiff import`: a calibration file, and what the other commands make of the result."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.measurements import read_measurements
from sk120stiff.model import base_model
from sk120stiff.robot import load_robot

TOLD = ("--robot", "motoman_sk120", "--length", "m", "--angle", "rad")
POSES = ([0.2, 0.4, -0.5, 0, -1, 0], [-0.7, 0.6, -0.8, 0, -0.8, 0], [0.9, -0.2, 0.1, 0, 0.5, 0])


def marks(folder: Path, payload: bool = True) -> str:
    """Positions of the flange by J K⁻¹ Jᵀ W, side load and weight, two loads at each pose."""
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    springs = np.array([1.4098e6, 4.0076e5, 9.3528e5])
    lines = ["x1,y1,z1,q1,q2,q3,q4,q5,q6" + (",load" if payload else "")]
    for a in np.array(POSES):
        x, J = robot.placement(a)[:3, 3], robot.jacobian(a)[:3, :3]
        for count in (0, 1) if payload else (0,):
            d = J @ ((J.T @ [0.0, 300.0, -490.0]) / springs) * count
            cells = [*(repr(float(v)) for v in x + d), *map(str, a)]
            lines.append(",".join([*cells, str(count)] if payload else cells))
    path = folder / "marks.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return str(path)


def test_the_springs_come_out(run, tmp_path: Path) -> None:
    out = str(tmp_path / "own.csv")
    outcome = run(
        "import", marks(tmp_path), *TOLD, "--wrench", "0,300,-490 N", "--out", out, "--json"
    )
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert found["doubts"] == []
    assert (found["rows"], found["poses"], found["useful_poses"]) == (6, 3, 3)
    assert found["stiffness_identifiable"] is True
    assert read_measurements(out).robot == "motoman_sk120"
    values = [p["value"] for p in run("identify", out, "--json").document["parameters"]]
    assert values == pytest.approx([1.4098e6, 4.0076e5, 9.3528e5], rel=2e-3)


def test_positions_alone_are_written_and_then_refused(run, tmp_path: Path) -> None:
    out = str(tmp_path / "own.csv")
    outcome = run("import", marks(tmp_path, payload=False), *TOLD, "--out", out)
    assert outcome.code == 0, outcome.stderr
    said = " ".join(outcome.stdout.split())
    assert "No pose of the 3 was read under two different loads." in said
    assert "no information on stiffness" in said
    for command in (("identify", out), ("explain", out, "--out", str(tmp_path / "e"))):
        refused = run(*command)
        assert (refused.code, refused.answered) == (2, False)
        assert "no information on stiffness" in refused.stderr
    assert not (tmp_path / "e").exists()


def test_the_file_itself_sends_one_here(run, tmp_path: Path) -> None:
    refused = run("identify", marks(tmp_path))
    assert refused.code == 2
    assert "sk120stiff import" in refused.stderr


def test_bad_options(run, tmp_path: Path) -> None:
    source, out = marks(tmp_path), str(tmp_path / "own.csv")
    for arguments, word in (
        ((*TOLD[:2], "--angle", "rad", "--out", out), "--length m or mm"),
        ((*TOLD[:4], "--out", out), "--angle rad or deg"),
        ((*TOLD, "--out", out), "--wrench"),
        ((*TOLD, "--out", source), "overwrite"),
        ((*TOLD, "--point", "1,2 mm", "--out", out), "no point"),
        ((*TOLD, "--marker", "2", "--out", out), "no marker 2"),
        ((*TOLD[2:], "--robot", "nobody", "--out", out), "nobody"),
    ):
        refused = run("import", source, *arguments)
        assert refused.code == 2, arguments
        assert word in refused.stderr
        assert not Path(out).exists()


def test_a_turned_tracker_and_a_wrong_unit_are_doubted(run, tmp_path: Path) -> None:
    source = Path(marks(tmp_path, payload=False))
    lines = source.read_text(encoding="utf-8").splitlines()
    turned = [lines[0]]
    for line in lines[1:]:
        x, y, *rest = line.split(",")
        turned.append(",".join([y, str(-float(x)), *rest]))
    source.write_text("\n".join(turned) + "\n", encoding="utf-8")
    out = str(tmp_path / "own.csv")
    (doubt,) = run("import", str(source), *TOLD, "--out", out, "--json").document["doubts"]
    assert "about 90 deg" in doubt
    told = (*TOLD[:2], "--length", "mm", "--angle", "rad")
    outcome = run("import", marks(tmp_path), *told, "--wrench", "0,0,-9 N", "--out", out)
    assert outcome.code == 0
    assert "Check the units" in outcome.stderr
