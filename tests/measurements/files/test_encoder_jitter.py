"""Encoders read a little otherwise without load: the difference goes through the kinematics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError

ROBOT = "motoman_sk120"


def file_of(tmp_path: Path, jitter: float) -> Path:
    """Positions of exact springs, every row with joint values of its own."""
    robot = sk.load_robot(ROBOT)
    model, rng = sk.base_model(robot), np.random.default_rng(0)
    lines = [
        "pose,"
        + ",".join(f"{n}[rad]" for n in robot.actuated)
        + ",fx[N],fy[N],fz[N],x[m],y[m],z[m]"
    ]
    for pose in range(6):
        q = rng.uniform(-0.8, 0.8, robot.n)
        for load in range(3):
            force = 300.0 * rng.normal(size=3) * (load > 0)
            here = q + rng.uniform(-jitter, jitter, robot.n)
            stands = robot.screws(here[None]).position[0]
            stands = stands + model.deflect(here, np.r_[force, 0, 0, 0][None])[0]
            cells = [f"{x:.12g}" for x in (*here, *force, *stands)]
            lines.append(",".join([f"P{pose}", *cells]))
    path = tmp_path / "j.csv"
    path.write_text("\n".join(lines) + "\n")
    path.with_suffix(".yaml").write_text(f"robot: {ROBOT}\nforce: {{frame: base}}\n")
    return path


def test_up_to_a_milliradian_is_the_same_pose_and_goes_through_fk(tmp_path: Path) -> None:
    data = sk.read(file_of(tmp_path, 4e-4))
    found = sk.fit(sk.base_model(sk.load_robot(ROBOT)), data)
    springs = [p.value for p in found.parameters]
    assert springs == pytest.approx([1.4098e6, 4.0076e5, 9.3528e5], rel=1e-5)
    assert found.rms < 1e-10
    assert np.abs(data.zero_joints - data.joints).max() > 1e-4


def test_beyond_a_milliradian_it_is_another_pose(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the pose 'P0' has"):
        sk.read(file_of(tmp_path, 3e-3))
