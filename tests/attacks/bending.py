"""Loads around and beyond the critical one: no number that does not exist, no refusal too soon.

What the command says is held against a plain continuation in load, by differences of 4x4 matrices.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sk120stiff import load_robot, write_model
from sk120stiff.model import joint_spring_model
from tests.attacks.judge import Verdict, heard
from tests.oracles.numpy_kinematics import UrdfTree
from tests.stiffness.arms import Arm, mixed_urdf, uncoupled

Array = NDArray[np.float64]
SHARES = (0.5, 0.97, 1.03, 1.15, 1.5, 3.0)  # of the critical load
STEPS = 60  # in which the load is followed
NEAR = 0.02  # share of the load within which two ways of following it may end
BALANCE = "beyond what these springs can hold"


def bending(folder: Path, count: int = 30, seed: int = 0) -> Iterator[Verdict]:
    """Random arms, poses, springs and loads through `stiffness --json`."""
    folder.mkdir(parents=True)
    rng = np.random.default_rng(seed)
    for k in range(count):
        text = uncoupled(mixed_urdf(seed + k % 7)).replace('type="prismatic"', 'type="revolute"')
        robot = load_robot(text, base="l0", tool="l7")
        arm = Arm(robot, UrdfTree(text), "l7", rng.uniform(2e3, 4e3, robot.n))
        a = rng.uniform(-0.5, 0.5, robot.n)
        load = np.append(rng.normal(size=3), np.zeros(3))
        load *= SHARES[k % len(SHARES)] * _critical(arm, a, load)
        (folder / "arm.urdf").write_text(text, encoding="utf-8")
        write_model(joint_spring_model(load_robot(folder / "arm.urdf", base="l0", tool="l7"),
                                       arm.springs), folder / "model.yaml")  # fmt: skip
        pose = ",".join(map(repr, a.tolist())) + " rad"
        wrench = ",".join(map(repr, load[:3].tolist())) + " N"
        found = heard(
            f"{SHARES[k % len(SHARES)]} of the critical load, arm {k}", "stiffness",
            str(folder / "model.yaml"), "--pose", pose, "--wrench", wrench, "--json",
        )  # fmt: skip
        loss = found.loss or _judged(json.loads(found.said[found.said.index("{") :]), arm, a, load)
        yield Verdict(found.attack, loss, found.seconds)


def _critical(arm: Arm, a: Array, load: Array) -> float:
    """Factor of a load at which K − λ ∂τ/∂q is singular; where none is, that of −load."""
    root = np.sqrt(arm.springs)
    values = np.linalg.eigvalsh(_statics(arm, a, load)[1] / np.outer(root, root))
    return float(1.0 / values[-1] if values[-1] > 0.0 else 1.0 / values[0])


def _statics(arm: Arm, q: Array, load: Array) -> tuple[Array, Array]:
    """(n,) torques of a force at the tool, w × r of every joint, and their slope by differences."""
    step = 1e-5 * np.eye(arm.n)
    at = np.concatenate([q[None], q + step, q - step])
    body, axes, origins = np.tile(np.eye(4), (len(at), 1, 1)), [], []
    for k, name in enumerate(arm.robot.actuated):
        joint = arm.tree.joints[name]
        body = body @ joint.origin
        axes.append(body[:, :3, :3] @ joint.axis)
        origins.append(body[:, :3, 3])
        x, y, z = joint.axis
        across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        sine, rest = np.sin(at[:, k])[:, None, None], 1.0 - np.cos(at[:, k])[:, None, None]
        turn = np.tile(np.eye(4), (len(at), 1, 1))
        turn[:, :3, :3] += sine * across + rest * (across @ across)
        body = body @ turn
    tip = body[:, :3, 3]
    torques = np.stack(
        [np.cross(w, tip - o) @ load[:3] for w, o in zip(axes, origins, strict=True)], axis=1
    )
    slope = (torques[1 : arm.n + 1] - torques[arm.n + 1 :]).T / 2e-5
    return torques[0], 0.5 * (slope + slope.T)


def followed(arm: Arm, a: Array, load: Array) -> tuple[float, Array]:
    """How much of the load the arm holds, followed from zero, and where it then stands."""
    q, K, way, stride = a.copy(), np.diag(arm.springs), 0.0, 1.0 / STEPS
    while way < 1.0 and stride > 1e-4:
        ahead, tried = min(1.0, way + stride), q.copy()
        for _ in range(12):
            torques, slope = _statics(arm, tried, ahead * load)
            change = np.linalg.solve(K - slope, arm.springs * (tried - a) - torques)
            tried = tried - change
            if np.abs(change).max() < 1e-10 or np.abs(tried - q).max() > 0.5:
                break
        held = np.abs(change).max() < 1e-10 and np.abs(tried - q).max() < 0.5
        if held and np.linalg.eigvalsh(K - _statics(arm, tried, ahead * load)[1])[0] > 0.0:
            q, way = tried, ahead
        else:
            stride *= 0.5
    return way, q


def _judged(document: dict, arm: Arm, a: Array, load: Array) -> str:
    bent, stable = document["deflection"], document["definiteness"]["K_theta_minus_K_C"]
    if (stable != "positive definite") != (bent["enhanced"] is None):
        return f"K_theta - K_C is {stable}, and the enhanced deflection is {bent['enhanced']}"
    for name in ("enhanced", "equilibrium"):
        if (bent[name] is None) != (name in bent["why_null"]):
            return f"{name}: {bent[name]}, because {bent['why_null'].get(name)}"
    held, q = followed(arm, a, load)
    if bent["equilibrium"] is None:
        said = BALANCE in bent["why_null"]["equilibrium"]
        return (
            "" if said and held < 1.0 + NEAR - 1e-9 and held < 1.0 else f"but it holds {held:.3g}"
        )
    moved = arm.position(q, np.zeros(3)) - arm.position(a, np.zeros(3))
    if held < 1.0 - NEAR:
        return f"an equilibrium where the way from zero ends at {held:.3g}"
    off = float(np.abs(moved - bent["equilibrium"]).max())
    return "" if held < 1.0 or off < 1e-6 else f"off the balance by {off:.2g} m"
