"""`compensate` for arms whose controller has its own base frame, through the command line."""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.programs import LANGUAGES
from tests.cli.conftest import Run
from tests.corpus.robots import example

# Universal Robots' table of the UR10: a [m], d [m], alpha in quarter turns; its frames are those of
# the controller, the first one that of the poses on the pendant.
UR10 = [
    (0.0, 0.1273, 1),
    (-0.612, 0.0, 0),
    (-0.5723, 0.0, 0),
    (0.0, 0.163941, 1),
    (0.0, 0.1157, -1),
    (0.0, 0.0922, 0),
]


def by_the_makers_table(q: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    for angle, (a, d, quarter) in zip(q, UR10, strict=True):
        step = np.eye(4)
        turned = Rotation.from_euler("z", angle) * Rotation.from_euler("x", quarter * np.pi / 2)
        step[:3, :3] = turned.as_matrix()
        step[:3, 3] = [a * np.cos(angle), a * np.sin(angle), d]
        T = T @ step
    return T


def test_a_ur_is_driven_to_where_its_maker_says_that_its_joints_are(
    run: Run, tmp_path: Path
) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G21 G90 G17\nG0 X0 Y0 Z20\nG1 Z-1 F600\nG1 X100 F1200\n")
    out = tmp_path / "part.script"
    done = run("compensate", str(example("ur10_robot.urdf")), str(path), "--frame",
               "x=600 mm; y=-100 mm; z=200 mm", "--wrench", "40,0,-80 N",
               "--out", str(out))  # fmt: skip
    assert done.code == 0, done.stderr
    text = out.read_text()
    found = LANGUAGES["urscript"].read(text)
    meant = np.array([by_the_makers_table(q) for q in np.radians(found.joints)])
    np.testing.assert_allclose(found.position, meant[:, :3, 3], atol=1e-6)
    np.testing.assert_allclose(found.rotation, meant[:, :3, :3], atol=1e-6)
    assert np.linalg.norm(found.position[1] - [-0.6, 0.1, 0.199]) < 2e-3
    said = "Part's frame in base: x=-600 mm; y=100 mm; z=200 mm; yaw=180 deg."
    for told in (text, done.stdout):
        assert said in told and "controller's own base is the frame base" in told
