"""A six-axis arm that nothing of the product computes: kinematics, weight and sag of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
G = 9.80665
NAMES = ("j1", "j2", "j3", "j4", "j5", "j6")
ORIGINS = np.array(
    [[0, 0, 0.5], [0.25, 0, 0.2], [0, 0, 0.9], [0.1, 0, 0.15], [0.7, 0, 0], [0.15, 0, 0]]
)
AXES = np.array([[0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0.0]])
MASSES = np.array([60.0, 45.0, 30.0, 15.0, 6.0, 3.0])
CENTRES = np.array(
    [[0.1, 0, 0.1], [0, 0.02, 0.45], [0.05, 0, 0.08], [0.3, 0, 0.02], [0.05, 0, 0], [0.03, 0, 0]]
)
TOOL = np.array([0.1, 0.0, 0.0])


@dataclass
class Arm:
    """What is wrong with it, and how it yields; SI."""

    compliance: Array = field(default_factory=lambda: np.zeros(6))
    shift: Array = field(default_factory=lambda: np.zeros((6, 3)))  # of joint origins
    turn: Array = field(default_factory=lambda: np.zeros((6, 3)))  # of joint frames
    marker: Array = field(default_factory=lambda: np.array([0.05, -0.08, 0.12]))
    waves: Array = field(default_factory=lambda: np.zeros((6, 2)))  # sin q, cos q
    play: Array = field(default_factory=lambda: np.zeros(6))  # half of it
    flank: float = 0.0  # N·m over which teeth take hold
    hardens: Array = field(default_factory=lambda: np.zeros(6))  # rad/(N·m)²
    weighs: bool = True
    payload: float = 0.0  # kg, at the tool's origin
    rocks: Array = field(default_factory=lambda: np.zeros(2))  # base about x, y, rad/(N·m)
    up: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))  # against gravity, base

    def pose(self, q: Array) -> tuple[Array, Array, Array]:
        """Marker (..., 3), tool axes (..., 3, 3) and energy (...) at true joint values (..., 6)."""
        R, p, energy = np.eye(3), np.zeros(3), np.zeros(q.shape[:-1])
        for k in range(6):
            p = p + R @ (ORIGINS[k] + self.shift[k])
            R = R @ Rotation.from_rotvec(self.turn[k]).as_matrix() @ _about(AXES[k], q[..., k])
            energy += MASSES[k] * G * (p + R @ CENTRES[k]) @ self.up
        p = p + R @ TOOL
        energy += self.payload * G * p @ self.up
        return p + R @ self.marker, R, energy

    def stands(self, a: Array) -> tuple[Array, Array]:
        """Marker (N, 3) and tool axes (N, 3, 3) at rest under its own weight."""
        start = a + self.waves[:, 0] * np.sin(a) + self.waves[:, 1] * np.cos(a)
        q = start
        yields = self.compliance.any() or self.play.any()
        for _ in range(3 if self.weighs and yields else 0):
            torque = self.torque_of_weight(q)
            side = np.tanh(torque / self.flank) if self.flank else np.sign(torque)
            q = start + self.compliance * torque + self.play * side
            q -= self.hardens * torque * np.abs(torque)
        x, R, _ = self.pose(q)
        ways = np.eye(3)[:2]
        moment = [-replace(self, up=np.cross(self.up, way)).pose(q)[2] for way in ways]
        rocked = Rotation.from_rotvec((self.rocks[:, None] * moment).T @ ways)
        return rocked.apply(x), rocked.as_matrix() @ R

    def torque_of_weight(self, q: Array) -> Array:
        """(N, 6) what the weight does to the joints [N·m], though it may not count."""
        return -slopes(lambda near: self.pose(near)[2], q)


def slopes(energy: Callable[[Array], Array], q: Array) -> Array:
    """(N, 6) central differences of an energy, which takes joint values (N, 12, 6) at once."""
    e = energy(q[:, None] + 1e-5 * np.concatenate([np.eye(6), -np.eye(6)]))
    return (e[:, :6] - e[:, 6:]) / 2e-5


def _about(axis: Array, angle: Array) -> Array:
    """(..., 3, 3) rotations about one axis (Rodrigues)."""
    cross = np.cross(np.eye(3), axis)
    at = angle[..., None, None]
    return np.eye(3) + np.sin(at) * cross + (1.0 - np.cos(at)) * (cross @ cross)


SPAN = {"shift": 0.016, "turn": 0.05, "marker": 2.0}  # m, rad; no arm is off by more
KNOWN = 3.0  # standard sizes that such an error must make, or it is taken for known


def bound(arm: Arm, a: Array, sigma: float) -> Array:
    """(6,) Cramér-Rao bound of the compliances from positions at poses (N, 6).

    Free beside them: every joint's frame, the marker, the tracker's frame, as far as a rigid arm
    shows them. Central differences of `Arm`; infinite where nothing is told of a joint.
    """
    rigid = replace(arm, compliance=np.zeros(6))
    springs = _columns(arm, a, "compliance", 1e-8)
    both = []
    for own in (rigid, arm):
        x = own.stands(a)[0]
        frame = [np.tile(axis, (len(a), 1)).ravel() for axis in np.eye(3)]
        frame += [np.cross(axis, x).ravel() for axis in np.eye(3)]
        parts = [SPAN[name] * _columns(own, a, name, 1e-5) for name in SPAN]
        both.append(np.column_stack([*parts, 10.0 * np.array(frame).T]) / sigma)
    _, shown, ways = np.linalg.svd(both[0], full_matrices=False)
    geometry = both[1] @ ways[shown > KNOWN].T
    out = np.full(6, np.inf)
    for k in range(6):
        A = np.column_stack([geometry, np.delete(springs, k, axis=1)])
        size = np.linalg.norm(A, axis=0)
        U, values, _ = np.linalg.svd(A[:, size > 0.0] / size[size > 0.0], full_matrices=False)
        U = U[:, values > 1e-9 * values[0]]
        left = np.linalg.norm(springs[:, k] - U @ (U.T @ springs[:, k]))
        if left > 1e-6 * np.linalg.norm(springs[:, k]):
            out[k] = sigma / left
    return out


def _columns(arm: Arm, a: Array, name: str, step: float) -> Array:
    """(3N, p) derivative of the positions by one of the arm's attributes."""
    value, out = getattr(arm, name), []
    for way in np.eye(value.size):
        change = step * way.reshape(value.shape)
        ahead, behind = (
            replace(arm, **{name: value + s * change}).stands(a)[0] for s in (1.0, -1.0)
        )
        out.append((ahead - behind).ravel() / (2.0 * step))
    return np.array(out).T


def urdf(weighs: bool = True) -> str:
    """The arm as it was drawn."""
    links, joints = ['<link name="base"/>'], []
    for k, name in enumerate(NAMES):
        mass = (
            f'<inertial><origin xyz="{_text(CENTRES[k])}"/><mass value="{MASSES[k]}"/>'
            '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        )
        links.append(f'<link name="l{k + 1}">{mass if weighs else ""}</link>')
        parent = "base" if k == 0 else f"l{k}"
        joints.append(
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
            f'<child link="l{k + 1}"/><origin xyz="{_text(ORIGINS[k])}"/>'
            f'<axis xyz="{_text(AXES[k])}"/>'
            '<limit lower="-3.1" upper="3.1" effort="1" velocity="1"/></joint>'
        )
    links.append('<link name="tool"/>')
    joints.append(
        '<joint name="fix" type="fixed"><parent link="l6"/><child link="tool"/>'
        f'<origin xyz="{_text(TOOL)}"/></joint>'
    )
    return f'<robot name="six">{"".join(links + joints)}</robot>'


def _text(v: Array) -> str:
    return " ".join(f"{x:.12g}" for x in v)


def poses(count: int, seed: int) -> Array:
    """(count, 6) joint values over most of the reach."""
    rng = np.random.default_rng(seed)
    return rng.uniform([-1.5, -0.8, -0.9, -2, -1.5, -2.5], [1.5, 0.9, 1.0, 2, 1.5, 2.5], (count, 6))


def errors(seed: int) -> Arm:
    """Springs, and small errors of all joint frames."""
    rng = np.random.default_rng(seed)
    return Arm(
        compliance=np.array([1 / 9e5, 1 / 8e5, 1 / 5e5, 1 / 1e5, 1 / 8e4, 1 / 5e4]),
        shift=3e-4 * rng.normal(size=(6, 3)),
        turn=3e-4 * rng.normal(size=(6, 3)),
    )


TURN = Rotation.from_rotvec([0.4, -1.9, 1.2])
SHIFT = np.array([3.0, -1.5, 0.7])


def write(
    folder: Path,
    a: Array,
    x: Array,
    settings: str,
    *,
    more: str = "",
    cells: list[str] | None = None,
) -> Path:
    """A file of positions x (N, 3) [m] and the robot beside it."""
    path = folder / "readings.csv"
    lines = [",".join(f"{n}[deg]" for n in NAMES) + ",x[mm],y[mm],z[mm]" + more]
    for k, (q, p) in enumerate(zip(np.degrees(a), 1e3 * x, strict=True)):
        end = "" if cells is None else f",{cells[k]}"
        lines.append(",".join("" if np.isnan(v) else f"{v:.10g}" for v in (*q, *p)) + end)
    path.write_text("\n".join(lines) + "\n")
    (folder / "six.urdf").write_text(urdf("massless" not in settings))
    path.with_suffix(".yaml").write_text(
        "robot: six.urdf\nbase_frame: base\ntool_frame: tool\n" + settings.replace("massless", "")
    )
    return path


def tracked(x: Array) -> Array:
    """Positions (N, 3) as a tracker that stands elsewhere sees them."""
    return TURN.apply(x) + SHIFT
