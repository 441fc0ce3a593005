"""A UR5 as a tracker anywhere in the room sees it, exported by others' programs."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff import load_robot
from tests.corpus.robots import example

MARKER = np.array([0.03, 0.01, 0.09])  # m, tool frame
TURN = Rotation.from_rotvec([0.3, -0.5, 1.9])
SHIFT = np.array([3.0, -1.0, 0.5])


@dataclass(frozen=True)
class Campaign:
    """Names, joint values (N, 6) [deg] and positions (N, 3) [mm] in the tracker's axes."""

    names: tuple[str, ...]
    q: np.ndarray
    x: np.ndarray


def campaign(count: int = 40, sigma: float = 2e-5, seed: int = 0) -> Campaign:
    """Zeros are 0.05 to 0.1 degrees off; noise of `sigma` [m]."""
    robot = load_robot(ur5(), tool="tool0")
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.2, 1.2, (count, 6)).round(6)
    T = robot.placement(q + np.radians([0.0, 0.08, -0.05, 0.1, 0.05, 0.0]))
    x = T[:, :3, 3] + T[:, :3, :3] @ MARKER
    seen = TURN.apply(x) + SHIFT + rng.normal(0.0, sigma, x.shape)
    return Campaign(tuple(f"P{k + 1}" for k in range(count)), np.degrees(q), 1e3 * seen)


def ur5() -> str:
    return str(example("ur5_robot.urdf"))


def spatial_analyzer(folder: Path, seen: Campaign, name: str = "points.txt") -> Path:
    """Targets in millimetres."""
    path = folder / name
    lines = [
        "// SpatialAnalyzer 2023.1",
        "// Units: Millimeters",
        "// Collection Group Target X Y Z",
    ]
    lines += [f"A Poses {n} {x:.4f} {y:.4f} {z:.4f}" for n, (x, y, z) in
              zip(seen.names, seen.x, strict=True)]  # fmt: skip
    path.write_text("\n".join(lines) + "\n")
    return path


def joints_file(folder: Path, seen: Campaign, name: str = "joints.csv") -> Path:
    """Degrees with decimal commas, as a controller in Germany writes them, in another order."""
    path = folder / name
    rows = list(zip(seen.names, seen.q, strict=True))[::-1]
    head = "Name;" + ";".join(f"A{k} [°]" for k in range(1, 7))
    text = [head, *(";".join([n, *(f"{v:.5f}".replace(".", ",") for v in q)]) for n, q in rows)]
    path.write_bytes("\r\n".join(text).encode("cp1252"))
    return path
